#pragma once
// Cracks over the course of a run: lengths, tips and their speeds, first growth, first branching.
#include "analysis/crack_arms.hpp"
#include "output/history_csv.hpp"
#include "output/outputs.hpp"

#include <optional>
#include <utility>

namespace knap {

/// Tip speed from the growth of a path (time [s], position [m] from the start of the crack), both ascending, the
/// present last; between these moments the position is linear. It is the slope of the least-squares line through the
/// last T seconds, all of them with the same weight, where T is the duration of the last growth by `window` [m]. It
/// decreases while a tip stands and is zero once it has stood for T. NaN while the position is less than `min_growth`
/// [m], and where all of the growth came at once.
double speed_over_window(std::span<const std::pair<double, double>> samples, double window, double min_growth);

/// The far end of an arm.
struct CrackTip {
    Index arm;  // its number does not change
    Index vertex;
    Vec2 position;       // [m]
    double path_length;  // [m] from the start of the crack, along edges
    double speed;        // [m/s] NaN while unknown
    bool arrived;        // at the boundary, a pre-crack or another arm: no longer a tip

    void serialize(auto& archive) { archive(arm, vertex, position, path_length, speed, arrived); }
};

/// All cracks at one time.
struct CrackPattern {
    double broken_length = 0;   // [m] of all interfaces that broke in the run, also on twigs or isolated
    double damaged_length = 0;  // [m] of all interfaces that are damaged but not broken
    Index n_broken = 0, n_damaged = 0;
    double crack_length = 0;  // [m] of all arms, along edges
    double main_length = 0;   // [m] from the start of the main crack to its tip, along chords
    Index n_cracks = 0;
    Index n_branches = 0;
    CrackStart main_start = CrackStart::none;
    std::optional<CrackTip> main_end;  // tip of the main crack; none before anything broke
    std::vector<CrackTip> tips;        // that have not arrived

    void serialize(auto& archive) {
        archive(broken_length, damaged_length, n_broken, n_damaged, crack_length, main_length, n_cracks, n_branches,
                main_start, main_end, tips);
    }
};

struct FirstBranching {
    double time;    // [s] when both arms had started (not when the shorter one was long enough to count)
    Vec2 position;  // [m]
};

class CrackHistory {
public:
    CrackHistory(InterfaceGraph graph, const CrackOptions& options);

    /// Continues to a later time [s] with the edges whose status changed, as CrackedEdges::add. `work` [J]: of all
    /// interfaces until then. In every step: what is found must not depend on the times of snapshots.
    void grow(double time, std::span<const EdgeStatus> changed, double work = 0);
    /// The pattern at a time [s] up to which it has grown.
    const CrackPattern& snapshot(double time);
    /// Both, with one status per interface.
    const CrackPattern& snapshot(double time, std::span<const InterfaceStatus> status);

    /// After an excavation, which makes new faces, or of a continued run.
    void set_graph(InterfaceGraph graph) { arms_.set_graph(std::move(graph)); }

    /// After a refinement of the mesh.
    void renumber(InterfaceGraph graph, const Renumbering& numbers);

    /// The clock is set back by `time` [s]: what cracked before has negative times.
    void set_back(double time) {
        arms_.set_back(time);
        for (double& t : times_) t -= time;
        for (auto& [t, work] : works_) t -= time;
    }

    const CrackPattern& pattern() const { return pattern_; }  // of the last snapshot
    const CrackArms& arms() const { return arms_; }
    double tip_speed() const {
        return pattern_.main_end ? pattern_.main_end->speed : unknown;
    }  // [m/s] of the main tip
    /// [m/s] Largest speed of any tip over at least half a window of growth; NaN when none grew so far.
    double max_tip_speed() const;
    /// [m/s] Of the main tip over the second half of its path, at most max_tip_speed(); NaN while unknown.
    double mean_tip_speed() const;
    /// [deg] Acute angle between the x axis and the least-squares line through the vertices of the main crack (the
    /// axis of least inertia); NaN without one.
    double main_angle() const;
    /// [s] First edge of the cracks that count; while none does, of the longest stretch of broken edges.
    std::optional<double> first_growth_time() const;
    /// Work of all interfaces [J] and growth of the main crack along chords [m], between two parts of its length.
    struct Advance {
        double work, length;
    };
    std::optional<Advance> advance_between(double from, double to) const;
    std::optional<FirstBranching> first_branching() const;

    /// The final main crack and the final arms, from their first edges on: what had cracked of them at each snapshot,
    /// and the tip of the main crack. pattern().main_length becomes the last of these lengths.
    struct Past {
        std::vector<double> main, all;             // [m] main crack along chords, all arms along edges
        std::vector<std::optional<CrackTip>> tip;  // none before the first edge of its crack
    };
    Past conclude();
    /// arms.csv: for each arm its start and then its edges, when the tip passed their far ends.
    History arm_table() const;

    void serialize(auto& archive) { archive(arms_, pattern_, times_, speeds_, tips_, main_arm_, works_); }

private:
    /// The path of a tip from the start of its crack.
    struct Growth {
        std::vector<Index> way;             // nodes
        std::vector<double> reached;        // [s] when this edge or one farther on had cracked
        std::vector<double> run;            // [m] that the tip ran to get there, along chords
        double window = 0, min_growth = 0;  // [m] see speed_over_window
    };
    using Moments = std::vector<std::pair<double, double>>;  // time [s], and a position [m] or a work [J]

    Growth growth(Index arm) const;
    template <class Visit>
    void for_each_main_edge(const Visit& visit) const;
    double speed_at(const Growth& growth, double time) const;
    double bounded_speed(std::span<const std::pair<double, double>> growth, double window, double min_growth) const;
    void find_main();
    std::vector<double> along_chords(const std::vector<Index>& vertices) const;
    std::vector<Index> vertices_of(std::vector<Index> nodes) const;
    CrackTip tip_at(Index arm, Index node, double speed, bool arrived) const;
    CrackTip tip_of(Index arm) const;

    static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

    CrackArms arms_;
    CrackOptions options_;
    CrackPattern pattern_;
    std::vector<double> times_;   // [s] of the snapshots
    std::vector<double> speeds_;  // [m/s] per arm
    std::vector<Index> tips_;     // per arm: the node of the tip to which the speed belongs
    Index main_arm_ = -1;
    Moments works_;  // of all interfaces, when edges cracked
};

/// One line of cracks.csv.
struct CrackMoment {
    double time;  // [s]
    const CrackHistory& history;
    double rayleigh_speed;  // [m/s], 0: unknown
};
std::span<const Measure<CrackMoment>> crack_columns();

/// One line of arms.csv.
struct ArmMoment {
    Index arm, parent;
    double time;    // [s]
    Vec2 position;  // [m]
    double speed;   // [m/s]
    double length;  // [m]
};
std::span<const Measure<ArmMoment>> arm_columns();

}  // namespace knap
