// Shapes that cannot be meshed are rejected, and the part at fault is named.
#include "mesh/shapes.hpp"

#include "mesh/shape_graph.hpp"
#include "mesh/triangulate.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace shape_test {

using namespace knap;
using knap::testing::add_hole;
using knap::testing::block;
using knap::testing::relative;

namespace {

/// The part at fault according to check_shape, "" for a valid shape.
std::string blamed(const Shape& shape) {
    try {
        check_shape(shape);
    } catch (const ShapeError& error) {
        return error.part();
    }
    return "";
}

/// The same according to the mesher.
std::string blamed(const Shape& shape, const MeshOptions& options) {
    try {
        triangulate(shape, options);
    } catch (const ShapeError& error) {
        return error.part();
    }
    return "";
}

}  // namespace

TEST_CASE("a circle is a counterclockwise polygon on its radius") {
    const auto points = circle({1, 2}, 3, 7);
    REQUIRE(points.size() == 7);
    for (std::size_t i = 0; i < 7; ++i) {
        CHECK((points[i] - Vec2(1, 2)).norm() == relative(3, 1e-12));
        CHECK(cross(points[i] - Vec2(1, 2), points[(i + 1) % 7] - Vec2(1, 2)) > 0);
    }
}

TEST_CASE("valid shapes pass") {
    Shape shape = block();
    CHECK(blamed(shape) == "");
    add_hole(shape, circle({0.07, 0.02}, 0.005, 24));
    shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}, {{{0.03, -0.01}, {0.03, 0.05}}}};
    shape.regions = {{circle({0.02, 0.03}, 0.02, 20), 1}, {{{0.015, 0.02}, {0.03, 0.02}, {0.03, 0.05}}, 2}};
    CHECK(blamed(shape) == "");
}

TEST_CASE("rings that cross or fold or have no area are rejected") {
    Shape bow_tie = block();
    bow_tie.outer.points = {{0, 0}, {0.1, 0.04}, {0.1, 0}, {0, 0.04}};
    CHECK(blamed(bow_tie) == "outer");
    Shape spike = block();
    spike.outer = {{{0, 0}, {0.1, 0}, {0.1, 0.04}, {0.05, 0.04}, {0.08, 0.04}, {0, 0.04}}, {0, 0, 0, 0, 0, 0}};
    CHECK(blamed(spike) == "outer");
    Shape flat = block();
    flat.outer = {{{0, 0}, {0.05, 0}, {0.1, 0}}, {0, 0, 0}};
    CHECK(blamed(flat) == "outer");
    Shape repeated = block();
    repeated.outer = {{{0, 0}, {0.1, 0}, {0.1, 0.04}, {0, 0.04}, {0, 0}}, {0, 1, 2, 3, 3}};
    CHECK(blamed(repeated) == "outer");
    Shape not_a_number = block();
    not_a_number.outer.points[1].x() = std::numeric_limits<double>::quiet_NaN();
    CHECK(blamed(not_a_number) == "outer");
    Shape nameless = block();
    nameless.outer.boundary.pop_back();
    CHECK(blamed(nameless) == "outer");
    CHECK(blamed(Shape{}) == "outer");
}

TEST_CASE("holes stay apart and inside") {
    Shape shape = block();
    add_hole(shape, circle({0.07, 0.02}, 0.005, 24));
    SUBCASE("across the outer ring") { add_hole(shape, circle({0.1, 0.02}, 0.005, 24)); }
    SUBCASE("across another hole") { add_hole(shape, circle({0.065, 0.02}, 0.005, 24)); }
    SUBCASE("outside") { add_hole(shape, circle({0.2, 0.02}, 0.005, 24)); }
    SUBCASE("inside another hole") { add_hole(shape, circle({0.07, 0.02}, 0.002, 24)); }
    SUBCASE("round another hole") { add_hole(shape, circle({0.07, 0.02}, 0.01, 24)); }
    SUBCASE("touching the border in a point") { add_hole(shape, {{0.02, 0}, {0.03, 0.01}, {0.01, 0.01}}); }
    SUBCASE("touching along a side") { add_hole(shape, {{0.02, 0}, {0.03, 0}, {0.03, 0.01}, {0.02, 0.01}}); }
    SUBCASE("crossing itself") { add_hole(shape, {{0.02, 0.01}, {0.03, 0.02}, {0.03, 0.01}, {0.02, 0.02}}); }
    const std::string part = blamed(shape);
    CHECK((part == "holes[0]" || part == "holes[1]"));
}

TEST_CASE("cracks need a length inside the body") {
    Shape shape = block();
    shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}};
    SUBCASE("zero length") { shape.cracks.push_back({{{0.07, 0.02}, {0.07, 0.02}}}); }
    SUBCASE("one point") { shape.cracks.push_back({{{0.07, 0.02}}}); }
    SUBCASE("outside") { shape.cracks.push_back({{{0.2, 0.02}, {0.3, 0.02}}}); }
    SUBCASE("along the border") { shape.cracks.push_back({{{0.02, 0}, {0.03, 0}}}); }
    SUBCASE("along another crack") { shape.cracks.push_back({{{0.02, 0.02}, {0.03, 0.02}}}); }
    CHECK(blamed(shape) == "cracks[1]");
}

TEST_CASE("regions are simple polygons") {
    Shape shape = block();
    shape.regions = {{{{0.01, 0.01}, {0.03, 0.03}, {0.03, 0.01}, {0.01, 0.03}}, 1}};
    CHECK(blamed(shape) == "regions[0]");
    shape.regions = {{{{0.01, 0.01}, {0.03, 0.03}, {0.01, 0.03}}, -1}};
    CHECK(blamed(shape) == "regions[0]");
}

TEST_CASE("sizes that make no sense are rejected") {
    CHECK(blamed(block(), {.size = 0.2}) == "size");
    CHECK(blamed(block(), {.size = 0}) == "size");
    CHECK(blamed(block(), {.size = -1e-3}) == "size");
    CHECK(blamed(block(), {.size = std::numeric_limits<double>::quiet_NaN()}) == "size");
    CHECK(blamed(block(), {.size = 1e-6}) == "size");  // 9e9 triangles
    CHECK(blamed(block(), {.size = 2e-3, .refine = {{{{0, 0}, {0.01, 0.01}}, 1e-7}}}) == "size");
    CHECK(blamed(block(), {.size = 2e-3, .refine = {{{{0.01, 0}, {0, 0.01}}, 1e-3}}}) == "size");
    const std::vector<Vec2> line{{0.01, 0.02}, {0.09, 0.02}};
    CHECK(blamed(block(), {.size = 2e-3, .refine = {refined_strip(line, 0.01, 3e-6)}}) == "size");  // 2e8 triangles
    CHECK(blamed(block(), {.size = 2e-3, .refine = {refined_strip(line, 1e-5, 3e-5)}}) == "");
    CHECK(blamed(block(), {.size = 2e-3, .grading = 0}) == "size");
    CHECK(blamed(block(), {.size = 2e-3, .min_angle = 35}) == "size");
}

TEST_CASE("details far below the mesh size are rejected") {
    const MeshOptions options{.size = 2e-3};
    Shape shape = block();
    SUBCASE("a crack that ends just before the border") {
        shape.cracks = {{{{1e-5, 0.02}, {0.05, 0.02}}}};
        CHECK(blamed(shape, options) == "cracks[0]");
    }
    SUBCASE("a crack that ends just before another one") {
        shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}, {{{0.03, 0.02001}, {0.03, 0.03}}}};
        CHECK(blamed(shape, options).starts_with("cracks"));
    }
    SUBCASE("a crack that ends just behind another one") {
        shape.cracks = {{{{0, 0.02}, {0.05, 0.02}}}, {{{0.03, 0.01999}, {0.03, 0.03}}}};
        CHECK(blamed(shape, options) == "cracks[1]");
    }
    SUBCASE("a crack nearly along the border") {
        shape.cracks = {{{{0, 0}, {0.05, 4e-4}}}};
        CHECK(blamed(shape, options) == "cracks[0]");
    }
    SUBCASE("a hole very near the border") {
        add_hole(shape, {{0.02, 2e-5}, {0.03, 0.01}, {0.01, 0.01}});
        CHECK(blamed(shape, options) == "holes[0]");
    }
    SUBCASE("a circle of far too many sides") {
        add_hole(shape, circle({0.05, 0.02}, 0.005, 1000));
        CHECK(blamed(shape, options) == "holes[0]");
    }
}

}  // namespace shape_test
