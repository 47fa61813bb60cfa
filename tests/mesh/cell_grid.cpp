// The search grid of the Poisson discs: cells follow the local radius, and no neighbour is missed.
#include "mesh/poisson_discs.hpp"

#include "base/random.hpp"
#include "mesh/shapes.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace cell_grid_test {

using namespace knap;
using knap::testing::block;

namespace {

/// 20 times finer at the bottom than far from it.
MeshOptions graded() { return {.size = 2e-3, .refine = {{{{0, 0}, {0.1, 2e-4}}, 1e-4}}, .grading = 0.3}; }

}  // namespace

TEST_CASE("cells of a graded grid hold one point each and are not much smaller than that") {
    const MeshOptions options = graded();
    const SizeField radius(options, 1);
    std::vector<Vec2> on_lines;  // they mark the blocks that the body reaches with its rim only
    for (int i = 0; i <= 100; ++i) on_lines.insert(on_lines.end(), {{0.001 * i, 0.04}, {0.1, 0.0004 * i}});
    const CellGrid grid(block(), on_lines, radius);
    double area = 0;
    for (const CellGrid::Cell& cell : grid.cells_of_body()) {
        const Vec2 low = grid.place(cell, 0, 0), high = grid.place(cell, 1, 1);
        const double smallest_distance = (1 - CellGrid::spread) * std::min(radius(low), radius(high));
        CHECK((high - low).norm() <= smallest_distance * (1 + 1e-9));
        CHECK((high - low).norm() >= 0.2 * smallest_distance);
        const Vec2 inside = high.cwiseMin(Vec2(0.1, 0.04)) - low;
        area += std::max(0.0, inside.x()) * std::max(0.0, inside.y());
    }
    CHECK(area == testing::relative(0.1 * 0.04, 1e-9));
}

TEST_CASE("a graded grid finds the same neighbours as a look at all points") {
    const MeshOptions options = graded();
    const SizeField radius(options, 1);
    std::vector<Vec2> points = {{0, 0}, {0.1, 0}, {0.05, 0.02}};
    CellGrid grid(block(), points, radius);
    std::vector<double> factors(3, 1.0);
    Random random(1, "darts");
    int n_crowded = 0, n_wrong = 0;
    for (int i = 0; i < 3000; ++i) {
        // cubes of the height: most darts fall where the grid is fine
        const Vec2 dart(0.1 * random.uniform(), 0.04 * std::pow(random.uniform(), 3));
        const double factor = random.uniform(1 - CellGrid::spread, 1 + CellGrid::spread);
        bool crowded = false;
        for (std::size_t k = 0; k < factors.size(); ++k)
            crowded |= (points[k] - dart).norm() < radius(dart) * (k < 3 ? 1 : 0.5 * (factor + factors[k]));
        n_crowded += crowded;
        n_wrong += grid.crowded({dart, radius(dart), factor}) != crowded;
        if (crowded) continue;
        grid.add(dart, factor);
        points.push_back(dart), factors.push_back(factor);
    }
    CHECK(n_wrong == 0);
    CHECK(n_crowded > 500);
    CHECK(factors.size() > 500);

    const std::vector<std::uint64_t> covered = grid.covered_parts(radius);
    std::vector<CellGrid::Cell> cells = grid.cells_of_body();
    int n_covered = 0;
    n_crowded = n_wrong = 0;
    for (int i = 0; i < 20'000; ++i) {
        CellGrid::Cell& cell = cells[random.bits() % cells.size()];
        cell.covered = covered[grid.number(cell)];
        const double u = random.uniform(), v = random.uniform();
        const Vec2 dart = grid.place(cell, u, v);
        const bool crowded = grid.crowded({dart, radius(dart), 1 - CellGrid::spread});
        n_crowded += crowded, n_covered += cell.is_covered(u, v);
        n_wrong += cell.is_covered(u, v) && !crowded;
    }
    CHECK(n_wrong == 0);
    CHECK(n_covered > 0.6 * n_crowded);
}

}  // namespace cell_grid_test
