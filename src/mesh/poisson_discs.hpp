#pragma once
// Random points for a mesh without preferred directions: jittered along lines, and a maximal Poisson disc sample of the
// body (no two points nearer than a local radius, and hardly room for one more). The Delaunay triangles of such points
// have angles of about 30 to 120 degree and edges of 1 to 2 radii. Source: M. Ebeida, S. Mitchell, A. Davidson,
// A. Patney, P. Knupp, J. Owens, "Efficient and good Delaunay meshes from random points", Computer-Aided Design 43
// (2011) 1506.
#include "base/random.hpp"
#include "mesh/shape.hpp"
#include "mesh/size_field.hpp"

#include <array>
#include <cstdint>

namespace knap {

/// Poisson discs of this radius times the requested mean edge length give that mean edge length (measured).
inline constexpr double radius_per_size = 0.775;

/// The inner points that divide a-b into pieces of 1 to 1.42 radii.
std::vector<Vec2> points_along(const Vec2& a, const Vec2& b, const SizeField& radius, Random& random);

/// Where a line of that length [m] is divided into such pieces, as parts of it; the radius varies linearly between its
/// ends [m].
std::vector<double> pieces_along(double length, double radius_at_start, double radius_at_end, Random& random);

/// Points inside the body that keep the distance `radius` from each other and from the given points on its lines.
std::vector<Vec2> poisson_points(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius,
                                 Random& random);

/// A point that keeps a distance of `factor` times the local radius.
struct Disc {
    Vec2 centre;    // [m]
    double radius;  // [m], of the size field at the centre
    double factor;  // [-] 1 - spread to 1 + spread; 1 for points of lines
};

/// Finds the neighbours of a new point: square blocks, each divided into four while the radius varies by more than a
/// factor of two within one, and then into cells just too small for two points. The cells follow the local radius, so
/// that a strongly graded body needs no more of them per point than a uniform one.
class CellGrid {
public:
    /// Largest deviation of a factor from 1.
    static constexpr double spread = 0.15;

    struct Cell {
        static constexpr int n_parts = 8;  // per side
        Index block, column, row;
        std::uint64_t covered = 0;  // a bit for each of its parts: any disc in it is too near to a point

        /// At (u, v) in [0, 1)^2.
        bool is_covered(double u, double v) const {
            return covered >> (n_parts * static_cast<int>(n_parts * v) + static_cast<int>(n_parts * u)) & 1;
        }
    };

    CellGrid(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius);

    /// The cells of all blocks that the body reaches.
    std::vector<Cell> cells_of_body() const;
    Index number(const Cell& cell) const { return blocks_[cell.block].cell(cell.column, cell.row); }
    bool empty(const Cell& cell) const { return first_[number(cell)] < 0; }
    /// The point at (u, v) in [0, 1)^2 of a cell.
    Vec2 place(const Cell& cell, double u, double v) const;

    void add(const Vec2& p, double factor);
    /// True when a disc is too near to a point: two points of the body keep the mean of their factors apart, and points
    /// of lines keep a whole radius, so that no point of the body lies in the diametral circle of a piece of a line.
    bool crowded(const Disc& disc) const;

    /// `Cell::covered` of all cells by their numbers, for the points that are there.
    std::vector<std::uint64_t> covered_parts(const SizeField& radius) const;

    /// All but those of lines.
    std::vector<Vec2> inner_points() const;

private:
    /// A square with four children or with n_cells x n_cells cells; one that the body does not reach is one cell.
    struct Block {
        Vec2 low;                // [m]
        double width;            // [m]
        bool reached;            // by the body
        Index first_child = -1;  // of the children at (0, 0), (1, 0), (0, 1), (1, 1); -1: has cells
        Index n_cells = 1;       // per side
        Index first_cell = -1;

        Vec2 middle() const { return low + Vec2::Constant(width / 2); }
        Index cell_along(int axis, double x) const;  // column or row
        Index cell(Index column, Index row) const { return first_cell + row * n_cells + column; }
    };

    struct Point {
        Vec2 place;     // [m]
        double factor;  // [-]
        Index next;     // of the same cell; -1: none
    };

    void divide(Index block, const SizeField& radius);
    Index root_along(int axis, double x) const;  // column or row
    Index root_at(double x, double y) const { return root_along(1, y) * n_roots_[0] + root_along(0, x); }
    /// True when `visit(point, is_on_line)` says so of a point within the square `near`; it is not called again then.
    template <class Visit>
    bool any_near(const Box& near, const Visit& visit) const;
    template <class Visit>
    bool any_in(const Block& block, const Box& near, const Visit& visit) const;

    Vec2 low_;                      // [m] lower left corner of the first root
    double width_;                  // [m] of a root
    std::array<Index, 2> n_roots_;  // per direction
    std::vector<Block> blocks_;     // the roots first, row by row
    Index n_on_lines_;              // points of lines
    std::vector<Index> first_;      // point of each cell; -1: none
    std::vector<Point> points_;     // those of lines first
};

}  // namespace knap
