#include "observe/crack_graph.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

namespace knap {

CrackOptions crack_options(double mean_edge) {
    return {.pruning_length = 10 * mean_edge, .chord_length = 5 * mean_edge, .speed_window = 10 * mean_edge};
}

Index CrackPattern::n_branches() const {
    Index n = 0;
    for (const Branching& b : branchings) n += b.n_arms - 1;
    return n;
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Link {
    Index interface;
    std::array<Index, 2> node, vertex;
    double length;  // [m]
    int side(Index n) const { return node[0] == n ? 0 : 1; }
};

struct Node {
    Index vertex;           // one of them, when the node is a pre-crack
    bool precrack = false;  // all vertices of one pre-crack
    bool boundary = false;
    bool counted = false;        // on a counted arm
    double distance = infinity;  // [m] from the start of the crack, along broken interfaces
    Index parent = -1;           // link towards the start
    double reach = 0;            // [m] longest way on, away from the start
    Index onward = -1;           // first link of it
};

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
        : graph_(graph), options_(options) {
        collect(status);
        connect();
    }

    CrackPattern find() {
        std::vector<Tree> trees = grow_trees();
        for (const Tree& tree : trees) count_arms(tree, options_.pruning_length, true);
        if (pattern_.counted.empty() && !trees.empty()) {
            const auto longest =
                std::max_element(trees.begin(), trees.end(), [&](const Tree& a, const Tree& b) { return extent(a) < extent(b); });
            count_arms(*longest, extent(*longest), false);
        }
        close_loops();
        for (const Tree& tree : trees) collect_ends(tree);
        return std::move(pattern_);
    }

private:
    // ---- the graph ----

    /// Nodes and links of the broken interfaces; pre-cracks become one node each.
    void collect(std::span<const InterfaceStatus> status) {
        std::vector<Index> broken, precrack;
        for (Index i = 0; i < static_cast<Index>(status.size()); ++i) {
            switch (status[i]) {
                case InterfaceStatus::intact:
                    break;
                case InterfaceStatus::damaged:
                    ++pattern_.n_damaged, pattern_.damaged_length += graph_.length[i];
                    break;
                case InterfaceStatus::broken:
                    ++pattern_.n_broken, pattern_.broken_length += graph_.length[i], broken.push_back(i);
                    break;
                case InterfaceStatus::precrack:
                    precrack.push_back(i);
                    break;
            }
        }
        if (broken.empty()) return;

        std::vector<Index> set(graph_.vertices.size());  // union-find of the vertices of a pre-crack
        std::iota(set.begin(), set.end(), 0);
        const auto representative = [&](Index v) {
            while (set[v] != v) v = set[v] = set[set[v]];
            return v;
        };
        precrack_edges_.assign(graph_.vertices.size(), 0);
        for (const Index i : precrack) {
            const auto [a, b] = graph_.ends[i];
            ++precrack_edges_[a], ++precrack_edges_[b];
            set[representative(a)] = representative(b);
        }
        std::vector<Index> node_of(graph_.vertices.size(), -1);  // by representative
        const auto node = [&](Index vertex) {
            const Index r = representative(vertex);
            if (node_of[r] < 0) {
                node_of[r] = static_cast<Index>(nodes_.size());
                nodes_.push_back({.vertex = r, .precrack = precrack_edges_[r] > 0, .boundary = graph_.on_boundary[r] != 0});
            }
            return node_of[r];
        };
        for (const Index i : broken) {
            const auto [a, b] = graph_.ends[i];
            const Index node_a = node(a), node_b = node(b);
            if (node_a != node_b) links_.push_back({i, {node_a, node_b}, {a, b}, graph_.length[i]});
        }
    }

    void connect() {
        first_.assign(nodes_.size() + 1, 0);
        for (const Link& l : links_) ++first_[l.node[0] + 1], ++first_[l.node[1] + 1];
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        around_.resize(2 * links_.size());
        std::vector<Index> next(first_.begin(), first_.end() - 1);
        for (Index l = 0; l < static_cast<Index>(links_.size()); ++l) {
            for (const Index n : links_[l].node) around_[next[n]++] = l;
        }
    }

    std::span<const Index> links_at(Index node) const {
        return {around_.data() + first_[node], static_cast<std::size_t>(first_[node + 1] - first_[node])};
    }
    Index far_node(Index link, Index node) const { return links_[link].node[1 - links_[link].side(node)]; }
    bool end_of_precrack(Index vertex) const { return precrack_edges_[vertex] == 1 && !graph_.on_boundary[vertex]; }

    // ---- trees of shortest paths ----

    /// Dijkstra from `root`; sets distance and parent of every node of its piece and returns them, nearest first.
    std::vector<Index> shortest_paths(Index root, const std::vector<Index>& piece) {
        for (const Index n : piece) nodes_[n].distance = infinity, nodes_[n].parent = -1;
        using Entry = std::tuple<double, Index>;  // ties by node number: the same tree in every run
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        std::vector<Index> order;
        nodes_[root].distance = 0;
        queue.emplace(0.0, root);
        while (!queue.empty()) {
            const auto [distance, n] = queue.top();
            queue.pop();
            if (distance > nodes_[n].distance) continue;
            order.push_back(n);
            for (const Index l : links_at(n)) {
                Node& other = nodes_[far_node(l, n)];
                if (distance + links_[l].length < other.distance) {
                    other.distance = distance + links_[l].length;
                    other.parent = l;
                    queue.emplace(other.distance, far_node(l, n));
                }
            }
        }
        return order;
    }

    std::vector<Tree> grow_trees() {
        std::vector<Tree> trees;
        for (Index n = 0; n < static_cast<Index>(nodes_.size()); ++n) {
            if (nodes_[n].distance < infinity || links_at(n).empty()) continue;
            std::vector<Index> piece = shortest_paths(n, {});
            const auto [root, start] = choose_root(piece);
            trees.push_back({root, start, shortest_paths(root, piece)});
            measure_reach(trees.back());
        }
        return trees;
    }

    /// Where the crack of a piece starts; see the head of crack_graph.hpp. Of several boundary vertices: an end of a longest way across.
    std::pair<Index, CrackStart> choose_root(const std::vector<Index>& piece) {
        const auto precrack_first = [&](Index a, Index b) {  // and then by vertex: the same one as long as the crack grows
            return std::tuple(!nodes_[a].precrack, nodes_[a].vertex) < std::tuple(!nodes_[b].precrack, nodes_[b].vertex);
        };
        const Index precrack = *std::min_element(piece.begin(), piece.end(), precrack_first);
        if (nodes_[precrack].precrack) return {precrack, CrackStart::precrack};
        const auto on_boundary = [&](Index n) { return nodes_[n].boundary; };
        const auto boundary = std::find_if(piece.begin(), piece.end(), on_boundary);
        if (boundary != piece.end()) {
            const std::vector<Index> order = shortest_paths(*boundary, piece);
            return {*std::find_if(order.rbegin(), order.rend(), on_boundary), CrackStart::boundary};
        }
        const Index one_end = piece.back();
        const Index other_end = shortest_paths(one_end, piece).back();
        Index middle = other_end;
        while (nodes_[middle].distance > 0.5 * nodes_[other_end].distance) middle = far_node(nodes_[middle].parent, middle);
        return {middle, CrackStart::inside};
    }

    void measure_reach(const Tree& tree) {
        for (auto it = tree.order.rbegin(); it != tree.order.rend(); ++it) {
            const Node& n = nodes_[*it];
            if (n.parent < 0) continue;
            Node& before = nodes_[far_node(n.parent, *it)];
            const double length = links_[n.parent].length + n.reach;
            if (length > before.reach) before.reach = length, before.onward = n.parent;
        }
    }

    // ---- arms ----

    /// The ways on from a node, by leaving vertex, the longest first.
    std::vector<Arm> arms_of(Index n) const {
        std::vector<Arm> arms;
        for (const Index l : links_at(n)) {
            const Index child = far_node(l, n);
            if (nodes_[child].parent == l) arms.push_back({links_[l].vertex[links_[l].side(n)], links_[l].length + nodes_[child].reach, l});
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
            if (arm.length > longest)
                second = std::exchange(longest, arm.length);
            else
                second = std::max(second, arm.length);
        }
        return tree.start == CrackStart::inside ? longest + second : longest;
    }

    /// Marks what belongs to counted arms, and counts cracks and branchings. `precrack_ends`: rule 2 applies.
    void count_arms(const Tree& tree, double pruning_length, bool precrack_ends) {
        const bool inside = tree.start == CrackStart::inside;
        const bool long_inside = inside && extent(tree) >= pruning_length;  // then both halves count
        for (const Index n : tree.order) {
            const bool at_root = n == tree.root;
            if (!at_root && !nodes_[n].counted) continue;
            const std::vector<Arm> arms = arms_of(n);
            for (std::size_t begin = 0, end = 0; begin < arms.size(); begin = end) {  // the arms that leave at one vertex
                while (end < arms.size() && arms[end].vertex == arms[begin].vertex) ++end;
                std::size_t n_counted = 0;
                for (std::size_t k = begin; k < end; ++k) {
                    const Arm& arm = arms[k];
                    const bool is_first = k == begin;
                    const bool goes_on = at_root ? long_inside && k < begin + 2 : arm.link == nodes_[n].onward;
                    const bool leaves_end = precrack_ends && is_first && end_of_precrack(arm.vertex);
                    if (!goes_on && !leaves_end && arm.length < pruning_length) continue;
                    ++n_counted;
                    count(arm.link, n);
                }
                if (at_root && n_counted > 0) nodes_[n].counted = true, ++pattern_.n_cracks;
                const std::size_t passing = at_root && inside ? 1 : 0;  // at the middle of a crack two arms are no fork
                if (n_counted < passing + 2) continue;
                const Arm& shorter = arms[begin + passing + 1];
                if (shorter.length >= options_.pruning_length) {
                    pattern_.branchings.push_back({graph_.vertices[shorter.vertex], shorter.vertex, static_cast<Index>(n_counted - passing),
                                                   shorter.length, links_[shorter.link].interface});
                }
            }
        }
    }

    void count(Index link, Index node) {
        nodes_[far_node(link, node)].counted = true;
        pattern_.crack_length += links_[link].length;
        pattern_.counted.push_back(links_[link].interface);
    }

    // ---- loops ----

    /// Length of the loop that a link outside the tree closes [m].
    double loop_length(const Link& link) const {
        Index a = link.node[0], b = link.node[1];
        double length = link.length;
        while (a != b) {
            Index& further = nodes_[a].distance > nodes_[b].distance ? a : b;
            length += links_[nodes_[further].parent].length;
            further = far_node(nodes_[further].parent, further);
        }
        return length;
    }

    /// Two counted arms that met count as whole; a loop shorter than two twigs is noise.
    void close_loops() {
        arrived_.assign(nodes_.size(), false);
        for (Index l = 0; l < static_cast<Index>(links_.size()); ++l) {
            const Link& link = links_[l];
            const auto [a, b] = link.node;
            if (nodes_[a].parent == l || nodes_[b].parent == l || !nodes_[a].counted || !nodes_[b].counted) continue;
            if (loop_length(link) < 2 * options_.pruning_length) continue;
            arrived_[a] = arrived_[b] = true;
            pattern_.crack_length += link.length;
            pattern_.counted.push_back(link.interface);
        }
    }

    // ---- ends ----

    void collect_ends(const Tree& tree) {
        for (const Index n : tree.order) {
            const Node& node = nodes_[n];
            if (!node.counted || node.onward >= 0 || node.parent < 0) continue;
            const Link& last = links_[node.parent];
            const Index vertex = last.vertex[last.side(n)];
            const CrackEnd end{graph_.vertices[vertex], vertex, node.distance, node.boundary || node.precrack || arrived_[n]};
            if (!end.arrived) pattern_.tips.push_back(end);
            if (!pattern_.main_end || end.path_length > pattern_.main_end->path_length) {
                pattern_.main_end = end;
                pattern_.main_start = tree.start;
                pattern_.main_length = length_along_chords(n);
            }
        }
    }

    double length_along_chords(Index end) const {
        std::vector<std::array<Index, 2>> path;  // vertices of each link, from the end to the start
        for (Index n = end; nodes_[n].parent >= 0; n = far_node(nodes_[n].parent, n)) {
            const Link& link = links_[nodes_[n].parent];
            path.push_back({link.vertex[1 - link.side(n)], link.vertex[link.side(n)]});
        }
        double length = 0, since_knot = 0;
        Index knot = path.empty() ? -1 : path.back()[0];
        for (std::size_t k = path.size(); k-- > 0;) {
            const auto [from, to] = path[k];
            since_knot += (graph_.vertices[to] - graph_.vertices[from]).norm();
            const bool through_precrack = k > 0 && path[k - 1][0] != to;
            if (k > 0 && !through_precrack && since_knot < options_.chord_length) continue;
            length += (graph_.vertices[to] - graph_.vertices[knot]).norm();
            knot = k > 0 ? path[k - 1][0] : to;
            since_knot = 0;
        }
        return length;
    }

    const InterfaceGraph& graph_;
    const CrackOptions& options_;
    CrackPattern pattern_;
    std::vector<Node> nodes_;
    std::vector<Link> links_;
    std::vector<Index> first_, around_;  // links at each node
    std::vector<Index> precrack_edges_;  // per vertex
    std::vector<std::uint8_t> arrived_;  // per node
};

}  // namespace

CrackPattern find_cracks(const InterfaceGraph& graph, std::span<const InterfaceStatus> status, const CrackOptions& options) {
    return CrackFinder(graph, status, options).find();
}

}  // namespace knap
