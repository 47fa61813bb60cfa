#pragma once
// The motion of rigid obstacles over a step: what is prescribed, and the free components from
//
//     M (V+ - V) = k F + Q(W),     W = theta V+ + (1 - theta) V,     Q: wrench of the impulses of the body at W
//
// The explicit bulk has theta = 1 and k = (previous h + h)/2, and damping alpha adds -k alpha M (V + V+)/2 there;
// the implicit bulk has k = h, and -k alpha M W there. The body is solved exactly for
// given rates, so Q is piecewise linear: Newton's method on the few free components, with a slope by differences.
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

#include <functional>
#include <vector>

namespace knap {

class ObstacleMotion {
public:
    explicit ObstacleMotion(const Model& model) : model_(model) {}

    /// Set the rates without contacts; final in prescribed components. All times in s; `damping` [-]: k alpha/2, of the
    /// implicit bulk theta h alpha.
    void begin_explicit(const State& begin, double kick_time, double drift_time, double damping);
    void begin_theta(const State& begin, double h, double theta, double damping);

    /// [N s, N s, N m s] of the contacts on each obstacle at rate().
    using Response = std::function<void(std::vector<Vec3>& wrench)>;

    /// `is_costly`: the response is found by iteration. The first steps then take the impulses of the last trial, which
    /// converges where an obstacle is much heavier than what it touches.
    struct Accuracy {
        double tolerance;  // [-] of the largest impulse
        bool is_costly = false;
    };
    /// Finds the free rates of the obstacles in `touched` [0/1]. Returns the error, relative to the largest impulse.
    double solve(const State& begin, const std::vector<std::uint8_t>& touched, const Accuracy& accuracy,
                 const Response& response);

    const std::vector<Vec3>& rate() const { return rate_; }  // W
    /// [1/kg, 1/kg, 1/(kg m2)] Of the change of the rates by impulses, zero in prescribed components.
    Vec3 inverse_mass(Index obstacle) const {
        Vec3 inverse = Vec3::Zero();
        for (int k = 0; k < 3; ++k)
            if (model_.obstacles[obstacle].is_free(k))
                inverse[k] = theta_ / ((1 + damping_) * model_.obstacles[obstacle].inertia_of(k));
        return inverse;
    }

    /// The obstacles at the end of the step under the wrenches of the contacts, their energies and works.
    void finish(const State& begin, const std::vector<Vec3>& wrench, State& end, StepReport& report) const;

private:
    struct Component {
        Index obstacle;
        int k;
        double mass;  // [kg] or [kg m2], times 1 + damping
    };
    void begin_step(const State& begin, const StepTimes& times);
    template <int max_components>
    double find_rates(const State& begin, const Accuracy& accuracy, const Response& response);

    const Model& model_;
    bool theta_scheme_ = false;
    double kick_time_ = 0, drift_time_ = 0, theta_ = 1, damping_ = 0;
    std::vector<Vec3> rate_, end_velocity_;  // end_velocity_: of prescribed components
    std::vector<Vec3> force_;                // [N, N, N m]
    std::vector<Component> free_;            // that something may touch
    std::vector<Vec3> without_contact_;      // W at the start of the step; solve() may be called again
    std::vector<Vec3> wrench_;               // memory of find_rates
};

}  // namespace knap
