#pragma once
// What the cracks did in the course of a run: tip speed, first growth, first branching.
#include "observe/crack_graph.hpp"

#include <deque>
#include <optional>
#include <utility>

namespace knap {

/// Speed of a tip from its path length, which grows in jumps of an edge: the slope of the least-squares line through the last
/// stretch of the history in which it grew by `window` on top of its largest single jump. N edges in a window leave a relative error
/// of about 1/N^2 of the staircase in the slope; one jump J raises it by 1.5 J/window at most. It belongs to the middle of the stretch.
class TipSpeed {
public:
    explicit TipSpeed(double window) : window_(window) {}  // [m]

    void add(double time, double length);    // [s], [m]; times ascend, a length below the last one counts as the last one
    void restart();                          // forgets the past; the next length is where it goes on from
    double speed() const { return speed_; }  // [m/s]; 0 as long as it is not known

private:
    bool long_enough(std::size_t begin) const;
    double slope() const;

    double window_;
    std::deque<std::pair<double, double>> samples_;  // time, length
    double speed_ = 0;
};

struct FirstBranching {
    double time;    // [s] when the shorter arm's first interface was seen broken (not when the arm had become long enough to count)
    Vec2 position;  // [m]
};

class CrackHistory {
public:
    CrackHistory(InterfaceGraph graph, const CrackOptions& options);

    /// Cracks at a later time; one status per interface.
    const CrackPattern& snapshot(double time, std::span<const InterfaceStatus> status);

    const CrackPattern& pattern() const { return pattern_; }                   // of the last snapshot
    double tip_speed() const { return speed_.speed(); }                        // [m/s] of the main tip; 0 as long as it is not known
    double max_tip_speed() const { return max_speed_; }                        // [m/s]
    std::optional<double> first_growth_time() const { return first_growth_; }  // [s] first snapshot with a counted crack
    const std::optional<FirstBranching>& first_branching() const { return first_branching_; }
    const InterfaceGraph& graph() const { return graph_; }

private:
    InterfaceGraph graph_;
    CrackOptions options_;
    CrackPattern pattern_;
    TipSpeed speed_;
    double max_speed_ = 0;
    std::optional<double> first_growth_;
    std::optional<FirstBranching> first_branching_;
    std::vector<double> broken_since_;  // [s] per interface: first snapshot that saw it broken; infinite before
};

}  // namespace knap
