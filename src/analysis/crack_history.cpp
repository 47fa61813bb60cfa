#include "analysis/crack_history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace knap {

// The slope over [start, now] of f, which is linear between the moments t_i: with tau = t - (start + now)/2
//     slope = int tau f dt / int tau^2 dt = 12/T^3 int tau f dt,     Simpson's rule is exact for tau f
double speed_over_window(std::span<const std::pair<double, double>> growth, double window, double min_growth) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (growth.size() < 3 || growth.back().second < min_growth * (1 - 1e-9)) return unknown;
    const auto [now, end] = growth.back();
    std::size_t first = growth.size() - 1, last = growth.size() - 1;
    while (first > 0 && end - growth[first].second < window) --first;
    while (last > first && growth[last - 1].second == end) --last;
    double begin = growth[first].first;  // of the growth by a window
    if (const auto& [t, s] = growth[first]; end - s > window)
        begin += (end - window - s) / (growth[first + 1].second - s) * (growth[first + 1].first - t);
    const double duration = growth[last].first - begin, start = now - duration;
    if (!(duration > 0)) return unknown;
    std::size_t i = growth.size() - 1;
    while (i > 0 && growth[i].first > start) --i;
    const double middle = 0.5 * (start + now);
    double sum = 0;  // int tau (f - end) dt
    for (; i + 1 < growth.size(); ++i) {
        const auto [t0, s0] = growth[i];
        const auto [t1, s1] = growth[i + 1];
        const double from = std::max(t0, start), h = t1 - from;
        if (!(h > 0)) continue;
        const double f0 = s0 - end + (s1 - s0) * (from - t0) / (t1 - t0), f1 = s1 - end;
        sum += h / 6 * ((from - middle) * f0 + (t1 + from - 2 * middle) * (f0 + f1) + (t1 - middle) * f1);
    }
    return 12 * sum / (duration * duration * duration);
}

CrackHistory::CrackHistory(InterfaceGraph graph, const CrackOptions& options)
    : arms_(std::move(graph), options), options_(options) {}

void CrackHistory::renumber(InterfaceGraph graph, const Renumbering& numbers) {
    arms_.renumber(std::move(graph), numbers);
    if (pattern_.main_end) pattern_.main_end->vertex = numbers.vertex[pattern_.main_end->vertex];
    for (CrackTip& tip : pattern_.tips) tip.vertex = numbers.vertex[tip.vertex];
}

void CrackHistory::grow(double time, std::span<const EdgeStatus> changed, double work) {
    if (changed.empty() || !arms_.grow(time, changed)) return;
    works_.emplace_back(time, work);
    double length = arms_.arms().empty() ? arms_.longest_isolated().length : 0;
    for (Index arm = 0; arm < static_cast<Index>(arms_.arms().size()); ++arm) length += arms_.length(arm);
    pattern_.crack_length = std::max(pattern_.crack_length, length);
}

const CrackPattern& CrackHistory::snapshot(double time, std::span<const InterfaceStatus> status) {
    std::vector<EdgeStatus> statuses;
    for (std::size_t e = 0; e < status.size(); ++e) statuses.push_back({static_cast<Index>(e), status[e]});
    grow(time, statuses);
    return snapshot(time);
}

const CrackPattern& CrackHistory::snapshot(double time) {
    times_.push_back(time);
    pattern_.n_broken = pattern_.n_damaged = 0;
    pattern_.broken_length = pattern_.damaged_length = 0;
    const std::span<const InterfaceStatus> status = arms_.edges().status();
    for (std::size_t e = 0; e < status.size(); ++e) {
        const double length = arms_.graph().length[e];
        if (status[e] == InterfaceStatus::broken) ++pattern_.n_broken, pattern_.broken_length += length;
        if (status[e] == InterfaceStatus::damaged) ++pattern_.n_damaged, pattern_.damaged_length += length;
    }
    for (std::size_t i = 0; i < arms_.arms().size(); ++i) {
        const Index tip = arms_.arms()[i].tip();
        if (i == speeds_.size()) speeds_.push_back(unknown), tips_.push_back(-1);
        if (tips_[i] == tip && speeds_[i] == 0) continue;  // it stands
        tips_[i] = tip;
        speeds_[i] = speed_at(growth(static_cast<Index>(i)), time);
    }
    find_main();
    return pattern_;
}

// ---- speeds ----

CrackHistory::Growth CrackHistory::growth(Index arm) const {
    Growth growth;
    growth.way = arms_.way_from(-1, arms_.arms()[arm].tip());
    const std::size_t n = growth.way.size();
    growth.reached.resize(n);
    double time = infinity;
    for (std::size_t i = n; i-- > 1;) growth.reached[i] = time = std::min(time, arms_.nodes()[growth.way[i]].since);
    growth.reached[0] = time;  // the time until the first edge cracks does not count

    const std::vector<double> position = along_chords(vertices_of(growth.way));
    const double edge = position.back() / static_cast<double>(std::max<std::size_t>(n - 1, 1));
    growth.window = std::max(options_.speed_edges * edge, options_.speed_length);
    growth.min_growth = std::max(options_.start_edges * edge, 0.25 * growth.window);
    // A stretch on which the path gets ahead of the fastest wave by more than a burst of edges did not break one edge
    // after the other: the crack joined it, which is no growth.
    const double burst = options_.start_edges * edge * (1 + 1e-9);
    growth.run.assign(n, 0);
    for (std::size_t i = 1, before = 0; i < n; ++i) {
        growth.run[i] = growth.run[i - 1] + position[i] - position[i - 1];
        if (i + 1 < n && growth.reached[i + 1] == growth.reached[i]) continue;  // all that one step breaks
        const double duration = growth.reached[i] - growth.reached[before],
                     ahead = growth.run[i] - growth.run[before] - (duration > 0 ? options_.fastest * duration : 0);
        if (ahead > burst) std::fill_n(growth.run.begin() + before, i + 1 - before, growth.run[before]);
        if (ahead <= 0 || ahead > burst) before = i;
    }
    return growth;
}

/// Unknown where it would exceed the fastest wave.
double CrackHistory::bounded_speed(std::span<const std::pair<double, double>> growth, double window,
                                   double min_growth) const {
    const double speed = speed_over_window(growth, window, min_growth);
    return speed <= options_.fastest ? speed : unknown;
}

double CrackHistory::speed_at(const Growth& growth, double time) const {
    const auto n = std::ranges::upper_bound(growth.reached, time) - growth.reached.begin();
    if (n == 0) return unknown;
    const double window_start = growth.run[n - 1] - growth.window;
    const auto first = std::ranges::upper_bound(growth.run, window_start) - growth.run.begin();
    Moments moments;
    for (auto i = std::max<std::ptrdiff_t>(first - 1, 0); i < n; ++i)
        moments.emplace_back(growth.reached[i], growth.run[i]);
    if (time > moments.back().first) moments.emplace_back(time, moments.back().second);
    return bounded_speed(moments, growth.window, growth.min_growth);
}

double CrackHistory::mean_tip_speed() const {
    if (main_arm_ < 0) return unknown;
    const Growth way = growth(main_arm_);
    const auto half = std::ranges::lower_bound(way.run, 0.5 * way.run.back()) - way.run.begin();
    Moments second_half;
    for (std::size_t i = half; i < way.run.size(); ++i) second_half.emplace_back(way.reached[i], way.run[i]);
    return bounded_speed(second_half, way.run.back() - way.run[half], way.min_growth);
}

double CrackHistory::max_tip_speed() const {
    double largest = mean_tip_speed();  // it, too, is over a long growth
    for (std::size_t arm = 0; arm < arms_.arms().size(); ++arm) {
        const Growth way = growth(static_cast<Index>(arm));
        for (std::size_t i = way.way.size() - arms_.arms()[arm].nodes.size(); i < way.way.size(); ++i)
            if (way.run[i] >= 0.5 * way.window * (1 - 1e-9))
                largest = std::fmax(largest, speed_at(way, way.reached[i]));  // fmax ignores NaN
    }
    return largest;
}

// ---- lengths ----

std::vector<Index> CrackHistory::vertices_of(std::vector<Index> nodes) const {
    for (Index& n : nodes) n = arms_.nodes()[n].vertex;
    return nodes;
}

/// Distances from the first vertex: the edges between two knots share the length of the chord between them.
std::vector<double> CrackHistory::along_chords(const std::vector<Index>& vertices) const {
    const auto distance = [&](std::size_t a, std::size_t b) {
        return (arms_.graph().vertices[vertices[b]] - arms_.graph().vertices[vertices[a]]).norm();
    };
    std::vector<double> position(vertices.size(), 0);
    for (std::size_t knot = 0; knot + 1 < vertices.size();) {
        const std::size_t end = std::min(knot + static_cast<std::size_t>(options_.chord_edges), vertices.size() - 1);
        double along = 0;
        for (std::size_t k = knot; k < end; ++k) along += distance(k, k + 1), position[k + 1] = along;
        const double chord = distance(knot, end);
        for (std::size_t k = knot + 1; k <= end; ++k)
            position[k] = position[knot] + (along > 0 ? position[k] * chord / along : 0);
        knot = end;
    }
    return position;
}

CrackTip CrackHistory::tip_at(Index arm, Index node, double speed, bool arrived) const {
    const CrackNode& at = arms_.nodes()[node];
    return {arm, at.vertex, arms_.graph().vertices[at.vertex], at.distance, speed, arrived};
}

CrackTip CrackHistory::tip_of(Index arm) const {
    const Index node = arms_.arms()[arm].tip();
    CrackTip tip = tip_at(arm, node, speeds_[arm], arms_.nodes()[node].ends);
    tip.path_length = arms_.arms()[arm].path_length;
    return tip;
}

void CrackHistory::find_main() {
    const auto& arms = arms_.arms();
    const std::vector<std::uint8_t> passed = arms_.passed();
    Index longest = -1;
    pattern_.tips.clear();
    for (Index arm = 0; arm < static_cast<Index>(arms.size()); ++arm) {
        const std::vector<Index>& nodes = arms[arm].nodes;
        const CrackTip tip = tip_of(arm);
        if (!tip.arrived && !passed[arm] && nodes.size() > 1) pattern_.tips.push_back(tip);
        if (longest < 0 || arms[arm].path_length > arms[longest].path_length) longest = arm;
    }
    pattern_.n_cracks = arms_.n_cracks();
    pattern_.n_branches = static_cast<Index>(arms_.branchings().size());
    std::vector<Index> vertices;
    if (longest >= 0) {
        main_arm_ = longest;
        pattern_.main_end = tip_of(main_arm_);
        pattern_.main_start = arms_.cracks()[arms_.first_of(arms[main_arm_].crack)].start;
        vertices = vertices_of(arms_.way(arms[main_arm_].tip()));
    } else if (const IsolatedStretch& isolated = arms_.longest_isolated(); isolated.length > 0) {
        vertices = isolated.way;
        pattern_.n_cracks = 1;
        pattern_.main_start = isolated.start;
        pattern_.main_end = {-1, vertices.back(), arms_.graph().vertices[vertices.back()], 0, unknown, isolated.ends};
        if (!isolated.ends) pattern_.tips.push_back(*pattern_.main_end);
    }
    if (!vertices.empty()) pattern_.main_length = std::max(pattern_.main_length, along_chords(vertices).back());
}

std::optional<double> CrackHistory::first_growth_time() const {
    double first = infinity;
    for (const CrackArm& arm : arms_.arms())
        for (std::size_t k = 1; k < arm.nodes.size(); ++k) first = std::min(first, arms_.nodes()[arm.nodes[k]].since);
    if (std::isinf(first))
        for (const Index e : arms_.longest_isolated().edges) first = std::min(first, arms_.edges().since(e));
    return std::isinf(first) ? std::nullopt : std::optional(first);
}

double CrackHistory::main_angle() const {
    if (main_arm_ < 0) return unknown;
    const std::vector<Index> way = vertices_of(arms_.way(arms_.arms()[main_arm_].tip()));
    const auto place = [&](Index vertex) -> const Vec2& { return arms_.graph().vertices[vertex]; };
    Vec2 mean = Vec2::Zero();
    for (const Index vertex : way) mean += place(vertex) / static_cast<double>(way.size());
    double xx = 0, yy = 0, xy = 0;
    for (const Index vertex : way) {
        const Vec2 from_mean = place(vertex) - mean;
        xx += from_mean.x() * from_mean.x(), yy += from_mean.y() * from_mean.y(), xy += from_mean.x() * from_mean.y();
    }
    return std::abs(0.5 * std::atan2(2 * xy, xx - yy)) * 180 / std::numbers::pi;
}

/// visit(time [s] when it cracked, length [m] along chords)
template <class Visit>
void CrackHistory::for_each_main_edge(const Visit& visit) const {
    const std::vector<CrackNode>& nodes = arms_.nodes();
    const std::vector<Index> way = arms_.way(arms_.arms()[main_arm_].tip());
    const std::vector<double> position = along_chords(vertices_of(way));
    for (std::size_t i = 1; i < way.size(); ++i) {
        // of two nodes the one with the edge between them: a chain of cracks goes back to the start of each
        const Index later = nodes[way[i]].parent == way[i - 1] ? way[i] : way[i - 1];
        if (position[i] > position[i - 1]) visit(nodes[later].since, position[i] - position[i - 1]);
    }
}

std::optional<CrackHistory::Advance> CrackHistory::advance_between(double from, double to) const {
    if (main_arm_ < 0) return {};
    Moments growth;  // length of the edges that cracked at a time
    for_each_main_edge([&](double since, double length) { growth.emplace_back(since, length); });
    std::ranges::stable_sort(growth, {}, &Moments::value_type::first);
    double all = 0, length = 0;
    for (const auto& [time, edge] : growth) all += edge;
    std::array<Advance, 2> at{};
    std::size_t n_reached = 0;
    for (std::size_t i = 0; i < growth.size(); ++i) {
        length += growth[i].second;
        if (i + 1 < growth.size() && growth[i + 1].first == growth[i].first) continue;
        const auto work = std::ranges::lower_bound(works_, growth[i].first, {}, &Moments::value_type::first);
        while (n_reached < 2 && length >= (n_reached == 0 ? from : to) * all * (1 - 1e-12))
            at[n_reached++] = {work->second, length};
    }
    return n_reached < 2 ? std::nullopt : std::optional(Advance{at[1].work - at[0].work, at[1].length - at[0].length});
}

CrackHistory::Past CrackHistory::conclude() {
    const std::size_t n = times_.size();
    Past past{.main = std::vector<double>(n, 0), .all = std::vector<double>(n, 0), .tip = {}};
    past.tip.resize(n);
    const auto line = [&](double since) { return std::ranges::lower_bound(times_, since) - times_.begin(); };
    const std::vector<CrackNode>& nodes = arms_.nodes();
    for (const CrackNode& node : nodes)
        if (node.arm >= 0 && node.parent >= 0)
            past.all[line(node.since)] += node.distance - nodes[node.parent].distance;
    if (main_arm_ >= 0) {
        for_each_main_edge([&](double since, double length) { past.main[line(since)] += length; });
        const Growth ran = growth(main_arm_);
        for (std::size_t i = line(ran.reached.front()); i < n; ++i) {
            const auto k = std::ranges::upper_bound(ran.reached, times_[i]) - ran.reached.begin() - 1;
            const bool arrived = ran.way[k] == ran.way.back() && nodes[ran.way[k]].ends;
            past.tip[i] = tip_at(main_arm_, ran.way[k], speed_at(ran, times_[i]), arrived);
        }
    }
    std::partial_sum(past.main.begin(), past.main.end(), past.main.begin());
    std::partial_sum(past.all.begin(), past.all.end(), past.all.begin());
    if (main_arm_ >= 0) pattern_.main_length = past.main.back();
    return past;
}

std::optional<FirstBranching> CrackHistory::first_branching() const {
    if (arms_.branchings().empty()) return {};
    const Branching& first = *std::ranges::min_element(arms_.branchings(), {}, &Branching::time);
    return FirstBranching{first.time, arms_.graph().vertices[arms_.nodes()[first.node].vertex]};
}

// ---- tables ----

std::span<const Measure<CrackMoment>> crack_columns() {
    using M = CrackMoment;
    constexpr static auto tip_place = [](const M& m, int k) {
        return m.history.pattern().main_end ? m.history.pattern().main_end->position[k] : std::nan("");
    };
    static constexpr Measure<M> columns[] = {
        {"time", "s", "end of the step", [](const M& m) { return m.time; }},
        {"main_length", "m", "length of the main crack (longest path from the start of a crack to a tip), along chords",
         [](const M& m) { return m.history.pattern().main_length; }},
        {"crack_length", "m",
         "length of all crack arms, along edges, without twigs and isolated broken interfaces; written again at the "
         "end of the run, where an arm counts from its first edge on",
         [](const M& m) { return m.history.pattern().crack_length; }},
        {"broken_length", "m", "length of all broken interfaces",
         [](const M& m) { return m.history.pattern().broken_length; }},
        {"damaged_length", "m", "length of all interfaces that are damaged but not broken",
         [](const M& m) { return m.history.pattern().damaged_length; }},
        {"tips", "", "number of crack tips that have not arrived at a boundary or at another crack",
         [](const M& m) { return double(m.history.pattern().tips.size()); }},
        {"branches", "", "number of branchings so far",
         [](const M& m) { return double(m.history.pattern().n_branches); }},
        {"tip_x", "m",
         "x of the tip of the main crack; written again at the end of the run, for the crack that is the main one then",
         [](const M& m) { return tip_place(m, 0); }},
        {"tip_y", "m", "y of the same tip", [](const M& m) { return tip_place(m, 1); }},
        {"tip_speed", "m/s",
         "speed of the same tip: least-squares slope over its last growth by 20 edges (or by 1.5 process zones if "
         "that is more), known from a quarter of that growth on",
         [](const M& m) { return m.history.tip_speed(); }},
        {"tip_speed_over_cR", "", "tip_speed over the Rayleigh speed",
         [](const M& m) { return m.rayleigh_speed > 0 ? m.history.tip_speed() / m.rayleigh_speed : std::nan(""); }},
        {"n_broken", "", "number of broken interfaces",
         [](const M& m) { return double(m.history.pattern().n_broken); }},
        {"n_damaged", "", "number of interfaces that are damaged but not broken",
         [](const M& m) { return double(m.history.pattern().n_damaged); }}};
    return columns;
}

std::span<const Measure<ArmMoment>> arm_columns() {
    using M = ArmMoment;
    static constexpr Measure<M> columns[] = {
        {"arm", "", "number of the arm, from 0 in the order in which arms were found",
         [](const M& m) { return double(m.arm); }},
        {"parent", "", "number of the arm from which it branched; -1: it is the first of its crack",
         [](const M& m) { return double(m.parent); }},
        {"time", "s", "time at which the tip had passed this place", [](const M& m) { return m.time; }},
        {"x", "m", "x of a vertex of the arm", [](const M& m) { return m.position.x(); }},
        {"y", "m", "y of the vertex", [](const M& m) { return m.position.y(); }},
        {"speed", "m/s", "speed of the tip at that time", [](const M& m) { return m.speed; }},
        {"length", "m", "length of the arm up to this place, along edges", [](const M& m) { return m.length; }}};
    return columns;
}

History CrackHistory::arm_table() const {
    History table{.columns = names_of(arm_columns()), .rows = {}};
    for (Index arm = 0; arm < static_cast<Index>(arms_.arms().size()); ++arm) {
        const CrackArm& a = arms_.arms()[arm];
        if (a.nodes.size() < 2) continue;
        const Growth way = growth(arm);
        const std::size_t start = way.way.size() - a.nodes.size();
        for (std::size_t i = start; i < way.way.size(); ++i) {
            const double time = way.reached[std::max(i, start + 1)];
            const CrackNode& node = arms_.nodes()[way.way[i]];
            const double length = node.distance - arms_.nodes()[a.nodes.front()].distance;
            const ArmMoment moment{arm,   a.parent, time, arms_.graph().vertices[node.vertex], speed_at(way, time),
                                   length};
            table.rows.push_back(values_of(arm_columns(), moment));
        }
    }
    return table;
}

}  // namespace knap
