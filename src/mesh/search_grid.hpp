#pragma once
// A square grid in which segments and points are found by their places.
#include "mesh/polygon.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

class SearchGrid {
public:
    /// About `n_cells` of a box; what lies outside is in the cells of its border.
    SearchGrid(const Box& box, std::size_t n_cells) : low_(box.low) {
        const Vec2 extent = box.extent().cwiseMax(1e-6 * box.diagonal() + 1e-300);
        cell_ = std::sqrt(extent.x() * extent.y() / static_cast<double>(std::max<std::size_t>(n_cells, 1)));
        cell_ = std::max(cell_, extent.maxCoeff() / 1e4);
        n_x_ = static_cast<int>(extent.x() / cell_) + 1, n_y_ = static_cast<int>(extent.y() / cell_) + 1;
        items_.resize(static_cast<std::size_t>(n_x_) * n_y_);
    }

    void add(const Segment& s, Index item) {
        visit_cells(s, 0, [&](std::vector<Index>& cell, int, int) { cell.push_back(item); });
    }

    /// An item that was a straight line ends at `far.a` from now on; what lies beyond, `far`, is another item.
    void cut(const Segment& far, Index item, Index beyond) {
        const int row_here = number(far.a.y(), low_.y(), n_y_), column_here = number(far.a.x(), low_.x(), n_x_);
        visit_cells(far, 0, [&](std::vector<Index>& cell, int row, int column) {
            const bool at_border = row == 0 || column == 0 || row == n_y_ - 1 || column == n_x_ - 1,
                       at_end = std::abs(row - row_here) <= 1 && std::abs(column - column_here) <= 1;
            const auto old = at_border || at_end ? cell.end() : std::ranges::find(cell, item);
            if (old != cell.end()) *old = beyond;
            else cell.push_back(beyond);
        });
    }

    /// All items that come within `margin` [m] of a segment, and others: ascending, each once.
    std::vector<Index> near(const Segment& s, double margin) {
        std::vector<Index> found;
        visit_cells(s, margin, [&](const std::vector<Index>& cell, int, int) {
            found.insert(found.end(), cell.begin(), cell.end());
        });
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }

private:
    int number(double x, double low, int n) const {
        return static_cast<int>(std::clamp(std::floor((x - low) / cell_), 0.0, n - 1.0));
    }

    /// In every row those along the part of the segment that is within the margin of the row.
    template <class Visit>
    void visit_cells(Segment s, double margin, const Visit& visit) {
        if (s.a.y() > s.b.y()) std::swap(s.a, s.b);
        margin += 1e-6 * cell_;  // rounding
        const int first = number(s.a.y() - margin, low_.y(), n_y_), last = number(s.b.y() + margin, low_.y(), n_y_);
        const double rise = s.b.y() - s.a.y();
        for (int row = first; row <= last; ++row) {
            const auto x_at = [&](double y) {
                return s.a.x() + (rise > 0 ? std::clamp((y - s.a.y()) / rise, 0.0, 1.0) : 0) * (s.b.x() - s.a.x());
            };
            const double below = low_.y() + row * cell_ - margin, above = low_.y() + (row + 1) * cell_ + margin;
            double from = row == 0 || rise == 0 ? s.a.x() : x_at(below),
                   to = row == n_y_ - 1 || rise == 0 ? s.b.x() : x_at(above);
            if (from > to) std::swap(from, to);
            for (int column = number(from - margin, low_.x(), n_x_); column <= number(to + margin, low_.x(), n_x_);
                 ++column)
                visit(items_[static_cast<std::size_t>(row) * n_x_ + column], row, column);
        }
    }

    Vec2 low_;
    double cell_;  // [m]
    int n_x_, n_y_;
    std::vector<std::vector<Index>> items_;
};

}  // namespace knap
