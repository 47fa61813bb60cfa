#pragma once
// How a planar graph is made: one straight piece after the other.
#include "mesh/planar_graph.hpp"
#include "mesh/search_grid.hpp"

namespace knap {

/// Inserts one straight piece after the other; earlier pieces keep their place, later ones are bent onto them.
class GraphBuilder {
public:
    /// Goes on with a graph. `box`: about where the pieces lie; `n_pieces`: about how many there are.
    GraphBuilder(PlanarGraph& graph, const Box& box, std::size_t n_pieces);

    /// Points of the pieces that are nearer than the tolerance to earlier nodes and segments are moved onto these.
    /// Throws ShapeError where lines cross too often.
    void insert(const std::vector<Segment>& pieces, double tolerance, GraphSegment labels,
                const std::vector<Index>& boundaries = {});

private:
    void connect_through(Index from, Index to, const GraphSegment& labels, int n_bends);
    void connect(Index from, Index to, GraphSegment labels);
    Index node_at(const Vec2& p);
    Index add_node(const Vec2& p);
    Index split(std::size_t s, const Vec2& p);
    void split_crossed(const Vec2& p, const Vec2& q, const GraphSegment& labels);
    void register_node();
    void register_segment();

    PlanarGraph& graph_;
    SearchGrid near_nodes_, near_segments_;
    std::vector<std::vector<Index>> at_node_;  // segments that ended there when they were made
    double tolerance_ = 0;                     // [m]
    int n_crossings_ = 0;
};

}  // namespace knap
