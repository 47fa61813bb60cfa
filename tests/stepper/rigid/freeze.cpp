// The body becomes rigid pieces and deformable again: what stays, and what the books take.
#include "stepper/rigid/freeze.hpp"

#include "base/random.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

namespace rigid_freeze_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Two halves of a bar that nothing joins but contact, with velocities at random.
struct Halves {
    Model model;
    State state;

    explicit Halves(std::uint64_t seed) : model(make_model(input())), state(initial_state(model)) {
        freeze(model, state);  // parts what has no cohesion
        Random random(seed, "freeze");
        for (Vec2& v : state.velocity) v = Vec2(random.uniform(-2, 3), random.uniform(-1, 2));
    }
    static ModelInput input() {
        ModelInput made = turning_body(bar_mesh(6, 2, 3, 1, [](int i) { return Index(i >= 3); }),
                                       {.density = 2000, .E = 1e9, .nu = 0.2}, {.sigma_c = 1e6, .G_c = 10});
        made.materials.push_back(made.materials[0]);
        made.laws.push_back({.sigma_c = 0, .G_c = 0, .friction = 0.3});
        made.law_of_pair = {{0, 1}, {1, 0}};
        return made;
    }
    /// [N s, N s, N m s] about the origin, and [J], per piece.
    std::vector<std::pair<Vec3, double>> momenta(const FrozenBody& body) const {
        std::vector<std::pair<Vec3, double>> all(body.pieces.size(), {Vec3::Zero(), 0});
        for (Index c = 0; c < model.mesh.n_corners(); ++c) {
            const Vec2 &x = place_of(model, state, c), &v = state.velocity[state.node_of_corner[c]];
            auto& [momentum, energy] = all[body.piece_of_triangle[model.mesh.triangle_of(c)]];
            momentum += model.corner_mass[c] * Vec3(v.x(), v.y(), cross(x, v));
            energy += 0.5 * model.corner_mass[c] * v.squaredNorm();
        }
        return all;
    }
};

}  // namespace

TEST_CASE("pieces that become rigid keep momentum and angular momentum and the books take the vibration") {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Halves at(seed);
        const FrozenPieces frozen = freeze(at.model, at.state);
        REQUIRE(frozen.pieces.size() == 2);
        const auto before = at.momenta(*frozen.body);
        const std::vector<Vec2> places = at.state.displacement;
        at.state.frozen = frozen.body, at.state.rigid_pieces = frozen.pieces;
        place_nodes(at.model, at.state);
        const auto after = at.momenta(*frozen.body);
        double kinetic = 0;
        for (std::size_t p = 0; p < 2; ++p) {
            const RigidPiece& piece = frozen.pieces[p];
            const double M = frozen.body->pieces[p].mass;
            CHECK((after[p].first - before[p].first).norm() <= 1e-14 * before[p].first.norm());
            CHECK((M * piece.velocity - before[p].first.head<2>()).norm() <= 1e-14 * before[p].first.norm());
            CHECK(before[p].second - after[p].second == relative(frozen.vibration[p], 1e-13));
            CHECK(frozen.vibration[p] > 0.1 * before[p].second);  // at random: most of it
            kinetic += after[p].second;
        }
        CHECK(kinetic == relative(frozen.kinetic, 1e-14));
        double moved = 0;
        for (std::size_t i = 0; i < places.size(); ++i)
            moved = std::max(moved, (places[i] - at.state.displacement[i]).norm());
        CHECK(moved <= 1e-15 * 3);  // the length of the bar
    }
}

TEST_CASE("a rigid piece that turns keeps the distances of its nodes and deformable again its energy and momenta") {
    Halves at(7);
    const FrozenPieces frozen = freeze(at.model, at.state);
    at.state.frozen = frozen.body, at.state.rigid_pieces = frozen.pieces;
    place_nodes(at.model, at.state);
    const auto before = at.momenta(*frozen.body);
    const Vec2 first = place_of(at.model, at.state, 0), second = place_of(at.model, at.state, 4);
    RigidPiece& piece = at.state.rigid_pieces[0];
    piece.centre += Vec2(30, -40), piece.angle = 200.3;  // 32 turns: no small angle
    place_nodes(at.model, at.state);
    const Vec2 turned_first = place_of(at.model, at.state, 0), turned_second = place_of(at.model, at.state, 4);
    CHECK((turned_second - turned_first - turned(second - first, 200.3)).norm() <= 1e-13 * (second - first).norm());
    const auto after = at.momenta(*frozen.body);
    const double M = frozen.body->pieces[0].mass;
    const Vec2 v = frozen.pieces[0].velocity;
    CHECK((after[0].first - before[0].first).head<2>().norm() <= 1e-13 * M * v.norm());
    // about the origin: that of the centre, which moved, and the same spin
    CHECK(after[0].first.z() - before[0].first.z() == relative(M * cross(Vec2(30, -40), v), 1e-12));
    CHECK(after[0].second == relative(before[0].second, 1e-13));
    CHECK(after[1].second == before[1].second);
}

TEST_CASE("parts that turn about the last whole point between them are no rigid piece") {
    ModelInput input = turning_body(bar_mesh(2, 1, 2, 1), {.density = 2000, .E = 1e9, .nu = 0.2},
                                    {.sigma_c = 1e6, .G_c = 10, .friction = 0.3});
    const Model model = make_model(std::move(input));
    State state = initial_state(model);
    const Vec2 hinge(1, 0);
    const auto is_right = [&](Index corner) {
        const Index first = 3 * model.mesh.triangle_of(corner);
        double x = 0;
        for (Index k = 0; k < 3; ++k) x += model.mesh.corner(first + k).x() / 3;
        return x > 1;
    };
    for (Index f = 0; f < std::ssize(model.fans); ++f)  // the upper point of the edge between the halves
        if (model.mesh.vertices[model.fans[f].vertex] == Vec2(1, 1)) {
            split(model, f, state);
            const auto points = model.points(model.fans[f]);
            for (std::size_t j = 0; j < points.size(); ++j)
                if (is_right(points[j].before) != is_right(points[j].after))
                    state.points[state.first_point[state.split_rank[f]] + static_cast<Index>(j)].cohesion = 0;
        }
    const RigidOptions options{.step = 1e-3};
    const auto unrest_of = [&](double spin_left, double spin_right, const Vec2& velocity = Vec2::Zero()) {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            state.velocity[state.node_of_corner[c]] =
                velocity + (is_right(c) ? spin_right : spin_left) * turned_left(Vec2(model.mesh.corner(c) - hinge));
        const FrozenPieces frozen = freeze(model, state);
        REQUIRE(frozen.pieces.size() == 1);
        CHECK(frozen.strain == 0);
        if (!velocity.isZero()) CHECK((frozen.vibration[0] < 0.01 * frozen.kinetic) == (velocity.norm() > 1));
        return unrest(frozen.body->pieces[0], frozen.pieces[0], frozen.vibration[0], options);
    };
    CHECK(unrest_of(3, 3) < 1e-14);
    const double opens = unrest_of(-1, 1);
    CHECK(opens > 1);
    CHECK(unrest_of(0.5, 2.5) == relative(opens));  // the turn of the whole is no part of it
    CHECK(unrest_of(-0.1, 0.1) == relative(0.1 * opens));
    CHECK(unrest_of(-1, 1, {0, 10}) < 1);  // it flies so fast that its swing is a small part of its energy
    CHECK(unrest_of(-1, 1, {0, 0.1}) == relative(opens));
}

}  // namespace rigid_freeze_test
