// Polylines, contact pieces and the retirement of points round cracks.
#include "stepper/contact/retirement.hpp"
#include "support/pieces.hpp"

#include <doctest/doctest.h>

#include <set>

namespace free_boundary_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// n triangles round a vertex, numbered counterclockwise; edge i leads from the centre to vertex i, before triangle i.
Mesh wheel(int n) {
    std::vector<Vec2> outline;
    for (int i = 0; i < n; ++i) outline.push_back(turned({1, 0}, 2 * std::numbers::pi * i / n));
    return star_mesh(outline);
}

/// Splits every fan and breaks every point.
void break_all(Pieces& scene) {
    for (Index f = 0; f < Index(scene.model.fans.size()); ++f)
        if (scene.state.split_rank[f] < 0) split(scene.model, f, scene.state);
    for (PointState& point : scene.state.points) point.cohesion = 0;
}

/// The point at vertex `at` of the interface between two vertices.
Index point_at(const Model& model, Index at, Index other) {
    for (std::size_t i = 0; i < model.interfaces.size(); ++i)
        for (Index place = 0; place < 2; ++place)
            if (model.interfaces[i].vertex[place] == at && model.interfaces[i].vertex[1 - place] == other)
                return 2 * Index(i) + place;
    return -1;
}

/// Every edge has one predecessor and one successor, and the polylines are closed: the number of them.
int n_polylines(const FreeBoundary& boundary) {
    const auto edges = boundary.edges();
    std::set<Index> seen;
    int n = 0;
    for (Index e = 0; e < Index(edges.size()); ++e) {
        CHECK(edges[edges[e].next].prev == e);
        CHECK(edges[edges[e].prev].next == e);
        if (seen.contains(e)) continue;
        ++n;
        for (Index i = e; seen.insert(i).second;) i = edges[i].next;
    }
    return n;
}

int n_vertices(const FreeBoundary& boundary) {
    return int(std::ranges::count_if(boundary.edges(), [](const FreeEdge& edge) { return edge.entering >= 0; }));
}

}  // namespace

TEST_CASE("the boundary of a whole body is one polyline") {
    const Pieces scene({bar_mesh(4, 3, 4, 3)});
    const FreeBoundary boundary(scene.model);
    CHECK(boundary.edges().size() == 14);
    CHECK(n_polylines(boundary) == 1);
    CHECK(n_vertices(boundary) == 14);
    for (const FreeEdge& edge : boundary.edges()) {
        CHECK(edge.piece_start >= 0);
        const FreeEdge& before = boundary.edges()[edge.entering];
        CHECK(scene.model.mesh.corner(before.end) == scene.model.mesh.corner(edge.start));
        CHECK_FALSE(edge.reflex_piece);
    }
}

TEST_CASE("a star of three cracks gives three pieces that are reflex only where they are") {
    Pieces scene({wheel(6)});  // the centre is vertex 6
    FreeBoundary boundary(scene.model);
    const Index centre = 6;
    const auto retire = [&](Index at, Index other) {
        REQUIRE(point_at(scene.model, at, other) >= 0);
        scene.state.retired[point_at(scene.model, at, other)] = Retirement::retired;
    };
    const auto pieces_at_centre = [&] {
        std::vector<const FreeEdge*> pieces;
        for (const FreeEdge& edge : boundary.edges())
            if (edge.entering >= 0 && scene.model.mesh.corner(edge.start).norm() < 1e-12) pieces.push_back(&edge);
        return pieces;
    };
    CHECK_FALSE(boundary.update(scene.state.retired));
    CHECK(boundary.edges().size() == 6);
    // far ends retire first: edges on both sides, but the fan at the centre still owns its points
    for (const Index i : {0, 2, 3}) retire(i, centre);
    CHECK(boundary.update(scene.state.retired));
    CHECK(boundary.edges().size() == 12);
    CHECK(n_polylines(boundary) == 3);  // wedges of 120, 60 and 180 degrees
    CHECK(pieces_at_centre().empty());
    CHECK(n_vertices(boundary) == 6 + 3);
    // the centre retires at one crack: one piece of 360 degrees; at two: 120 and 240; at three
    retire(centre, 0);
    CHECK(boundary.update(scene.state.retired));
    REQUIRE(pieces_at_centre().size() == 1);
    CHECK(pieces_at_centre()[0]->reflex_piece);
    retire(centre, 2);
    boundary.update(scene.state.retired);
    REQUIRE(pieces_at_centre().size() == 2);
    CHECK(pieces_at_centre()[0]->reflex_piece != pieces_at_centre()[1]->reflex_piece);
    retire(centre, 3);
    boundary.update(scene.state.retired);
    REQUIRE(pieces_at_centre().size() == 3);
    // every edge is in the piece at whose vertex it ends
    for (const FreeEdge& edge : boundary.edges()) {
        CHECK(boundary.edges()[edge.piece_end].entering >= 0);
        CHECK(edge.piece_end == edge.next);
    }
    // the same from one list of points, and from a state with fewer retired points
    FreeBoundary anew(scene.model);
    anew.update(scene.state.retired);
    CHECK(anew.edges().size() == boundary.edges().size());
    const std::vector none(scene.state.retired.size(), Retirement::none);
    CHECK(anew.update(none));
    CHECK(anew.edges().size() == 6);
    CHECK(n_polylines(anew) == 1);
    CHECK(n_vertices(anew) == 6);
}

TEST_CASE("a crack that reaches the outer boundary splits its vertex when its point retires") {
    Pieces scene({bar_mesh(2, 1, 2, 1)});  // the vertical edge in the middle joins vertices 1 (below) and 4
    FreeBoundary boundary(scene.model);
    REQUIRE(point_at(scene.model, 1, 4) >= 0);
    scene.state.retired[point_at(scene.model, 1, 4)] = Retirement::retired;
    boundary.update(scene.state.retired);
    CHECK(boundary.edges().size() == 8);
    CHECK(n_polylines(boundary) == 2);  // the wedges at vertex 4 are apart, but the live point keeps them one piece
    CHECK(n_vertices(boundary) == 7);
    const auto at_hinge = [&] {
        std::vector<FreeEdge> found;
        for (const FreeEdge& edge : boundary.edges())
            if (scene.model.mesh.corner(edge.start) == Vec2(1, 1)) found.push_back(edge);
        return found;
    };
    REQUIRE(at_hinge().size() == 2);
    CHECK(at_hinge()[0].piece_start == at_hinge()[1].piece_start);
    // turned wide open it has two vertices, which belong to one group: the point keeps them apart
    scene.state.retired[point_at(scene.model, 4, 1)] = Retirement::parted;
    CHECK(boundary.update(scene.state.retired));
    CHECK(boundary.edges().size() == 8);
    CHECK(n_vertices(boundary) == 8);
    CHECK(at_hinge()[0].piece_start != at_hinge()[1].piece_start);
    CHECK(at_hinge()[0].group_start == at_hinge()[1].group_start);
    scene.state.retired[point_at(scene.model, 4, 1)] = Retirement::retired;
    boundary.update(scene.state.retired);
    CHECK(n_polylines(boundary) == 2);
    CHECK(n_vertices(boundary) == 8);
    CHECK(at_hinge()[0].group_start != at_hinge()[1].group_start);
}

TEST_CASE("a point retires beyond a slip or opening of two thousandths of its edge and beyond as many radians") {
    const auto marked = [](Retirement mark, const Vec2& shift, double angle, double cohesion) {
        Pieces scene({bar_mesh(1, 1, 1, 1)});
        break_all(scene);
        for (PointState& point : scene.state.points) point.cohesion = cohesion;
        for (Index c = 3; c < 6; ++c)
            scene.displacement(c) = turned(scene.model.mesh.corner(c), angle) - scene.model.mesh.corner(c) + shift;
        scene.retire();
        return int(std::ranges::count(scene.state.retired, mark));
    };
    const auto retired = [&](const Vec2& shift, double angle, double cohesion) {
        return marked(Retirement::retired, shift, angle, cohesion);
    };
    const auto parted = [&](const Vec2& shift, double angle, double cohesion) {
        return marked(Retirement::parted, shift, angle, cohesion);
    };
    const Vec2 along = Vec2(1, 1), across = Vec2(-1, 1) / std::sqrt(2.0);  // of the diagonal, whose length is sqrt(2)
    CHECK(retired(0.0016 * along, 0, 0) == 0);
    CHECK(retired(0.0024 * along, 0, 0) == 2);
    CHECK(retired(0.0024 * along, 0, 0.01) == 0);
    CHECK(retired(0.0016 * std::sqrt(2.0) * across, 0, 0) == 0);
    CHECK(retired(0.0024 * std::sqrt(2.0) * across, 0, 0) == 2);
    CHECK(retired({0, 0}, 0.0016, 0) == 0);
    CHECK(retired({0, 0}, 0.0024, 0) == 2);
    CHECK(retired({0, 0}, -0.0024, 0) == 2);
    // one that still holds is parted beyond a fiftieth of its edge and beyond 0.2 rad
    CHECK(parted(0.016 * along, 0, 0.01) == 0);
    CHECK(parted(0.024 * along, 0, 0.01) == 2);
    CHECK(parted({0, 0}, 0.01, 0.01) == 0);
    CHECK(parted({0, 0}, 0.16, 0.01) == 1);  // the far end, by its opening
    CHECK(parted({0, 0}, -0.24, 0.01) == 2);
    CHECK(parted({0, 0}, 2.4, 0.01) == 2);
    CHECK(parted({0, 0}, 2.4, 0) == 0);
}

}  // namespace free_boundary_test
