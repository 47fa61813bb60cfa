#pragma once
// Which free edges are near which vertices of the free boundary: a cell grid, and a list that stays complete while the
// boundary moves a little.
#include "stepper/contact/free_boundary.hpp"

namespace knap {

/// A corner of FreeBoundary::corners() as it is now.
struct CornerMotion {
    Vec2 x;  // [m]
    Vec2 v;  // [m/s]
};

/// Places in FreeBoundary::edges(): the edge that leaves a vertex, and an edge near it.
struct NearbyEdge {
    Index vertex, edge;
};

/// A pair (vertex, edge) with gap g and the point of the vertex beside s of the edge is near if g <= reach, if the
/// penetration is at most FreeEdge::depth, and if the point lies beyond an end of the edge by at most L/4 and reach, or
/// where it is deep reach + min(-g, depth + g). The list contains every near pair of a reach as long as all ends of
/// edges have moved by at most (margin - 1.5 reach)/2.5 since it was made (the distance between a vertex and an edge
/// changes by at most 2 moves, the gap of a point beside the prolonged edge by at most 2.5).
class NearbyEdges {
public:
    static constexpr std::size_t block = 256;  // vertices

    void find(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners, double margin);
    /// The pairs of the vertices of block b, in the order of (vertex, edge).
    std::span<const NearbyEdge> of_block(std::size_t b) const { return pairs_[b]; }
    std::size_t n_blocks() const { return n_blocks_; }
    double margin() const { return margin_; }
    /// [m2] The square of the distance of a corner from its place when the list was made.
    double squared_move(std::size_t corner, const Vec2& x) const { return (x - x_[corner]).squaredNorm(); }

private:
    struct Entry {
        std::int32_t x, y;  // cell
        Index edge;
    };
    std::array<std::int32_t, 2> cell(const Vec2& x) const;
    std::size_t bucket(std::int32_t x, std::int32_t y) const;
    void fill_grid(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners);

    double margin_ = -1, cell_size_ = 1;
    std::size_t n_blocks_ = 0;
    std::vector<Vec2> x_;                         // [m] per corner, when the list was made
    std::vector<Index> bucket_end_;               // of a hash table of cells, into entries_
    std::vector<Entry> entries_;                  // within a bucket in the order of the edges
    std::vector<std::vector<NearbyEdge>> pairs_;  // per block
};

}  // namespace knap
