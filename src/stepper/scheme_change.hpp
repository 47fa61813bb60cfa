#pragma once
// bulk = "auto": when a run changes between the two schemes, and how its state does.
//
//     implicit -> explicit   a step is not resolved, and it is no larger than the smallest one (StepLimits::cracking):
//                            the run goes on with explicit steps from its start. Larger ones are repeated with a
//                            quarter of their size, which finds the moment. Not resolved is a step that
//                              has no unique solution (Assumption 1: K and the softening slopes are no longer positive
//                                definite, so a crack runs) or none that was found
//                              misses the work of cohesion: law lag > 1/20 of the energy that the step consumed
//                              begins the damage far below the strength: it consumes more than all before, and the
//                                strain energy rises by a tenth. With theta = 1/2 the law bounds the stress of its
//                                middle, and its end lies beyond by half of what rose, by all of it in one step from 0
//                              leaves the body in motion: kinetic energy > 10 quiet_below U, in a step in which a
//                                load only begins 100 quiet_below U; U: strain energy and what interfaces consumed,
//                                at least the fracture energy of the weakest point (both may be near 0 at first)
//     explicit -> implicit   for quiet_for after that step, the kinetic energy was at most quiet_below U, whether or
//                            not interfaces softened: what softens without motion follows its load. As long as it is
//                            above quiet_below times the strain energy alone (pieces hardly have any; at least that
//                            point) and halves within every quiet_for, damping and contacts still bring them to
//                            rest, and explicit steps go on. An implicit stage that lasts no longer than this
//                            waiting time doubles the next one, up to 16 times.
//                            Motion that is steady is as good as rest: what slides or drifts with the same speed,
//                            whose kinetic energy would change by quiet_below U in the largest step at the rate of the
//                            last quiet_for. From then on until it is quiet, implicit steps judge the change of the
//                            kinetic energy in a step in the place of the energy.
//
// Between steps the explicit scheme has velocities of the middle of the last step, the implicit one those of its end:
//
//     implicit -> explicit   last step 0: the first kick is that of half a step, v+ = v + h/2 M^-1 (f + ...)
//     explicit -> implicit   a last explicit step of nearly no length (closing_part of a step) has the kick of the
//                            other half; then 1/2 u_n' K u_n+1 becomes 1/2 u' K u
//
// The first implicit step has theta = 1/(1 + e), the others 1/2: with 1/2 a touching pair keeps half of its approach,
// w_N >= -|V_N|/2, and round a vertex these bounds contradict each other by the rounding of the explicit rates (1e-10
// m/s), which has no solution but sliding of all its points. With theta = 1/(1 + e) the bounds of touching pairs are 0.
//
// Both are steps of the leapfrog with a change of its size, whose energy is booked in step_change_work: the energy
// identity holds to rounding, and every impulse is counted once.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

struct SchemeChangeOptions {
    double explicit_step = 0;   // [s] 0: the run has one scheme
    double largest_step = 0;    // [s] implicit
    double quiet_below = 1e-4;  // [-] kinetic energy over U of a body at which large steps go on
    double quiet_for = 0;       // [s] for which it must be quiet
    double weakest_point = 0;   // [J] fracture energy of a point: motion that is small against it breaks nothing
};

/// [-] Of the step before: the length of the step that ends a stage of the leapfrog.
inline constexpr double closing_part = 1. / 1024;

/// Whether an implicit step over h [s] from a state is the first one after explicit steps: others are at most twice as
/// long as the step before.
inline bool begins_implicit_stage(const State& state, double h) {
    return state.last_step > 0 && state.last_step <= closing_part * h;
}

/// A state with velocities of this moment goes on with explicit steps.
void begin_leapfrog(State& state);
/// A state with velocities of the middle of its step goes on with implicit steps.
void begin_theta_scheme(State& state);

enum class StepFault { none, motion, cohesive_work };

class SchemeChange {
public:
    explicit SchemeChange(const SchemeChangeOptions& options) : options_(options) {}

    /// With the energies of another run at its end.
    void start_from(const SchemeChange& earlier) { surface_ = earlier.surface_, strain_ = earlier.strain_; }

    /// Whether an implicit step resolves what happened in it.
    StepFault fault(const StepReport& report) const;

    /// A step that counts, of either scheme, from `begin` over h [s].
    void after_step(const State& begin, double h, const StepReport& report);
    /// An implicit step from `time` over h [s] that does not count.
    void rejected(double time, double h) { busy_until_ = time + h; }
    bool is_beyond_rejected(double time) const { return time >= busy_until_; }
    void to_explicit(double time);
    void to_implicit(double time, const StepReport& closing);
    /// The closing step was not possible.
    void stay_explicit(double time) { quiet_since_ = time; }

    /// [s] Of an explicit stage, if the body is quiet from now on.
    double earliest_end() const { return std::max(quiet_since_, busy_until_) + waiting_time(); }
    bool is_quiet(double time) const { return time >= earliest_end() && (at_rest_ || !calms_down_); }

    template <class Archive>
    void serialize(Archive& archive) {
        archive(surface_, strain_, quiet_since_, busy_until_, changed_, patience_);
        archive(at_rest_, calms_down_, steady_, kinetic_, least_, most_, look_again_);
    }

private:
    double waiting_time() const { return patience_ * options_.quiet_for; }
    /// [J] Kinetic energy that is small against this energy.
    double quiet_part(double energy) const { return options_.quiet_below * std::max(energy, options_.weakest_point); }

    SchemeChangeOptions options_;
    double surface_ = 0, strain_ = 0;     // [J] Psi and strain energy after the last step
    double quiet_since_ = 0;              // [s]
    double busy_until_ = 0;               // [s] the end of the last implicit step that did not count
    double changed_ = -infinity;          // [s] the last change
    double patience_ = 1;                 // [-]
    bool at_rest_ = false;                // the kinetic energy is below a part of the strain energy alone
    bool calms_down_ = true;              // it has halved within quiet_for
    bool steady_ = false;                 // it hardly changed within quiet_for, and has not been quiet since
    double kinetic_ = infinity;           // [J] when that was looked at; of implicit steps after the last one
    double least_ = infinity, most_ = 0;  // [J] since then
    double look_again_ = 0;               // [s]
};

}  // namespace knap
