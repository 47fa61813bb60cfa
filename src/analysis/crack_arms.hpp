#pragma once
// Cracks as they grow: each a tree of cracked edges, read as arms. src/README.md, "Cracks", has the definitions.
#include "analysis/loose_stretch.hpp"

#include <functional>
#include <queue>
#include <tuple>

namespace knap {

/// A vertex that a crack has come to, and the edge that it came by.
struct CrackNode {
    Index vertex, edge, parent;  // edge and parent -1 at the start of a crack
    Index crack;
    Index arm = -1;       // that its edge belongs to; -1 on a twig
    double distance = 0;        // [m] from the start of its crack, along edges
    Index n = 0;                // edges of that
    double since = 0;           // [s] when its edge cracked
    bool ends = false;          // the boundary, a pre-crack or another crack: no tip any more

    template <class Archive>
    void serialize(Archive& archive) { archive(vertex, edge, parent, crack, arm, distance, n, since, ends); }
};

struct CrackArm {
    Index crack, parent;       // parent: the arm that it left, or -1 at the start of a crack
    std::vector<Index> nodes;  // from the one that it left, which belongs to the parent, to its far end
    double path_length = 0;    // [m] along edges, from the start of the crack to its far end
    double kept = 0;           // [m] up to this distance it does not turn: other arms begin there

    Index tip() const { return nodes.back(); }

    template <class Archive>
    void serialize(Archive& archive) { archive(crack, parent, nodes, path_length, kept); }
};

struct CrackTree {
    CrackStart start;
    Index root;                     // node
    std::array<Index, 2> arms;      // that begin there; the second -1 but of a crack that started inside
    Index from = -1, at = -1;       // it goes on with a crack that met it: from this node of that one, at this node of its own

    template <class Archive>
    void serialize(Archive& archive) { archive(start, root, arms, from, at); }
};

/// A place from which two ways on are long enough to be arms; two of them for a fork into three.
struct Branching {
    Index node;
    double time;  // [s] when both ways on had begun

    template <class Archive>
    void serialize(Archive& archive) { archive(node, time); }
};

/// Where a crack goes on with another one that met it.
struct Junction {
    Index from, at;       // nodes of the same vertex: of the crack that leads here, and of the one that goes on
    Index n_counted = 0;  // branchings that were made of it

    template <class Archive>
    void serialize(Archive& archive) { archive(from, at, n_counted); }
};

class CrackArms {
public:
    CrackArms(InterfaceGraph graph, const CrackOptions& options);

    /// Cracks at a later time [s]; one status per interface. Cost: a pass over them, and n log n in the edges that cracked since.
    void grow(double time, std::span<const InterfaceStatus> status);

    const CrackedEdges& edges() const { return edges_; }
    const InterfaceGraph& graph() const { return edges_.graph(); }
    const std::vector<CrackNode>& nodes() const { return nodes_; }
    const std::vector<CrackArm>& arms() const { return arms_; }
    const std::vector<CrackTree>& cracks() const { return cracks_; }
    const std::vector<Branching>& branchings() const { return branchings_; }
    const LooseStretch& longest_loose() const { return loose_; }
    /// Per arm: it stands where another crack went on, so what it has beyond is a twig.
    std::vector<std::uint8_t> passed() const;
    Index first_of(Index crack) const;  // the one that it goes on with in the end, or itself
    Index n_cracks() const;             // those that go on with another one are one with it
    double length(Index arm) const { return nodes_[arms_[arm].tip()].distance - nodes_[arms_[arm].nodes.front()].distance; }  // [m] along edges

    /// The nodes on the way to `node`: from the start of its own crack, or from the start of what that crack goes on with.
    std::vector<Index> way_in_crack(Index node) const;
    std::vector<Index> way(Index node) const;

    template <class Archive>
    void serialize(Archive& archive) {
        archive(edges_, node_of_, owner_, nodes_, arms_, cracks_, branchings_, junctions_, loose_);
    }

private:
    struct Reached {  // the next edge that a crack takes
        double distance;
        Index edge, from;
        bool operator>(const Reached& o) const { return std::tie(distance, edge, from) > std::tie(o.distance, o.edge, o.from); }
    };
    using Queue = std::priority_queue<Reached, std::vector<Reached>, std::greater<>>;

    void push_edges(Index node, double distance, Queue& queue) const;
    void sweep(Queue& queue);
    Index add_node(Index vertex, Index edge, Index parent, bool ends);
    void settle(Index node);
    void append(Index arm, Index node);
    void turn(Index arm, Index base, const std::vector<Index>& way);
    void begin_arm(Index base, Index node);
    void take_long_stretch(Index vertex);
    bool beside_arms(Index edge) const;
    struct Stretch {
        Index end;  // vertex
        std::vector<Index> edges;
    };
    Stretch farthest_beside_arms(Index vertex) const;
    std::vector<Index> way_from(Index base, Index node) const;
    Index base_of(Index node) const;
    bool is_arm(Index from, Index to) const { return options_.is_arm(nodes_[to].n - nodes_[from].n, nodes_[to].distance - nodes_[from].distance); }
    bool stays(Index arm, Index node) const { return nodes_[node].distance < arms_[arm].kept || is_arm(node, arms_[arm].tip()); }
    double way_on(Index arm, Index node) const { return nodes_[arms_[arm].tip()].distance - nodes_[node].distance; }
    bool is_tip(Index node) const { return nodes_[node].arm >= 0 && arms_[nodes_[node].arm].tip() == node; }
    void close(Index edge, Index a, Index b);
    void go_on(Index from, Index at);
    Index common(Index a, Index b) const;
    double path_length(Index node) const;
    void count_branchings(Junction& junction);
    double begun(Index arm, Index base) const;
    void look_at_loose(Index edge, std::vector<Index>& looked_at);
    void begin_crack(Index vertex, CrackStart start);

    static constexpr Index closing = -2;

    CrackedEdges edges_;
    CrackOptions options_;
    std::vector<Index> node_of_;  // per edge: the node that was reached by it, `closing` for one that closes a loop, or -1
    std::vector<Index> owner_;    // per vertex: its node, or -1
    std::vector<CrackNode> nodes_;
    std::vector<CrackArm> arms_;
    std::vector<CrackTree> cracks_;
    std::vector<Branching> branchings_;
    std::vector<Junction> junctions_;
    LooseStretch loose_;
    bool went_on_ = false;
};

}  // namespace knap
