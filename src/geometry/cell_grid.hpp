#pragma once
// Where the points of a Poisson disc sampling lie, so that the neighbours of a new one are found at once: square blocks, cut into four
// as long as the radius varies by more than a factor of two within one, and then into cells just too small for two points. The cells
// follow the local radius, so that a strongly graded body needs no more of them for a point than a uniform one.
#include "geometry/shape.hpp"
#include "geometry/size_field.hpp"

#include <vector>

namespace knap {

/// A point that keeps a distance of `factor` times the local radius.
struct Disc {
    Vec2 centre;    // [m]
    double radius;  // [m], of the size field at the centre
    double factor;  // [-] 1 - spread to 1 + spread; 1 for points of lines
};

class CellGrid {
public:
    /// Largest deviation of a factor from 1.
    static constexpr double spread = 0.15;

    struct Cell {
        Index block, column, row;
    };

    CellGrid(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius);

    /// The cells of all blocks that the body reaches.
    std::vector<Cell> cells_of_body() const;
    bool empty(const Cell& cell) const;
    /// The point at (u, v) in [0, 1)^2 of a cell.
    Vec2 place(const Cell& cell, double u, double v) const;

    void add(const Vec2& p, double factor);
    /// True when a disc is too near to a point: two points of the body keep the mean of their factors apart, and points of lines keep a
    /// whole radius, so that no point of the body lies in the diametral circle of a piece of a line.
    bool crowded(const Disc& disc) const;

    /// Points of lines first.
    const std::vector<Vec2>& points() const { return points_; }

private:
    /// A square with four children or with n_cells x n_cells cells. One that the body does not reach is one cell.
    struct Block {
        Vec2 low;                // [m]
        double width;            // [m]
        bool reached;            // by the body
        Index first_child = -1;  // of the children at (0, 0), (1, 0), (0, 1), (1, 1); -1: has cells
        Index n_cells = 1;       // per side
        Index first_cell = -1;

        Vec2 middle() const { return low + Vec2::Constant(width / 2); }
    };

    void mark_reached(const Shape& shape, const std::vector<Vec2>& on_lines);
    void cut(Index block, const SizeField& radius);
    Index root_column(double x) const;
    Index root_row(double y) const;
    Index cell_at(const Vec2& p) const;
    bool crowded_in(const Block& block, const Disc& disc, double reach) const;
    bool crowded_in_cell(Index cell, const Disc& disc) const;

    Vec2 low_;                         // [m] corner of the first root
    double width_;                     // [m] of a root
    Index n_x_ = 0, n_y_ = 0;          // roots per direction
    std::vector<Block> blocks_;        // the roots first, row by row
    Index n_on_lines_;                 // points of lines
    std::vector<Index> first_, next_;  // linked lists of points: per cell, per point; -1 ends one
    std::vector<Vec2> points_;         // [m]
    std::vector<double> factor_;       // [-] per point
};

}  // namespace knap
