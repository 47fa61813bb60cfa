#include "geometry/random_points.hpp"

#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"

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

namespace {

/// The radius of every point is the local one times a random factor of 1 +- spread.
constexpr double spread = 0.15;

/// Blocks of equal width, each cut into square cells smaller than the local radius / sqrt(2), with the points in every cell.
/// A block that the body does not reach is one cell.
class CellGrid {
public:
    CellGrid(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius)
        : n_on_lines_(static_cast<Index>(on_lines.size())) {
        const Box box = bounding_box(shape.outer.points);
        const Vec2 extent = box.high - box.low;
        low_ = box.low;
        width_ = std::max(6 * radius.largest(), std::sqrt(extent.x() * extent.y()) / 4000);
        n_x_ = static_cast<Index>(extent.x() / width_) + 1;
        n_y_ = static_cast<Index>(extent.y() / width_) + 1;
        mark_reached(shape, on_lines);
        const double half_diagonal = width_ * std::sqrt(0.5);
        for (Index block = 0; block < n_blocks(); ++block) {
            const Vec2 centre = block_low(block) + Vec2::Constant(width_ / 2);
            const double least = std::max(radius.smallest(), radius(centre) - radius.slope() * half_diagonal);
            n_cells_.push_back(reached_[block] ? static_cast<Index>(std::ceil(2 * half_diagonal / ((1 - spread) * least))) : 1);
            first_cell_.push_back(total_);
            total_ += n_cells_.back() * n_cells_.back();
        }
        first_.assign(total_, -1);
        for (const Vec2& p : on_lines) add(p, 1);
    }

    bool reached(Index block) const { return reached_[block]; }
    Index n_blocks() const { return n_x_ * n_y_; }
    Index cells_per_side(Index block) const { return n_cells_[block]; }
    Index first_cell(Index block) const { return first_cell_[block]; }
    double block_width() const { return width_; }
    Vec2 block_low(Index block) const { return low_ + width_ * Vec2(block % n_x_, block / n_x_); }
    bool empty(Index cell) const { return first_[cell] < 0; }
    const std::vector<Vec2>& points() const { return points_; }

    void add(const Vec2& p, double factor) {
        const Index x = column(p.x()), y = row(p.y()), block = y * n_x_ + x;
        const Vec2 local = (p - block_low(block)) * (n_cells_[block] / width_);
        const Index i = clamped(local.x(), n_cells_[block]), j = clamped(local.y(), n_cells_[block]);
        const Index cell = first_cell_[block] + j * n_cells_[block] + i;
        next_.push_back(first_[cell]);
        first_[cell] = static_cast<Index>(points_.size());
        points_.push_back(p);
        factor_.push_back(factor);
    }

    /// True when p, with its radius and factor, is too near to a point: two points of the body keep the mean of their factors apart,
    /// and points of lines keep a whole radius so that no point of the body lies in the diametral circle of a piece of a line.
    bool crowded(const Vec2& p, double radius, double factor) const {
        const double distance = (1 + 0.5 * spread + 0.5 * (factor - 1)) * radius;
        for (Index y = row(p.y() - distance); y <= row(p.y() + distance); ++y)
            for (Index x = column(p.x() - distance); x <= column(p.x() + distance); ++x) {
                const Index block = y * n_x_ + x, n = n_cells_[block];
                const Vec2 local = p - block_low(block);
                const double per_length = n / width_;
                const Index i_end = clamped((local.x() + distance) * per_length, n),
                            j_end = clamped((local.y() + distance) * per_length, n);
                const Index i_begin = clamped((local.x() - distance) * per_length, n);
                for (Index j = clamped((local.y() - distance) * per_length, n); j <= j_end; ++j)
                    for (Index i = i_begin; i <= i_end; ++i)
                        for (Index k = first_[first_cell_[block] + j * n + i]; k >= 0; k = next_[k])
                            if ((points_[k] - p).norm() < radius * (k < n_on_lines_ ? 1 : 0.5 * (factor + factor_[k]))) return true;
            }
        return false;
    }

private:
    /// Blocks with their centre in the body, and those that one of its lines comes near (a quarter of a block from its points).
    void mark_reached(const Shape& shape, const std::vector<Vec2>& on_lines) {
        reached_.resize(n_blocks());
        for (Index block = 0; block < n_blocks(); ++block) reached_[block] = in_body(shape, block_low(block) + Vec2::Constant(width_ / 2));
        for (const Vec2& p : on_lines)
            for (const double dx : {-0.25, 0.25})
                for (const double dy : {-0.25, 0.25}) reached_[row(p.y() + dy * width_) * n_x_ + column(p.x() + dx * width_)] = 1;
    }

    static Index clamped(double position, Index n) { return std::clamp(static_cast<Index>(std::floor(position)), Index{0}, n - 1); }
    Index column(double x) const { return clamped((x - low_.x()) / width_, n_x_); }
    Index row(double y) const { return clamped((y - low_.y()) / width_, n_y_); }

    Vec2 low_;
    double width_;  // [m] of a block
    Index n_x_ = 0, n_y_ = 0, total_ = 0;
    Index n_on_lines_;                         // the points of lines come first
    std::vector<char> reached_;                // per block
    std::vector<Index> n_cells_, first_cell_;  // per block: cells per side, number of its first cell
    std::vector<Index> first_, next_;          // linked lists of points: per cell, per point
    std::vector<Vec2> points_;
    std::vector<double> factor_;  // [-] of the radius, per point
};

struct Cell {
    Index block, i, j;
};

std::vector<Cell> cells_of_body(const CellGrid& grid) {
    std::vector<Cell> cells;
    for (Index block = 0; block < grid.n_blocks(); ++block) {
        if (!grid.reached(block)) continue;
        for (Index j = 0; j < grid.cells_per_side(block); ++j)
            for (Index i = 0; i < grid.cells_per_side(block); ++i) cells.push_back({block, i, j});
    }
    return cells;
}

}  // namespace

std::vector<Vec2> poisson_points(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius, Random& random) {
    CellGrid grid(shape, on_lines, radius);
    std::vector<Cell> cells = cells_of_body(grid);
    for (std::size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[random.bits() % i]);

    // dart throwing: one dart in every free cell, a few times; the gaps that stay are closed by the Delaunay refinement
    constexpr int n_rounds = 12;
    for (int round = 0; round < n_rounds; ++round) {
        std::vector<Cell> still_free;
        for (const Cell& cell : cells) {
            const Index n = grid.cells_per_side(cell.block);
            if (!grid.empty(grid.first_cell(cell.block) + cell.j * n + cell.i)) continue;
            const double u = random.uniform(), v = random.uniform();
            const Vec2 dart = grid.block_low(cell.block) + (grid.block_width() / n) * Vec2(cell.i + u, cell.j + v);
            const double factor = random.uniform(1 - spread, 1 + spread);
            if (!grid.crowded(dart, radius(dart), factor) && in_body(shape, dart))
                grid.add(dart, factor);
            else
                still_free.push_back(cell);
        }
        cells.swap(still_free);
    }
    return {grid.points().begin() + static_cast<std::ptrdiff_t>(on_lines.size()), grid.points().end()};
}

}  // namespace knap
