#pragma once
// The step sizes that the [time] of a scenario gives for a mesh.
#include "base/error.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"
#include "stepper/step_control.hpp"

namespace knap {

/// step = "auto" with the implicit bulk, in stable steps: a wave passes some twenty edges in a step.
inline constexpr double automatic_multiple = 20;

/// time.step = "auto".
StepLength automatic_step(const TimeOptions& time);

struct StepPlan {
    StepLimits limits;
    std::int64_t n_steps;                         // if all have the largest size
    double stable_step;                           // [s] of the explicit bulk: that of the worst free triangle
    std::vector<double> stable_of_triangle = {};  // [s] each free triangle
    std::int64_t n_at_corners = 0;                // of n_steps: implicit ones that end at corners of tables over time
};

/// Whether explicit steps follow from triangles whose masses time.mass_scaling could change, and does not.
bool may_scale_masses(const Scenario& scenario);

/// A step that the mesh does not allow, or step sizes in the wrong order.
class BadStep : public UserError {
public:
    BadStep(std::string where, const std::string& code, const std::string& message, const std::string& note)
        : UserError(code, message, note), key(std::move(where)) {}
    std::string key;  // "time.step"
};

/// Throws BadStep. Steps do not depend on `until` [s]: a shorter run is the start of the longer one.
StepPlan plan_steps(const TimeOptions& time, double stable_step, double until);
StepPlan plan_steps(const TimeOptions& time, const AdaptOptions& adapt, const Model& model, double until);

}  // namespace knap
