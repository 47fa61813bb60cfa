#pragma once
// The size of the next step: the policy outside of the stepper, which only says what it thinks of the step it was
// given.
//
//     while the body is intact     the largest step
//     cohesion falls               in a step larger than the cracking step: repeated with that one, which is the
//     largest from then on the stepper rejects          repeated with half the step; at Assumption 1 no larger than the
//     cracking step ten steps without a cut      1.5 times the step, up to the largest (the policy of Collins-Craft,
//     Bourrier, Acary, CMAME 400 (2022) 115545) near the end                 what is left, or two halves of it, so that
//     the last step lands on the end and is no sliver
//
// It depends on nothing but the reports, so a run does the same steps every time and whenever it is stopped.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace knap {

/// All [s].
struct StepLimits {
    double largest;   // while nothing breaks
    double cracking;  // from the first loss of cohesion on; `largest` where nothing else is wanted
    double smallest;  // a run that would need a smaller one stops
    double end;       // of the simulated time
};

enum class CutbackReason { softening, release, assumption_1, not_converged };
inline constexpr std::array cutback_reasons{CutbackReason::softening, CutbackReason::release,
                                            CutbackReason::assumption_1, CutbackReason::not_converged};
std::string_view name_of(CutbackReason reason);   // "assumption_1", as in run.json
std::string_view describe(CutbackReason reason);  // "Assumption 1 does not hold"

/// A step that was not taken.
struct Cutback {
    CutbackReason reason;
    double time;      // [s] at its begin
    double from, to;  // [s] the step, and the one to try instead
};

class StepControl {
public:
    explicit StepControl(const StepLimits& limits);

    /// [s] The step to take from a state.
    double next(const State& begin) const;

    /// Whether that step depends on where the run ends: all before are those of a longer run.
    bool depends_on_end(const State& begin) const;

    /// What a step of size h [s] from `begin` came to: nothing where it counts, else its end must be thrown away and
    /// next() be asked again.
    std::optional<Cutback> judge(const State& begin, double h, const StepReport& report);

    /// The last cut asked for a step below the smallest one.
    bool is_stuck() const { return stuck_; }

    /// Whether a state is at `time` [s], up to what rounding adds up to over its steps.
    static bool has_reached(const State& state, double time);

    double smallest_taken() const { return smallest_taken_; }  // [s] 0 before the first step
    double largest_taken() const { return largest_taken_; }
    const std::array<std::int64_t, cutback_reasons.size()>& n_cutbacks() const {
        return n_cutbacks_;
    }                                                                     // in the order of cutback_reasons
    const StepReport& rejected_steps() const { return rejected_steps_; }  // counts of the steps that were not taken

    template <class Archive>
    void serialize(Archive& archive) {
        archive(step_, largest_, n_good_, smallest_taken_, largest_taken_, n_cutbacks_, rejected_steps_);
    }

private:
    double tolerance(const State& begin) const;  // [s]
    std::optional<CutbackReason> objection(double h, const StepReport& report) const;
    void grow();

    StepLimits limits_;
    double step_, largest_;  // [s] now, and as large as it may become again
    int n_good_ = 0;         // steps since the last change
    bool stuck_ = false;
    double smallest_taken_ = 0, largest_taken_ = 0;
    std::array<std::int64_t, cutback_reasons.size()> n_cutbacks_{};
    StepReport rejected_steps_;
};

/// Where most cohesion was lost in a step, or where a fan came apart if none was [m].
Vec2 place_of_damage(const Model& model, const State& begin, const State& end);

}  // namespace knap
