#pragma once
// Cracks as they grow: each a tree of cracked edges, divided into arms. README.md of this folder has the definitions.
#include "analysis/cracked_edges.hpp"

namespace knap {

/// Numbers of edges are those of the path itself, so they are local on a graded mesh.
struct CrackOptions {
    Index arm_edges = 10;         // a path is an arm when it has so many edges; a shorter one is a twig
    Index short_arm_edges = 10;   // or when it has so many
    double short_arm_length = 0;  // and this length [m]
    double min_length = 0;        // [m] of any arm: edges may be too small to be seen in a picture of the body
    Index gap_edges = 0;          // largest number of damaged interfaces between two broken stretches of one crack
    Index chord_edges = 1;        // lengths of paths are measured along chords of so many edges, not along the zigzag
    Index speed_edges = 20;       // a tip speed is fitted over growth by so many edges
    double speed_length = 0;      // and by at least this length [m]
    Index start_edges = 5;      // growth from which a tip speed is known; most edges that a running tip breaks at once
    double fastest = infinity;  // [m/s] of waves: bound of tip speeds

    bool is_arm(Index n_edges, double length) const {
        return length >= min_length &&
               (n_edges >= arm_edges || (n_edges >= short_arm_edges && length >= short_arm_length));
    }
};

/// For a random mesh whose triangle sides are `edges_per_side` interfaces: arms of ten sides, or of five that are 1/20
/// of `extent` [m], the size of the body: about what one sees as a fork in its picture. Where edges are very small, an
/// arm is at least 1/100 of `extent` long. Interfaces break in bursts
/// within a process zone [m], so a speed is fitted over at least 1.5 process zones.
CrackOptions crack_options(double extent, double process_zone, double fastest, Index edges_per_side);

enum class CrackStart : std::uint8_t { none, precrack, boundary, inside };

/// A vertex that a crack has reached, and the edge by which it did.
struct CrackNode {
    Index vertex, edge, parent;  // edge and parent: -1 at the start of a crack
    Index crack;
    Index arm = -1;       // to which its edge belongs; -1 on a twig
    double distance = 0;  // [m] from the start of its crack, along edges
    Index n_edges = 0;    // from there
    double since = 0;     // [s] when its edge cracked
    bool ends = false;    // at the boundary, a pre-crack or another crack: no longer a tip

    void serialize(auto& archive) { archive(vertex, edge, parent, crack, arm, distance, n_edges, since, ends); }
};

struct CrackArm {
    Index crack, parent;       // parent: the arm from which it branched, or -1 at the start of a crack
    std::vector<Index> nodes;  // from the branching node, which belongs to the parent, to its far end
    double path_length = 0;    // [m] along edges, from the start of the crack to its far end
    double kept = 0;           // [m] other arms branch from it up to this distance: it does not change there

    Index tip() const { return nodes.back(); }
    void serialize(auto& archive) { archive(crack, parent, nodes, path_length, kept); }
};

struct CrackTree {
    CrackStart start;
    Index root;                 // node
    std::array<Index, 2> arms;  // that start there; the second is -1 except for a crack that started inside the body
    Index from = -1, at = -1;   // it continues a crack that met it: from that node of the other, at this one of its own

    void serialize(auto& archive) { archive(start, root, arms, from, at); }
};

/// A place from which two paths are long enough to be arms. A fork into three is two branchings.
struct Branching {
    Index node;
    double time;  // [s] when both paths had started

    void serialize(auto& archive) { archive(node, time); }
};

/// Where a crack continues another one that met it.
struct Junction {
    Index from, at;       // nodes of the same vertex: of the crack that leads here, and of the one that continues it
    Index n_counted = 0;  // branchings counted here

    void serialize(auto& archive) { archive(from, at, n_counted); }
};

/// A connected set of cracked edges that is too small to be a crack.
struct IsolatedStretch {
    std::vector<Index> edges;
    CrackStart start = CrackStart::none;
    bool at_end_of_precrack = false;
    double length = 0;  // [m] of its longest path from the start, or (inside the body) from end to end, along edges
    std::vector<Index> way;  // vertices from the start (inside the body: its middle) to the far end
    bool ends = false;       // the far end is at the boundary or a pre-crack

    void serialize(auto& archive) { archive(edges, start, at_end_of_precrack, length, way, ends); }
};

class CrackArms {
public:
    CrackArms(InterfaceGraph graph, const CrackOptions& options);

    /// Continues to a later time [s] with statuses as CrackedEdges::add. Returns whether edges cracked. Cost: n log n
    /// in the number of edges that cracked since the last time.
    bool grow(double time, std::span<const EdgeStatus> statuses);

    void set_graph(InterfaceGraph graph) { edges_.set_graph(std::move(graph)); }

    /// After a refinement of the mesh.
    void renumber(InterfaceGraph graph, const Renumbering& numbers);

    /// The clock is set back by `time` [s].
    void set_back(double time) {
        edges_.set_back(time);
        for (CrackNode& node : nodes_) node.since -= time;
        for (Branching& branching : branchings_) branching.time -= time;
    }

    const CrackedEdges& edges() const { return edges_; }
    const InterfaceGraph& graph() const { return edges_.graph(); }
    const std::vector<CrackNode>& nodes() const { return nodes_; }
    const std::vector<CrackArm>& arms() const { return arms_; }
    const std::vector<CrackTree>& cracks() const { return cracks_; }
    const std::vector<Branching>& branchings() const { return branchings_; }
    const IsolatedStretch& longest_isolated() const { return isolated_; }
    /// Per arm: another crack continues from it near its end, so that the rest of it is a twig.
    std::vector<std::uint8_t> passed() const;
    Index first_of(Index crack) const;  // the start of the chain of cracks that it continues; or itself
    Index n_cracks() const;             // a crack counts together with all that continue it
    double length(Index arm) const {    // [m] along edges
        return nodes_[arms_[arm].tip()].distance - nodes_[arms_[arm].nodes.front()].distance;
    }

    /// The nodes on the path to `node`: behind `base` (-1: from the start of its crack), and from the start of the
    /// chain of cracks that its crack continues.
    std::vector<Index> way_from(Index base, Index node) const;
    std::vector<Index> way(Index node) const;

    void serialize(auto& archive) {
        archive(edges_, node_of_, owner_, nodes_, arms_, cracks_, branchings_, junctions_, isolated_);
    }

private:
    struct Reached {  // an edge that a crack may take next
        double distance;
        Index edge, from;
        auto operator<=>(const Reached&) const = default;
    };
    using Queue = std::priority_queue<Reached, std::vector<Reached>, std::greater<>>;

    bool is_free(Index edge) const { return edges_.cracked(edge) && node_of_[edge] == -1; }
    void push_edges(Index node, double distance, Queue& queue) const;
    void take_edges(Queue& queue);
    Index add_node(Index vertex, Index edge, Index parent, bool ends);
    void close(Index edge, Index a, Index b);
    Index common(Index a, Index b) const;
    void place_in_arm(Index node);
    void extend(Index arm, Index base, Index node);
    void start_arm(Index base, Index node);
    void take_long_stretch(Index vertex);
    Search off_arms(Index vertex) const;
    Index base_of(Index node) const;
    bool is_arm(Index from, Index to) const {
        return options_.is_arm(nodes_[to].n_edges - nodes_[from].n_edges, nodes_[to].distance - nodes_[from].distance);
    }
    double beyond(Index arm, Index node) const { return nodes_[arms_[arm].tip()].distance - nodes_[node].distance; }
    double start_time(Index arm, Index base) const;
    IsolatedStretch isolated_stretch(Index edge) const;
    void start_crack(Index vertex, CrackStart start);
    void continue_crack(Index from, Index at);
    void count_branchings(Junction& junction);
    double path_length(Index node) const;

    static constexpr Index closing = -2;

    CrackedEdges edges_;
    CrackOptions options_;
    std::vector<Index> node_of_;  // per edge: the node that it leads to; `closing`: it closes a loop; -1: in no crack
    std::vector<Index> owner_;    // per vertex: its node, or -1
    std::vector<CrackNode> nodes_;
    std::vector<CrackArm> arms_;
    std::vector<CrackTree> cracks_;
    std::vector<Branching> branchings_;
    std::vector<Junction> junctions_;
    IsolatedStretch isolated_;  // the longest so far
    bool continued_ = false;    // a crack continues another one since the last time
};

}  // namespace knap
