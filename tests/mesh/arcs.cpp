// Arcs and circles as polygons: where they lie, how fine they are, and how their areas converge.
#include "mesh/size_field.hpp"

#include "mesh/polygon.hpp"
#include "mesh/shapes.hpp"
#include "mesh/triangulate.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace arcs_test {

using namespace knap;
using knap::testing::relative;

namespace {

constexpr double pi = std::numbers::pi;

double longest_side(const std::vector<Vec2>& ring, auto&& where) {
    double longest = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if (where(0.5 * (a + b))) longest = std::max(longest, (b - a).norm());
    }
    return longest;
}

}  // namespace

TEST_CASE("an arc goes through its three points either way round") {
    const Vec2 a(1, 0), b(-1, 0), up(0, 1), down(0, -1);
    const Arc left = *arc_through(a, up, b), right = *arc_through(a, down, b);
    CHECK(left.radius == relative(1, 1e-14));
    CHECK(left.sweep == relative(pi, 1e-14));
    CHECK(right.sweep == relative(-pi, 1e-14));
    const Arc most = *arc_through({0, 0}, {2, 4}, {2, 0});  // the long way
    CHECK(std::abs(most.sweep) > pi);
    for (const Arc& arc : {left, right, most})
        for (double part = 0; part <= 1; part += 0.125)
            CHECK((arc.at(part) - arc.centre).norm() == relative(arc.radius, 1e-14));
    CHECK((most.at(0) - Vec2(0, 0)).norm() <= 1e-14);
    CHECK((most.at(1) - Vec2(2, 0)).norm() <= 1e-14);
    CHECK_FALSE(arc_through({0, 0}, {1, 1}, {2, 2}));
    CHECK_FALSE(arc_through({0, 0}, {1, 1e-10}, {2, 0}));
    CHECK_FALSE(arc_through({0, 0}, {0, 0}, {2, 0}));
}

TEST_CASE("the area of a horseshoe and of a disc converges to the exact one at second order") {
    double last_horseshoe = 0, last_disc = 0;
    for (const double h : {0.1, 0.05, 0.025, 0.0125}) {
        const MeshOptions mesh{.size = h};
        const SizeField size(mesh, 1);
        std::vector<Vec2> horseshoe{{0, 0}, {2, 0}, {2, 1}};  // a square of 2 x 1 under half a disc
        for (const Vec2& p : points_within(*arc_through({2, 1}, {1, 2}, {0, 1}), size)) horseshoe.push_back(p);
        horseshoe.push_back({0, 1});
        const double of_horseshoe = 2 + pi / 2 - signed_area(horseshoe),
                     of_disc = pi - signed_area(circle({3, 4}, 1, size));
        CHECK(of_horseshoe > 0);
        if (last_horseshoe > 0) {
            CHECK(std::log2(last_horseshoe / of_horseshoe) == relative(2, 0.03));
            CHECK(std::log2(last_disc / of_disc) == relative(2, 0.03));
        }
        last_horseshoe = of_horseshoe, last_disc = of_disc;
    }
    CHECK(last_disc < 1e-4);
}

TEST_CASE("the sides of a round hole follow the local mesh size") {
    const MeshOptions plain{.size = 1.5}, refined{.size = 1.5, .refine = {{{{-7, -7}, {7, 7}}, 0.3}}},
        half{.size = 1.5, .refine = {{{{0, -7}, {7, 7}}, 0.3}}, .grading = 0.5};
    CHECK(circle({0, 0}, 2.5, SizeField(plain, 1)) == circle({0, 0}, 2.5, 12));  // as before
    const auto everywhere = [](const Vec2&) { return true; };
    const std::vector<Vec2> fine = circle({0, 0}, 2.5, SizeField(refined, 1));
    CHECK(fine.size() == 53);  // 2 pi 2.5/0.3 = 52.4
    CHECK(longest_side(fine, everywhere) <= 0.3);
    const std::vector<Vec2> graded = circle({0, 0}, 2.5, SizeField(half, 1));
    CHECK(longest_side(graded, [](const Vec2& x) { return x.x() > 0.3; }) <= 0.3);
    CHECK(longest_side(graded, [](const Vec2& x) { return x.x() < -2.3; }) > 0.9);
    for (const Vec2& p : graded) CHECK(p.norm() == relative(2.5, 1e-14));
    Shape shape;
    shape.boundary_names = {"rock", "wall"};
    shape.outer = {{{-20, -20}, {20, -20}, {20, 20}, {-20, 20}}, {0, 0, 0, 0}};
    shape.holes.push_back({graded, std::vector<Index>(graded.size(), 1)});
    const Mesh mesh = triangulate(shape, half);
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 middle =
            0.5 * (mesh.corner(edge.triangle, edge.side) + mesh.corner(edge.triangle, (edge.side + 1) % 3));
        CHECK((edge.boundary == 1) == (middle.norm() < 3));
    }
}

}  // namespace arcs_test
