#pragma once
// The motion of rigid obstacles over a step: what is prescribed, and the free components from
//
//     M (V+ - V) = k F + Q(W),     W = theta V+ + (1 - theta) V,     Q: wrench of the impulses of contacts
//
// The explicit bulk has theta = 1 and k = (previous h + h)/2, and damping alpha adds -k alpha M (V + V+)/2 there;
// the implicit bulk has k = h, and -k alpha M W there. Q is found in explicit/vertex_contacts and
// implicit/free_obstacles.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

#include <vector>

namespace knap {

class ObstacleMotion {
public:
    explicit ObstacleMotion(const Model& model) : model_(model) {}

    /// Set the rates without contacts; final in prescribed components. All times in s; `damping` [-]: k alpha/2, of the
    /// implicit bulk theta h alpha.
    void begin_explicit(const State& begin, double kick_time, double drift_time, double damping);
    void begin_theta(const State& begin, double h, double theta, double damping);

    const std::vector<Vec3>& rate() const { return rate_; }  // W
    void set_rate(const std::vector<Vec3>& rate) { rate_ = rate; }
    /// [kg], or [kg m2], of a free component, with what damping adds.
    double mass(Index obstacle, int k) const { return (1 + damping_) * model_.obstacles[obstacle].inertia_of(k); }
    /// [1/kg, 1/kg, 1/(kg m2)] Of the change of the rates by impulses, zero in prescribed components.
    Vec3 inverse_mass(Index obstacle) const {
        Vec3 inverse = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
            if (model_.obstacles[obstacle].is_free(k)) inverse[k] = theta_ / mass(obstacle, k);
        return inverse;
    }

    /// The obstacles at the end of the step under the wrenches of the contacts, their energies and works.
    void finish(const State& begin, const std::vector<Vec3>& wrench, State& end, StepReport& report) const;

private:
    void begin_step(const State& begin, const StepTimes& times);

    const Model& model_;
    bool theta_scheme_ = false;
    double kick_time_ = 0, drift_time_ = 0, theta_ = 1, damping_ = 0;
    std::vector<Vec3> rate_, end_velocity_;  // end_velocity_: of prescribed components
    std::vector<Vec3> force_;                // [N, N, N m]
};

}  // namespace knap
