#pragma once
// What the cracks did in the course of a run: lengths, tips and their speeds, first growth, first branching.
#include "analysis/crack_arms.hpp"
#include "output/outputs.hpp"

#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace knap {

/// Slope of the least-squares line through samples (time [s], position [m] from the start of the crack), both ascending: those of the last so many seconds as
/// the last growth by `window` [m] took, three at least. So it falls to zero while a tip stands, and is zero when it has stood for as long. Growth by whole edges, N to a
/// window, leaves a relative error of about 1/N^2 in it. NaN as long as the position is less than `least`.
double speed_over_window(std::span<const std::pair<double, double>> samples, double window, double least);

/// The far end of an arm.
struct CrackTip {
    Index arm;  // its number for ever
    Index vertex;
    Vec2 position;       // [m]
    double path_length;  // [m] from the start of the crack, along edges
    double speed;        // [m/s] NaN as long as it is not known
    bool arrived;        // at the boundary, at a pre-crack or at another arm: not a tip any more

    template <class Archive>
    void serialize(Archive& archive) { archive(arm, vertex, position, path_length, speed, arrived); }
};

struct CrackPattern {
    double broken_length = 0;   // [m] of all new broken interfaces, twigs and isolated ones included
    double damaged_length = 0;  // [m] of all interfaces damaged but not broken
    Index n_broken = 0, n_damaged = 0;
    double crack_length = 0;  // [m] of all arms, along edges
    double main_length = 0;   // [m] from the start of the main crack to its tip, along chords
    Index n_cracks = 0;
    Index n_branches = 0;
    CrackStart main_start = CrackStart::none;
    std::optional<CrackTip> main_end;  // tip of the main crack; none before anything broke
    std::vector<CrackTip> tips;        // that have not arrived

    template <class Archive>
    void serialize(Archive& archive) {
        archive(broken_length, damaged_length, n_broken, n_damaged, crack_length, main_length, n_cracks, n_branches, main_start, main_end, tips);
    }
};

struct FirstBranching {
    double time;    // [s] when both arms had begun (not when the shorter one had become long enough to count)
    Vec2 position;  // [m]
};

class CrackHistory {
public:
    CrackHistory(InterfaceGraph graph, const CrackOptions& options);

    /// Cracks at a later time; one status per interface.
    const CrackPattern& snapshot(double time, std::span<const InterfaceStatus> status);

    const CrackPattern& pattern() const { return pattern_; }  // of the last snapshot
    const CrackArms& arms() const { return arms_; }
    double tip_speed() const { return pattern_.main_end ? pattern_.main_end->speed : unknown; }  // [m/s] of the main tip; NaN as long as it is not known
    /// [m/s] the largest that any tip had over at least half a window of growth; NaN when none grew so far.
    double max_tip_speed() const;
    double mean_tip_speed() const;  // [m/s] of the main tip over the second half of its way; NaN as long as it is not known, else no more than max_tip_speed()
    std::optional<double> first_growth_time() const { return first_growth_; }  // [s] first edge of a crack that counts
    std::optional<FirstBranching> first_branching() const;

    /// How much had cracked at each snapshot of what is the main crack (along chords) and of what are arms in the end (along edges), and the tip of that main crack:
    /// all of the one crack that is the longest now. pattern().main_length becomes the last of them.
    struct Past {
        std::vector<double> main, all;              // [m]
        std::vector<std::optional<CrackTip>> tip;   // none before the first edge of its own crack
    };
    Past conclude();
    /// arms.csv: for each arm its start and then its edges: when the tip came past their far ends, the length of the arm along edges then, and the speed of the tip.
    static std::span<const Output> arm_columns();
    std::vector<std::vector<double>> arm_rows() const;

    template <class Archive>
    void serialize(Archive& archive) {
        archive(arms_, pattern_, times_, speeds_, tips_, main_arm_, first_growth_);
    }

private:
    /// The way of a tip from the start of its crack.
    struct Growth {
        std::vector<Index> way;        // nodes
        std::vector<double> reached;   // [s] when this edge or one further on had cracked
        std::vector<double> run;       // [m] that the tip ran to get there, along chords
        double window = 0, least = 0;  // [m] of growth: over which a speed is fitted, from which one is known
    };
    using Samples = std::vector<std::pair<double, double>>;

    Growth growth(Index arm) const;
    Samples samples(const Growth& growth, double from, double to) const;
    double speed_at(const Growth& growth, double time) const;
    double known_speed(const Samples& samples, double window, double least) const;
    void add_lengths();
    void find_speeds();
    void find_main();
    std::vector<Index> vertices_of(std::vector<Index> nodes) const;
    std::vector<double> along_chords(const std::vector<Index>& vertices) const;
    CrackTip tip_of(Index arm) const;

    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    CrackArms arms_;
    CrackOptions options_;
    CrackPattern pattern_;
    std::vector<double> times_;   // [s] of the snapshots
    std::vector<double> speeds_;  // [m/s] per arm
    std::vector<Index> tips_;     // per arm: the node of its tip that the speed belongs to
    Index main_arm_ = -1;
    std::optional<double> first_growth_;
};

}  // namespace knap
