#include "stepper/moreau_jean.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "stepper/common/law_change.hpp"
#include "stepper/explicit/explicit_scheme.hpp"
#include "stepper/implicit/implicit_scheme.hpp"

#include <cmath>

namespace knap {
namespace {

std::unique_ptr<StepScheme> make_scheme(const Model& model, const SchemeOptions& options) {
    if (options.bulk == BulkScheme::explicit_lumped) return std::make_unique<ExplicitScheme>(model, options);
    if (model.large_rotation)  // the scheme is linear in the displacement
        throw UserError("large-rotation", "large rotations need the explicit bulk");
    return std::make_unique<ImplicitScheme>(model, options);
}

}  // namespace

MoreauJean::MoreauJean(const Model& model, const SchemeOptions& options)
    : model_(model), options_(options), scheme_(make_scheme(model, options)) {
    if (model.heat) heat_.emplace(model, options.bulk == BulkScheme::implicit_theta);
}

StepReport MoreauJean::step(const State& begin, double h, State& end) {
    if (heat_) end.temperature = heat_->after(begin, h);
    StepReport report = scheme_->step(begin, h, end);
    if (heat_) end.temperature_before = begin.temperature;
    if (model_.laws_follow_temperature) account_law_change(model_, begin, report);
    if (report.rejection != Rejection::none) return report;
    end.time = begin.time + h;
    end.last_step = h;
    end.n_steps = begin.n_steps + 1;
    if (std::isfinite(report.kinetic + report.strain)) return report;
    throw SimulationError(
        formatted("the motion is no longer finite at t = %.9g s (step %lld) at ", end.time,
                  static_cast<long long>(end.n_steps)) +
        place_text(place_of_largest_speed(model_, end)) +
        ": the step is probably too large, or a load or velocity absurd; try a smaller time.step, and "
        "look at the units of the loads");
}

}  // namespace knap
