#include "mesh/poisson_discs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

Index clamped(double position, Index n) { return std::clamp(static_cast<Index>(position), Index{0}, n - 1); }

/// The inner ends of random pieces of 1 to 1.42 in a length; both without a unit.
std::vector<double> random_pieces(double length, Random& random) {
    if (length <= 1.42) return {};
    std::vector<double> pieces(std::max(2, static_cast<int>(std::lround(length / 1.2))));
    for (double& piece : pieces) piece = random.uniform(0.83, 1.17);
    const double scale = length / std::accumulate(pieces.begin(), pieces.end(), 0.0);
    pieces.pop_back();  // ends at the end
    double until = 0;
    for (double& piece : pieces) piece = until += scale * piece;
    return pieces;
}

}  // namespace

std::vector<Vec2> points_along(const Vec2& a, const Vec2& b, const SizeField& radius, Random& random) {
    LengthInSizes in_radii((b - a).norm(), radius, [&](double position) { return Vec2(a + (b - a) * position); });
    std::vector<Vec2> points;
    for (const double target : random_pieces(in_radii.total(), random))
        points.push_back(a + (b - a) * in_radii.position(target));
    return points;
}

/// With r = r_a (1 + g x) at a part x of the line, the length up to x in local radii is L/r_a log(1 + g x)/g.
std::vector<double> pieces_along(double length, double radius_at_start, double radius_at_end, Random& random) {
    const double g = radius_at_end / radius_at_start - 1, in_radii = length / radius_at_start;
    const bool is_uniform = std::abs(g) < 1e-6;
    std::vector<double> parts;
    for (const double target : random_pieces(in_radii * (is_uniform ? 1 : std::log1p(g) / g), random))
        parts.push_back(is_uniform ? target / in_radii : std::expm1(g * target / in_radii) / g);
    return parts;
}

std::vector<Vec2> poisson_points(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius,
                                 Random& random) {
    CellGrid grid(shape, on_lines, radius);
    std::vector<CellGrid::Cell> cells = grid.cells_of_body();
    for (std::size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[random.bits() % i]);

    std::erase_if(cells, [&](const CellGrid::Cell& cell) { return !grid.empty(cell); });

    // dart throwing: one dart in every free cell, a few times; the remaining gaps are closed by the Delaunay refinement
    constexpr int n_rounds = 12;
    for (int round = 0; round < n_rounds; ++round) {
        if (round == 1) {  // most gaps are too small from now on, so that most darts need no look at points
            const std::vector<std::uint64_t> covered = grid.covered_parts(radius);
            for (CellGrid::Cell& cell : cells) cell.covered = covered[grid.number(cell)];
        }
        std::erase_if(cells, [&](const CellGrid::Cell& cell) {
            const double u = random.uniform(), v = random.uniform();
            const double factor = random.uniform(1 - CellGrid::spread, 1 + CellGrid::spread);
            if (cell.is_covered(u, v)) return false;
            const Vec2 dart = grid.place(cell, u, v);
            const bool hits = !grid.crowded({dart, radius(dart), factor}) && shape.contains(dart);
            if (hits) grid.add(dart, factor);
            return hits;
        });
    }
    return grid.inner_points();
}

CellGrid::CellGrid(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius)
    : n_on_lines_(static_cast<Index>(on_lines.size())) {
    const Box box = bounding_box(shape.outer.points);
    const Vec2 extent = box.extent();
    low_ = box.low;
    width_ = std::max(6 * radius.largest(), std::sqrt(extent.x() * extent.y()) / 4000);
    for (const int axis : {0, 1}) n_roots_[axis] = static_cast<Index>(extent[axis] / width_) + 1;
    // the roots that the body reaches have their centre in it, or lie within a quarter of a block from a point of its
    // lines, which are nearer to each other than that
    for (Index root = 0; root < n_roots_[0] * n_roots_[1]; ++root) {
        const Vec2 low = low_ + width_ * Vec2(root % n_roots_[0], root / n_roots_[0]);
        Block& block = blocks_.emplace_back(Block{.low = low, .width = width_});
        block.reached = shape.contains(block.middle());
    }
    for (const Vec2& p : on_lines)
        for (const double dx : {-0.25, 0.25})
            for (const double dy : {-0.25, 0.25})
                blocks_[root_at(p.x() + dx * width_, p.y() + dy * width_)].reached = true;
    for (Index block = 0; block < std::ssize(blocks_); ++block) divide(block, radius);  // children come at the end
    for (const Vec2& p : on_lines) add(p, 1);
}

/// Into four, or into cells with a diagonal below the smallest distance of two points.
void CellGrid::divide(Index number, const SizeField& radius) {
    const Block block = blocks_[number];  // a reference would not outlive the first child
    const double half_diagonal = block.width * std::sqrt(0.5);
    const double at_middle = radius(block.middle()), change = radius.slope() * half_diagonal;
    const double smallest = std::max(radius.smallest(), at_middle - change);
    const double largest = std::min(radius.largest(), at_middle + change);
    if (block.reached && radius.slope() > 0 && largest > 2 * smallest) {
        blocks_[number].first_child = static_cast<Index>(blocks_.size());
        for (const double y : {block.low.y(), block.middle().y()})
            for (const double x : {block.low.x(), block.middle().x()})
                blocks_.push_back({.low = {x, y}, .width = block.width / 2, .reached = true});
        return;
    }
    const Index n = block.reached ? static_cast<Index>(std::ceil(2 * half_diagonal / ((1 - spread) * smallest))) : 1;
    blocks_[number].n_cells = n;
    blocks_[number].first_cell = static_cast<Index>(first_.size());
    first_.resize(first_.size() + n * n, -1);
}

Index CellGrid::root_along(int axis, double x) const { return clamped((x - low_[axis]) / width_, n_roots_[axis]); }

Index CellGrid::Block::cell_along(int axis, double x) const {
    return clamped((x - low[axis]) * (n_cells / width), n_cells);
}

std::vector<CellGrid::Cell> CellGrid::cells_of_body() const {
    std::vector<Cell> cells;
    for (Index number = 0; number < std::ssize(blocks_); ++number) {
        const Block& block = blocks_[number];
        if (!block.reached || block.first_child >= 0) continue;
        for (Index row = 0; row < block.n_cells; ++row)
            for (Index column = 0; column < block.n_cells; ++column) cells.push_back({number, column, row});
    }
    return cells;
}

Vec2 CellGrid::place(const Cell& cell, double u, double v) const {
    const Block& block = blocks_[cell.block];
    return block.low + (block.width / block.n_cells) * Vec2(cell.column + u, cell.row + v);
}

void CellGrid::add(const Vec2& p, double factor) {
    const Block* block = &blocks_[root_at(p.x(), p.y())];
    while (block->first_child >= 0) {
        const Vec2 middle = block->middle();
        block = &blocks_[block->first_child + 2 * (p.y() >= middle.y()) + (p.x() >= middle.x())];
    }
    Index& first = first_[block->cell(block->cell_along(0, p.x()), block->cell_along(1, p.y()))];
    points_.push_back({p, factor, first});
    first = static_cast<Index>(points_.size()) - 1;
}

bool CellGrid::crowded(const Disc& disc) const {
    const double reach = (1 + 0.5 * spread + 0.5 * (disc.factor - 1)) * disc.radius;
    const Vec2 margin = Vec2::Constant(reach), centre = disc.centre;
    return any_near({centre - margin, centre + margin}, [&](const Point& point, bool is_on_line) {
        return (point.place - centre).norm() < disc.radius * (is_on_line ? 1 : 0.5 * (disc.factor + point.factor));
    });
}

std::vector<std::uint64_t> CellGrid::covered_parts(const SizeField& radius) const {
    std::vector<std::uint64_t> covered(first_.size(), 0);
    for (const Cell& cell : cells_of_body()) {  // in order of place, so that points are in the cache
        const double width = blocks_[cell.block].width / blocks_[cell.block].n_cells, part = width / Cell::n_parts;
        const double at_middle = radius(place(cell, 0.5, 0.5)), change = radius.slope() * width * std::sqrt(0.5);
        const Vec2 low = place(cell, 0, 0), margin = Vec2::Constant(at_middle + change - part);
        std::uint64_t& parts = covered[number(cell)];
        any_near({low - margin, low + Vec2::Constant(width) + margin}, [&](const Point& point, bool is_on_line) {
            const double factor = is_on_line ? 1 : 0.5 * (1 - spread + point.factor);
            const double least =
                (1 - 1e-6) * factor * (at_middle - change);  // of any disc in the cell, without rounding
            const auto square_to_far_side = [&](int axis, int i) {
                const double from = low[axis] + i * part - point.place[axis], to = from + part;
                return std::max(from * from, to * to);
            };
            std::array<double, Cell::n_parts> columns;
            for (int i = 0; i < Cell::n_parts; ++i) columns[i] = square_to_far_side(0, i);
            for (int row = 0; row < Cell::n_parts; ++row) {
                const double rest = least * least - square_to_far_side(1, row);
                for (int i = 0; rest > 0 && i < Cell::n_parts; ++i)
                    parts |= std::uint64_t{columns[i] < rest} << (Cell::n_parts * row + i);
            }
            return parts == ~std::uint64_t{0};
        });
    }
    return covered;
}

std::vector<Vec2> CellGrid::inner_points() const {
    std::vector<Vec2> places;
    for (Index k = n_on_lines_; k < std::ssize(points_); ++k) places.push_back(points_[k].place);
    return places;
}

template <class Visit>
bool CellGrid::any_near(const Box& near, const Visit& visit) const {
    for (Index y = root_along(1, near.low.y()); y <= root_along(1, near.high.y()); ++y)
        for (Index x = root_along(0, near.low.x()); x <= root_along(0, near.high.x()); ++x)
            if (any_in(blocks_[y * n_roots_[0] + x], near, visit)) return true;
    return false;
}

template <class Visit>
bool CellGrid::any_in(const Block& block, const Box& near, const Visit& visit) const {
    if (block.first_child >= 0) {
        const Vec2 middle = block.middle();
        for (Index y = near.low.y() >= middle.y(); y <= Index{near.high.y() >= middle.y()}; ++y)
            for (Index x = near.low.x() >= middle.x(); x <= Index{near.high.x() >= middle.x()}; ++x)
                if (any_in(blocks_[block.first_child + 2 * y + x], near, visit)) return true;
        return false;
    }
    const Index left = block.cell_along(0, near.low.x()), right = block.cell_along(0, near.high.x());
    const Index bottom = block.cell_along(1, near.low.y()), top = block.cell_along(1, near.high.y());
    for (Index row = bottom; row <= top; ++row)
        for (Index column = left; column <= right; ++column)
            for (Index k = first_[block.cell(column, row)]; k >= 0; k = points_[k].next)
                if (visit(points_[k], k < n_on_lines_)) return true;
    return false;
}

}  // namespace knap
