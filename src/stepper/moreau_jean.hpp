#pragma once
// One step of the Moreau-Jean time stepping scheme for nonsmooth dynamics with extrinsic cohesive interfaces
// (Acary, Collins-Craft, Bourrier; J. J. Moreau 1988, M. Jean 1999):
//
//     M (v+ - v) = h (F - K u)_theta + H' P,     u+ = u + h v_theta,     the interface laws at the end of the step,
//
// with unknown impulses P. Two schemes solve it: explicit_scheme.hpp (lumped mass, forces at the start of the step, one
// problem per vertex) and implicit_scheme.hpp (all interfaces and the stiffness together), each with explicit or
// implicit cohesion. A third one, rigid/rigid_scheme.hpp, moves pieces that nothing can break now as rigid bodies;
// which one takes a step is in the state: State::motion, State::has_end_velocities.
#include "heat/heat_step.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/equilibrium.hpp"
#include "stepper/rigid/rigid_scheme.hpp"
#include "stepper/step_control.hpp"

#include <memory>
#include <optional>

namespace knap {

class Islands;

class MoreauJean {
public:
    explicit MoreauJean(const Model& model, const SchemeOptions& options = {});
    ~MoreauJean();

    /// With [rigid]: pieces that a blow makes deformable step by themselves within these limits, if the model allows
    /// it (islands.hpp); without this a blow rejects the step.
    void resolve_islands(const StepLimits& limits);

    /// One step of size h [s] from `begin` to `end`, which may be any earlier state of the same run: its memory is
    /// reused. After a rejected step (report.rejection) `end` is void. Throws SimulationError where the motion is no
    /// longer finite.
    StepReport step(const State& begin, double h, State& end);

    /// [s] The size of the step from a state, at most `h` [s]: implicit ones end at corners of tables over time.
    double step_size(const State& begin, double h) const;

    /// BulkScheme::automatic, after an explicit step: the step that brings the velocities to the end of all steps so
    /// far, so that implicit ones can follow (stepper/scheme_change.hpp). `end` is void after a rejection.
    StepReport close_leapfrog(const State& begin, State& end);

    /// After a step that a blow cut back (Cutback::thaws): the body is deformable from `now` on, and its next step is
    /// explicit (rigid/rigid_scheme.hpp). Of rigid pieces `end` is the state, with its report; where only the trial was
    /// one of rigid pieces `now` is.
    std::optional<StepReport> thaw(State& now, State& end);

    /// Before the first step of a run: that of an automatic bulk is implicit; with [rigid] that of pieces which vibrate
    /// or are held and can break is one of the deformable body.
    void begin(State& start) const;

    /// Static equilibrium at start.time (stepper/equilibrium.hpp).
    void start_in_equilibrium(State& start, const TellSearch& tell = {}) const {
        knap::start_in_equilibrium(model_, options_.mass, start, tell);
    }

    /// Ends a long step early, by StepGivenUp. Without it every step is completed.
    void give_up_when(GiveUp condition);

    bool is_implicit(const State& begin) const;  // the next step
    /// With the theta that an implicit step of h [s] has.
    SchemeOptions options_of(const State& begin, double h) const;
    double stable_step() const;      // [s] of explicit steps; infinite without them
    FactorSize factor_size() const;  // of the implicit scheme

private:
    bool changes() const { return options_.bulk == BulkScheme::automatic; }
    void make_scheme(bool implicit);
    StepScheme& scheme_of(const State& begin, double h);
    StepReport advance(const State& begin, double h, State& end);
    StepReport complete(const State& begin, double h, StepReport report, State& end) const;

    const Model& model_;
    SchemeOptions options_;
    GiveUp give_up_ = nullptr;
    std::unique_ptr<StepScheme> explicit_, implicit_;  // null: not used so far
    std::unique_ptr<RigidScheme> rigid_;               // null: no [rigid]
    std::unique_ptr<Islands> islands_;                 // null: all pieces become deformable together
    std::optional<HeatStep> heat_;
    bool friction_follows_slip_ = false;
};

}  // namespace knap
