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
/// penetration is at most FreeEdge::depth, and if the point lies beyond an end of the edge by at most L/4 and reach +
/// depth + min(g, 0). The list contains every near pair of a reach as long as all ends of edges have moved by at most
/// (margin - reach_margin reach)/motion_margin since it was made (the distance between a vertex and an edge changes by
/// at most 2 moves, the gap of a point beside the prolonged edge by at most 2.5). Left out are pairs whose edge stays
/// outside the cone of the vertex meanwhile (FaceContacts, rule 3).
class NearbyEdges {
public:
    static constexpr double reach_margin = 1.5, motion_margin = 2.5;
    static constexpr std::size_t block = 256;  // vertices

    /// The edge leaves a vertex that may touch something.
    static bool is_vertex(std::span<const FreeEdge> edges, Index edge);
    /// The vertex that edge i leaves and edge e belong to different groups, which may touch.
    static bool may_meet(std::span<const FreeEdge> edges, Index i, Index e);
    void find(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners, double margin);
    /// Adds edges that appeared since and repeats the search for all `changed` ones, which include them. False where a
    /// search for all edges is cheaper by now.
    bool add(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners, std::span<const Index> changed);
    /// The pairs of the vertices of block b; those that add() found are the last block. Except in this block they have
    /// the order of (vertex, edge).
    std::span<const NearbyEdge> of_block(std::size_t b) const { return pairs_[b]; }
    std::size_t n_blocks() const { return n_blocks_; }
    std::size_t n_corners() const { return x_.size(); }
    double margin() const { return margin_; }
    /// [m2] The square of the distance of a corner from its place when the list was made.
    double squared_move(std::size_t corner, const Vec2& x) const { return (x - x_[corner]).squaredNorm(); }

private:
    struct Entry {
        std::int32_t x, y;  // cell
        Index edge;         // or vertex
    };
    std::array<std::int32_t, 2> cell(const Vec2& x) const;
    struct Cells {
        std::vector<Index> bucket_end;  // of a hash table of cells, into entries
        std::vector<Entry> entries;     // within a bucket in their order
    };
    struct CellBox {
        std::array<std::int32_t, 2> low, high;
    };
    CellBox cells_of(const FreeEdge& edge) const;
    CellBox cells_of_moving(std::span<const FreeEdge> edges) const;
    template <class ForEntries>
    void fill(Cells& cells, std::size_t n, const ForEntries& for_entries) const;
    template <class Visit>
    void for_entries_at(const Cells& cells, std::int32_t x, std::int32_t y, const Visit& visit) const;
    void fill_grid(std::span<const FreeEdge> edges);
    Vec2 place_of_vertex(std::span<const FreeEdge> edges, Index i) const;
    /// A vertex with its edges, at the time of the search.
    struct Corner {
        Vec2 x, t_in, t_out;
        double turn_in, turn_out;  // [-] how much t_in and t_out may turn until the next search
    };
    Corner corner(std::span<const FreeEdge> edges, Index i) const;
    double largest_turn(double length) const;
    bool is_near(std::span<const FreeEdge> edges, Index i, const Corner& corner, Index e) const;

    double margin_ = -1, cell_size_ = 1;
    std::size_t n_blocks_ = 0;
    std::vector<Vec2> x_;                             // [m] per corner, when the search met it for the first time
    Cells edge_cells_, vertex_cells_;                 // of the last complete search
    std::size_t n_listed_ = 0;                        // edges then
    std::vector<Index> late_edges_, late_vertices_;   // added or changed since
    std::vector<std::uint8_t> is_late_, is_changed_;  // per edge: in late_vertices_; in the present list of add()
    std::vector<std::vector<NearbyEdge>> pairs_;      // per block
};

}  // namespace knap
