// Meshes fill their shape, follow its lines, keep the requested size, and are random.
#include "mesh/triangulate.hpp"

#include "base/union_find.hpp"
#include "mesh/mesh_report.hpp"
#include "mesh/polygon.hpp"
#include "mesh/shapes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace triangulate_test {

using namespace knap;
using knap::testing::add_hole;
using knap::testing::block;
using knap::testing::relative;

namespace {

Vec2 edge_start(const Mesh& mesh, const InteriorEdge& edge) { return mesh.corner(edge.triangle[0], edge.side[0]); }
Vec2 edge_end(const Mesh& mesh, const InteriorEdge& edge) {
    return mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
}

double cracked_length(const Mesh& mesh) {
    double length = 0;
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.cracked) length += (edge_end(mesh, edge) - edge_start(mesh, edge)).norm();
    return length;
}

double boundary_length(const Mesh& mesh, Index boundary) {
    double length = 0;
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        if (edge.boundary == boundary) length += mesh.side_vector(edge.triangle, edge.side).norm();
    return length;
}

double total_area(const Mesh& mesh) {
    double area = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) area += mesh.area(t);
    return area;
}

double area_of_tag(const Mesh& mesh, Index tag) {
    double area = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (mesh.region[t] == tag) area += mesh.area(t);
    return area;
}

int euler_characteristic(const Mesh& mesh) {
    return mesh.n_vertices() - static_cast<int>(mesh.interior_edges.size() + mesh.boundary_edges.size()) +
           mesh.n_triangles();
}

/// Connected components of the triangles, not connected across cracked edges.
int n_bodies(const Mesh& mesh) {
    UnionFind sets(mesh.triangles.size());
    int n = mesh.n_triangles();
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (!edge.cracked) n -= sets.join(edge.triangle[0], edge.triangle[1]);
    return n;
}

}  // namespace

TEST_CASE("edges of two triangles") {
    Mesh mesh;
    mesh.vertices = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {2, 3, 0}};
    find_edges(mesh);
    REQUIRE(mesh.interior_edges.size() == 1);
    CHECK(mesh.interior_edges[0].triangle == std::array<Index, 2>{0, 1});
    CHECK(mesh.interior_edges[0].side == std::array<Index, 2>{2, 2});
    CHECK(mesh.boundary_edges.size() == 4);
    find_edges(mesh);
    CHECK(mesh.interior_edges.size() == 1);

    mesh.triangles = {{0, 1, 2}, {0, 2, 1}};  // the second one is turned over: three edges with opposite sides
    find_edges(mesh);
    CHECK(mesh.interior_edges.size() == 3);
    mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
    CHECK_THROWS_AS(find_edges(mesh), ShapeError);
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {1, 0, 2}};
    CHECK_THROWS_AS(find_edges(mesh), ShapeError);
}

TEST_CASE("a block has its area and sides and mean edge length") {
    const Mesh mesh = triangulate(block(), {.size = 1e-3});
    CHECK(total_area(mesh) == relative(0.004, 1e-12));
    for (const Index side : {0, 2}) CHECK(boundary_length(mesh, side) == relative(0.1, 1e-12));
    for (const Index side : {1, 3}) CHECK(boundary_length(mesh, side) == relative(0.04, 1e-12));
    CHECK(mesh.boundary_names == block().boundary_names);
    CHECK(euler_characteristic(mesh) == 1);
    CHECK(*std::max_element(mesh.region.begin(), mesh.region.end()) == 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        if (edge.boundary == 1) CHECK(mesh.corner(edge.triangle, edge.side).x() == 0.1);
}

TEST_CASE("the requested size is the mean edge length for coarse and fine meshes and other bodies") {
    for (const double size : {4e-3, 1e-3, 5e-4})
        CHECK(judge(triangulate(block(), {.size = size})).mean_edge == relative(size, 0.05));
    Shape disc;
    disc.boundary_names = {"rim"};
    disc.outer = {circle({5, 5}, 1, 120), std::vector<Index>(120, 0)};
    CHECK(judge(triangulate(disc, {.size = 0.05})).mean_edge == relative(0.05, 0.05));
    CHECK(judge(triangulate(block(), {.size = 5e-4})).n_triangles == relative(37000, 0.05));
}

TEST_CASE("triangles are well shaped over many seeds") {
    Shape shape = block();
    shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}};
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const MeshReport report = judge(triangulate(shape, {.size = 1e-3, .seed = seed}));
        CHECK(report.smallest_angle >= 20);
        CHECK(report.largest_angle <= 125);
        CHECK(report.smallest_altitude >= 0.48e-3);
        CHECK(report.smallest_edge >= 0.55e-3);
        CHECK(report.largest_edge <= 2.3e-3);
    }
}

TEST_CASE("a seed gives the same mesh bit by bit and another seed another mesh") {
    Shape shape = block();
    shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}};
    const Mesh first = triangulate(shape, {.size = 2e-3, .seed = 7}),
               again = triangulate(shape, {.size = 2e-3, .seed = 7});
    CHECK(first.vertices == again.vertices);
    CHECK(first.triangles == again.triangles);
    const Mesh other = triangulate(shape, {.size = 2e-3, .seed = 8});
    Index n_shared = 0;
    for (const Vec2& p : first.vertices) n_shared += std::count(other.vertices.begin(), other.vertices.end(), p);
    CHECK(n_shared == 6);  // the corners and both ends of the crack
}

TEST_CASE("a crack is covered exactly by cracked edges") {
    Shape shape = block();
    shape.cracks = {{{{0, 0.02}, {0.03, 0.023}, {0.05, 0.02}}}};
    const Mesh mesh = triangulate(shape, {.size = 1e-3});
    const double length = (Vec2(0.03, 0.023) - Vec2(0, 0.02)).norm() + (Vec2(0.05, 0.02) - Vec2(0.03, 0.023)).norm();
    CHECK(cracked_length(mesh) == relative(length, 1e-12));
    for (const InteriorEdge& edge : mesh.interior_edges) {
        if (!edge.cracked) continue;
        const Vec2 middle = 0.5 * (edge_start(mesh, edge) + edge_end(mesh, edge));
        CHECK(std::min(distance_to_segment({0, 0.02}, {0.03, 0.023}, middle),
                       distance_to_segment({0.03, 0.023}, {0.05, 0.02}, middle)) < 1e-12);
    }
    CHECK(n_bodies(mesh) == 1);
}

TEST_CASE("crossing cracks keep their lengths") {
    Shape shape = block();
    shape.cracks = {{{{0.02, 0.02}, {0.06, 0.02}}}, {{{0.04, 0.01}, {0.05, 0.03}}}};
    CHECK(cracked_length(triangulate(shape, {.size = 2e-3})) == relative(0.04 + std::sqrt(0.0005), 1e-12));
}

TEST_CASE("a slit across the body makes two bodies") {
    Shape shape = block();
    shape.cracks = {{{{0.04, 0}, {0.04, 0.04}}}};
    const Mesh mesh = triangulate(shape, {.size = 2e-3});
    CHECK(n_bodies(mesh) == 2);
    CHECK(cracked_length(mesh) == relative(0.04, 1e-12));
}

TEST_CASE("a crack that reaches out of the body is cut off") {
    Shape shape = block();
    shape.cracks = {{{{0.05, -0.01}, {0.05, 0.06}}}};
    add_hole(shape, {{0.04, 0.01}, {0.06, 0.01}, {0.06, 0.02}, {0.04, 0.02}});
    const Mesh mesh = triangulate(shape, {.size = 2e-3});
    CHECK(cracked_length(mesh) == relative(0.03, 1e-12));
    CHECK(n_bodies(mesh) == 2);
}

TEST_CASE("a crack that ends very near the border ends on it") {
    for (const double gap : {1e-9, -1e-9, 5e-8}) {
        Shape shape = block();
        shape.cracks = {{{{gap, 0.02}, {0.1 - gap, 0.021}}}};
        const Mesh mesh = triangulate(shape, {.size = 2e-3});
        CHECK(n_bodies(mesh) == 2);
        CHECK(judge(mesh).smallest_angle > 15);
        CHECK(total_area(mesh) == relative(0.004, 1e-9));
    }
}

TEST_CASE("a crack from a slanted border is meshed at every angle") {
    for (int degrees = 0; degrees < 180; degrees += 15) {
        CAPTURE(degrees);
        const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180);
        const auto turned = [&](double x, double y) { return Vec2(c * x - s * y, s * x + c * y); };
        Shape shape;
        shape.outer = {.points = {turned(0, 0), turned(0.04, 0), turned(0.04, 0.02), turned(0, 0.02)},
                       .boundary = {0, 0, 0, 0}};
        shape.cracks = {{.points = {turned(0, 0.01), turned(0.015, 0.01)}}};
        shape.boundary_names = {"side"};
        const Mesh mesh = triangulate(shape, {.size = 2e-3});
        double cracked = 0;
        for (const InteriorEdge& edge : mesh.interior_edges)
            if (edge.cracked)
                cracked += (mesh.corner(edge.triangle[0], edge.side[0]) -
                            mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3))
                               .norm();
        CHECK(cracked == relative(0.015, 1e-9));
    }
}

TEST_CASE("a crack into a sharp corner ends and follows its line") {
    Shape shape = block();
    shape.cracks = {{{{0, 0}, {0.08, 0.005}}}};
    const Mesh mesh = triangulate(shape, {.size = 2e-3});
    CHECK(cracked_length(mesh) == relative(std::hypot(0.08, 0.005), 1e-12));
    CHECK(mesh.n_triangles() < 10000);
}

TEST_CASE("holes have their boundary and the Euler characteristic counts them") {
    Shape shape = block();
    add_hole(shape, circle({0.03, 0.02}, 0.008, 40));
    add_hole(shape, circle({0.07, 0.02}, 0.008, 40));
    std::reverse(shape.holes[1].points.begin(), shape.holes[1].points.end());
    const Mesh mesh = triangulate(shape, {.size = 1.5e-3});
    const double hole = 0.5 * 40 * std::sin(2 * std::numbers::pi / 40) * 0.008 * 0.008;
    CHECK(total_area(mesh) == relative(0.004 - 2 * hole, 1e-10));
    CHECK(boundary_length(mesh, 4) == relative(2 * 40 * 2 * 0.008 * std::sin(std::numbers::pi / 40), 1e-10));
    CHECK(euler_characteristic(mesh) == -1);
}

TEST_CASE("a clockwise outer ring gives counterclockwise triangles") {
    Shape shape = block();
    shape.outer = {{{0, 0.04}, {0.1, 0.04}, {0.1, 0}, {0, 0}}, {2, 1, 0, 3}};
    const Mesh mesh = triangulate(shape, {.size = 4e-3});
    CHECK(total_area(mesh) == relative(0.004, 1e-12));
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        if (edge.boundary == 0) CHECK(mesh.corner(edge.triangle, edge.side).y() == 0);
}

TEST_CASE("regions have their area and later ones lie over earlier ones") {
    Shape shape = block();
    shape.regions = {{{{-0.01, -0.01}, {0.05, -0.01}, {0.05, 0.05}, {-0.01, 0.05}}, 1},
                     {{{0.04, 0.01}, {0.06, 0.01}, {0.06, 0.03}, {0.04, 0.03}}, 2}};
    const Mesh mesh = triangulate(shape, {.size = 2e-3});
    CHECK(area_of_tag(mesh, 2) == relative(0.02 * 0.02, 1e-10));
    CHECK(area_of_tag(mesh, 1) == relative(0.05 * 0.04 - 0.01 * 0.02, 1e-10));
    CHECK(cracked_length(mesh) == 0);
}

TEST_CASE("regions may share borders with each other and with a crack") {
    Shape shape = block();
    shape.regions = {{{{0, 0}, {0.05, 0}, {0.05, 0.04}, {0, 0.04}}, 1},
                     {{{0.05, 0}, {0.1, 0}, {0.1, 0.04}, {0.05, 0.04}}, 2}};
    shape.cracks = {{{{0.05, 0}, {0.05, 0.015}}}};
    const Mesh mesh = triangulate(shape, {.size = 2e-3});
    CHECK(area_of_tag(mesh, 1) == relative(0.002, 1e-10));
    CHECK(area_of_tag(mesh, 2) == relative(0.002, 1e-10));
    CHECK(cracked_length(mesh) == relative(0.015, 1e-12));
}

TEST_CASE("region borders yield to cracks and to the mesh size") {
    Shape shape = block();
    shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}};
    double area = 0.002;
    SUBCASE("a border that starts just next to a crack") {
        shape.regions = {{{{0, 0.02001}, {0.1, 0.02001}, {0.1, 0.05}, {0, 0.05}}, 1}};
    }
    SUBCASE("a border of very many sides") {
        area = 0.0008;
        shape.regions = {{circle({0.08, 0.02}, std::sqrt(0.0008 / std::numbers::pi), 3000), 1}};
    }
    SUBCASE("two borders that nearly coincide") {
        shape.regions = {{{{0, 0}, {0.05, 0}, {0.05, 0.04}, {0, 0.04}}, 2},
                         {{{0.05001, 0}, {0.1, 0}, {0.1, 0.04}, {0.05001, 0.04}}, 1}};
    }
    const Mesh mesh = triangulate(shape, {.size = 2e-3});
    CHECK(cracked_length(mesh) == relative(0.05, 1e-12));
    CHECK(area_of_tag(mesh, 1) == relative(area, 0.01));
    CHECK(judge(mesh).smallest_angle > 10);
}

TEST_CASE("a refined place has its size inside and the requested size far away") {
    RefinedPlace place;
    SUBCASE("box") { place = {{{0.06, 0.01}, {0.08, 0.03}}, 5e-4}; }
    SUBCASE("strip") { place = refined_strip({{0.06, 0.01}, {0.07, 0.02}, {0.09, 0.02}}, 8e-3, 5e-4); }
    const Mesh mesh = triangulate(block(), {.size = 2e-3, .refine = {place}});
    double inside = 0, away = 0;
    int n_inside = 0, n_away = 0;
    for (const InteriorEdge& edge : mesh.interior_edges) {
        const Vec2 a = edge_start(mesh, edge), b = edge_end(mesh, edge);
        if (place.distance(a) == 0 && place.distance(b) == 0) inside += (b - a).norm(), ++n_inside;
        if (a.x() < 0.05 && b.x() < 0.05) away += (b - a).norm(), ++n_away;
    }
    CHECK(inside / n_inside == relative(5e-4, 0.07));
    CHECK(away / n_away == relative(2e-3, 0.07));
    CHECK(judge(mesh).smallest_angle >= 20);
}

TEST_CASE("the size grows with the distance from the nearest of all refined places") {
    const MeshOptions options{.size = 2e-3,
                              .refine = {{{{0.01, 0.01}, {0.02, 0.02}}, 5e-4},
                                         refined_strip({{0.05, 0.01}, {0.07, 0.03}, {0.09, 0.03}}, 4e-3, 2e-4)},
                              .grading = 0.25};
    const SizeField size(options, 2);
    const auto expected = [&](double own, double distance) {
        return relative(2 * std::min(2e-3, own + 0.25 * distance), 1e-12);
    };
    CHECK(size({0.015, 0.02}) == expected(5e-4, 0));
    CHECK(size({0.023, 0.024}) == expected(5e-4, 5e-3));                              // from a corner of the box
    CHECK(size({0.08, 0.0315}) == expected(2e-4, 0));                                 // in the strip
    CHECK(size({0.08, 0.036}) == expected(2e-4, 4e-3));                               // beside it
    CHECK(size({0.093, 0.034}) == expected(2e-4, 3e-3));                              // beyond its round end
    CHECK(size({0.0632, 0.0168}) == expected(2e-4, 0.0064 / std::sqrt(2.0) - 2e-3));  // inside the box around it
    CHECK(size({0.035, 0.035}) == expected(2e-3, 0));
    CHECK(size.smallest() == relative(4e-4, 1e-12));
}

TEST_CASE("sizes do not depend on the unit of length or the origin") {
    const auto scaled = [](double scale, const Vec2& shift) {
        Shape shape = block();
        for (Vec2& p : shape.outer.points) p = scale * p + shift;
        return triangulate(shape, {.size = 2e-3 * scale});
    };
    const Mesh metres = scaled(1, {0, 0});
    CHECK(scaled(1000, {0, 0}).n_triangles() == relative(metres.n_triangles(), 0.03));
    CHECK(scaled(1, {100, -50}).n_triangles() == relative(metres.n_triangles(), 0.03));
}

TEST_CASE("neighbours are near in memory") {
    const Mesh mesh = triangulate(block(), {.size = 1e-3});
    std::vector<Index> jumps;
    for (const InteriorEdge& edge : mesh.interior_edges) jumps.push_back(std::abs(edge.triangle[1] - edge.triangle[0]));
    std::nth_element(jumps.begin(), jumps.begin() + static_cast<std::ptrdiff_t>(jumps.size() / 2), jumps.end());
    CHECK(jumps[jumps.size() / 2] < 20);
}

}  // namespace triangulate_test
