#pragma once
// The velocities of rigid obstacles over a step of the explicit bulk: what is prescribed, and what is free
//
//     M (V+ - V) = k F + Q(V+),     Q = wrench of the impulses that the body gives them, each fan solved exactly for the obstacle velocities V+
//
// Q is piecewise linear: Newton's method on the few free components, its derivative by differences, with a line search on the error.
#include "model/state.hpp"

#include <functional>
#include <vector>

namespace knap {

class ObstacleMotion {
public:
    explicit ObstacleMotion(const Model& model) : model_(model) {}

    /// V+ where no contact acts, for a step with kick time k and drift time h [s]; exact where it is prescribed.
    void begin_step(const State& begin, double kick_time, double drift_time);

    /// [N s, N s, N m s] of the contacts on each obstacle, for given velocities.
    using Response = std::function<void(const std::vector<Vec3>& velocity, std::vector<Vec3>& wrench)>;

    /// Finds the velocities of the obstacles in `touched` [0/1] that are free. Returns the error left, over the largest impulse.
    double solve(const State& begin, const std::vector<std::uint8_t>& touched, const Response& response);

    const std::vector<Vec3>& velocity() const { return velocity_; }  // V+
    const std::vector<Vec3>& force() const { return force_; }        // [N, N, N m] at the begin of the step

private:
    const Model& model_;
    double kick_time_ = 0;
    std::vector<Vec3> velocity_, force_;
};

}  // namespace knap
