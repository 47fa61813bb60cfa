#include "microstructure/body_patterns.hpp"

#include "base/union_find.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

/// Joins points nearer than `nearest`: each becomes the mean of those it is joined to; on the border of the box it
/// stays there.
void join_near_points(std::vector<Vec2>& points, const Box& box, double nearest) {
    const Index n = static_cast<Index>(points.size());
    std::vector<Index> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](Index i) { return points[i].x(); });
    UnionFind sets(points.size());
    for (Index i = 0; i < n; ++i)
        for (Index j = i + 1; j < n && points[order[j]].x() - points[order[i]].x() < nearest; ++j)
            if ((points[order[j]] - points[order[i]]).norm() < nearest) sets.join(order[i], order[j]);
    std::vector<Vec2> sum(n, Vec2::Zero()), border(n, Vec2::Constant(std::nan("")));
    std::vector<int> count(n, 0);
    const double on_border = 1e-9 * box.diagonal();
    for (Index i = 0; i < n; ++i) {
        const Index set = sets.find(i);
        sum[set] += points[i], ++count[set];
        for (const int k : {0, 1})
            for (const double side : {box.low[k], box.high[k]})
                if (std::abs(points[i][k] - side) < on_border) border[set][k] = side;
    }
    for (Index i = 0; i < n; ++i) {
        const Index set = sets.find(i);
        points[i] = sum[set] / count[set];
        for (const int k : {0, 1})
            if (!std::isnan(border[set][k])) points[i][k] = border[set][k];
    }
}

/// Without points that follow each other within `nearest`; the part of the polygon that is left lies in it if it is
/// convex.
void drop_short_sides(std::vector<Vec2>& polygon, double nearest) {
    for (std::size_t i = 0; i < polygon.size() && polygon.size() > 2;) {
        if ((polygon[(i + 1) % polygon.size()] - polygon[i]).norm() <= nearest)
            polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>((i + 1) % polygon.size()));
        else ++i;
    }
}

/// The points of a polygon that are at least `distance` behind the lines of all its sides but those on the border.
std::vector<Vec2> shrunk(const std::vector<Vec2>& polygon, const Box& box, double distance) {
    std::vector<Vec2> inner = polygon, scratch;
    for (const auto& [a, b] : sides_of(polygon, true)) {
        const auto both_at = [&, a = a, b = b](int k, double x) { return a[k] == x && b[k] == x; };
        if (both_at(0, box.low.x()) || both_at(0, box.high.x()) || both_at(1, box.low.y()) || both_at(1, box.high.y()))
            continue;
        const Vec2 inward = turned_left((b - a).normalized());
        clip(
            inner, [&, a = a](const Vec2& p) { return distance - inward.dot(p - a); }, scratch);
    }
    return inner;
}

}  // namespace

Outlines wall(const WallOptions& options) {
    const double step = options.block.x() + options.gap, length = options.columns * step - options.gap;
    Outlines blocks;
    const auto add = [&](int row, double from, double to) {
        const Vec2 low = options.origin + Vec2(from, row * (options.block.y() + options.gap)),
                   high = low + Vec2(to - from, options.block.y());
        blocks.push_back(Box{low, high}.corners());
    };
    for (int row = 0; row < options.rows; ++row) {
        const double shift = row % 2 == 0 ? 0 : options.bond * step;
        if (shift > 0) add(row, 0, shift - options.gap);
        for (int column = 0; column < options.columns; ++column) {
            const double from = shift + column * step;
            add(row, from, std::min(from + options.block.x(), length));
        }
    }
    return blocks;
}

Outlines cells_of_box(const GrainOptions& options, const Box& box, double gap, double nearest, std::uint64_t seed,
                      const std::string& part) {
    const PowerDiagram diagram = round_cells(options, box, seed, part);
    std::vector<Vec2> points;  // of all cells
    std::vector<std::size_t> end;
    for (Index i = 0; i < diagram.n_sites(); ++i) {
        const std::vector<Vec2> cell = diagram.cell(i);
        points.insert(points.end(), cell.begin(), cell.end());
        end.push_back(points.size());
    }
    join_near_points(points, box, nearest);
    Outlines cells;
    std::size_t first = 0;
    for (const std::size_t last : end) {
        std::vector<Vec2> cell(points.begin() + static_cast<std::ptrdiff_t>(first),
                               points.begin() + static_cast<std::ptrdiff_t>(last));
        first = last;
        drop_short_sides(cell, 0);
        if (gap > 0) cell = shrunk(cell, box, 0.5 * gap), drop_short_sides(cell, nearest);
        if (cell.size() > 2 && signed_area(cell) > nearest * nearest) cells.push_back(std::move(cell));
    }
    return cells;
}

Outlines heap(InclusionOptions options, const Box& box, std::uint64_t seed, const std::string& part) {
    Shape space;
    space.outer = {box.corners(), {0, 0, 0, 0}};
    options.tag = 0;
    options.convex = true;
    place_inclusions(space, options, seed, part);
    Outlines stones;
    for (Region& region : space.regions) stones.push_back(std::move(region.points));
    return stones;
}

}  // namespace knap
