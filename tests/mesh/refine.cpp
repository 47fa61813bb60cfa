// A mesh refined where it is too coarse: what stays, what becomes small, and what edges inherit.
#include "mesh/refine.hpp"

#include "mesh/size_field.hpp"
#include "mesh/triangulate.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace refine_test {

using namespace knap;
using knap::tests::relative;

namespace {

constexpr double coarse = 0.08, fine = 0.01;  // [m]

/// A plate of 1 m by 0.5 m with a crack from the left, a joint, and a region on the right.
Mesh plate() {
    Shape shape;
    shape.outer = {{{0, 0}, {1, 0}, {1, 0.5}, {0, 0.5}}, {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    shape.cracks = {{{{0, 0.25}, {0.3, 0.25}}, -1}, {{{0.45, 0}, {0.45, 0.5}}, 2}};
    shape.regions = {{.points = {{0.7, -0.1}, {1.1, -0.1}, {1.1, 0.6}, {0.7, 0.6}}, .tag = 1}};
    return triangulate(shape, {.size = coarse});
}

/// Fine within 0.1 m of a place, with the grading 0.3.
std::vector<double> sizes_around(const Mesh& mesh, const Vec2& centre) {
    std::vector<double> size;
    for (const Vec2& x : mesh.vertices)
        size.push_back(std::min(coarse, fine + 0.3 * std::max(0.0, (x - centre).norm() - 0.1)));
    return size;
}

std::map<std::string, double> boundary_lengths(const Mesh& mesh) {
    std::map<std::string, double> length;
    for (const BoundaryEdge& e : mesh.boundary_edges)
        length[mesh.boundary_names[e.boundary]] += mesh.side_vector(e.triangle, e.side).norm();
    return length;
}

struct Lines {
    double cracks = 0, joints = 0, between_regions = 0;  // [m]
};
Lines lines_of(const Mesh& mesh) {
    Lines lines;
    for (const InteriorEdge& e : mesh.interior_edges) {
        const double length = mesh.side_vector(e.triangle[0], e.side[0]).norm();
        if (e.cracked) lines.cracks += length;
        if (e.joint == 2) lines.joints += length;
        if (mesh.region[e.triangle[0]] != mesh.region[e.triangle[1]]) lines.between_regions += length;
    }
    return lines;
}

}  // namespace

TEST_CASE("refined mesh: fine where requested with the lines and borders of the old one") {
    const Mesh old = plate();
    for (const Vec2& centre : {Vec2(0.6, 0.3), Vec2(0.7, 0.25), Vec2(0.45, 0.5), Vec2(1, 0), Vec2(0.32, 0.25)}) {
        CAPTURE(centre.transpose());
        const std::vector<double> size = sizes_around(old, centre);
        std::vector<std::uint8_t> frozen(old.n_triangles(), 0);
        for (const InteriorEdge& e : old.interior_edges)
            if (e.cracked) frozen[e.triangle[0]] = frozen[e.triangle[1]] = 1;
        const auto refined = knap::refined(old, {.size = size, .frozen = frozen, .seed = 3});
        REQUIRE(refined);
        const Mesh& mesh = refined->mesh;

        double area = 0, edge = 0;
        Index n_edges = 0;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            CHECK(mesh.area(t) > 0);
            area += mesh.area(t);
        }
        CHECK(area == relative(0.5, 1e-13));
        for (const InteriorEdge& e : mesh.interior_edges) {
            const Vec2 along = mesh.side_vector(e.triangle[0], e.side[0]),
                       middle = mesh.corner(e.triangle[0], e.side[0]) + 0.5 * along;
            if ((middle - centre).norm() > 0.08 || (middle - Vec2(0.2, 0.25)).norm() < 0.11) continue;
            edge += along.norm(), ++n_edges;
        }
        if (centre.x() > 0.35) CHECK(edge / n_edges == relative(fine, 0.1));

        const auto before = boundary_lengths(old), after = boundary_lengths(mesh);
        for (const auto& [name, length] : before) CHECK(after.at(name) == relative(length, 1e-13));
        const Lines a = lines_of(old), b = lines_of(mesh);
        CHECK(b.cracks == relative(a.cracks, 1e-13));
        CHECK(b.joints == relative(a.joints, 1e-13));
        CHECK(b.between_regions == relative(a.between_regions, 1e-13));

        Index n_frozen = 0;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const Index was = refined->triangle_before[t];
            if (was < 0) continue;
            n_frozen += frozen[was];
            CHECK(mesh.region[t] == old.region[was]);
            for (Index k = 0; k < 3; ++k) CHECK(mesh.corner(t, k) == old.corner(was, k));  // the same bits
        }
        CHECK(n_frozen == std::ranges::count(frozen, 1));

        // linear fields come back exactly
        for (Index v = 0; v < mesh.n_vertices(); ++v) {
            const VertexOrigin& from = refined->origin[v];
            if (from.triangle < 0) {
                CHECK(mesh.vertices[v] == old.vertices[from.vertex]);
                continue;
            }
            Vec2 mean = Vec2::Zero();
            for (int k = 0; k < 3; ++k) mean += from.weight[k] * old.corner(from.triangle, k);
            CHECK((mean - mesh.vertices[v]).norm() <= 1e-13);
            CHECK(*std::ranges::min_element(from.weight) >= -1e-12);
        }
        const auto again = knap::refined(old, {.size = size, .frozen = frozen, .seed = 3});
        CHECK(again->mesh.vertices == mesh.vertices);
        CHECK(again->mesh.triangles == mesh.triangles);
    }
}

TEST_CASE("refined mesh: grains of one material keep their borders as materials do") {
    Mesh old = plate();
    std::swap(old.grain, old.region), old.region.assign(old.n_triangles(), 0);  // the region on the right is a grain
    std::vector<std::uint8_t> frozen(old.n_triangles(), 0);
    const std::vector<double> size = sizes_around(old, {0.7, 0.25});
    const auto refined = knap::refined(old, {.size = size, .frozen = frozen, .seed = 3});
    REQUIRE(refined);
    const Mesh& mesh = refined->mesh;
    REQUIRE(mesh.grain.size() == mesh.triangles.size());
    REQUIRE(mesh.n_triangles() > 2 * old.n_triangles());
    for (Index t = 0; t < mesh.n_triangles(); ++t) CHECK(mesh.grain[t] == (mesh.centroid(t).x() > 0.7));
    for (const InteriorEdge& e : mesh.interior_edges)
        if (!mesh.within_grain(e))
            for (const Index v : mesh.side_vertices(e.triangle[0], e.side[0]))
                CHECK(std::abs(mesh.vertices[v].x() - 0.7) < 1e-12);
}

TEST_CASE("refined mesh: nothing happens where it is fine enough or frozen") {
    const Mesh old = plate();
    std::vector<double> size(old.n_vertices(), coarse);
    std::vector<std::uint8_t> frozen(old.n_triangles(), 0);
    CHECK_FALSE(refined(old, {.size = size, .frozen = frozen}));
    std::ranges::fill(size, fine);
    std::ranges::fill(frozen, 1);
    CHECK_FALSE(refined(old, {.size = size, .frozen = frozen}));
}

TEST_CASE("refined mesh: triangles that are not allowed do not come about") {
    const Mesh old = plate();
    const std::vector<double> size = sizes_around(old, {0.6, 0.3});
    const std::vector<std::uint8_t> frozen(old.n_triangles(), 0);
    const auto smallest_height = [](const Mesh& mesh, Index t) {
        double longest = 0;
        for (Index k = 0; k < 3; ++k) longest = std::max(longest, mesh.side_vector(t, k).norm());
        return 2 * mesh.area(t) / longest;
    };
    const double limit = 0.6 * fine;  // that of an equilateral triangle is 0.87
    const auto free = refined(old, {.size = size, .frozen = frozen});
    const auto bound = refined(old, {.size = size, .frozen = frozen, .allowed = [&](const Mesh& mesh, Index t) {
                                         return smallest_height(mesh, t) >= limit;
                                     }});
    REQUIRE(free);
    REQUIRE(bound);
    const auto n_low = [&](const Mesh& mesh) {
        Index n = 0;
        for (Index t = 0; t < mesh.n_triangles(); ++t) n += smallest_height(mesh, t) < limit;
        return n;
    };
    CHECK(n_low(free->mesh) > 0);
    CHECK(n_low(bound->mesh) == 0);
    CHECK(bound->mesh.n_triangles() > 0.7 * free->mesh.n_triangles());
}

TEST_CASE("refined mesh: bodies that touch are refined each as if it were alone and keep their names") {
    const auto block = [](double left, const char* side) {
        Shape shape;
        shape.outer = {{{left, 0}, {left + 0.5, 0}, {left + 0.5, 0.5}, {left, 0.5}}, {0, 0, 0, 0}};
        shape.boundary_names = {side};
        return triangulate(shape, {.size = coarse});
    };
    const Mesh alone = block(0, "a.rim");
    Mesh old = alone;
    append(old, block(0.5, "b.rim"));
    append(old, block(1, "c.rim"));
    const Index n = alone.n_triangles(), of_b = block(0.5, "").n_triangles();
    old.parts = {
        {"a", 0, n}, {"b", n, of_b}, {"c", n + of_b, old.n_triangles() - n - of_b}, {"bc", n, old.n_triangles() - n}};
    const Vec2 touching(0.5, 0.25);  // of a and b
    const std::vector<std::uint8_t> frozen(old.n_triangles(), 0);
    const std::vector<double> size = sizes_around(old, touching), of_alone = sizes_around(alone, touching);
    const auto refined = knap::refined(old, {.size = size, .frozen = frozen, .seed = 3}),
               as_alone = knap::refined(alone, {.size = of_alone, .frozen = frozen, .seed = 3});
    REQUIRE(refined);
    const Mesh& mesh = refined->mesh;
    REQUIRE(mesh.parts.size() == 4);
    Index next = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& [name, first, count] = mesh.parts[i];
        CHECK(name == old.parts[i].name);
        CHECK(first == next);
        next += count;
        CHECK((count > 2 * old.parts[i].n_triangles) == (i < 2));
        for (Index t = first; t < next; ++t) CHECK(std::abs(mesh.centroid(t).x() - 0.25 - 0.5 * i) < 0.25);
    }
    CHECK(next == mesh.n_triangles());
    CHECK(mesh.parts[3].first_triangle == mesh.parts[1].first_triangle);
    CHECK(mesh.parts[3].n_triangles == mesh.parts[1].n_triangles + mesh.parts[2].n_triangles);
    for (const auto& [name, length] : boundary_lengths(mesh)) CHECK(length == relative(2, 1e-13));
    for (const InteriorEdge& e : mesh.interior_edges)
        CHECK((mesh.centroid(e.triangle[0]).x() < 0.5) == (mesh.centroid(e.triangle[1]).x() < 0.5));
    // the same bits as of the body alone
    REQUIRE(mesh.parts[0].n_triangles == as_alone->mesh.n_triangles());
    for (Index t = 0; t < as_alone->mesh.n_triangles(); ++t) {
        CHECK(mesh.triangles[t] == as_alone->mesh.triangles[t]);
        for (Index k = 0; k < 3; ++k) CHECK(mesh.corner(t, k) == as_alone->mesh.corner(t, k));
    }
}

}  // namespace refine_test
