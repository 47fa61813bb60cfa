#pragma once
// The interfaces beside the explicit lumped bulk, whose mass couples nothing beyond a fan: each vertex is solved by itself and exactly
// (interface/fan_solver.hpp), and the cohesion follows from the openings at the end. Explicit beta: its forces are those of the cohesion at the
// begin. Implicit beta: of beta_theta = theta beta+ + (1 - theta) beta (interface/fan_cohesion.hpp).
//
// A corner near a rigid obstacle has one link more in its fan, to the obstacle as a body with prescribed motion. A free obstacle couples the fans
// that it touches by its three velocities; ObstacleMotion finds them first. A corner of an obstacle on an edge couples the two fans at its ends by its impulse.
#include "interface/fan_cohesion.hpp"
#include "interface/fan_solver.hpp"
#include "model/state.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/obstacle_motion.hpp"
#include "stepper/common/scheme_options.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/explicit/explicit_bulk.hpp"
#include "stepper/explicit/free_motion.hpp"
#include "stepper/explicit/inscribed_circles.hpp"
#include "stepper/explicit/mesh_blocks.hpp"
#include "stepper/explicit/stationary_fans.hpp"

#include <memory>

namespace knap {

class VertexScheme {
public:
    VertexScheme(const Model& model, const SchemeOptions& options);
    /// From the state at the begin of the step and the forces of the bulk: velocities, displacements, cohesion and the partition at its end.
    /// `end` may be any earlier state of the same run; its time is not touched. Loads on corners are accounted by the bulk.
    StepReport advance(const State& begin, const ExplicitBulk& bulk, FreeMotion& free, State& end);

private:
    struct alignas(128) Workspace {  // no cache line of two threads
        FanProblem problem;
        FanSolver solver;
        std::vector<LinkCohesion> cohesion;
        std::vector<Vec2> force;           // [N] on the corners of a block of triangles
        std::vector<Vec2> required;        // [N] per corner of a fan in one piece: what its points must give it
        StationaryFans::Workspace stationary;
        std::vector<double> restitution;  // [-] of the links of a fan, where they are put aside
    };

    /// What the body at a contact on an edge answers to its impulse.
    struct EdgeAnswer {
        double mobility;  // [1/kg]
        Vec2 last_velocity = Vec2::Zero(), last_change = Vec2::Zero();
    };

    void copy_partition(const State& begin, State& end) const;
    StepReport sweep_blocks(const State& begin, const ExplicitBulk& bulk, FreeMotion& free, State& end);
    void advance_inner(const MeshBlocks::Block& block, const State& begin, FreeMotion& free, State& end, Workspace& work, StepReport& report);
    void part_from_obstacles(const State& begin);
    StepReport advance_bordering(const State& begin, const FreeMotion& free, State& end);
    bool bonded_by_estimate(Index fan, const Vec2& force, std::vector<Vec2>& forces);
    bool is_bonded(Index fan, const State& begin, const FreeMotion& free, Workspace& work, StepReport& report);
    void account_drive(Index fan, const PrescribedMotion& motion, const State& begin, const FreeMotion& free, const Vec2& force, State& end,
                       StepReport& report) const;
    void release(const State& begin, State& end, StepReport& report);
    void find_edge_impulses(const State& begin, const FreeMotion& free, StepReport& report);
    Vec2 end_velocity_at(const ObstacleContact& contact, const State& begin, const FreeMotion& free, Workspace& work) const;
    const std::vector<Vec3>& contact_wrenches();  // [N s, N s, N m s] of the body on each obstacle
    Vec2 edge_impulse_on(Index corner) const;    // [N s] of the contacts on edges
    void account_edges(const State& begin, const State& end, const FreeMotion& free, StepReport& report) const;
    void find_obstacle_velocities(const State& begin, const FreeMotion& free, StepReport& report);
    bool fans_are_by_themselves() const { return model_.obstacles.empty(); }  // no contact that several of them share
    StepReport account_loads(const State& begin, const ExplicitBulk& bulk, const FreeMotion& free, const State& end);
    StepReport advance_split(const State& begin, const FreeMotion& free, State& end);
    void advance_fan(Index rank, const State& begin, const FreeMotion& free, State& end, Workspace& work, StepReport& report);

    FanSolution solve(Index fan, const State& begin, Workspace& work) const;
    FanSolution solve_assembled(Index fan, const State& begin, Workspace& work, double rest = 0) const;
    void assemble_problem(Index fan, const State& begin, const FreeMotion& free, FanProblem& problem) const;
    Vec2 prescribed_velocity(const PrescribedMotion& motion, const Vec2& displacement, const State& begin, double h) const;
    double cohesion_before(Index fan, Index point, const State& begin) const;

    const Model& model_;
    SchemeOptions options_;
    MeshBlocks blocks_;
    InscribedCircles circles_;
    std::vector<double> mass_;               // [kg] of the corners, in the order of Model::fan_corners: whoever asks for one of a fan asks for all
    std::vector<std::uint8_t> fan_is_candidate_;   // per fan: the stress criterion does not clear it
    std::vector<std::uint8_t> splits_;  // per fan, in this step
    ObstacleContacts contacts_;
    StationaryFans stationary_;
    ObstacleMotion motion_;
    std::vector<Vec2> contact_impulse_;      // [N s] per contact, on the body
    std::vector<FanLink> edge_links_;        // of the contacts on edges, solved
    std::vector<EdgeAnswer> edge_answers_;   // likewise
    FanProblem edge_problem_;
    std::vector<std::uint8_t> touched_;      // per obstacle: it is free, and something may meet it
    std::vector<Index> touching_fans_;
    std::vector<Vec3> wrench_;               // per obstacle
    std::vector<Workspace> workspaces_;      // one a thread
    std::vector<StepReport> partial_;
    State unordered_;
};

}  // namespace knap
