#include "analysis/crack_arms.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace knap {

CrackArms::CrackArms(InterfaceGraph graph, const CrackOptions& options) : edges_(std::move(graph), options.gap_edges), options_(options) {
    node_of_.assign(edges_.graph().ends.size(), -1);
    owner_.assign(edges_.graph().vertices.size(), -1);
}

void CrackArms::grow(double time, std::span<const InterfaceStatus> status) {
    const std::vector<Index> cracked = edges_.add(time, status);
    Queue queue;
    for (const Index e : cracked)
        for (const Index v : graph().ends[e])
            if (owner_[v] >= 0) queue.push({graph().length[e], e, owner_[v]});
    sweep(queue);
    std::vector<Index> looked_at;
    for (const Index e : cracked)
        if (node_of_[e] == -1 && !std::binary_search(looked_at.begin(), looked_at.end(), e)) look_at_loose(e, looked_at);
    for (Junction& junction : junctions_)
        if (junction.n_counted < 2) count_branchings(junction);
    if (std::exchange(went_on_, false))
        for (CrackArm& arm : arms_) arm.path_length = path_length(arm.tip());
}

// ---- trees ----

void CrackArms::push_edges(Index node, double distance, Queue& queue) const {
    for (const Index e : edges_.edges_at(nodes_[node].vertex))
        if (edges_.cracked(e) && node_of_[e] == -1) queue.push({distance + graph().length[e], e, node});
}

/// Takes all edges that the queue leads to, the nearest first.
void CrackArms::sweep(Queue& queue) {
    while (!queue.empty()) {
        const auto [distance, edge, from] = queue.top();
        queue.pop();
        if (node_of_[edge] != -1) continue;
        node_of_[edge] = closing;
        const Index vertex = edges_.far_end(edge, nodes_[from].vertex);
        if (owner_[vertex] >= 0) {
            close(edge, from, owner_[vertex]);
            take_long_stretch(vertex);
            continue;
        }
        const bool ends = edges_.terminal(vertex);
        const Index node = add_node(vertex, edge, from, ends);
        if (ends) continue;
        owner_[vertex] = node;
        push_edges(node, distance, queue);
    }
}

Index CrackArms::add_node(Index vertex, Index edge, Index parent, bool ends) {
    const CrackNode& before = nodes_[parent];
    const Index node = static_cast<Index>(nodes_.size());
    nodes_.push_back({.vertex = vertex,
                      .edge = edge,
                      .parent = parent,
                      .crack = before.crack,
                      .distance = before.distance + graph().length[edge],
                      .n = before.n + 1,
                      .since = edges_.since(edge),
                      .ends = ends});
    node_of_[edge] = node;
    settle(node);
    return node;
}

/// An edge that joins two vertices that cracks have come to: a small loop is noise, else one arm ends at the other.
void CrackArms::close(Index edge, Index a, Index b) {
    const bool same = nodes_[a].crack == nodes_[b].crack;
    if (same && 1 + nodes_[a].n + nodes_[b].n - 2 * nodes_[common(a, b)].n < 2 * options_.arm_edges) return;
    const auto rank = [&](Index node) { return std::pair(is_tip(node), path_length(node)); };
    if (rank(a) < rank(b)) std::swap(a, b);  // the edge is the last one of the tip that has come further
    const Index end = add_node(nodes_[b].vertex, edge, a, true);
    nodes_[b].ends = true;
    if (!same) go_on(end, b);
}

Index CrackArms::common(Index a, Index b) const {
    while (a != b) {
        Index& further = nodes_[a].distance > nodes_[b].distance || (nodes_[a].distance == nodes_[b].distance && a > b) ? a : b;
        further = nodes_[further].parent;
    }
    return a;
}

// ---- arms ----

Index CrackArms::base_of(Index node) const {
    while (nodes_[node].arm < 0) node = nodes_[node].parent;
    return node;
}

/// The nodes behind `base` on the way to `node`.
std::vector<Index> CrackArms::way_from(Index base, Index node) const {
    std::vector<Index> way;
    for (; node != base; node = nodes_[node].parent) way.push_back(node);
    std::reverse(way.begin(), way.end());
    return way;
}

/// Lets the node lengthen an arm, become the way on of one, or make a new one.
void CrackArms::settle(Index node) {
    const Index base = base_of(node);
    const double length = nodes_[node].distance - nodes_[base].distance;
    Index arm = nodes_[base].arm;
    const auto& [first, second] = cracks_[nodes_[node].crack].arms;
    if (base == cracks_[nodes_[node].crack].root && second >= 0) arm = way_on(second, base) < way_on(first, base) ? second : first;
    if (!stays(arm, base) && length > way_on(arm, base)) {
        const bool leaves_twig = arms_[arm].tip() != base;
        turn(arm, base, way_from(base, node));
        if (leaves_twig) take_long_stretch(nodes_[base].vertex);
    } else if (is_arm(base, node)) {
        begin_arm(base, node);
    } else {
        take_long_stretch(nodes_[node].vertex);
    }
}

/// In no arm, but in a tree or between two of its vertices.
bool CrackArms::beside_arms(Index edge) const {
    const Index node = node_of_[edge];
    return node == closing || (node >= 0 && nodes_[node].arm < 0);
}

/// Where the edges beside arms lead to from a vertex, and the fewest of them to the farthest place.
CrackArms::Stretch CrackArms::farthest_beside_arms(Index vertex) const {
    std::map<Index, Index> came_by{{vertex, -1}};
    std::vector<Index> order{vertex};
    for (std::size_t i = 0; i < order.size(); ++i) {
        const Index v = order[i];
        if (i > 0 && (owner_[v] < 0 || nodes_[owner_[v]].arm >= 0)) continue;
        for (const Index e : edges_.edges_at(v))
            if (beside_arms(e) && came_by.try_emplace(edges_.far_end(e, v), e).second) order.push_back(edges_.far_end(e, v));
    }
    Stretch stretch{order.back(), {}};
    for (Index v = order.back(); v != vertex; v = edges_.far_end(stretch.edges.back(), v)) stretch.edges.push_back(came_by[v]);
    return stretch;
}

/// Twigs that hang together, or that a loop joins, may be as many edges as an arm has, each of them less: then the longest is an arm.
void CrackArms::take_long_stretch(Index vertex) {
    while (true) {
        const Stretch stretch = farthest_beside_arms(farthest_beside_arms(vertex).end);
        if (static_cast<Index>(stretch.edges.size()) < options_.arm_edges) return;
        Index longest = -1, n_longest = 0;
        for (const Index e : stretch.edges) {
            const Index node = node_of_[e], n = node < 0 ? 0 : nodes_[node].n - nodes_[base_of(node)].n;
            if (n > n_longest) longest = node, n_longest = n;
        }
        if (longest < 0) return;
        begin_arm(base_of(longest), longest);
        arms_.back().kept = nodes_[longest].distance;
    }
}

/// The arm goes on from `base`, a node of it, along `way`; what it had there becomes a twig.
void CrackArms::turn(Index arm, Index base, const std::vector<Index>& way) {
    std::vector<Index>& nodes = arms_[arm].nodes;
    while (nodes.back() != base) nodes_[nodes.back()].arm = -1, nodes.pop_back();
    for (const Index n : way) append(arm, n);
    arms_[arm].path_length = path_length(way.back());
}

void CrackArms::append(Index arm, Index node) {
    nodes_[node].arm = arm;
    arms_[arm].nodes.push_back(node);
}

void CrackArms::begin_arm(Index base, Index node) {
    const Index arm = static_cast<Index>(arms_.size()), parent = nodes_[base].arm;
    arms_.push_back({.crack = nodes_[base].crack, .parent = parent, .nodes = {base}});
    for (const Index n : way_from(base, node)) append(arm, n);
    arms_[arm].path_length = path_length(node);
    arms_[parent].kept = std::max(arms_[parent].kept, nodes_[base].distance);
    branchings_.push_back({.node = base, .time = std::max(begun(parent, base), begun(arm, base))});
}

/// When the first edge of an arm beyond one of its nodes cracked.
double CrackArms::begun(Index arm, Index base) const {
    const std::vector<Index>& nodes = arms_[arm].nodes;
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t i = nodes.size(); i-- > 1 && nodes[i] != base;) time = std::min(time, nodes_[nodes[i]].since);
    return time;
}

std::vector<Index> CrackArms::way_in_crack(Index node) const {
    std::vector<Index> way;
    for (; node >= 0; node = nodes_[node].parent) way.push_back(node);
    std::reverse(way.begin(), way.end());
    return way;
}

// ---- cracks ----

void CrackArms::look_at_loose(Index edge, std::vector<Index>& looked_at) {
    LooseStretch stretch = loose_stretch(edges_, node_of_, edge);
    if (stretch.at_end_of_precrack || options_.is_arm(static_cast<Index>(stretch.edges.size()), stretch.length)) return begin_crack(stretch.way.front(), stretch.start);
    const auto middle = looked_at.insert(looked_at.end(), stretch.edges.begin(), stretch.edges.end());
    std::inplace_merge(looked_at.begin(), middle, looked_at.end());
    if (stretch.length > loose_.length) loose_ = std::move(stretch);
}

void CrackArms::begin_crack(Index vertex, CrackStart start) {
    const Index root = static_cast<Index>(nodes_.size()), crack = static_cast<Index>(cracks_.size()), arm = static_cast<Index>(arms_.size());
    const bool inside = start == CrackStart::inside;
    nodes_.push_back({.vertex = vertex, .edge = -1, .parent = -1, .crack = crack, .arm = arm});
    owner_[vertex] = root;
    cracks_.push_back({.start = start, .root = root, .arms = {arm, inside ? arm + 1 : -1}});
    for (int k = 0; k < (inside ? 2 : 1); ++k) arms_.push_back({.crack = crack, .parent = -1, .nodes = {root}});
    Queue queue;
    push_edges(root, 0, queue);
    sweep(queue);
}

/// Two cracks met. One that started inside the body goes on with the other, when that one has come further: no way to a tip gets shorter by it.
void CrackArms::go_on(Index a, Index b) {
    const Index first_a = first_of(nodes_[a].crack), first_b = first_of(nodes_[b].crack);
    if (first_a == first_b) return;
    const double length_a = path_length(a), length_b = path_length(b);
    if (cracks_[first_a].start == CrackStart::inside && (cracks_[first_b].start != CrackStart::inside || length_a < length_b)) std::swap(a, b);
    const Index first = first_of(nodes_[b].crack);
    if (cracks_[first].start != CrackStart::inside || path_length(a) < path_length(b)) return;
    // the cracks between b and the first one of its row now go on the other way round
    Index from = a, at = b;
    while (true) {
        CrackTree& crack = cracks_[nodes_[at].crack];
        std::swap(crack.from, from), std::swap(crack.at, at);
        if (from < 0) break;
        std::swap(from, at);
    }
    junctions_.push_back({.from = a, .at = b});
    went_on_ = true;
}

std::vector<std::uint8_t> CrackArms::passed() const {
    std::vector<std::uint8_t> passed(arms_.size(), 0);
    for (const Junction& j : junctions_)
        for (const Index node : {j.from, j.at})
            if (const Index base = base_of(node), arm = nodes_[base].arm; !is_arm(base, arms_[arm].tip())) passed[arm] = 1;
    return passed;
}

/// The ways on from a junction: that of the first crack, and both along the second.
void CrackArms::count_branchings(Junction& junction) {
    const Index straight = base_of(junction.from), ahead = base_of(junction.at);
    const auto [first, second] = cracks_[nodes_[junction.at].crack].arms;
    if (second < 0) return;
    const Index other = nodes_[ahead].arm == first ? second : first;
    std::vector<double> begun_at;  // [s] of those that are long enough
    for (const Index base : {straight, ahead})
        if (is_arm(base, arms_[nodes_[base].arm].tip())) begun_at.push_back(begun(nodes_[base].arm, base));
    const CrackNode& back = nodes_[arms_[other].tip()];
    if (options_.is_arm(nodes_[ahead].n + back.n, nodes_[ahead].distance + back.distance)) begun_at.push_back(begun(other, arms_[other].nodes.front()));
    std::sort(begun_at.begin(), begun_at.end());
    for (; junction.n_counted + 1 < static_cast<Index>(begun_at.size()); ++junction.n_counted)
        branchings_.push_back({.node = straight, .time = begun_at[junction.n_counted + 1]});
}

Index CrackArms::first_of(Index crack) const {
    while (cracks_[crack].from >= 0) crack = nodes_[cracks_[crack].from].crack;
    return crack;
}

Index CrackArms::n_cracks() const {
    return static_cast<Index>(std::count_if(cracks_.begin(), cracks_.end(), [](const CrackTree& c) { return c.from < 0; }));
}

double CrackArms::path_length(Index node) const {
    double length = 0;
    while (true) {
        const CrackTree& crack = cracks_[nodes_[node].crack];
        if (crack.from < 0) return length + nodes_[node].distance;
        length += nodes_[node].distance + nodes_[crack.at].distance - 2 * nodes_[common(node, crack.at)].distance;
        node = crack.from;
    }
}

std::vector<Index> CrackArms::way(Index node) const {
    std::vector<Index> way;  // from the node back
    while (true) {
        const CrackTree& crack = cracks_[nodes_[node].crack];
        const Index turn = crack.from < 0 ? crack.root : common(node, crack.at);
        for (; node != turn; node = nodes_[node].parent) way.push_back(node);
        way.push_back(turn);
        if (crack.from < 0) break;
        std::vector<Index> down;
        for (Index n = crack.at; n != turn; n = nodes_[n].parent) down.push_back(n);
        way.insert(way.end(), down.rbegin(), down.rend());
        node = crack.from;
    }
    std::reverse(way.begin(), way.end());
    return way;
}

}  // namespace knap
