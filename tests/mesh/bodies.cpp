// Several bodies in one mesh, and shapes that lie in each other.
#include "mesh/mesh_report.hpp"
#include "mesh/shapes.hpp"
#include "mesh/triangulate.hpp"

#include <doctest/doctest.h>

#include <numbers>

namespace bodies_test {

using namespace knap;
using knap::testing::add_hole;
using knap::testing::block;
using knap::testing::relative;

namespace {

Shape moved(Shape shape, const Vec2& by) {
    for (Vec2& p : shape.outer.points) p += by;
    for (Ring& hole : shape.holes)
        for (Vec2& p : hole.points) p += by;
    return shape;
}

constexpr double tolerance = 1e-6;

double depth(const Shape& a, const Shape& b) {
    const auto found = overlap(a, b, tolerance);
    CHECK(found.has_value() == overlap(b, a, tolerance).has_value());
    return found ? found->depth : 0;
}

}  // namespace

TEST_CASE("bodies: two blocks that touch have nothing in common") {
    const MeshOptions options{.size = 4e-3};
    const Mesh one = triangulate(block(), options), other = triangulate(moved(block(), {0.1, 0}), options);
    Mesh mesh = one;
    append(mesh, other);
    CHECK(mesh.n_triangles() == one.n_triangles() + other.n_triangles());
    CHECK(mesh.n_vertices() == one.n_vertices() + other.n_vertices());
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (const Index v : mesh.triangles[t]) CHECK((v < one.n_vertices()) == (t < one.n_triangles()));
    const MeshReport report = judge(mesh);
    CHECK(report.area == relative(2 * 0.1 * 0.04, 1e-12));
    CHECK(report.smallest_angle > 15);
    // the edges are those that a search finds in all triangles together
    Mesh searched = mesh;
    find_edges(searched);
    CHECK(searched.interior_edges.size() == mesh.interior_edges.size());
    CHECK(searched.boundary_edges.size() == mesh.boundary_edges.size());
    for (const InteriorEdge& edge : mesh.interior_edges)
        CHECK(edge_key(mesh.side_vertices(edge.triangle[0], edge.side[0])) ==
              edge_key(mesh.side_vertices(edge.triangle[1], edge.side[1])));
    // each has its four sides, also where they touch
    std::vector<double> length(mesh.boundary_names.size(), 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        length[edge.boundary] += mesh.side_vector(edge.triangle, edge.side).norm();
    for (const std::size_t body : {0, 5}) {
        CHECK(length[body] == relative(0.1, 1e-12));
        CHECK(length[body + 1] == relative(0.04, 1e-12));
        CHECK(length[body + 3] == relative(0.04, 1e-12));
    }
}

TEST_CASE("bodies: shapes that touch do not overlap") {
    CHECK(depth(block(), moved(block(), {0.1, 0})) == 0);
    CHECK(depth(block(), moved(block(), {0.03, 0.04})) == 0);
    CHECK(depth(block(), moved(block(), {0.1, 0.04})) == 0);                 // corner on corner
    CHECK(depth(block(), moved(block(), {0.1 - 0.9 * tolerance, 0})) == 0);  // to the tolerance
    CHECK(depth(block(), moved(block(), {0.3, 0})) == 0);
    Shape tilted = block();
    turn(tilted, {0, 0}, 0.3);  // stands on the long side of the first with a corner
    CHECK(depth(block(), moved(tilted, {0.05, 0.04})) == 0);
    Shape frame = block();
    add_hole(frame, {{0.02, 0.01}, {0.06, 0.01}, {0.06, 0.03}, {0.02, 0.03}});
    Shape stone = block();
    stone.outer.points = {{0.02, 0.01}, {0.06, 0.01}, {0.06, 0.03}, {0.02, 0.03}};  // fills the hole
    CHECK(depth(frame, stone) == 0);
}

TEST_CASE("bodies: the depth of an overlap") {
    CHECK(depth(block(), moved(block(), {0.1 - 1e-3, 0})) == relative(1e-3, 1e-9));
    CHECK(depth(block(), moved(block(), {0, 0.03})) == relative(0.01, 1e-9));
    CHECK(depth(block(), block()) > 0.015);  // one and the same
    Shape cross = block();
    turn(cross, {0.05, 0.02}, std::numbers::pi / 2);  // no corner of either lies in the other
    CHECK(depth(block(), cross) > 0.015);
    Shape small = block();
    small.outer.points = {{0.04, 0.015}, {0.05, 0.015}, {0.05, 0.02}};
    CHECK(depth(block(), small) > 0.015);  // within
    Shape diagonal = block();              // its long side runs through two corners of the block
    diagonal.outer.points = {{-0.05, -0.02}, {0.15, 0.06}, {0.05, 0.2}};
    CHECK(depth(block(), diagonal) > 0.01);
    const auto place = overlap(block(), moved(block(), {0.1 - 1e-3, 0.03}), tolerance);
    REQUIRE(place);
    CHECK((place->place - Vec2(0.0995, 0.035)).norm() < 6e-3);
}

TEST_CASE("bodies: a turned shape keeps its area and its lines") {
    Shape shape = block();
    add_hole(shape, {{0.02, 0.01}, {0.06, 0.01}, {0.06, 0.03}});
    shape.cracks.push_back({.points = {{0.07, 0.02}, {0.09, 0.02}}});
    shape.regions.push_back({.points = {{0.01, 0.03}, {0.015, 0.03}, {0.015, 0.035}}});
    const double area = shape.area();
    turn(shape, {0.1, 0}, std::numbers::pi / 2);
    CHECK(shape.area() == relative(area, 1e-12));
    CHECK((shape.outer.points[0] - Vec2(0.1, -0.1)).norm() < 1e-15);
    CHECK((shape.holes[0].points[0] - Vec2(0.09, -0.08)).norm() < 1e-15);
    CHECK((shape.cracks[0].points[1] - Vec2(0.08, -0.01)).norm() < 1e-15);
    CHECK((shape.regions[0].points[0] - Vec2(0.07, -0.09)).norm() < 1e-15);
}

}  // namespace bodies_test
