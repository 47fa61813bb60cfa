#include "analysis/crack_arms.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace knap {

CrackOptions crack_options(double extent, double process_zone, double fastest, Index edges_per_side) {
    return {.arm_edges = 10 * edges_per_side,
            .short_arm_edges = 5 * edges_per_side,
            .short_arm_length = 0.05 * extent,
            .min_length = 0.01 * extent,
            .gap_edges = 2 * edges_per_side,
            .chord_edges = 10 * edges_per_side,
            .speed_edges = 20 * edges_per_side,
            .speed_length = 1.5 * process_zone,
            .start_edges = 5 * edges_per_side,
            .fastest = fastest};
}

CrackArms::CrackArms(InterfaceGraph graph, const CrackOptions& options)
    : edges_(std::move(graph), options.gap_edges),
      options_(options),
      node_of_(edges_.graph().ends.size(), -1),
      owner_(edges_.graph().vertices.size(), -1) {}

void CrackArms::renumber(InterfaceGraph graph, const Renumbering& numbers) {
    const auto renumber_places = [](std::vector<Index>& of, const std::vector<Index>& numbers, std::size_t n) {
        std::vector<Index> next(n, -1);
        for (std::size_t i = 0; i < of.size(); ++i)
            if (of[i] != -1) next[numbers[i]] = of[i];
        of = std::move(next);
    };
    renumber_places(node_of_, numbers.interface, graph.ends.size());
    renumber_places(owner_, numbers.vertex, graph.vertices.size());
    edges_.renumber(std::move(graph), numbers);
    for (CrackNode& node : nodes_) {
        node.vertex = numbers.vertex[node.vertex];
        if (node.edge >= 0) node.edge = numbers.interface[node.edge];
    }
    for (Index& e : isolated_.edges) e = numbers.interface[e];
    for (Index& v : isolated_.way) v = numbers.vertex[v];
}

bool CrackArms::grow(double time, std::span<const EdgeStatus> statuses) {
    const std::vector<Index> cracked = edges_.add(time, statuses);
    if (cracked.empty()) return false;
    Queue queue;
    for (const Index e : cracked)
        for (const Index v : graph().ends[e])
            if (owner_[v] >= 0) queue.push({graph().length[e], e, owner_[v]});
    take_edges(queue);
    std::set<Index> examined;  // edges of stretches that are too small
    for (const Index e : cracked) {
        if (node_of_[e] != -1 || examined.contains(e)) continue;
        IsolatedStretch stretch = isolated_stretch(e);
        if (stretch.at_end_of_precrack || options_.is_arm(static_cast<Index>(stretch.edges.size()), stretch.length)) {
            start_crack(stretch.way.front(), stretch.start);
            continue;
        }
        examined.insert(stretch.edges.begin(), stretch.edges.end());
        if (stretch.length > isolated_.length) isolated_ = std::move(stretch);
    }
    for (Junction& junction : junctions_)
        if (junction.n_counted < 2) count_branchings(junction);
    if (std::exchange(continued_, false))
        for (CrackArm& arm : arms_) arm.path_length = path_length(arm.tip());
    return true;
}

// ---- trees ----

void CrackArms::push_edges(Index node, double distance, Queue& queue) const {
    for (const Index e : edges_.edges_at(nodes_[node].vertex))
        if (is_free(e)) queue.push({distance + graph().length[e], e, node});
}

/// Adds all edges that the queue leads to, the nearest first.
void CrackArms::take_edges(Queue& queue) {
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
                      .n_edges = before.n_edges + 1,
                      .since = edges_.since(edge),
                      .ends = ends});
    node_of_[edge] = node;
    place_in_arm(node);
    return node;
}

/// An edge that joins two vertices that cracks have reached. A small loop is noise; else one arm ends at the other.
void CrackArms::close(Index edge, Index a, Index b) {
    const bool same = nodes_[a].crack == nodes_[b].crack;
    if (same) {
        const CrackNode& fork = nodes_[common(a, b)];
        const Index n_edges = 1 + nodes_[a].n_edges + nodes_[b].n_edges - 2 * fork.n_edges;
        const double length = graph().length[edge] + nodes_[a].distance + nodes_[b].distance - 2 * fork.distance;
        if (n_edges < 2 * options_.arm_edges || length < 2 * options_.min_length) return;
    }
    const auto rank = [&](Index node) {
        const bool is_tip = nodes_[node].arm >= 0 && arms_[nodes_[node].arm].tip() == node;
        return std::pair(is_tip, path_length(node));
    };
    if (rank(a) < rank(b)) std::swap(a, b);  // the edge is the last one of the tip with the longer path
    const Index end = add_node(nodes_[b].vertex, edge, a, true);
    nodes_[b].ends = true;
    if (!same) continue_crack(end, b);
}

/// The last node that the paths to two nodes of a crack have in common.
Index CrackArms::common(Index a, Index b) const {
    const auto rank = [&](Index node) { return std::pair(nodes_[node].distance, node); };
    while (a != b) {  // the farther one goes back
        if (rank(a) > rank(b)) a = nodes_[a].parent;
        else b = nodes_[b].parent;
    }
    return a;
}

// ---- arms ----

/// The last node of an arm on the path to a node.
Index CrackArms::base_of(Index node) const {
    while (nodes_[node].arm < 0) node = nodes_[node].parent;
    return node;
}

std::vector<Index> CrackArms::way_from(Index base, Index node) const {
    std::vector<Index> way;
    for (; node != base; node = nodes_[node].parent) way.push_back(node);
    std::ranges::reverse(way);
    return way;
}

/// A new node lengthens an arm, makes another path the continuation of one, starts an arm, or is on a twig.
void CrackArms::place_in_arm(Index node) {
    const Index base = base_of(node);
    const double length = nodes_[node].distance - nodes_[base].distance;
    Index arm = nodes_[base].arm;
    const auto& [first, second] = cracks_[nodes_[node].crack].arms;
    if (base == cracks_[nodes_[node].crack].root && second >= 0)
        arm = beyond(second, base) < beyond(first, base) ? second : first;
    const bool stays = nodes_[base].distance < arms_[arm].kept || is_arm(base, arms_[arm].tip());
    if (!stays && length > beyond(arm, base)) {  // what the arm had beyond its base becomes a twig
        std::vector<Index>& nodes = arms_[arm].nodes;
        const bool leaves_twig = nodes.back() != base;
        for (; nodes.back() != base; nodes.pop_back()) nodes_[nodes.back()].arm = -1;
        extend(arm, base, node);
        if (leaves_twig) take_long_stretch(nodes_[base].vertex);
    } else if (is_arm(base, node)) {
        start_arm(base, node);
    } else {
        take_long_stretch(nodes_[node].vertex);
    }
}

/// Adds the path from `base`, the last node of an arm, to a node.
void CrackArms::extend(Index arm, Index base, Index node) {
    for (const Index n : way_from(base, node)) {
        nodes_[n].arm = arm;
        arms_[arm].nodes.push_back(n);
    }
    arms_[arm].path_length = path_length(node);
}

void CrackArms::start_arm(Index base, Index node) {
    const Index arm = static_cast<Index>(arms_.size()), parent = nodes_[base].arm;
    arms_.push_back({.crack = nodes_[base].crack, .parent = parent, .nodes = {base}});
    extend(arm, base, node);
    arms_[parent].kept = std::max(arms_[parent].kept, nodes_[base].distance);
    branchings_.push_back({.node = base, .time = std::max(start_time(parent, base), start_time(arm, base))});
}

/// When the first edge of an arm beyond one of its nodes cracked.
double CrackArms::start_time(Index arm, Index base) const {
    const std::vector<Index>& nodes = arms_[arm].nodes;
    double time = infinity;
    for (std::size_t i = nodes.size(); i-- > 1 && nodes[i] != base;) time = std::min(time, nodes_[nodes[i]].since);
    return time;
}

/// The vertices that edges of cracks connect with one, without those of arms; distances are numbers of edges.
Search CrackArms::off_arms(Index vertex) const {
    const auto length = [&](Index edge) {
        const Index node = node_of_[edge];
        return node == closing || (node >= 0 && nodes_[node].arm < 0) ? 1 : CrackedEdges::never;
    };
    const auto goes_on = [&](Index v, double) { return v == vertex || (owner_[v] >= 0 && nodes_[owner_[v]].arm < 0); };
    return {edges_, vertex, Search::Ties::first_found, length, goes_on};
}

/// Connected twigs and loops may be as long as an arm from end to end, though each twig is shorter: then the longest
/// one is an arm.
void CrackArms::take_long_stretch(Index vertex) {
    while (true) {
        const Search search = off_arms(off_arms(vertex).farthest());
        if (search.ways.at(search.farthest()).length < options_.arm_edges) return;
        double length = 0;
        Index longest = -1, n_longest = 0;
        for (const Index e : search.edges_back(edges_, search.farthest())) {
            length += graph().length[e];
            const Index node = node_of_[e], n = node < 0 ? 0 : nodes_[node].n_edges - nodes_[base_of(node)].n_edges;
            if (n > n_longest) longest = node, n_longest = n;
        }
        if (longest < 0 || length < options_.min_length) return;
        start_arm(base_of(longest), longest);
        arms_.back().kept = nodes_[longest].distance;
    }
}

// ---- cracks ----

/// The isolated stretch of an edge. It starts at a pre-crack, at its end rather than its side; without one at the
/// boundary, at an end of a longest path across; without either in the middle of its longest path.
IsolatedStretch CrackArms::isolated_stretch(Index edge) const {
    const auto search_from = [&](Index root) {
        const auto length = [&](Index e) { return is_free(e) ? graph().length[e] : CrackedEdges::never; };
        const auto goes_on = [&](Index v, double) { return v == root || !edges_.terminal(v); };
        return Search(edges_, root, Search::Ties::lowest_vertex, length, goes_on);
    };
    const auto [a, b] = graph().ends[edge];
    const Search all = search_from(edges_.terminal(a) ? b : a);
    IsolatedStretch found;
    std::set<Index> stretch;
    for (const Index v : all.order)
        for (const Index e : edges_.edges_at(v))
            if (is_free(e) && (!edges_.terminal(v) || all.ways.contains(edges_.far_end(e, v)))) stretch.insert(e);
    found.edges.assign(stretch.begin(), stretch.end());

    const auto rank = [&](Index v) {  // the number last: the same start as long as the stretch grows
        return std::tuple(!edges_.end_of_precrack(v), !edges_.on_precrack(v), !edges_.terminal(v), v);
    };
    Index root = *std::ranges::min_element(all.order, {}, rank);
    found.at_end_of_precrack = edges_.end_of_precrack(root);
    found.start = edges_.on_precrack(root) ? CrackStart::precrack
                  : edges_.terminal(root)  ? CrackStart::boundary
                                           : CrackStart::inside;
    if (found.start == CrackStart::boundary) {
        const std::vector<Index> order = search_from(root).order;
        root = *std::find_if(order.rbegin(), order.rend(), [&](Index v) { return edges_.terminal(v); });
    }
    if (found.start == CrackStart::inside) {
        const Search across = search_from(all.farthest());
        root = across.farthest();
        found.length = across.ways.at(root).length;
        while (across.ways.at(root).length > 0.5 * found.length) root = edges_.far_end(across.ways.at(root).edge, root);
    }
    const Search search = search_from(root);
    found.way = {search.farthest()};
    for (const Index e : search.edges_back(edges_, found.way.front()))
        found.way.push_back(edges_.far_end(e, found.way.back()));
    std::ranges::reverse(found.way);
    found.ends = edges_.terminal(found.way.back());
    if (found.start != CrackStart::inside) found.length = search.ways.at(found.way.back()).length;
    return found;
}

void CrackArms::start_crack(Index vertex, CrackStart start) {
    const Index root = static_cast<Index>(nodes_.size()), crack = static_cast<Index>(cracks_.size()),
                arm = static_cast<Index>(arms_.size());
    const bool inside = start == CrackStart::inside;
    nodes_.push_back({.vertex = vertex, .edge = -1, .parent = -1, .crack = crack, .arm = arm});
    owner_[vertex] = root;
    cracks_.push_back({.start = start, .root = root, .arms = {arm, inside ? arm + 1 : -1}});
    arms_.insert(arms_.end(), inside ? 2 : 1, {.crack = crack, .parent = -1, .nodes = {root}});
    Queue queue;
    push_edges(root, 0, queue);
    take_edges(queue);
}

/// Two cracks met at nodes a and b. One that started inside the body continues the other one if that has the longer
/// path: no path to a tip gets shorter.
void CrackArms::continue_crack(Index a, Index b) {
    const auto rank = [&](Index node) {  // of the crack that is continued: the higher
        return std::pair(cracks_[first_of(nodes_[node].crack)].start != CrackStart::inside, path_length(node));
    };
    if (first_of(nodes_[a].crack) == first_of(nodes_[b].crack)) return;
    if (!rank(a).first && rank(a) < rank(b)) std::swap(a, b);
    if (rank(b).first || path_length(a) < path_length(b)) return;
    // the cracks from b back to the start of its chain now continue each other in the opposite order
    Index from = a, at = b;
    while (true) {
        CrackTree& crack = cracks_[nodes_[at].crack];
        std::swap(crack.from, from), std::swap(crack.at, at);
        if (from < 0) break;
        std::swap(from, at);
    }
    junctions_.push_back({.from = a, .at = b});
    continued_ = true;
}

std::vector<std::uint8_t> CrackArms::passed() const {
    std::vector<std::uint8_t> passed(arms_.size(), 0);
    for (const Junction& j : junctions_)
        for (const Index node : {j.from, j.at})
            if (const Index base = base_of(node), arm = nodes_[base].arm; !is_arm(base, arms_[arm].tip()))
                passed[arm] = 1;
    return passed;
}

/// The paths from a junction: the rest of the first crack, and both directions along the second.
void CrackArms::count_branchings(Junction& junction) {
    const Index straight = base_of(junction.from), ahead = base_of(junction.at);
    const auto [first, second] = cracks_[nodes_[junction.at].crack].arms;
    if (second < 0) return;
    const Index other = nodes_[ahead].arm == first ? second : first;
    std::vector<double> started;  // [s] those that are long enough
    for (const Index base : {straight, ahead})
        if (is_arm(base, arms_[nodes_[base].arm].tip())) started.push_back(start_time(nodes_[base].arm, base));
    const CrackNode& back = nodes_[arms_[other].tip()];
    if (options_.is_arm(nodes_[ahead].n_edges + back.n_edges, nodes_[ahead].distance + back.distance))
        started.push_back(start_time(other, arms_[other].nodes.front()));
    std::ranges::sort(started);
    for (; junction.n_counted + 1 < static_cast<Index>(started.size()); ++junction.n_counted)
        branchings_.push_back({.node = straight, .time = started[junction.n_counted + 1]});
}

Index CrackArms::first_of(Index crack) const {
    while (cracks_[crack].from >= 0) crack = nodes_[cracks_[crack].from].crack;
    return crack;
}

Index CrackArms::n_cracks() const { return static_cast<Index>(std::ranges::count(cracks_, -1, &CrackTree::from)); }

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
    const CrackTree& crack = cracks_[nodes_[node].crack];
    if (crack.from < 0) return way_from(-1, node);
    const Index turn = common(node, crack.at);
    std::vector<Index> way = this->way(crack.from), back = way_from(turn, crack.at), on = way_from(turn, node);
    way.insert(way.end(), back.rbegin(), back.rend());
    way.push_back(turn);
    way.insert(way.end(), on.begin(), on.end());
    return way;
}

}  // namespace knap
