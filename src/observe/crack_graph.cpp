#include "observe/crack_graph.hpp"

#include "observe/broken_graph.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace knap {

CrackOptions crack_options(double mean_edge, double process_zone) {
    return {.pruning_length = 10 * mean_edge, .chord_length = 10 * mean_edge, .speed_window = std::max(20 * mean_edge, 1.5 * process_zone)};
}

Index CrackPattern::n_branches() const {
    Index n = 0;
    for (const Branching& b : branchings) n += b.n_arms - 1;
    return n;
}

namespace {

/// One connected piece of the broken graph as a tree of shortest paths.
struct Tree {
    Index root;
    CrackStart start;
    std::vector<Index> order;  // its nodes, nearest first
};

/// A way on from a node.
struct Arm {
    Index vertex;   // where it leaves the node
    double length;  // [m] to its far end
    Index link;     // its first
};

class CrackFinder {
public:
    CrackFinder(const InterfaceGraph& graph, std::span<const InterfaceStatus> status, const CrackOptions& options)
        : graph_(graph), options_(options), broken_(graph, status) {
        reach_.assign(broken_.n_nodes(), 0);
        onward_.assign(broken_.n_nodes(), -1);
        counted_.assign(broken_.n_nodes(), false);
        arrived_.assign(broken_.n_nodes(), false);
        add_lengths(status);
    }

    CrackPattern find() {
        grow_trees();
        for (const Tree& tree : trees_) count_arms(tree, options_.pruning_length, true);
        if (pattern_.counted.empty() && !trees_.empty()) {
            const auto shorter = [&](const Tree& a, const Tree& b) { return extent(a) < extent(b); };
            const Tree& longest = *std::max_element(trees_.begin(), trees_.end(), shorter);
            count_arms(longest, extent(longest), false);
        }
        close_loops();
        Index main_node = -1;
        for (const Tree& tree : trees_) collect_ends(tree, main_node);
        if (main_node >= 0) {
            pattern_.main_path = path_along_chords(main_node);
            pattern_.main_length = pattern_.main_path.back().position;
        }
        return std::move(pattern_);
    }

private:
    void add_lengths(std::span<const InterfaceStatus> status) {
        for (std::size_t i = 0; i < status.size(); ++i) {
            if (status[i] == InterfaceStatus::broken) ++pattern_.n_broken, pattern_.broken_length += graph_.length[i];
            if (status[i] == InterfaceStatus::damaged) ++pattern_.n_damaged, pattern_.damaged_length += graph_.length[i];
        }
    }

    void grow_trees() {
        for (Index n = 0; n < broken_.n_nodes(); ++n) {
            if (broken_.node(n).distance < BrokenNode::unreached || broken_.links_at(n).empty()) continue;
            const auto [root, start] = choose_root(broken_.shortest_paths(n));
            trees_.push_back({root, start, broken_.shortest_paths(root)});
            measure_reach(trees_.back());
        }
    }

    /// Where the crack of a piece starts; see the head of crack_graph.hpp. Of several boundary vertices: an end of a longest way across.
    std::pair<Index, CrackStart> choose_root(const std::vector<Index>& piece) {
        const auto precrack_first = [&](Index a, Index b) {  // and then by vertex: the same one as long as the crack grows
            const BrokenNode &m = broken_.node(a), &n = broken_.node(b);
            return std::tuple(!m.precrack, !m.boundary, m.vertex) < std::tuple(!n.precrack, !n.boundary, n.vertex);
        };
        const Index first = *std::min_element(piece.begin(), piece.end(), precrack_first);
        if (broken_.node(first).precrack) return {first, CrackStart::precrack};
        if (broken_.node(first).boundary) {
            const std::vector<Index> order = broken_.shortest_paths(first);
            const auto furthest = std::find_if(order.rbegin(), order.rend(), [&](Index n) { return broken_.node(n).boundary; });
            return {*furthest, CrackStart::boundary};
        }
        const Index one_end = piece.back();
        const Index other_end = broken_.shortest_paths(one_end).back();
        const double half = 0.5 * broken_.node(other_end).distance;
        Index middle = other_end;
        while (broken_.node(middle).distance > half) middle = before(middle);
        return {middle, CrackStart::inside};
    }

    Index before(Index n) const { return broken_.link(broken_.node(n).parent).far_node(n); }

    void measure_reach(const Tree& tree) {
        for (auto n = tree.order.rbegin(); n != tree.order.rend() && *n != tree.root; ++n) {
            const Index parent = broken_.node(*n).parent;
            const double length = broken_.link(parent).length + reach_[*n];
            if (length > reach_[before(*n)]) reach_[before(*n)] = length, onward_[before(*n)] = parent;
        }
    }

    // ---- arms ----

    /// The ways on from a node, by leaving vertex, the longest first.
    std::vector<Arm> arms_of(Index n) const {
        std::vector<Arm> arms;
        for (const Index l : broken_.links_at(n)) {
            const BrokenLink& link = broken_.link(l);
            const Index next = link.far_node(n);
            if (broken_.node(next).parent == l) arms.push_back({link.vertex_at(n), link.length + reach_[next], l});
        }
        std::sort(arms.begin(), arms.end(), [](const Arm& a, const Arm& b) {
            return std::tuple(a.vertex, -a.length, a.link) < std::tuple(b.vertex, -b.length, b.link);
        });
        return arms;
    }

    /// The longest path of the tree that begins at its root, or (of a crack inside the body) that passes through it.
    double extent(const Tree& tree) const {
        double longest = 0, second = 0;
        for (const Arm& arm : arms_of(tree.root)) {
            second = std::max(second, std::min(longest, arm.length));
            longest = std::max(longest, arm.length);
        }
        return tree.start == CrackStart::inside ? longest + second : longest;
    }

    /// Marks what belongs to counted arms, and counts cracks and branchings. `precrack_ends`: rule 2 applies.
    void count_arms(const Tree& tree, double pruning_length, bool precrack_ends) {
        const bool inside = tree.start == CrackStart::inside;
        const bool long_inside = inside && extent(tree) >= pruning_length;  // then both halves count
        for (const Index n : tree.order) {
            const bool at_root = n == tree.root;
            if (!at_root && !counted_[n]) continue;
            const auto counts = [&](const Arm& arm, std::size_t rank) {
                if (arm.length >= pruning_length) return true;
                if (at_root ? long_inside && rank < 2 : arm.link == onward_[n]) return true;
                return precrack_ends && rank == 0 && broken_.end_of_precrack(arm.vertex);
            };
            const std::vector<Arm> arms = arms_of(n);
            for (std::size_t begin = 0, end = 0; begin < arms.size(); begin = end) {  // the arms that leave at one vertex
                std::size_t n_counted = 0;
                for (end = begin; end < arms.size() && arms[end].vertex == arms[begin].vertex; ++end) {
                    if (!counts(arms[end], end - begin)) continue;
                    ++n_counted;
                    count(arms[end].link, n);
                }
                if (at_root && n_counted > 0) counted_[n] = true, ++pattern_.n_cracks;
                const std::size_t passing = at_root && inside ? 1 : 0;  // at the middle of a crack two arms are no fork
                if (n_counted >= passing + 2) add_branching(arms[begin + passing + 1], n_counted - passing);
            }
        }
    }

    void count(Index link, Index node) {
        counted_[broken_.link(link).far_node(node)] = true;
        pattern_.crack_length += broken_.link(link).length;
        pattern_.counted.push_back(broken_.link(link).interface);
    }

    void add_branching(const Arm& shorter, std::size_t n_arms) {
        if (shorter.length < options_.pruning_length) return;  // of equally short ones, under rule 3
        pattern_.branchings.push_back({.position = graph_.vertices[shorter.vertex],
                                       .vertex = shorter.vertex,
                                       .n_arms = static_cast<Index>(n_arms),
                                       .shorter_arm = shorter.length,
                                       .first_interface = broken_.link(shorter.link).interface});
    }

    /// Two counted arms that met count as a whole; a loop shorter than two twigs is noise.
    void close_loops() {
        for (Index l = 0; l < static_cast<Index>(broken_.links().size()); ++l) {
            const BrokenLink& link = broken_.link(l);
            const auto [a, b] = link.node;
            const bool in_tree = broken_.node(a).parent == l || broken_.node(b).parent == l;
            if (in_tree || !counted_[a] || !counted_[b] || broken_.loop_length(link) < 2 * options_.pruning_length) continue;
            arrived_[a] = arrived_[b] = true;
            pattern_.crack_length += link.length;
            pattern_.counted.push_back(link.interface);
        }
    }

    // ---- ends ----

    void collect_ends(const Tree& tree, Index& main_node) {
        for (const Index n : tree.order) {
            const BrokenNode& node = broken_.node(n);
            if (!counted_[n] || onward_[n] >= 0 || node.parent < 0) continue;
            const Index vertex = broken_.link(node.parent).vertex_at(n);
            const CrackEnd end{graph_.vertices[vertex], vertex, node.distance, node.boundary || node.precrack || arrived_[n]};
            if (!end.arrived) pattern_.tips.push_back(end);
            if (pattern_.main_end && end.path_length <= pattern_.main_end->path_length) continue;
            pattern_.main_end = end;
            pattern_.main_start = tree.start;
            main_node = n;
        }
    }

    /// The path from the start of the crack to node `end`; between knots about a chord apart the edges share the chord's length.
    std::vector<PathStep> path_along_chords(Index end) const {
        struct Link {
            Index from, to;  // vertices
            Index interface;
        };
        std::vector<Link> links;  // from the end to the start
        for (Index n = end; broken_.node(n).parent >= 0; n = before(n)) {
            const BrokenLink& link = broken_.link(broken_.node(n).parent);
            links.push_back({link.far_vertex(n), link.vertex_at(n), link.interface});
        }
        std::reverse(links.begin(), links.end());
        const auto distance = [&](Index a, Index b) { return (graph_.vertices[b] - graph_.vertices[a]).norm(); };

        std::vector<PathStep> path;
        double at_knot = 0, since_knot = 0;
        std::size_t knot = 0;  // link that begins at the last knot
        for (std::size_t k = 0; k < links.size(); ++k) {
            since_knot += distance(links[k].from, links[k].to);
            path.push_back({links[k].interface, since_knot});
            const bool goes_on = k + 1 < links.size() && links[k + 1].from == links[k].to;  // neither the end nor a pre-crack on the way
            if (goes_on && since_knot < options_.chord_length) continue;
            const double chord = distance(links[knot].from, links[k].to);
            for (std::size_t i = knot; i <= k; ++i) path[i].position = at_knot + path[i].position * chord / since_knot;
            at_knot += chord;
            since_knot = 0;
            knot = k + 1;
        }
        return path;
    }

    const InterfaceGraph& graph_;
    const CrackOptions& options_;
    BrokenGraph broken_;
    std::vector<Tree> trees_;
    std::vector<double> reach_;          // [m] per node: longest way on, away from the root
    std::vector<Index> onward_;          // per node: first link of it
    std::vector<std::uint8_t> counted_;  // per node: on a counted arm
    std::vector<std::uint8_t> arrived_;  // per node: a large loop closes here
    CrackPattern pattern_;
};

}  // namespace

CrackPattern find_cracks(const InterfaceGraph& graph, std::span<const InterfaceStatus> status, const CrackOptions& options) {
    return CrackFinder(graph, status, options).find();
}

}  // namespace knap
