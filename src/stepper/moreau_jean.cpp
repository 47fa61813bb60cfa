#include "stepper/moreau_jean.hpp"

#include "base/error.hpp"
#include "stepper/explicit_beta.hpp"

#include <cmath>
#include <string>

namespace knap {

MoreauJean::MoreauJean(const Model& model, const SchemeOptions&) : bulk_(model), interfaces_(std::make_unique<ExplicitBeta>(model)) {}

StepReport MoreauJean::step(const State& begin, double h, State& end) {
    bulk_.free_motion(begin, h, free_);                             // as if no interface acted
    StepReport report = interfaces_->advance(begin, free_, end);    // who is bound, who touches, who slides; velocities, openings, cohesion
    bulk_.account_loads(begin, end, free_, report);
    report.largest_speed = std::sqrt(report.largest_speed);
    end.time = begin.time + h;
    end.last_step = h;
    end.n_steps = begin.n_steps + 1;
    if (!std::isfinite(report.kinetic + report.strain))
        throw SimulationError("the motion is no longer finite at t = " + std::to_string(end.time) + " s (step " +
                              std::to_string(end.n_steps) + "): the step is probably too large");
    return report;
}

}  // namespace knap
