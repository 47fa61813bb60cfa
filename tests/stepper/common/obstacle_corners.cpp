// Corners of obstacles against the inside of edges of the body, on both bulks: exact impacts, balances, nothing passes
// between the nodes.
#include "stepper/common/obstacle_contacts.hpp"
#include "support/bodies.hpp"
#include "support/obstacles.hpp"
#include "support/pieces.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace obstacle_corners_test {

using namespace knap;
using namespace knap::tests;

namespace {

Obstacle wedge(const Vec2& tip, const ContactLaw& contact, double side) {
    return polygon({tip, tip + Vec2(side * 0.4, side), tip + Vec2(-side * 0.4, side)}, contact);
}

void check_energy_balance(const Run& run) { tests::check_energy_balance(run, 1e-10, 1e-12); }

const SchemeOptions schemes[] = {{}, implicit()};

}  // namespace

TEST_CASE("a tip that meets an edge shares its impulse between the masses at its ends as a rod does") {
    // masses of 1 at x = 0 and 2 and the tip at share s = 1/4: P = (1 + e) v / ((1 - s)^2 + s^2 + 1/M), ends (1 - s) P
    // and s P
    for (const SchemeOptions& scheme : schemes)
        for (const double e : {0.0, 0.5, 1.0})
            for (const bool free : {false, true}) {
                CAPTURE(e);
                CAPTURE(free);
                ModelInput input = point_masses({.sigma_c = 0}, false);
                input.supports.clear();
                Obstacle tip = wedge({0.5, -0.0105}, {.restitution = e}, -1);
                const double mass = 5;
                if (free) {
                    set_free(tip, mass / tip.outline.area());
                    tip.drive[2] = {};  // it does not turn
                    tip.initial_velocity = Vec3(0, 1, 0);
                } else {
                    tip.drive[1] = driven(1);
                }
                input.obstacles = {tip};
                Run run(input, scheme);
                while (run.now.time < 0.0195) run.step(1e-3);
                const double accuracy =
                    e > 0 ? 1e-9 : 1e-4;  // without a rebound the contact goes on, and the edge turns under it
                const double impulse = (1 + e) / (0.75 * 0.75 + 0.25 * 0.25 + (free ? 1 / mass : 0));
                CHECK(run.v(0, 0).y() == relative(0.75 * impulse, accuracy));
                CHECK(run.v(0, 1).y() == relative(0.25 * impulse, accuracy));
                if (free) CHECK(run.now.obstacles[0].velocity.y() == relative(1 - impulse / mass, accuracy));
                check_energy_balance(run);
            }
}

TEST_CASE("a block slides over the seam between two flush polygons as over one") {
    for (const SchemeOptions& scheme : schemes)
        for (const double speed : {1.0, 0.1})
            for (const double seam : {1.13, 1.25}) {
                CAPTURE(speed);
                CAPTURE(seam);
                const auto end = [&](const std::vector<double>& edges) {
                    ModelInput input = free_block(1, CohesiveLaw::unbreakable());
                    for (std::size_t i = 1; i < edges.size(); ++i)
                        input.obstacles.push_back(
                            polygon({{edges[i - 1], -1}, {edges[i], -1}, {edges[i], 0}, {edges[i - 1], 0}}, {}));
                    input.loads = {load(Load::Kind::acceleration, "", 0.0, -0.1, {{0, 1}, {0, 1}})};
                    Run run(input, scheme);
                    for (Vec2& v : run.now.velocity) v.x() = speed;
                    const double h = std::min(5e-3, 0.8 * run.stepper.stable_step());
                    while (run.now.time * speed < 0.5) run.step(h);
                    return run.now.displacement;
                };
                const std::vector<Vec2> two = end({-2, seam, 5}), one = end({-2, 5});
                for (std::size_t i = 0; i < one.size(); ++i) CHECK((two[i] - one[i]).norm() < 1e-9);
            }
}

TEST_CASE("a sharp boulder that falls between the nodes of a block does not pass and momentum and energy balance") {
    for (const SchemeOptions& scheme : schemes)
        for (const int order : {1, 2})
            for (const double mu : {0.0, 0.4}) {
                CAPTURE(order);
                CAPTURE(mu);
                ModelInput input = free_block(order, CohesiveLaw::unbreakable());
                Obstacle tip = wedge({0.4, 1.002}, {.friction = mu}, 1);
                set_free(tip, 2);
                tip.initial_velocity = Vec3(0.05, -0.5, 0.2);
                input.obstacles = {tip};
                Run run(input, scheme);
                const auto momentum = [&] {
                    Vec2 sum = tip.mass * run.now.obstacles[0].velocity.head<2>();
                    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
                        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]];
                    return sum;
                };
                const Vec2 before = momentum();
                const double h = std::min(2e-3, 0.8 * run.stepper.stable_step());
                double deepest = 0;
                while (run.now.time < 0.3) {
                    REQUIRE(run.step_if_taken(h));
                    const Vec2 x =
                        run.now.obstacles[0].pose.position +
                        Rotation::by(run.now.obstacles[0].pose.angle).turned(run.model.obstacles[0].outline.points[0]);
                    for (const BoundaryEdge& edge : run.model.mesh.boundary_edges) {
                        const Index k = edge.side, next = (k + 1) % 3;
                        const Vec2 a = run.model.mesh.corner(edge.triangle, k) + run.u(edge.triangle, k);
                        const Vec2 b = run.model.mesh.corner(edge.triangle, next) + run.u(edge.triangle, next);
                        const double depth = cross(b - a, x - a) / (b - a).norm();
                        if (order == 1 && a.y() > 0.9 && b.y() > 0.9 && x.x() > b.x() && x.x() < a.x())
                            deepest = std::max(deepest, depth);
                    }
                }
                CHECK(run.now.obstacles[0].velocity.y() > -0.4);  // braked
                CHECK(deepest <= 2e-3);                           // two steps' way, of a way of .15
                CHECK((momentum() - before).norm() <= 1e-10 * before.norm());
                CHECK((mu > 0) == (run.ledger.row().friction_work < -1e-9));
                check_energy_balance(run);
            }
}

TEST_CASE("the corner of an open crack of a rigid piece meets an obstacle") {
    // eight triangles round a vertex: three stand with their tip on the ground, five have moved up
    std::vector<Vec2> outline;
    for (int i = 0; i < 8; ++i) outline.push_back(turned({1, 0}, 0.25 * i * std::numbers::pi));
    const Vec2 up = turned({1, 0}, 0.375 * std::numbers::pi);
    ModelInput input;
    input.mesh = star_mesh(outline);
    input.mesh.boundary_names = {"free"};
    find_edges(input.mesh);
    input.materials.push_back({.density = 1, .E = 1, .nu = 0.2});
    input.laws.push_back({.sigma_c = 1, .G_c = 1});
    input.law_of_pair.assign(1, std::vector<Index>(1, 0));
    input.obstacles = {platen(-2 * up, up)};
    const Model model = make_model(input);
    State state = initial_state(model);
    state.obstacles[0].pose.position = {0, 0};
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f)
        if (model.fans[f].n_points > 0) split(model, f, state);
    for (Index c = 9; c < model.mesh.n_corners(); ++c) state.displacement[state.node_of_corner[c]] = 2 * up;
    const auto body = std::make_shared<FrozenBody>();
    body->piece_of_triangle.assign(8, 0);
    body->pieces.push_back({.first_triangle = 0, .n_triangles = 8, .radius = 4});
    state.rigid_pieces.resize(1);
    ObstacleContacts contacts(model);
    contacts.set_pieces(body);
    contacts.find(state, 1e-3, std::vector<Vec3>(1, Vec3::Zero()), {});
    REQUIRE(contacts.all().size() == 1);
    CHECK(contacts.all()[0].corner % 3 == 2);
    CHECK(contacts.all()[0].corner < 9);
    CHECK(std::abs(contacts.all()[0].gap) < 1e-15);
}

}  // namespace obstacle_corners_test
