#pragma once
// The size of the next step, from the reports of the steps so far:
//
//     while the body is intact    the largest step
//     cohesion falls              in a step above the cracking step: it is repeated with the cracking step, which is
//                                 the largest one from then on
//     the step is rejected        it is repeated with half the size; under Assumption 1 with the cracking step at most
//     a hard impact               obstacles or free faces meet at a speed that covers three critical openings in a
//                                 step: it is repeated with a size that covers one, before anything is stressed; a
//                                 later one in which a point that loses cohesion opens by more than half of one, with
//                                 0.4. So until two passages of a shear wave after the last such contact; the step
//                                 grows as below, where a point then would open by at most a quarter
//     free faces lie too deep in  likewise; these, and faces that meet too fast, end the run where a thousandth of the
//     each other, or break laws   largest step does not help
//     ten steps without cutback   1.5 times the size, up to the largest (Collins-Craft, Bourrier, Acary, CMAME 400
//                                 (2022) 115545)
//     a run that changes scheme   scheme_change.hpp: implicit steps are quartered down to the cracking step and doubled
//                                 after each that counts; explicit ones have a size of their own. A size that was not
//                                 solved is tried again after 8 steps, where it fails again after 16, up to 128
//     rigid pieces ([rigid])      steps have a size of their own, in which faces that meet move by at most a fifth
//                                 of an edge, down to that of a deformable body. After a blow the body is deformable
//                                 until nothing has lost cohesion for `hold` passages of a wave; then a step of rigid
//                                 pieces is tried, which counts if it is no blow and no piece vibrates as fast as one
//     near the end                the rest, or two halves of it: the last step ends there and is no sliver
//
// It depends on the reports alone, so a run takes the same steps whenever it is interrupted.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/scheme_change.hpp"

#include <optional>
#include <string_view>

namespace knap {

/// All [s].
struct StepLimits {
    double largest;                            // while nothing breaks
    double cracking;                           // from the first loss of cohesion on
    double smallest;                           // a run that needs a smaller one stops
    double end;                                // of the simulated time
    double contact_depth = max_contact_depth;  // [-] largest, of free faces, over the length of the edge
    double critical_opening = infinity;        // [m] the smallest of the interfaces that can break
    double passage = 0;                        // [s] of a shear wave through the body
    SchemeChangeOptions change = {};
    struct Rigid {
        double step = 0;                // largest of rigid pieces; 0: there are none
        double smallest = 0;            // of rigid pieces
        double hold = 0;                // for which the body stays deformable after the last blow
        double not_before = -infinity;  // loads change until then, and what is held and may break bears them
    } rigid = {};
    bool changes() const { return change.explicit_step > 0; }
};

enum class CutbackReason {
    softening,
    release,
    assumption_1,
    contact_speed,
    contact_depth,
    contact_residual,
    not_converged,
    motion,
    cohesive_work,
    jammed,
    impact,
    blow
};
inline constexpr std::array cutback_reasons{
    CutbackReason::softening,     CutbackReason::release,       CutbackReason::assumption_1,
    CutbackReason::contact_speed, CutbackReason::contact_depth, CutbackReason::contact_residual,
    CutbackReason::not_converged, CutbackReason::motion,        CutbackReason::cohesive_work,
    CutbackReason::jammed,        CutbackReason::impact,        CutbackReason::blow};
std::string_view name_of(CutbackReason reason);   // "assumption_1", as in run.json
std::string_view describe(CutbackReason reason);  // "Assumption 1 does not hold"

/// A step that does not count and is repeated with a smaller size.
struct Cutback {
    CutbackReason reason;
    double time;                               // [s] at its start
    double from, to;                           // [s] its size, and the next one
    std::optional<Vec2> place = std::nullopt;  // [m] nothing: where the body was damaged
    double value = 0;                          // [-] of contacts and impacts: what was too large
    bool changes_to_explicit = false;          // the run goes on with explicit steps
    double explicit_until = 0;                 // [s] the earliest end of these
    bool thaws = false;                        // the body is deformable from the start of the step on
};

/// Change of a run between its two schemes.
struct SchemeChangeEvent {
    double time;           // [s]
    bool to_explicit;      // or to implicit
    CutbackReason reason;  // of a change to explicit steps

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time, to_explicit, reason);
    }
};

class StepControl {
public:
    explicit StepControl(const StepLimits& limits)
        : limits_(limits),
          step_(limits.largest),
          largest_(limits.largest),
          rigid_step_(limits.rigid.step),
          deformable_until_(limits.rigid.hold),
          change_(limits.change) {}

    /// Starts where another run was: with its step, where cutbacks had made it smaller, and with the cracking step,
    /// where its cohesion had begun to fall. The counts begin at zero.
    void start_from(const StepControl& earlier, const State& start);

    /// As after a hard impact at `time` [s].
    void go_on_after_impact(double time);

    double next(const State& begin) const;  // [s] size of the step from a state

    /// Whether that step depends on the end of the run: all earlier ones are those of a longer run.
    bool depends_on_end(const State& begin) const;

    /// The decision on a step of h [s] from `begin`: nothing where it counts; else its end state is void.
    std::optional<Cutback> judge(const State& begin, double h, const StepReport& report);

    /// Whether implicit steps can go on after the explicit ones up to this state; then it must become one of them.
    bool ends_explicit_stage(const State& now) const;
    void begin_implicit_stage(const State& now, const StepReport& closing);
    void stay_explicit(const State& now) { change_.stay_explicit(now.time); }
    const std::vector<SchemeChangeEvent>& changes() const { return changes_; }

    /// The next step of a deformable body is tried as one of rigid pieces.
    bool may_freeze(const State& now) const {
        return now.motion == Motion::thawed && now.time >= std::max(deformable_until_, limits_.rigid.not_before);
    }

    bool is_stuck() const { return stuck_; }  // the last cutback led below the smallest step
    /// [s] That step, from a state.
    double smallest_step(const State& begin, CutbackReason reason) const {
        return begin.motion == Motion::rigid ? limits_.rigid.smallest : smallest_against(reason);
    }

    /// Whether a state is at `time` [s], up to the rounding of the sum of its steps.
    static bool has_reached(const State& state, double time);

    double smallest_taken() const { return smallest_taken_; }  // [s] 0 before the first step
    double largest_taken() const { return largest_taken_; }
    double thawed_time() const { return thawed_time_; }  // [s] with [rigid]: in which pieces were deformable
    /// In the order of cutback_reasons.
    const std::array<std::int64_t, cutback_reasons.size()>& n_cutbacks() const { return n_cutbacks_; }
    const StepReport& rejected_steps() const { return rejected_steps_; }  // sum over the steps that do not count

    template <class Archive>
    void serialize(Archive& archive) {
        archive(step_, largest_, intact_, n_good_, smallest_taken_, largest_taken_, n_cutbacks_, rejected_steps_);
        archive(change_, changes_, unsolved_, patience_, struck_until_, opened_);
        archive(rigid_step_, deformable_until_, thawed_time_);
    }

private:
    double size(const State& begin) const { return begin.motion == Motion::rigid ? rigid_step_ : step_; }  // [s]
    double tolerance(const State& begin) const;                                                            // [s]
    std::optional<Cutback> judge_rigid(const State& begin, double h, const StepReport& report);
    std::optional<Cutback> reason_against(const State& begin, double h, const StepReport& report) const;
    void begin_stage(double step, double largest);
    void shorten_or_change(Cutback& cut);
    double smallest_against(CutbackReason reason) const;  // [s]
    double least_after_impact() const;                    // [s]
    bool is_struck(const State& begin) const { return begin.time < struck_until_; }

    StepLimits limits_;
    double step_, largest_;       // [s] current, and the largest from now on
    bool intact_ = true;          // no cohesion has fallen, and no step had several solutions
    int n_good_ = 0;              // steps since the last change
    double unsolved_ = infinity;  // [s] of a run that changes scheme: the last size that was not solved
    int patience_ = 0;            // steps after which it is tried again
    bool stuck_ = false;
    double struck_until_ = -1;  // [s] a hard impact is not over before
    double opened_ = 0;         // [-] StepReport::largest_opened since the step was last looked at to grow
    double rigid_step_;         // [s]
    double deformable_until_;   // [s]
    double thawed_time_ = 0;    // [s] in which pieces were deformable
    double smallest_taken_ = 0, largest_taken_ = 0;
    SchemeChange change_;
    std::vector<SchemeChangeEvent> changes_;
    std::array<std::int64_t, cutback_reasons.size()> n_cutbacks_{};
    StepReport rejected_steps_;
};

/// [-] Critical openings that an approach covers in a step from which on it is a hard impact.
inline constexpr double hard_impact = 3;

/// [m] Where most cohesion was lost in a step, or where a fan split if none was lost.
Vec2 place_of_damage(const Model& model, const State& begin, const State& end);
/// [m] Of a step from `begin` to `end`: the place of the cutback, else that of the damage; of a motion the fastest one.
Vec2 place_of(const Cutback& cut, const Model& model, const State& begin, const State& end);

}  // namespace knap
