#pragma once
// Rigid obstacles next to the explicit bulk, where a contact reaches beyond a fan: a free obstacle couples the fans
// that it touches by its three velocities; a contact on an edge couples the two fans at its ends by its impulse.
#include "stepper/explicit/vertex_solver.hpp"

#include <algorithm>
#include <functional>

namespace knap {

class VertexObstacles {
public:
    VertexObstacles(const Model& model, const VertexSolver& solver, ObstacleStep& obstacles)
        : model_(model),
          solver_(solver),
          now_(obstacles),
          any_is_free_(std::ranges::any_of(model.obstacles, [](const Obstacle& o) { return o.is_free(); })) {}

    /// Motion of the obstacles without the body, and the contacts that may close.
    void begin(const ExplicitStep& step);
    /// The fan is coupled with others, by the motion of a free obstacle or by a contact on an edge.
    bool couple(Index fan) const;
    /// Solves the contacts between free faces of fans that are coupled; returns the change of their impulses [-].
    using BetweenFaces = std::function<double(StepReport& report)>;
    /// End velocities of free obstacles, impulses of contacts on edges, and of those between free faces, if any.
    void solve(const ExplicitStep& step, const BetweenFaces& between_faces, VertexSolver::Workspace& work,
               StepReport& report);
    /// The obstacles at the end of the step, their energies and works, and those of the contacts on edges.
    void finish(const ExplicitStep& step, StepReport& report);

private:
    struct EdgeContact {
        double mobility;  // [1/kg] of the body at the contact
        Vec2 last_velocity = Vec2::Zero(), last_change = Vec2::Zero();
        LinkResult found = {};
    };
    void solve_obstacles(const ExplicitStep& step, const BetweenFaces& between_faces, VertexSolver::Workspace& work,
                         StepReport& report);
    void solve_at_rates(const ExplicitStep& step, const BetweenFaces& between_faces, VertexSolver::Workspace& work,
                        StepReport& report);
    void solve_edges(const ExplicitStep& step, VertexSolver::Workspace& work, StepReport& report);
    Vec2 end_velocity_at(const ObstacleContact& contact, const ExplicitStep& step, VertexSolver::Workspace& work) const;
    void correct_work(const State& end, StepReport& report) const;
    void sum_wrenches(std::vector<Vec3>& wrench) const;

    const Model& model_;
    const VertexSolver& solver_;
    ObstacleStep& now_;
    bool any_is_free_;
    std::vector<EdgeContact> edges_;
    SolvedFan edge_;                     // one of them as a fan of two bodies
    std::vector<std::uint8_t> touched_;  // per obstacle: it is free, and something may touch it
    std::vector<Index> touching_fans_;
    std::vector<Vec3> wrench_;  // [N s, N s, N m s] per obstacle
};

}  // namespace knap
