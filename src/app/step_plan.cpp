#include "app/step_plan.hpp"

#include "bulk/triangle_matrices.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

void check_order(const char* key, double step, const char* larger_key, double larger) {
    if (step <= larger) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s = %.3g s is larger than %s = %.3g s", key, step, larger_key, larger);
    throw BadStep(key, "step-order", text, "time.step_min <= time.step_cracking <= time.step <= time.end");
}

/// [s] What time.step asks for.
double wanted_step(const TimeOptions& time, double stable_step) {
    const bool implicit = time.scheme.bulk == BulkScheme::implicit_theta;
    const double wanted = time.step.value > 0 ? time.step.seconds(stable_step) : (implicit ? automatic_multiple : time.safety) * stable_step;
    if (implicit || wanted <= stable_step) return wanted;
    char text[160];
    std::snprintf(text, sizeof text, "time.step = %.3g s is beyond the stable step of the explicit bulk, %.3g s", wanted, stable_step);
    throw BadStep("time.step", "unstable-step", text, "use step = \"auto\", a smaller step, a coarser mesh, or bulk = \"implicit\"");
}

}  // namespace

StepPlan plan_steps(const Scenario& scenario, double stable_step, double until) {
    const TimeOptions& time = scenario.time;
    const double wanted = wanted_step(time, stable_step);
    const std::int64_t n = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(time.end / wanted * (1 - 1e-12))));
    const double step = time.end / static_cast<double>(n);  // equal steps, as long as none is cut

    const double cracking = time.step_cracking.value > 0 ? time.step_cracking.seconds(stable_step) : wanted;
    const double smallest = time.step_min.value > 0 ? time.step_min.seconds(stable_step) : std::ldexp(std::min(cracking, step), -20);
    check_order("time.step_cracking", cracking, "time.step", wanted);
    check_order("time.step_min", smallest, "time.step_cracking", cracking);
    const double end = std::min(time.end, until);
    return {.limits = {.largest = step, .cracking = std::min(cracking, step), .smallest = std::min(smallest, step), .end = time.end},
            .n_steps = std::min(n, static_cast<std::int64_t>(std::ceil(end / step * (1 - 1e-12)))),
            .stable_step = stable_step};
}

StepPlan plan_of(const ReadResult& read, const Model& model, double until) {
    const std::vector<double> stable = stable_steps(model.mesh, model.materials, model.plane);
    try {
        return plan_steps(read.scenario, *std::min_element(stable.begin(), stable.end()), until);
    } catch (const BadStep& error) {
        throw located(read, error.key, error);
    }
}

}  // namespace knap
