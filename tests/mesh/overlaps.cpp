// One overlap is found among very many triangles in unfavourable positions.
#include "mesh/overlap.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace overlaps_test {

using namespace knap;

namespace {

/// Of triangles without common vertices, each counterclockwise.
Mesh mesh_of(const std::vector<std::array<Vec2, 3>>& triangles) {
    Mesh mesh;
    for (const auto& [a, b, c] : triangles) {
        const Index n = mesh.n_vertices();
        mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
        mesh.triangles.push_back({n, n + 1, n + 2});
    }
    find_edges(mesh);
    return mesh;
}

constexpr Index n_slivers = 50'000;

struct Family {
    const char* name;
    std::function<std::array<Vec2, 3>(double)> sliver;  // of x = 0 to 1 less one step
};

const double step = 1. / n_slivers;

std::vector<Family> families() {
    const auto round = [](double x) { return Vec2(std::cos(1.5 * x), std::sin(1.5 * x)); };
    return {{"side by side, askew",
             [](double x) {
                 return std::array<Vec2, 3>{Vec2(x, -x), Vec2(x + 0.3 * step + 1, 1 - x), Vec2(x + 1, 1 - x)};
             }},
            {"the box of each in that of the next",
             [](double x) {
                 return std::array<Vec2, 3>{Vec2(1 + x, 0), Vec2(1 + x + 0.3 * step, 0.1 * step), Vec2(0, 1 + x)};
             }},
            {"round a point", [=](double x) {
                 return std::array<Vec2, 3>{Vec2(0, 0), round(x), round(x + 0.5 * step)};
             }}};
}

}  // namespace

TEST_CASE("overlap: one sliver over another one is found among fifty thousand") {
    for (const Family& family : families()) {
        CAPTURE(family.name);
        std::vector<std::array<Vec2, 3>> slivers;
        for (Index i = 0; i < n_slivers; ++i) slivers.push_back(family.sliver(i * step));
        CHECK_FALSE(find_overlap(mesh_of(slivers)).has_value());
        const auto [a, b, c] = slivers[n_slivers / 3];
        slivers.push_back({0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)});  // its middle
        const auto found = find_overlap(mesh_of(slivers));
        REQUIRE(found.has_value());
        CHECK(std::min((*found)[0], (*found)[1]) == n_slivers / 3);
        CHECK(std::max((*found)[0], (*found)[1]) == n_slivers);
    }
}

TEST_CASE("overlap: a disc of very many triangles around one vertex has none") {
    Mesh mesh;
    mesh.vertices.emplace_back(0, 0);
    for (Index i = 0; i < n_slivers; ++i)
        mesh.vertices.emplace_back(std::cos(2 * std::numbers::pi * i * step),
                                   std::sin(2 * std::numbers::pi * i * step));
    for (Index i = 0; i < n_slivers; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n_slivers});
    find_edges(mesh);
    CHECK(mesh.interior_edges.size() == n_slivers);
    CHECK(mesh.boundary_edges.size() == n_slivers);
    CHECK_FALSE(find_overlap(mesh).has_value());
}

}  // namespace overlaps_test
