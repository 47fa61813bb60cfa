#include "geometry/random_points.hpp"

#include "geometry/cell_grid.hpp"
#include "geometry/planar_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {

std::vector<Vec2> points_along(const Vec2& a, const Vec2& b, const SizeField& radius, Random& random) {
    // length in radii up to the end of each of many small intervals
    const double length = (b - a).norm();
    const int n_intervals = std::max(1, static_cast<int>(std::ceil(8 * length / radius.smallest())));
    std::vector<double> in_radii{0.0};
    const int n_samples = radius.slope() > 0 ? n_intervals : 1;
    for (int i = 0; i < n_samples; ++i) {
        const Vec2 middle = a + (b - a) * ((i + 0.5) / n_samples);
        in_radii.push_back(in_radii.back() + length / n_samples / radius(middle));
    }
    const double total = in_radii.back();
    if (total <= 1.42) return {};
    const int n_pieces = std::max(2, static_cast<int>(std::lround(total / 1.2)));
    std::vector<double> pieces(n_pieces);
    for (double& piece : pieces) piece = random.uniform(0.83, 1.17);
    const double scale = total / std::accumulate(pieces.begin(), pieces.end(), 0.0);

    std::vector<Vec2> points;
    double wanted = 0;
    std::size_t i = 1;
    for (int k = 0; k + 1 < n_pieces; ++k) {
        wanted += scale * pieces[k];
        while (i + 1 < in_radii.size() && in_radii[i] < wanted) ++i;
        const double fraction = (wanted - in_radii[i - 1]) / (in_radii[i] - in_radii[i - 1]);
        points.push_back(a + (b - a) * ((static_cast<double>(i) - 1 + fraction) / n_samples));
    }
    return points;
}

std::vector<Vec2> poisson_points(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius, Random& random) {
    CellGrid grid(shape, on_lines, radius);
    std::vector<CellGrid::Cell> cells = grid.cells_of_body();
    for (std::size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[random.bits() % i]);

    // dart throwing: one dart in every free cell, a few times; the gaps that stay are closed by the Delaunay refinement
    constexpr int n_rounds = 12;
    for (int round = 0; round < n_rounds; ++round) {
        std::vector<CellGrid::Cell> still_free;
        for (const CellGrid::Cell& cell : cells) {
            if (!grid.empty(cell)) continue;
            const double u = random.uniform(), v = random.uniform();
            const Vec2 dart = grid.place(cell, u, v);
            const double factor = random.uniform(1 - CellGrid::spread, 1 + CellGrid::spread);
            if (!grid.crowded({dart, radius(dart), factor}) && in_body(shape, dart))
                grid.add(dart, factor);
            else
                still_free.push_back(cell);
        }
        cells.swap(still_free);
    }
    return {grid.points().begin() + static_cast<std::ptrdiff_t>(on_lines.size()), grid.points().end()};
}

}  // namespace knap
