#include "observe/crack_history.hpp"

#include <algorithm>
#include <limits>

namespace knap {

void TipSpeed::restart() {
    samples_.clear();
    speed_ = 0;
}

void TipSpeed::add(double time, double length) {
    if (!samples_.empty()) length = std::max(length, samples_.back().second);
    // waiting for the first growth is no part of it
    if (samples_.size() == 1 && samples_.front().second == length) samples_.clear();
    samples_.emplace_back(time, length);
    while (long_enough(1)) samples_.pop_front();
    if (long_enough(0)) speed_ = slope();
}

bool TipSpeed::long_enough(std::size_t begin) const {
    if (samples_.size() < begin + 3) return false;
    double largest_jump = 0;
    for (std::size_t i = begin + 1; i < samples_.size(); ++i)
        largest_jump = std::max(largest_jump, samples_[i].second - samples_[i - 1].second);
    const double besides = samples_.back().second - samples_[begin].second - largest_jump;
    return besides > 0 && besides >= window_;
}

double TipSpeed::slope() const {
    double mean_time = 0, mean_length = 0;
    for (const auto& [t, l] : samples_) mean_time += t, mean_length += l;
    mean_time /= static_cast<double>(samples_.size());
    mean_length /= static_cast<double>(samples_.size());
    double tl = 0, tt = 0;
    for (const auto& [t, l] : samples_) {
        tl += (t - mean_time) * (l - mean_length);
        tt += (t - mean_time) * (t - mean_time);
    }
    return tl / tt;
}

CrackHistory::CrackHistory(InterfaceGraph graph, const CrackOptions& options)
    : graph_(std::move(graph)),
      options_(options),
      speed_(options.speed_window),
      broken_since_(graph_.ends.size(), std::numeric_limits<double>::infinity()) {}

const CrackPattern& CrackHistory::snapshot(double time, std::span<const InterfaceStatus> status) {
    for (std::size_t i = 0; i < status.size(); ++i) {
        if (status[i] == InterfaceStatus::broken && broken_since_[i] > time) broken_since_[i] = time;
    }
    CrackPattern now = find_cracks(graph_, status, options_);

    // two cracks that become one, or one that becomes longer because it is measured from elsewhere, did not run that far
    const bool other_start = now.main_start != pattern_.main_start && pattern_.main_start != CrackStart::none;
    const bool coalesced = now.n_cracks < pattern_.n_cracks;
    if ((other_start || coalesced) && now.main_length > pattern_.main_length + options_.speed_window) speed_.restart();
    speed_.add(time, now.main_length);
    max_speed_ = std::max(max_speed_, speed_.speed());

    if (!first_growth_ && !now.counted.empty()) first_growth_ = time;
    if (!first_branching_ && !now.branchings.empty()) {
        const auto first = std::min_element(now.branchings.begin(), now.branchings.end(), [&](const Branching& a, const Branching& b) {
            return broken_since_[a.first_interface] < broken_since_[b.first_interface];
        });
        first_branching_ = {broken_since_[first->first_interface], first->position};
    }
    pattern_ = std::move(now);
    return pattern_;
}

}  // namespace knap
