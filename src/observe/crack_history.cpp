#include "observe/crack_history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {

double speed_over_window(std::span<const std::pair<double, double>> samples, double window) {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (samples.empty()) return unknown;
    std::size_t first = samples.size();
    while (first > 0 && samples.back().second - samples[first - 1].second < window) --first;
    if (first == 0) return unknown;
    const auto used = samples.subspan(first - 1);
    if (used.size() < 3) return unknown;
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

std::vector<std::pair<double, double>> CrackHistory::front() const {
    std::vector<std::pair<double, double>> broken;  // time, position
    for (const PathStep& step : pattern_.main_path) broken.emplace_back(broken_since_[step.interface], step.position);
    std::sort(broken.begin(), broken.end());
    std::vector<std::pair<double, double>> front;
    double position = 0;
    std::size_t next = 0;
    for (const double time : times_) {
        for (; next < broken.size() && broken[next].first <= time; ++next) position = std::max(position, broken[next].second);
        if (position > 0) front.emplace_back(time, position);  // waiting for the first growth is no part of it
    }
    return front;
}

CrackHistory::CrackHistory(InterfaceGraph graph, const CrackOptions& options)
    : graph_(std::move(graph)),
      options_(options),
      broken_since_(graph_.ends.size(), std::numeric_limits<double>::infinity()) {}

const CrackPattern& CrackHistory::snapshot(double time, std::span<const InterfaceStatus> status) {
    for (std::size_t i = 0; i < status.size(); ++i) {
        if (status[i] == InterfaceStatus::broken && broken_since_[i] > time) broken_since_[i] = time;
    }
    times_.push_back(time);
    pattern_ = find_cracks(graph_, status, options_);
    speed_ = speed_over_window(front(), options_.speed_window);
    max_speed_ = std::fmax(max_speed_, speed_);  // ignores what is not known

    if (!first_growth_ && !pattern_.counted.empty()) first_growth_ = time;
    if (!first_branching_ && !pattern_.branchings.empty()) {
        const auto first = std::min_element(pattern_.branchings.begin(), pattern_.branchings.end(), [&](const Branching& a, const Branching& b) {
            return broken_since_[a.first_interface] < broken_since_[b.first_interface];
        });
        first_branching_ = {broken_since_[first->first_interface], first->position};
    }
    return pattern_;
}

}  // namespace knap
