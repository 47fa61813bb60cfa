// What probes take: the triangles of a box, the nearest interface, the nearest point of the boundary.
#include "analysis/probes.hpp"

#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

namespace probes_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("a probe of a box has the mean stress of its triangles") {
    ModelInput input;
    input.mesh = bar_mesh(8, 2, 4, 1);
    input.plane = PlaneModel::stress;
    input.materials = {{.density = 1, .E = 10, .nu = 0.25}};
    input.laws = {{.sigma_c = 1e9, .G_c = 1, .gamma = 1}};
    input.law_of_pair = {{0}};
    const Model model = make_model(input);
    State state = initial_state(model);
    // u_x = a x^2/2: the strain a x is linear, and so its mean in a box of whole cells is that at the middle
    const double a = 1e-3;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const double x = model.mesh.corner(c).x();
        state.displacement[state.node_of_corner[c]] = {0.5 * a * x * x, 0};
    }
    using Watch = ProbeOptions::Watch;
    const Probes probes(model, {{.name = "all", .watch = Watch::stress},
                                {.name = "right", .watch = Watch::stress, .box = Box{{2, -1}, {4, 2}}},
                                {.name = "end", .at = {4, 0}}});
    const auto names = probes.columns();
    REQUIRE(names.size() == 1 + 3 + 3 + 4);
    CHECK(names[4] == "right_stress_xx");
    const std::vector<double> line = probes.line(state);
    const double D = 10 / (1 - 0.25 * 0.25);
    CHECK(line[1] == relative(D * a * 2, 1e-12));
    CHECK(line[2] == relative(0.25 * D * a * 2, 1e-12));
    CHECK(line[4] == relative(D * a * 3, 1e-12));
    CHECK(line[7] == relative(8 * a, 1e-12));
    CHECK_THROWS_AS(Probes(model, {{.name = "none", .watch = Watch::stress, .box = Box{{5, 5}, {6, 6}}}}),
                    SimulationError);
}

namespace {

using Watch = ProbeOptions::Watch;

/// 8 x 4 cells of 1 m on a support; the edges at y = 2 from x = 2 to 4 are a pre-crack, material 1 begins at x = 6.
ModelInput cracked_block() {
    ModelInput input;
    input.mesh = bar_mesh(8, 4, 8, 4, [](int column) { return column < 6 ? 0 : 1; });
    for (InteriorEdge& edge : input.mesh.interior_edges) {
        const auto [a, b] = input.mesh.side_vertices(edge.triangle[0], edge.side[0]);
        const Vec2 middle = 0.5 * (input.mesh.vertices[a] + input.mesh.vertices[b]);
        edge.cracked = middle.y() == 2 && middle.x() > 2 && middle.x() < 4;
    }
    input.materials = {{.density = 1, .E = 1, .nu = 0}, {.density = 1, .E = 1, .nu = 0}};
    input.laws = {{.sigma_c = 1, .G_c = 1}, {.friction = 0.5}};
    input.law_of_pair = {{0, 0}, {0, 0}};
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = false}};
    return input;
}

ProbeSubject taken_by(const Model& model, const ProbeOptions& probe) { return Probes(model, {probe}).subjects()[0]; }

void damage(const Model& model, State& state, Index interface, double cohesion) {
    for (const Index end : {0, 1}) {
        const Index p = model.fan_point_of[2 * interface + end];
        for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
            const Fan& fan = model.fans[f];
            if (p < fan.first_point || p >= fan.first_point + fan.n_points) continue;
            if (state.split_rank[f] < 0) split(model, f, state);
            state.points[state.first_point[state.split_rank[f]] + p - fan.first_point].cohesion = cohesion;
        }
    }
}

}  // namespace

TEST_CASE("a probe of an interface takes that whose edge is nearest and says which") {
    const Model model = make_model(cracked_block());
    const auto kind_at = [&](double x, double y) {
        return taken_by(model, {.name = "p", .at = {x, y}, .watch = Watch::interface}).kind;
    };
    CHECK(kind_at(3, 2) == "pre-crack");  // a vertex of six edges
    CHECK(kind_at(2, 2) == "pre-crack");  // its end
    CHECK(kind_at(3.3, 2.01) == "pre-crack");
    CHECK(kind_at(3.5, 2.3) == "interface");  // the diagonal there is nearer
    CHECK(kind_at(3, 0) == "support");        // a vertex of it and of edges inside
    CHECK(kind_at(3, -5) == "support");
    CHECK(kind_at(6, 1.5) == "boundary between materials");
    CHECK(kind_at(6, 2) == "boundary between materials");
    CHECK(kind_at(5, 1.5) == "interface");
    // an edge whose middle is far, beside one whose middle is near: distances count, of the edge
    ModelInput only = cracked_block();
    only.laws[0] = CohesiveLaw::unbreakable();
    only.supports.clear();
    const Model rigid = make_model(only);
    const ProbeSubject far = taken_by(rigid, {.name = "p", .at = {7, 2}, .watch = Watch::interface});
    CHECK(far.kind == "pre-crack");  // the others never open
    CHECK(far.distance == 3);
    CHECK(text_of(far) == "pre-crack from (4, 2) m to (3, 2) m, 3 m from its place");
    for (InteriorEdge& edge : only.mesh.interior_edges) edge.cracked = false;
    CHECK_THROWS_AS(Probes(make_model(only), {{.name = "p", .watch = Watch::interface}}), SimulationError);
}

TEST_CASE("a probe keeps an interface that has begun to open when a nearer one appears") {
    const Model model = make_model(cracked_block());
    Probes probes(model, {{.name = "p", .at = {5, 3.5}, .watch = Watch::interface}});
    const auto ends = [&] { return probes.subjects()[0].place; };
    const std::vector<Vec2> near = ends();
    Renumbering numbers;
    numbers.interface.assign(model.interfaces.size(), -1);
    // what the probe watched is now an interface at the far end
    const Index other = nearest_interface(model, {1, 0.5}).interface,
                watched = nearest_interface(model, {5, 3.5}).interface;
    numbers.interface[watched] = other;
    State state = initial_state(model);
    CHECK(probes.renumber(state, numbers).size() == 1);  // intact: the nearest one
    CHECK(ends() == near);
    damage(model, state, other, 0.5);
    numbers.interface[watched] = other;
    CHECK(probes.renumber(state, numbers).empty());
    CHECK(ends() != near);
    CHECK(probes.line(state)[3] == 0.5);
    probes.renew();  // an excavation elsewhere: it stays
    CHECK(probes.line(state)[3] == 0.5);
}

TEST_CASE("a probe outside the body takes the nearest point of the boundary") {
    const Model model = make_model(cracked_block());
    const ProbeSubject taken = taken_by(model, {.name = "p", .at = {2.5, 4.5}});
    REQUIRE(taken.place.size() == 1);
    CHECK((taken.place[0] - Vec2(2.5, 4)).norm() < 1e-12);  // the nearest vertices are half an edge away
    CHECK(taken.distance == relative(0.5, 1e-12));
    CHECK(taken_by(model, {.name = "p", .at = {3.2, 1.7}}).distance == 0);
    CHECK((taken_by(model, {.name = "p", .at = {9, 5}}).place[0] - Vec2(8, 4)).norm() < 1e-12);  // a corner
}

}  // namespace probes_test
