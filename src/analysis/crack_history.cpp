#include "analysis/crack_history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace knap {

CrackOptions crack_options(double extent, double process_zone, double fastest, Index edges_per_side) {
    return {.arm_edges = 10 * edges_per_side,
            .short_arm_edges = 5 * edges_per_side,
            .short_arm_length = 0.05 * extent,
            .gap_edges = 2 * edges_per_side,
            .chord_edges = 10 * edges_per_side,
            .speed_edges = 20 * edges_per_side,
            .speed_length = 1.5 * process_zone,
            .start_edges = 5 * edges_per_side,
            .fastest = fastest};
}

double speed_over_window(std::span<const std::pair<double, double>> samples, double window, double least) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (samples.size() < 3 || samples.back().second < least * (1 - 1e-9)) return unknown;
    const double end = samples.back().second, now = samples.back().first;
    std::size_t first = samples.size() - 1, last = samples.size() - 1;  // of the growth
    while (first > 0 && end - samples[first].second < window) --first;
    while (last > first && samples[last - 1].second == end) --last;
    const double duration = samples[last].first - samples[first].first;
    std::size_t begin = samples.size() - 3;
    while (begin > 0 && now - samples[begin].first < duration * (1 - 1e-9)) --begin;
    const auto used = samples.subspan(begin);
    if (used.front().second == used.back().second) return 0;
    double mean_time = 0, mean_position = 0;
    for (const auto& [t, s] : used) mean_time += t, mean_position += s;
    mean_time /= static_cast<double>(used.size());
    mean_position /= static_cast<double>(used.size());
    double ts = 0, tt = 0;
    for (const auto& [t, s] : used) {
        ts += (t - mean_time) * (s - mean_position);
        tt += (t - mean_time) * (t - mean_time);
    }
    return ts / tt;
}

CrackHistory::CrackHistory(InterfaceGraph graph, const CrackOptions& options) : arms_(std::move(graph), options), options_(options) {}

const CrackPattern& CrackHistory::snapshot(double time, std::span<const InterfaceStatus> status) {
    times_.push_back(time);
    arms_.grow(time, status);
    add_lengths();
    find_speeds();
    find_main();
    return pattern_;
}

void CrackHistory::add_lengths() {
    const auto length = [&](const std::vector<Index>& edges) {
        double sum = 0;
        for (const Index e : edges) sum += arms_.graph().length[e];
        return sum;
    };
    const CrackedEdges& edges = arms_.edges();
    pattern_.n_broken = static_cast<Index>(edges.broken().size());
    pattern_.n_damaged = static_cast<Index>(edges.damaged().size());
    pattern_.broken_length = length(edges.broken());
    pattern_.damaged_length = length(edges.damaged());
}

CrackTip CrackHistory::tip_of(Index arm) const {
    const CrackNode& node = arms_.nodes()[arms_.arms()[arm].tip()];
    return {arm, node.vertex, arms_.graph().vertices[node.vertex], arms_.arms()[arm].path_length, speeds_[arm], node.ends};
}

void CrackHistory::find_speeds() {
    for (std::size_t i = 0; i < arms_.arms().size(); ++i) {
        const Index arm = static_cast<Index>(i), tip = arms_.arms()[i].tip();
        if (i == speeds_.size()) speeds_.push_back(unknown), tips_.push_back(-1);
        if (tips_[i] == tip && speeds_[i] == 0) continue;  // it stands
        tips_[i] = tip;
        speeds_[i] = speed_at(growth(arm), times_.back());
    }
}

CrackHistory::Growth CrackHistory::growth(Index arm) const {
    const std::vector<CrackNode>& nodes = arms_.nodes();
    Growth growth{.way = arms_.way_in_crack(arms_.arms()[arm].tip())};
    growth.reached.resize(growth.way.size());
    double time = std::numeric_limits<double>::infinity();
    for (std::size_t i = growth.way.size(); i-- > 1;) growth.reached[i] = time = std::min(time, nodes[growth.way[i]].since);
    growth.reached[0] = time;  // waiting for the first growth is no part of it

    const std::vector<double> position = along_chords(vertices_of(growth.way));
    const double edge = position.back() / static_cast<double>(std::max<std::size_t>(growth.way.size() - 1, 1));
    growth.window = std::max(options_.speed_edges * edge, options_.speed_length);
    const double burst = options_.start_edges * edge * (1 + 1e-9);
    growth.least = std::max(options_.start_edges * edge, 0.25 * growth.window);
    // what got ahead of the fastest wave by more than a burst of edges was not run through, but joined
    growth.run.assign(position.size(), 0);
    for (std::size_t i = 1, before = 0; i < position.size(); ++i) {
        growth.run[i] = growth.run[i - 1] + position[i] - position[i - 1];
        const double time = growth.reached[i] - growth.reached[before], ahead = growth.run[i] - growth.run[before] - (time > 0 ? options_.fastest * time : 0);
        while (ahead > burst && i + 1 < position.size() && growth.reached[i + 1] == growth.reached[i]) ++i;
        if (ahead > burst) std::fill(growth.run.begin() + static_cast<std::ptrdiff_t>(before), growth.run.begin() + static_cast<std::ptrdiff_t>(i + 1), growth.run[before]);
        if (ahead <= 0 || ahead > burst) before = i;
    }
    return growth;
}

/// How far the tip had run at each snapshot from one time to another.
CrackHistory::Samples CrackHistory::samples(const Growth& growth, double from, double to) const {
    Samples samples;
    auto next = growth.reached.begin();
    for (auto t = std::lower_bound(times_.begin(), times_.end(), std::max(from, growth.reached.front())); t != times_.end() && *t <= to; ++t) {
        next = std::upper_bound(next, growth.reached.end(), *t);
        samples.emplace_back(*t, growth.run[next - growth.reached.begin() - 1]);
    }
    return samples;
}

/// What no tip can have is none.
double CrackHistory::known_speed(const Samples& samples, double window, double least) const {
    const double speed = speed_over_window(samples, window, least);
    return speed <= options_.fastest ? speed : unknown;
}

double CrackHistory::speed_at(const Growth& growth, double time) const {
    const auto reached = std::upper_bound(growth.reached.begin(), growth.reached.end(), time);
    if (reached == growth.reached.begin()) return unknown;
    const double begin = growth.run[reached - growth.reached.begin() - 1] - growth.window;
    const auto first = std::upper_bound(growth.run.begin(), growth.run.end(), begin) - growth.run.begin();  // in the window
    // three snapshots before the first of the window, so that there are three however few fall into it
    const auto at = std::lower_bound(times_.begin(), times_.end(), growth.reached[first]) - times_.begin();
    return known_speed(samples(growth, times_[std::max<std::ptrdiff_t>(at - 3, 0)], time), growth.window, growth.least);
}

double CrackHistory::mean_tip_speed() const {
    if (main_arm_ < 0) return unknown;
    const Growth way = growth(main_arm_);
    const auto half = std::lower_bound(way.run.begin(), way.run.end(), 0.5 * way.run.back()) - way.run.begin();
    const Samples second_half = samples(way, way.reached[half], way.reached.back());
    return second_half.empty() ? unknown : known_speed(second_half, second_half.back().second - second_half.front().second, way.least);
}

double CrackHistory::max_tip_speed() const {
    double largest = mean_tip_speed();  // this too is one over a long growth
    for (std::size_t arm = 0; arm < arms_.arms().size(); ++arm) {
        const Growth way = growth(static_cast<Index>(arm));
        for (std::size_t i = way.way.size() - arms_.arms()[arm].nodes.size(); i < way.way.size(); ++i)
            if (way.run[i] >= 0.5 * way.window * (1 - 1e-9)) largest = std::fmax(largest, speed_at(way, way.reached[i]));  // ignores what is not known
    }
    return largest;
}

std::vector<Index> CrackHistory::vertices_of(std::vector<Index> nodes) const {
    for (Index& n : nodes) n = arms_.nodes()[n].vertex;
    return nodes;
}

/// Distances from the first vertex: between knots a chord apart the edges share the chord's length.
std::vector<double> CrackHistory::along_chords(const std::vector<Index>& vertices) const {
    const auto distance = [&](std::size_t a, std::size_t b) { return (arms_.graph().vertices[vertices[b]] - arms_.graph().vertices[vertices[a]]).norm(); };
    std::vector<double> position(vertices.size(), 0);
    for (std::size_t knot = 0; knot + 1 < vertices.size();) {
        const std::size_t end = std::min(knot + static_cast<std::size_t>(options_.chord_edges), vertices.size() - 1);
        double along = 0;
        for (std::size_t k = knot; k < end; ++k) along += distance(k, k + 1), position[k + 1] = along;
        const double chord = distance(knot, end);
        for (std::size_t k = knot + 1; k <= end; ++k) position[k] = position[knot] + (along > 0 ? position[k] * chord / along : 0);
        knot = end;
    }
    return position;
}

void CrackHistory::find_main() {
    const auto& arms = arms_.arms();
    pattern_.tips.clear();
    const auto grew_at = [&](double time) { first_growth_ = std::min(first_growth_.value_or(time), time); };
    double length = 0;
    const std::vector<std::uint8_t> passed = arms_.passed();
    Index longest = -1;
    for (std::size_t i = 0; i < arms.size(); ++i) {
        const Index arm = static_cast<Index>(i);
        length += arms_.length(arm);
        const CrackTip tip = tip_of(arm);
        if (!tip.arrived && !passed[i] && arms[i].nodes.size() > 1) pattern_.tips.push_back(tip);
        for (std::size_t k = 1; k < arms[i].nodes.size(); ++k) grew_at(arms_.nodes()[arms[i].nodes[k]].since);
        if (longest < 0 || arms[i].path_length > arms[longest].path_length) longest = arm;
    }
    pattern_.n_cracks = arms_.n_cracks();
    pattern_.n_branches = static_cast<Index>(arms_.branchings().size());
    std::vector<Index> vertices;
    if (longest >= 0) {
        if (main_arm_ < 0 || arms[longest].path_length > arms[main_arm_].path_length) main_arm_ = longest;
        pattern_.main_end = tip_of(main_arm_);
        pattern_.main_start = arms_.cracks()[arms_.first_of(arms[main_arm_].crack)].start;
        vertices = vertices_of(arms_.way(arms[main_arm_].tip()));
    } else if (const LooseStretch& loose = arms_.longest_loose(); loose.length > 0) {
        vertices = loose.way;
        length = loose.length;
        for (const Index e : loose.edges) grew_at(arms_.edges().since(e));
        pattern_.n_cracks = 1;
        pattern_.main_start = loose.start;
        pattern_.main_end = {-1, vertices.back(), arms_.graph().vertices[vertices.back()], 0, unknown, loose.ends};
        if (!loose.ends) pattern_.tips.push_back(*pattern_.main_end);
    }
    pattern_.crack_length = std::max(pattern_.crack_length, length);
    if (!vertices.empty()) pattern_.main_length = std::max(pattern_.main_length, along_chords(vertices).back());
}

CrackHistory::Past CrackHistory::conclude() {
    Past past{.main = std::vector<double>(times_.size(), 0), .all = std::vector<double>(times_.size(), 0), .tip = {}};
    past.tip.resize(times_.size());
    const auto line = [&](double since) { return std::lower_bound(times_.begin(), times_.end(), since) - times_.begin(); };
    const std::vector<CrackNode>& nodes = arms_.nodes();
    for (const CrackNode& node : nodes)
        if (node.arm >= 0 && node.parent >= 0) past.all[line(node.since)] += node.distance - nodes[node.parent].distance;
    if (main_arm_ >= 0) {
        const std::vector<Index> way = arms_.way(arms_.arms()[main_arm_].tip());
        const std::vector<double> position = along_chords(vertices_of(way));
        for (std::size_t i = 1; i < way.size(); ++i) {  // through a crack that goes on with another one the way leads back to its start first
            const Index later = nodes[way[i]].parent == way[i - 1] ? way[i] : way[i - 1];
            if (position[i] > position[i - 1]) past.main[line(nodes[later].since)] += position[i] - position[i - 1];
        }
        const Growth ran = growth(main_arm_);
        for (std::size_t i = line(ran.reached.front()); i < times_.size(); ++i) {
            const Index tip = ran.way[std::upper_bound(ran.reached.begin(), ran.reached.end(), times_[i]) - ran.reached.begin() - 1];
            const bool arrived = tip == ran.way.back() && nodes[tip].ends;
            past.tip[i] = {main_arm_, nodes[tip].vertex, arms_.graph().vertices[nodes[tip].vertex], nodes[tip].distance, speed_at(ran, times_[i]), arrived};
        }
    }
    std::partial_sum(past.main.begin(), past.main.end(), past.main.begin());
    if (main_arm_ >= 0) pattern_.main_length = past.main.back();
    std::partial_sum(past.all.begin(), past.all.end(), past.all.begin());
    return past;
}

std::span<const Output> CrackHistory::arm_columns() {
    static constexpr std::array columns{Output{"arm", "", "its number, from 0 in the order of their beginning"},
                                        Output{"parent", "", "number of the arm that it left; -1: the first of its crack"},
                                        Output{"time", "s", "when its tip had come past this place"},
                                        Output{"x", "m", "place of a vertex of the arm"},
                                        Output{"y", "m", "likewise"},
                                        Output{"speed", "m/s", "of its tip then"},
                                        Output{"length", "m", "of the arm up to there, along edges"}};
    return columns;
}

std::vector<std::vector<double>> CrackHistory::arm_rows() const {
    std::vector<std::vector<double>> rows;
    for (std::size_t arm = 0; arm < arms_.arms().size(); ++arm) {
        const CrackArm& a = arms_.arms()[arm];
        if (a.nodes.size() < 2) continue;
        const Growth way = growth(static_cast<Index>(arm));
        const std::size_t start = way.way.size() - a.nodes.size();
        for (std::size_t i = start; i < way.way.size(); ++i) {
            const double time = way.reached[std::max(i, start + 1)];
            const CrackNode& node = arms_.nodes()[way.way[i]];
            const Vec2& x = arms_.graph().vertices[node.vertex];
            const double length = node.distance - arms_.nodes()[a.nodes.front()].distance;
            rows.push_back({static_cast<double>(arm), static_cast<double>(a.parent), time, x.x(), x.y(), speed_at(way, time), length});
        }
    }
    return rows;
}

std::optional<FirstBranching> CrackHistory::first_branching() const {
    const auto& all = arms_.branchings();
    if (all.empty()) return {};
    const Branching& first = *std::min_element(all.begin(), all.end(), [](const Branching& a, const Branching& b) { return a.time < b.time; });
    return FirstBranching{first.time, arms_.graph().vertices[arms_.nodes()[first.node].vertex]};
}

}  // namespace knap
