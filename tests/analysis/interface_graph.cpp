// What the crack graph and the fragments see of a model whose points are broken by hand.
#include "analysis/interface_graph.hpp"

#include "analysis/crack_history.hpp"
#include "analysis/fragments.hpp"
#include "model/make_model.hpp"
#include "model/state.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

namespace interface_graph_test {

using namespace knap;
using knap::tests::relative;

namespace {

/// A bar of 8 m x 2 m with cells of 1 m x 1 m.
Model bar(Index order = 1) {
    Mesh mesh = tests::bar_mesh(8, 2, 8, 2);
    mesh.order = order;
    return make_model({.mesh = mesh,
                       .thickness = 0.5,
                       .materials = {{.density = 1000, .E = 1e9, .nu = 0.2}},
                       .laws = {{.sigma_c = 1e6, .G_c = 100}},
                       .law_of_pair = {{0}}});
}

bool stands_at(const Model& model, const Interface& i, double x) {
    return std::abs(model.mesh.vertices[i.vertex[0]].x() - x) + std::abs(model.mesh.vertices[i.vertex[1]].x() - x) <
           1e-9;
}

/// Gives all points of the upright interfaces at x this cohesion, below height y.
void weaken(const Model& model, State& state, double x, double y, double cohesion) {
    for (Index point = 0; point < model.n_points(); ++point) {
        const Interface& i = model.interfaces[model.interface_of(point)];
        if (!stands_at(model, i, x) ||
            model.mesh.vertices[i.vertex[0]].y() + model.mesh.vertices[i.vertex[1]].y() > 2 * y)
            continue;
        const FanPoint& at = model.fan_points[model.fan_point_of[point]];
        const Index f = model.fan_of_corner[at.after];
        if (state.split_rank[f] < 0) split(model, f, state);
        const Index in_fan = model.fan_point_of[point] - model.fans[f].first_point;
        state.points[state.first_point[state.split_rank[f]] + in_fan].cohesion = cohesion;
    }
}

}  // namespace

TEST_CASE("status of interfaces follows the cohesion of their points") {
    const Model model = bar();
    State state = initial_state(model);
    weaken(model, state, 3, 2, 0.0);
    weaken(model, state, 5, 2, 0.5);
    const std::vector<InterfaceStatus> status = interface_status(model, state);
    int n_upright = 0;
    for (std::size_t i = 0; i < status.size(); ++i) {
        const bool at_3 = stands_at(model, model.interfaces[i], 3), at_5 = stands_at(model, model.interfaces[i], 5);
        n_upright += at_3 + at_5;
        CHECK(status[i] == (at_3   ? InterfaceStatus::broken
                            : at_5 ? InterfaceStatus::damaged
                                   : InterfaceStatus::intact));
    }
    CHECK(n_upright == 4);
}

TEST_CASE("statuses that are followed step by step are those of the state") {
    const Model model = bar();
    State state = initial_state(model);
    StatusWatch watch(model);
    std::vector<InterfaceStatus> known(model.interfaces.size(), InterfaceStatus::intact);
    const auto follow = [&] {
        const std::vector<EdgeStatus>& changed = watch.changed(state);
        for (const auto& [edge, status] : changed) known[edge] = status;
        CHECK(known == interface_status(model, state));
        return changed.size();
    };
    CHECK(follow() == model.interfaces.size());
    CHECK(follow() == 0);
    weaken(model, state, 5, 2, 0.5);
    CHECK(follow() == 2);
    weaken(model, state, 5, 1, 0.0);
    weaken(model, state, 3, 2, 0.0);
    CHECK(follow() == 3);
    watch.renew();
    CHECK(follow() == model.interfaces.size());
}

TEST_CASE("a bar cut half and then in two") {
    const Model model = bar();
    State state = initial_state(model);
    CrackHistory history(interface_graph(model), {.arm_edges = 3, .short_arm_edges = 3, .speed_edges = 3});

    weaken(model, state, 3, 1, 0.0);
    CrackPattern cracks = history.snapshot(1, interface_status(model, state));
    CHECK(cracks.crack_length == relative(1));
    CHECK(cracks.main_start == CrackStart::boundary);
    REQUIRE(cracks.tips.size() == 1);
    CHECK((cracks.tips[0].position - Vec2(3, 1)).norm() < 1e-12);
    CHECK(find_fragments(model, state).pieces.size() == 1);

    weaken(model, state, 3, 2, 0.0);
    cracks = history.snapshot(2, interface_status(model, state));
    CHECK(cracks.crack_length == relative(2));
    CHECK(cracks.tips.empty());

    for (Vec2& v : state.velocity) v = Vec2(2, -1);
    const Fragments fragments = find_fragments(model, state);
    REQUIRE(fragments.pieces.size() == 2);
    CHECK(fragments.pieces[0].mass == relative(10 * 0.5 * 1000));
    CHECK(fragments.pieces[1].mass == relative(6 * 0.5 * 1000));
    CHECK(fragments.pieces[0].area == relative(10));
    CHECK((fragments.pieces[0].centre - Vec2(5.5, 1)).norm() < 1e-9);
    CHECK((fragments.pieces[1].velocity - Vec2(2, -1)).norm() < 1e-12);
    CHECK(fragments.pieces[0].n_triangles + fragments.pieces[1].n_triangles == model.mesh.n_triangles());
}

TEST_CASE("of second order halves of interfaces break when their two points have") {
    const Model model = bar(2);
    State state = initial_state(model);
    weaken(model, state, 3, 2, 0.0);
    // one end of the upright interfaces at 5
    for (Index point = 0; point < model.n_points(); ++point) {
        const Interface& edge = model.interfaces[model.interface_of(point)];
        if (!stands_at(model, edge, 5) || point % 3 == 0) continue;
        const Index f = model.fan_of_corner[model.fan_points[model.fan_point_of[point]].after];
        if (state.split_rank[f] < 0) split(model, f, state);
        state.points[state.first_point[state.split_rank[f]] + model.fan_point_of[point] - model.fans[f].first_point]
            .cohesion = 0;
    }
    const std::vector<InterfaceStatus> status = interface_status(model, state);
    const InterfaceGraph graph = interface_graph(model);
    REQUIRE(status.size() == 2 * model.interfaces.size());
    REQUIRE(graph.ends.size() == status.size());
    double broken = 0;
    for (std::size_t i = 0; i < status.size(); ++i) {
        const Vec2 along = graph.vertices[graph.ends[i][1]] - graph.vertices[graph.ends[i][0]];
        CHECK(along.norm() == relative(graph.length[i]));
        if (status[i] == InterfaceStatus::broken) broken += graph.length[i];
        if (stands_at(model, model.interfaces[i / 2], 5))
            CHECK(status[i] == (i % 2 == 0 ? InterfaceStatus::damaged : InterfaceStatus::broken));
    }
    CHECK(broken == relative(2 + 1));
    const Fragments fragments = find_fragments(model, state);  // the halves at 5 hold
    REQUIRE(fragments.pieces.size() == 2);
    CHECK(fragments.pieces[0].mass == relative(5 * 2 * 0.5 * 1000));
    CHECK(fragments.pieces[0].centre.x() == relative(5.5));
}

}  // namespace interface_graph_test
