#include "geometry/cell_grid.hpp"

#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

Index clamped(double position, Index n) { return std::clamp(static_cast<Index>(std::floor(position)), Index{0}, n - 1); }

}  // namespace

CellGrid::CellGrid(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius)
    : n_on_lines_(static_cast<Index>(on_lines.size())) {
    const Box box = bounding_box(shape.outer.points);
    const Vec2 extent = box.high - box.low;
    low_ = box.low;
    width_ = std::max(6 * radius.largest(), std::sqrt(extent.x() * extent.y()) / 4000);
    n_x_ = static_cast<Index>(extent.x() / width_) + 1;
    n_y_ = static_cast<Index>(extent.y() / width_) + 1;
    mark_reached(shape, on_lines);
    for (Index block = 0; block < static_cast<Index>(blocks_.size()); ++block) cut(block, radius);  // children come at the end
    for (const Vec2& p : on_lines) add(p, 1);
}

/// The roots: reached are those with their centre in the body, and those that one of its lines comes near (a quarter of a block from its
/// points, which are nearer to each other than that).
void CellGrid::mark_reached(const Shape& shape, const std::vector<Vec2>& on_lines) {
    for (Index root = 0; root < n_x_ * n_y_; ++root) {
        Block block{.low = low_ + width_ * Vec2(root % n_x_, root / n_x_), .width = width_, .reached = false};
        block.reached = in_body(shape, block.middle());
        blocks_.push_back(block);
    }
    for (const Vec2& p : on_lines)
        for (const double dx : {-0.25, 0.25})
            for (const double dy : {-0.25, 0.25})
                blocks_[root_row(p.y() + dy * width_) * n_x_ + root_column(p.x() + dx * width_)].reached = true;
}

/// Into four, or into cells with a diagonal below the smallest distance of two points.
void CellGrid::cut(Index number, const SizeField& radius) {
    Block& block = blocks_[number];
    const double half_diagonal = block.width * std::sqrt(0.5);
    const double at_middle = radius(block.middle()), change = radius.slope() * half_diagonal;
    const double least = std::max(radius.smallest(), at_middle - change), most = std::min(radius.largest(), at_middle + change);
    if (block.reached && radius.slope() > 0 && most > 2 * least) {
        block.first_child = static_cast<Index>(blocks_.size());
        const Block parent = block;  // the reference does not outlive the first child
        for (const double y : {parent.low.y(), parent.middle().y()})
            for (const double x : {parent.low.x(), parent.middle().x()})
                blocks_.push_back({.low = {x, y}, .width = parent.width / 2, .reached = true});
        return;
    }
    if (block.reached) block.n_cells = static_cast<Index>(std::ceil(2 * half_diagonal / ((1 - spread) * least)));
    block.first_cell = static_cast<Index>(first_.size());
    first_.resize(first_.size() + block.n_cells * block.n_cells, -1);
}

Index CellGrid::root_column(double x) const { return clamped((x - low_.x()) / width_, n_x_); }
Index CellGrid::root_row(double y) const { return clamped((y - low_.y()) / width_, n_y_); }

std::vector<CellGrid::Cell> CellGrid::cells_of_body() const {
    std::vector<Cell> cells;
    for (Index number = 0; number < static_cast<Index>(blocks_.size()); ++number) {
        const Block& block = blocks_[number];
        if (!block.reached || block.first_child >= 0) continue;
        for (Index row = 0; row < block.n_cells; ++row)
            for (Index column = 0; column < block.n_cells; ++column) cells.push_back({number, column, row});
    }
    return cells;
}

bool CellGrid::empty(const Cell& cell) const {
    const Block& block = blocks_[cell.block];
    return first_[block.first_cell + cell.row * block.n_cells + cell.column] < 0;
}

Vec2 CellGrid::place(const Cell& cell, double u, double v) const {
    const Block& block = blocks_[cell.block];
    return block.low + (block.width / block.n_cells) * Vec2(cell.column + u, cell.row + v);
}

Index CellGrid::cell_at(const Vec2& p) const {
    const Block* block = &blocks_[root_row(p.y()) * n_x_ + root_column(p.x())];
    while (block->first_child >= 0) {
        const Vec2 middle = block->middle();
        block = &blocks_[block->first_child + 2 * (p.y() >= middle.y()) + (p.x() >= middle.x())];
    }
    const Vec2 local = (p - block->low) * (block->n_cells / block->width);
    return block->first_cell + clamped(local.y(), block->n_cells) * block->n_cells + clamped(local.x(), block->n_cells);
}

void CellGrid::add(const Vec2& p, double factor) {
    Index& first = first_[cell_at(p)];
    next_.push_back(first);
    first = static_cast<Index>(points_.size());
    points_.push_back(p);
    factor_.push_back(factor);
}

bool CellGrid::crowded(const Disc& disc) const {
    const double reach = (1 + 0.5 * spread + 0.5 * (disc.factor - 1)) * disc.radius;
    const Vec2 low = disc.centre - Vec2::Constant(reach), high = disc.centre + Vec2::Constant(reach);
    for (Index y = root_row(low.y()); y <= root_row(high.y()); ++y)
        for (Index x = root_column(low.x()); x <= root_column(high.x()); ++x)
            if (crowded_in(blocks_[y * n_x_ + x], disc, reach)) return true;
    return false;
}

/// Among the points of one block within the square of half side `reach` round the disc.
bool CellGrid::crowded_in(const Block& block, const Disc& disc, double reach) const {
    const Vec2 low = disc.centre - Vec2::Constant(reach), high = disc.centre + Vec2::Constant(reach);
    if (block.first_child >= 0) {
        const Vec2 middle = block.middle();
        for (Index y = low.y() >= middle.y(); y <= Index{high.y() >= middle.y()}; ++y)
            for (Index x = low.x() >= middle.x(); x <= Index{high.x() >= middle.x()}; ++x)
                if (crowded_in(blocks_[block.first_child + 2 * y + x], disc, reach)) return true;
        return false;
    }
    const Index n = block.n_cells;
    const Vec2 from = (low - block.low) * (n / block.width), to = (high - block.low) * (n / block.width);
    for (Index row = clamped(from.y(), n); row <= clamped(to.y(), n); ++row)
        for (Index column = clamped(from.x(), n); column <= clamped(to.x(), n); ++column)
            if (crowded_in_cell(block.first_cell + row * n + column, disc)) return true;
    return false;
}

bool CellGrid::crowded_in_cell(Index cell, const Disc& disc) const {
    for (Index k = first_[cell]; k >= 0; k = next_[k])
        if ((points_[k] - disc.centre).norm() < disc.radius * (k < n_on_lines_ ? 1 : 0.5 * (disc.factor + factor_[k]))) return true;
    return false;
}

}  // namespace knap
