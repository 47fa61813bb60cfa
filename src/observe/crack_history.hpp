#pragma once
// What the cracks did in the course of a run: tip speed, first growth, first branching.
#include "observe/crack_graph.hpp"

#include <limits>
#include <optional>
#include <utility>

namespace knap {

/// Slope of the least-squares line through the last samples (time [s], position [m], both ascending) over which the position grew by
/// `window` [m]. Growth by whole edges, N to a window, leaves a relative error of about 1/N^2 in it. NaN as long as there was no such growth.
double speed_over_window(std::span<const std::pair<double, double>> samples, double window);

struct FirstBranching {
    double time;    // [s] when the shorter arm's first interface was seen broken (not when the arm had become long enough to count)
    Vec2 position;  // [m]

    template <class Archive>
    void serialize(Archive& archive) { archive(time, position); }
};

class CrackHistory {
public:
    CrackHistory(InterfaceGraph graph, const CrackOptions& options);

    /// Cracks at a later time; one status per interface.
    const CrackPattern& snapshot(double time, std::span<const InterfaceStatus> status);

    const CrackPattern& pattern() const { return pattern_; }                   // of the last snapshot
    double tip_speed() const { return speed_; }                        // [m/s] of the main tip; NaN as long as it is not known
    double max_tip_speed() const { return max_speed_; }                        // [m/s], NaN likewise
    std::optional<double> first_growth_time() const { return first_growth_; }  // [s] first snapshot with a counted crack
    const std::optional<FirstBranching>& first_branching() const { return first_branching_; }
    const InterfaceGraph& graph() const { return graph_; }

    template <class Archive>
    void serialize(Archive& archive) {
        archive(pattern_, times_, speed_, max_speed_, first_growth_, first_branching_, broken_since_);
    }

private:
    InterfaceGraph graph_;
    CrackOptions options_;
    /// How far along its present main path the crack had come at each snapshot: the furthest interface broken by then. A stretch that
    /// broke ahead of the tip counts when it broke, not when the gap behind it closed.
    std::vector<std::pair<double, double>> front() const;

    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    CrackPattern pattern_;
    std::vector<double> times_;  // [s] of the snapshots
    double speed_ = unknown, max_speed_ = unknown;
    std::optional<double> first_growth_;
    std::optional<FirstBranching> first_branching_;
    std::vector<double> broken_since_;  // [s] per interface: first snapshot that saw it broken; infinite before
};

}  // namespace knap
