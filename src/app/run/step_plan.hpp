#pragma once
// What the [time] of a scenario means for a mesh: the largest step, the one while the crack runs, the smallest.
#include "base/error.hpp"
#include "model/model.hpp"
#include "scenario/read_scenario.hpp"
#include "stepper/step_control.hpp"

namespace knap {

/// What step = "auto" means with the implicit bulk, in stable steps: a wave runs by some twenty edges in a step.
inline constexpr double automatic_multiple = 20;

struct SlowTriangle {
    Index triangle;
    double step;  // [s] its stable one
};

struct StepPlan {
    StepLimits limits;
    std::int64_t n_steps;  // if all are as large as they may be
    double stable_step;    // [s] of the explicit bulk: of the worst free triangle
    double usual_step = 0;           // [s] of the median triangle of the smallest wanted size; 0 of a mesh that was read
    std::vector<SlowTriangle> slow;  // those far below it, the slowest first
};

/// A step that the mesh does not allow, or steps that are in the wrong order.
class BadStep : public UserError {
public:
    BadStep(std::string where, const std::string& code, const std::string& message, const std::string& note)
        : UserError(code, message, note), key(std::move(where)) {}
    std::string key;  // "time.step"
};

/// Throws BadStep. The steps do not depend on `until` [s]: a shorter run is the begin of the longer one.
StepPlan plan_steps(const Scenario& scenario, double stable_step, double until);

/// The same for a model; what is wrong is an error at its line of the scenario.
StepPlan plan_of(const ReadResult& read, const Model& model, double until);

}  // namespace knap
