#pragma once
// The interfaces next to the explicit lumped bulk, whose mass couples nothing beyond a fan: every split fan is solved
// by itself and exactly (nonsmooth/fan_solver.hpp), and the cohesion follows from the openings at the end of the step.
// Explicit beta: the forces are those of the cohesion at the start. Implicit beta: of theta beta+ + (1 - theta) beta
// (nonsmooth/fan_cohesion.hpp).
//
// A corner near a rigid obstacle whose motion is given adds a link to its fan, and the obstacle as a body. Contacts
// that reach beyond a fan are those of vertex_contacts.hpp.
#include "nonsmooth/fan_cohesion.hpp"
#include "nonsmooth/fan_solver.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/obstacle_motion.hpp"
#include "stepper/common/obstacle_pairs.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/explicit/absorbing_boundary.hpp"
#include "stepper/explicit/explicit_step.hpp"
#include "stepper/explicit/rebounds.hpp"
#include "stepper/explicit/stationary_fans.hpp"

namespace knap {

/// The contacts with obstacles in a step.
struct ObstacleStep {
    ObstacleStep(const Model& model, std::span<const Dashpot> dashpots)
        : contacts(model), pairs(model, ObstaclePairs::Supports::meet), motion(model), rebounds(model, dashpots) {}

    ObstacleContacts contacts;
    ObstaclePairs pairs;
    ObstacleMotion motion;
    Rebounds rebounds;
    std::vector<GivingWay> gives;  // per contact; empty: no surface gives way
    std::vector<Vec2> impulse;     // [N s] per contact, on the body; of those within a fan

    GivingWay given_at(const ObstacleContact& contact) const {
        return gives.empty() ? GivingWay{} : gives[&contact - contacts.all().data()];
    }
};

class VertexSolver {
public:
    struct Workspace {
        SolvedFan fan, kept;
        FanSolver solver;
        std::vector<LinkCohesion> cohesion;
        std::vector<Vec2> mean_velocity;  // [m/s] guess per corner, on oblique absorbing boundaries
        StationaryWorkspace stationary;
    };

    /// `obstacles` and `absorbing` must outlive this.
    VertexSolver(const Model& model, const SchemeOptions& options, ObstacleStep& obstacles,
                 const AbsorbingBoundary& absorbing)
        : model_(model), options_(options), obstacles_(obstacles), absorbing_(absorbing) {}

    /// The problem of the fan in this step and its result, in work.fan: the bodies are its corners and then the
    /// obstacles in contact, the links its points and then these contacts.
    FanSolution solve(Index fan, const ExplicitStep& step, Workspace& work) const;

    /// Obstacles or dashpots act on the fan: its parts do not answer with their masses alone.
    bool has_outer_forces(Index fan) const {
        return std::ranges::any_of(obstacles_.contacts.of_fan(fan), [&](const auto& c) { return is_within_fan(c); }) ||
               !absorbing_.of_fan(fan).empty();
    }
    /// The contact concerns one fan: it is at a corner, and the obstacle does not give way.
    bool is_within_fan(const ObstacleContact& contact) const {
        return !contact.is_on_edge() && !model_.obstacles[contact.obstacle].is_free();
    }

    /// What solve found, to be used again.
    struct Known {
        SolvedFan fan;
        FanSolution solution;
    };

    /// Moves a split fan to the end of the step: velocities, displacements, cohesion, tractions, works. `known`: what
    /// solve would find; its fan is swapped for another one.
    void advance(Index rank, const ExplicitStep& step, Workspace& work, StepReport& report,
                 Known* known = nullptr) const;

private:
    FanSolution solve_for_mean(Index fan, const ExplicitStep& step, Workspace& work) const;
    FanSolution solve_once(Index fan, const ExplicitStep& step, bool rebounds, double rest, Workspace& work) const;
    void assemble(Index fan, const ExplicitStep& step, Workspace& work) const;
    void add_dashpots(Index fan, const ExplicitStep& step, Workspace& work) const;
    void add_contacts(Index fan, const ExplicitStep& step, FanProblem& problem) const;

    const Model& model_;
    SchemeOptions options_;
    ObstacleStep& obstacles_;
    const AbsorbingBoundary& absorbing_;
};

}  // namespace knap
