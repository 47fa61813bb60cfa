// The quality report of meshes with known answers, and of the random mesh against a lattice (case E15).
#include "mesh/mesh_report.hpp"

#include "mesh/shapes.hpp"
#include "mesh/triangulate.hpp"

#include "support/verification.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace mesh_report_test {

using namespace knap;
using namespace knap::tests;
using knap::testing::block;
using knap::testing::relative;

namespace {

/// Rows of equilateral triangles with edges of 1: a parallelogram of n x n rhombs.
Mesh lattice(Index n) {
    Mesh mesh;
    for (Index j = 0; j <= n; ++j)
        for (Index i = 0; i <= n; ++i) mesh.vertices.emplace_back(i + 0.5 * j, std::sqrt(0.75) * j);
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            const Index a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({b, d, c});
        }
    mesh.region.assign(mesh.triangles.size(), 0);
    find_edges(mesh);
    return mesh;
}

}  // namespace

TEST_CASE("a lattice of equilateral triangles is measured exactly") {
    const MeshReport report = judge(lattice(100));
    CHECK(report.n_triangles == 20000);
    CHECK(report.n_vertices == 101 * 101);
    CHECK(report.n_boundary_edges == 400);
    CHECK(report.n_interior_edges == (3 * 20000 - 400) / 2);
    CHECK(report.n_cracked_edges == 0);
    CHECK(report.area == relative(10000 * std::sqrt(0.75), 1e-12));
    for (const double edge : {report.smallest_edge, report.mean_edge, report.largest_edge})
        CHECK(edge == relative(1, 1e-12));
    for (const double angle : {report.smallest_angle, report.mean_smallest_angle, report.largest_angle})
        CHECK(angle == relative(60, 1e-12));
    for (const double angle : report.smallest_angle_percentiles) CHECK(angle == relative(60, 1e-12));
    CHECK(report.smallest_altitude == relative(std::sqrt(0.75), 1e-12));
}

TEST_CASE("a lattice has straight paths in three directions and long ones between them") {
    const MeshReport report = judge(lattice(100));
    REQUIRE(report.n_paths > 100);
    // along the rows the path is straight; at 30 degree it is 2 / sqrt 3 too long
    CHECK(report.path_excess[0] < 0.02);
    CHECK(report.path_excess[4] == relative(2 / std::sqrt(3.0) - 1, 0.03));
    // mean over the angle t of cos t + sin t / sqrt 3 on 0..60 degree
    CHECK(report.mean_path_excess == relative(2 * std::sqrt(3.0) / std::acos(-1.0) - 1, 0.02));
    CHECK(report.path_excess_spread > 0.03);
}

TEST_CASE("E15 a random mesh has no direction and at most 4.5 percent of excess on far paths") {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const MeshReport report = judge(triangulate(block(), {.size = 4e-4, .seed = seed}));
        REQUIRE(report.n_paths > 1000);
        const std::string at = ", seed " + std::to_string(seed);
        verify_at_most("excess of the shortest path along edges, growth from half to full reach" + at,
                       report.far_path_excess, 0.045);
        verify_at_most("mean excess" + at, report.mean_path_excess, 0.052);
        verify_at_most("its standard deviation over 24 directions" + at, report.path_excess_spread, 0.005);
        double worst = 0;
        for (const double excess : report.path_excess)
            worst = std::max(worst, std::abs(excess - report.mean_path_excess));
        verify_at_most("largest difference of a direction from the mean" + at, worst, 0.01);
    }
}

TEST_CASE("a mesh too small for far paths reports none") {
    const MeshReport report = judge(triangulate(block(), {.size = 0.01}));
    CHECK(report.n_paths == 0);
    CHECK(report.mean_path_excess == 0);
    CHECK(judge(Mesh{}).n_triangles == 0);
}

}  // namespace mesh_report_test
