#include "stepper/moreau_jean.hpp"

#include "base/error.hpp"
#include "stepper/explicit/explicit_scheme.hpp"
#include "stepper/implicit/implicit_scheme.hpp"
#include "stepper/static_preload.hpp"

#include <cmath>
#include <cstdio>

namespace knap {
namespace {

std::unique_ptr<StepScheme> make_scheme(const Model& model, const SchemeOptions& options) {
    if (options.bulk == BulkScheme::implicit_theta) return std::make_unique<ImplicitScheme>(model, options);
    return std::make_unique<ExplicitScheme>(model, options);
}

}  // namespace

MoreauJean::MoreauJean(const Model& model, const SchemeOptions& options)
    : model_(model), options_(options), scheme_(make_scheme(model, options)) {}

StepReport MoreauJean::step(const State& begin, double h, State& end) {
    StepReport report = scheme_->step(begin, h, end);
    if (report.rejection != Rejection::none) return report;
    end.time = begin.time + h;
    end.last_step = h;
    end.n_steps = begin.n_steps + 1;
    if (!std::isfinite(report.kinetic + report.strain)) {
        const Vec2 where = place_of_largest_speed(model_, end);
        char text[240];
        std::snprintf(text, sizeof text,
                      "the motion is no longer finite at t = %.9g s (step %lld) at (x, y) = (%.6g, %.6g) m: the step "
                      "is probably too large, or a load or velocity "
                      "absurd; try a smaller time.step, and look at the units of the loads",
                      end.time, static_cast<long long>(end.n_steps), where.x(), where.y());
        throw SimulationError(text);
    }
    return report;
}

void MoreauJean::start_in_equilibrium(State& start) const { load_statically(model_, options_, start); }

}  // namespace knap
