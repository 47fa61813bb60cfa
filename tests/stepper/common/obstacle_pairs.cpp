// Rigid obstacles that meet each other, in both schemes: rolling and slipping on an incline, impacts, stacks and
// heaps that come to rest.
#include "model/make_ground.hpp"
#include "model/obstacle_gap.hpp"
#include "support/obstacles.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace obstacle_pairs_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double g = 9.81;

const std::array<SchemeOptions, 2> both_schemes{SchemeOptions{}, implicit(0.5)};
bool is_implicit(const SchemeOptions& scheme) { return scheme.bulk == BulkScheme::implicit_theta; }

/// A body far away that meets none of them.
ModelInput scene(std::vector<Obstacle> obstacles) {
    ModelInput input = point_masses({.sigma_c = 0}, false);
    input.supports.clear();
    for (Vec2& x : input.mesh.vertices) x += Vec2(1000, 1000);
    input.obstacles = std::move(obstacles);
    return input;
}

/// With the weight of the free ones.
ModelInput heavy_scene(std::vector<Obstacle> obstacles) {
    for (Obstacle& o : obstacles)
        if (o.is_free()) o.forces = {{.value = Vec3(0, -g * o.mass, 0), .history = {}}};
    return scene(std::move(obstacles));
}

Obstacle freed(Obstacle obstacle) {
    set_free(obstacle, 1);
    return obstacle;
}

Obstacle box(const Vec2& low, const Vec2& high, double friction) {
    return polygon({low, {high.x(), low.y()}, high, {low.x(), high.y()}}, {.friction = friction});
}

/// A triangle glued to a support from (0, 0) to (2, 0), turned by an angle about (0, 0). The support goes on by 20 m.
ModelInput on_support(std::vector<Obstacle> obstacles, double angle, double friction) {
    CohesiveLaw law = CohesiveLaw::unbreakable();
    law.friction = friction;
    ModelInput input = point_masses(law, true);
    for (Vec2& x : input.mesh.vertices) x = Rotation::by(angle).turned(x);
    input.supports[0].beyond = 20;
    input.contact_of_pair = {{{}}};
    input.obstacles = heavy_scene(std::move(obstacles)).obstacles;
    return input;
}

double kinetic(const Run& run) {
    double sum = 0;
    for (std::size_t o = 0; o < run.model.obstacles.size(); ++o)
        sum += kinetic_energy(run.model.obstacles[o], run.now.obstacles[o].velocity);
    return sum;
}

/// [m] The largest overlap of two of them.
double overlap(const Run& run) {
    double deepest = 0;
    for (std::size_t j = 0; j < run.model.obstacles.size(); ++j)
        for (std::size_t i = 0; i < j; ++i)
            deepest = std::max(deepest, -gap_between({run.model.obstacles[i].outline, run.now.obstacles[i].pose},
                                                     {run.model.obstacles[j].outline, run.now.obstacles[j].pose})
                                             .gap);
    return deepest;
}

void check_energy_balance(const Run& run) { tests::check_energy_balance(run, 1e-11, 1e-12); }

}  // namespace

TEST_CASE("a free disc rolls down an incline with two thirds of g sin a and slips below friction tan a over 3") {
    const double a = 0.3, radius = 0.2, h = 1e-3, steps = 400;
    const Vec2 down(std::cos(a), -std::sin(a)), normal(std::sin(a), std::cos(a));
    enum class Slope { half_plane, polygon, polyline };
    for (const SchemeOptions& scheme : both_schemes)
        for (const Slope kind : {Slope::half_plane, Slope::polygon, Slope::polyline})
            for (const double part : {3.0, 1.01, 0.99, 0.5, 0.0}) {  // friction over tan(a)/3
                CAPTURE(is_implicit(scheme));
                CAPTURE(kind);
                CAPTURE(part);
                const double mu = part * std::tan(a) / 3;
                const std::vector<Vec2> slope{-5 * down, -5 * down - 2 * normal, 5 * down - 2 * normal, 5 * down};
                std::vector<Vec2> line;  // of 300 sides, shorter than the disc
                for (int i = 0; i <= 300; ++i) line.push_back((5 - 10. * i / 300) * down);
                Run run(heavy_scene({kind == Slope::polyline  ? terrain(line, {.friction = mu})
                                     : kind == Slope::polygon ? polygon(slope, {.friction = mu})
                                                              : platen({0, 0}, normal, {.friction = mu}),
                                     boulder(radius * normal, radius, {0, 0}, {.friction = mu})}),
                        scheme);
                for (int i = 0; i < steps; ++i) run.step(h);
                // velocities of the explicit scheme live at the middle of the steps
                const double t = (steps - (is_implicit(scheme) ? 0 : 0.5)) * h;
                const Vec3& v = run.now.obstacles[1].velocity;
                const bool rolls = part > 1;
                CHECK(v.head<2>().dot(down) ==
                      relative(rolls ? 2.0 / 3 * g * std::sin(a) * t : g * (std::sin(a) - mu * std::cos(a)) * t, 1e-3));
                const double turns = rolls ? v.head<2>().dot(down) : 2 * mu * g * std::cos(a) * t;  // [m/s]
                CHECK(-v.z() * radius == (mu > 0 ? relative(turns, 1e-3) : within(0, 1e-14)));
                CHECK(std::abs(v.head<2>().dot(normal)) < 1e-12);
                check_energy_balance(run);
            }
}

TEST_CASE("two free discs exchange their speeds and keep their momentum") {
    for (const SchemeOptions& scheme : both_schemes)
        for (const double e : {1.0, 0.5, 0.0})
            for (const double mu : {0.0, 0.4}) {
                CAPTURE(e);
                CAPTURE(mu);
                const ContactLaw contact{.friction = mu, .restitution = e};
                Obstacle left = boulder({0, 0}, 0.5, {1, 0}, contact), right = boulder({1.1, 0}, 0.5, {0, 0}, contact);
                left.initial_velocity.z() = 2;
                Run run(scene({left, right}), scheme);
                const auto momenta = [&] {
                    Vec3 sum = Vec3::Zero();
                    for (std::size_t o = 0; o < 2; ++o) {
                        const Obstacle& obstacle = run.model.obstacles[o];
                        const ObstacleState& now = run.now.obstacles[o];
                        sum += obstacle.mass * wrench_of(now.velocity.head<2>(), now.pose.position);
                        sum.z() += obstacle.inertia * now.velocity.z();
                    }
                    return sum;
                };
                const Vec3 before = momenta();
                for (int i = 0; i < 200; ++i) run.step(1e-3);
                CHECK(run.now.obstacles[0].velocity.x() == relative(0.5 * (1 - e), 1e-9));
                CHECK(run.now.obstacles[1].velocity.x() == relative(0.5 * (1 + e), 1e-9));
                CHECK((momenta() - before).head<2>().norm() < 1e-12);
                CHECK(std::abs((momenta() - before).z()) <
                      5e-4);  // arms are those of the middle of the step: h/2 v x P
                CHECK((mu > 0) == (std::abs(run.now.obstacles[0].velocity.z() - 2) > 1e-3));
                check_energy_balance(run);
            }
}

TEST_CASE("a rigid block stands with 47 percent beyond the edge of another one and tips with 53") {
    for (const SchemeOptions& scheme : both_schemes)
        for (const double overhang : {0.47, 0.53}) {
            CAPTURE(overhang);
            CAPTURE(is_implicit(scheme));
            Run run(heavy_scene({box({-3, -2}, {0, 0}, 0.9), freed(box({overhang - 1, 0}, {overhang, 0.3}, 0.9))}),
                    scheme);
            for (int i = 0; i < 500; ++i) run.step(1e-3);
            if (overhang < 0.5) {
                CHECK(std::abs(run.now.obstacles[1].moved.z()) < 1e-12);
                CHECK(run.now.obstacles[1].reaction.y() == relative(0.3 * g, 1e-9));
            } else {
                CHECK(run.now.obstacles[1].moved.z() < -0.05);
            }
            CHECK(overlap(run) < 1e-4);
            check_energy_balance(run);
        }
}

TEST_CASE("a rigid block slides down a rigid incline as Coulomb says") {
    const double a = 0.4, mu = 0.3, h = 1e-3, steps = 300;
    const Vec2 down(std::cos(a), -std::sin(a)), normal(std::sin(a), std::cos(a));
    const std::vector<Vec2> block{Vec2(0, 0), down, down + 0.5 * normal, 0.5 * normal};
    for (const SchemeOptions& scheme : both_schemes) {
        Run run(heavy_scene({platen({0, 0}, normal, {.friction = mu}), freed(polygon(block, {.friction = mu}))}),
                scheme);
        for (int i = 0; i < steps; ++i) run.step(h);
        const double t = (steps - (is_implicit(scheme) ? 0 : 0.5)) * h;
        CHECK(run.now.obstacles[1].velocity.head<2>().dot(down) ==
              relative(g * (std::sin(a) - mu * std::cos(a)) * t, 1e-9));
        CHECK(std::abs(run.now.obstacles[1].moved.z()) < 1e-9);
        check_energy_balance(run);
    }
}

TEST_CASE("R_N and R_T are those of the point of contact of a rigid body as far as friction can") {
    const double R_N = 0.35, R_T = 0.8;
    // a triangle whose corner hits the ground beside its centre of mass: both components are coupled
    for (const double mu : {2.0, 0.1})
        for (const bool terrain_decides : {false, true}) {
            CAPTURE(mu);
            CAPTURE(terrain_decides);
            const ContactLaw law{
                .friction = mu, .restitution = R_N, .rebound = ContactLaw::Rebound::of_bodies, .tangential = R_T};
            Obstacle triangle =
                freed(polygon({{0, 0.01}, {0.7, 0.4}, {-0.2, 0.8}}, terrain_decides ? ContactLaw{} : law));
            triangle.initial_velocity = Vec3(-1, -2, 0.5);
            Run run(scene({terrain({{5, 0}, {-5, 0}}, law), triangle}));
            const Vec3 before = run.now.obstacles[1].velocity;
            Vec2 V_before, V_after;
            for (int i = 0; i < 100 && run.now.obstacles[1].velocity == before; ++i) {
                const Pose& pose = run.now.obstacles[1].pose;
                const Vec2 corner = Rotation::by(pose.angle).turned(triangle.outline.points[0]);
                const Vec2 arm = corner + 0.5e-3 * before.z() * turned_left(corner) -
                                 Vec2(0, 0.5 * (pose.position + corner).y());  // of the middle of the step
                run.step(1e-3);
                V_before = velocity_at(before, arm), V_after = velocity_at(run.now.obstacles[1].velocity, arm);
            }
            CHECK(V_before.y() < -1.5);
            CHECK(V_after.y() == relative(-R_N * V_before.y(), 1e-9));
            const Vec2 P = triangle.mass * (run.now.obstacles[1].velocity - before).head<2>();
            if (mu > 1) CHECK(V_after.x() == relative(R_T * V_before.x(), 1e-9));
            else CHECK(P.x() == relative(mu * P.y(), 1e-9));
            CHECK(V_after.x() <= R_T * V_before.x() * (1 - 1e-9));
            check_energy_balance(run);
        }
}

TEST_CASE("R_T brakes no slide: Coulomb's friction does") {
    const ContactLaw law{.friction = 0.3, .rebound = ContactLaw::Rebound::of_bodies, .tangential = 0.9};
    Obstacle block = freed(box({0, 0}, {0.4, 0.2}, 0));
    block.initial_velocity.x() = 1;
    Run run(heavy_scene({platen({0, 0}, {0, 1}, law), block}));
    for (int i = 0; i < 200; ++i) run.step(1e-3);
    CHECK(run.now.obstacles[1].velocity.x() == relative(1 - 0.3 * g * 199.5e-3, 1e-9));
    for (int i = 0; i < 300; ++i) run.step(1e-3);
    CHECK(std::abs(run.now.obstacles[1].velocity.x()) < 1e-12);
    check_energy_balance(run);
}

TEST_CASE("four free obstacles in a heap come to rest") {
    const std::vector<Obstacle> heap{freed(box({-0.8, 0.05}, {-0.1, 0.45}, 0.5)),
                                     freed(box({0.05, 0.02}, {0.7, 0.6}, 0.5)),
                                     boulder({-0.3, 1.0}, 0.25, {0, 0}, {.friction = 0.5}),
                                     freed(polygon({{0.1, 0.8}, {0.9, 0.9}, {0.4, 1.4}}, {.friction = 0.5}))};
    // in a bin of three obstacles, and on a terrain that is this bin
    for (const SchemeOptions& scheme : both_schemes)
        for (const bool on_terrain : {false, true}) {
            CAPTURE(on_terrain);
            CAPTURE(is_implicit(scheme));
            std::vector<Obstacle> obstacles{platen({0, 0}, {0, 1}, {.friction = 0.5}), box({-2, 0}, {-1, 5}, 0.5),
                                            box({1, 0}, {2, 5}, 0.5)};
            if (on_terrain) obstacles = {terrain({{1, 5}, {1, 0}, {0.02, 0}, {-1, 0}, {-1, 5}}, {.friction = 0.5})};
            const std::size_t n_fixed = obstacles.size();
            obstacles.insert(obstacles.end(), heap.begin(), heap.end());
            Run run(heavy_scene(obstacles), scheme);
            for (int i = 0; i < 4000; ++i) run.step(1e-3);
            CHECK(kinetic(run) < 1e-12);
            CHECK(overlap(run) < 5e-3);
            double weight = 0, reaction = 0;
            for (std::size_t o = n_fixed; o < obstacles.size(); ++o) weight += g * run.model.obstacles[o].mass;
            for (std::size_t o = 0; o < n_fixed; ++o) reaction += run.now.obstacles[o].reaction.y();
            CHECK(reaction == relative(-weight, 1e-6));
            check_energy_balance(run);
        }
}

TEST_CASE("discs and a box in a wide valley come to rest in implicit steps of any size") {
    for (const double h : {1e-3, 5e-3}) {
        CAPTURE(h);
        const auto disc = [](const Vec2& at, double radius) {
            Obstacle made = boulder(at, radius, {0, 0}, {.friction = 0.5});
            set_free(made, 1);
            return made;
        };
        Run run(
            heavy_scene({terrain({{3, 2}, {0.6, 0}, {-0.6, 0}, {-3, 2}}, {.friction = 0.5}), disc({-0.25, 0.251}, 0.25),
                         disc({0.26, 0.251}, 0.25), freed(box({-0.2, 0.71}, {0.25, 1}, 0.5)), disc({0.02, 1.2}, 0.15)}),
            implicit(0.5));
        while (run.now.time < 3) run.step(h);
        CHECK(kinetic(run) < 1e-25);  // with friction sgn(w_T) alone 1.5e-6 and 1.4e-5 are left
        check_energy_balance(run);
    }
}

TEST_CASE("a disc and a square lie in a valley of a terrain and press on both of its sides") {
    const double angle = 0.6, radius = 0.2;
    const Vec2 left(-std::cos(angle), std::sin(angle)), right(std::cos(angle), std::sin(angle));
    for (const SchemeOptions& scheme : both_schemes)
        for (const bool is_disc : {true, false}) {
            CAPTURE(is_disc);
            CAPTURE(is_implicit(scheme));
            const double height = radius / std::cos(angle);
            const Obstacle body =
                is_disc ? boulder({0, height + 1e-3}, radius, {0, 0})
                        : freed(polygon({{0, 0.1}, {0.1, 0.2}, {0, 0.3}, {-0.1, 0.2}}, {.friction = 0.9}));
            const ContactLaw contact{.friction = is_disc ? 0 : 0.9};
            Run run(heavy_scene({terrain({2 * right, Vec2(0, 0), 2 * left}, contact), body}), scheme);
            for (int i = 0; i < 3000; ++i) run.step(1e-3);
            CHECK(kinetic(run) < 1e-12);
            CHECK(run.now.obstacles[1].reaction.y() == relative(run.model.obstacles[1].mass * g, 1e-6));
            if (is_disc)
                CHECK(run.now.obstacles[1].pose.position.y() == relative(height, is_implicit(scheme) ? 2e-4 : 1e-4));
            // what lands in an implicit step overlaps by (1 - theta) of its path
            CHECK(overlap(run) < (is_implicit(scheme) ? 4e-4 : 1e-4));
            check_energy_balance(run);
        }
}

TEST_CASE("a disc that rolls over the summit of a terrain follows its corner") {
    // a roof whose sides fall by 20 degrees: the disc comes over it slowly and stays on it
    const double angle = 20 * degree, radius = 0.3;
    Obstacle disc =
        boulder({0.2, radius / std::cos(angle) - 0.2 * std::tan(angle) + 1e-9}, radius, {-0.9, 0.3}, {.friction = 2});
    disc.initial_velocity = Vec3(-1.3 * std::cos(angle), 1.3 * std::sin(angle), 1.3 / radius);
    Run run(heavy_scene(
        {terrain({Vec2(3, -3 * std::tan(angle)), Vec2(0, 0), Vec2(-3, -3 * std::tan(angle))}, {.friction = 2}), disc}));
    double highest = -1;
    for (int i = 0; i < 600; ++i) {
        run.step(1e-3);
        highest = std::max(highest, run.now.obstacles[1].pose.position.y());
    }
    CHECK(highest == relative(radius, 1e-3));
    CHECK(run.now.obstacles[1].pose.position.x() < -0.1);
    CHECK(overlap(run) < 1e-3);
    check_energy_balance(run);
}

TEST_CASE("what leaves the end of a terrain falls past it") {
    Run run(heavy_scene({terrain({{1, 0}, {0, 0}}), boulder({0.1, 0.1}, 0.1, {-1, 0})}));
    for (int i = 0; i < 1000; ++i) run.step(1e-3);
    CHECK(run.now.obstacles[1].pose.position.y() < -0.5);
    check_energy_balance(run);
}

TEST_CASE("a driven polygon that turns carries a block") {
    // a plate turns slowly under a block, which it lifts without a gap
    Obstacle plate = box({-1, -0.2}, {1, 0}, 1.0);
    plate.drive[2] = driven(0.2);
    for (const SchemeOptions& scheme : both_schemes) {
        CAPTURE(is_implicit(scheme));
        Run run(heavy_scene({plate, freed(box({-0.3, 0}, {0.3, 0.2}, 1.0))}), scheme);
        for (int i = 0; i < 1000; ++i) run.step(1e-3);
        CHECK(run.now.obstacles[1].moved.z() == relative(0.2, 1e-3));
        CHECK(overlap(run) < 1e-4);
        check_energy_balance(run);
    }
}

TEST_CASE("a free disc rolls or slips on the ground of a support that goes on as on an obstacle") {
    const double a = 0.3, radius = 0.2, h = 1e-3, steps = 200;
    const Vec2 down(std::cos(a), -std::sin(a)), normal(std::sin(a), std::cos(a));
    for (const SchemeOptions& scheme : both_schemes)
        for (const double part : {1.01, 0.5}) {  // friction over tan(a)/3
            CAPTURE(is_implicit(scheme));
            CAPTURE(part);
            const double mu = part * std::tan(a) / 3;
            Run run(on_support({boulder(4 * down + radius * normal, radius, {0, 0}, {.friction = mu})}, -a, mu),
                    scheme);
            for (int i = 0; i < steps; ++i) run.step(h);
            const double t = (steps - (is_implicit(scheme) ? 0 : 0.5)) * h;
            const Vec3& v = run.now.obstacles[0].velocity;
            CHECK(v.head<2>().dot(down) ==
                  relative(part > 1 ? 2.0 / 3 * g * std::sin(a) * t : g * (std::sin(a) - mu * std::cos(a)) * t, 1e-3));
            CHECK(std::abs(v.head<2>().dot(normal)) < 1e-12);
            CHECK(run.now.obstacles[0].reaction.head<2>().dot(normal) == relative(g * std::cos(a), 1e-9));
            check_energy_balance(run);
        }
}

TEST_CASE("a rigid block stands beside a body beyond the end of its support and starts in equilibrium there") {
    for (const SchemeOptions& scheme : both_schemes)
        for (const double overhang : {0.47, 0.53}) {
            CAPTURE(overhang);
            CAPTURE(is_implicit(scheme));
            const double end = 22;
            Run run(on_support({freed(box({end + overhang - 1, 0}, {end + overhang, 0.3}, 0.9))}, 0, 0.9), scheme);
            if (overhang < 0.5) {
                run.stepper.start_in_equilibrium(run.now);
                CHECK(run.now.obstacles[0].reaction.y() == relative(0.3 * g, 1e-9));
            }
            for (int i = 0; i < 300; ++i) run.step(1e-3);
            const double turned = run.now.obstacles[0].moved.z();
            if (overhang < 0.5) CHECK(std::abs(turned) < 1e-12);
            else CHECK(turned < -0.02);
            check_energy_balance(run);
        }
}

TEST_CASE("a free disc rests in a valley whose sides are supports that go on beyond the body in it") {
    const double radius = 8, height = radius * std::sqrt(2.0);
    for (const SchemeOptions& scheme : both_schemes) {
        CAPTURE(is_implicit(scheme));
        ModelInput input = on_support({boulder({0, height}, radius, {0, 0})}, 0, 0);
        input.mesh.vertices = {{-2, 2}, {0, 0}, {2, 2}};
        for (BoundaryEdge& edge : input.mesh.boundary_edges) edge.boundary = edge.side < 2 ? 0 : 1;
        Run run(std::move(input), scheme);
        CHECK(obstacles_of_ground(run.model).size() == 1);
        run.stepper.start_in_equilibrium(run.now);
        for (int i = 0; i < 50; ++i) run.step(1e-3);
        const ObstacleState& disc = run.now.obstacles[0];
        CHECK(disc.reaction.y() == relative(g, 1e-9));
        CHECK(std::abs(disc.reaction.x()) < 1e-9);
        CHECK(disc.moved.norm() < 1e-12);
        check_energy_balance(run);
    }
}

}  // namespace obstacle_pairs_test
