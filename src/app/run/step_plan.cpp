#include "app/run/step_plan.hpp"

#include "element/triangle_matrices.hpp"
#include "mesh/size_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace knap {
namespace {

void check_order(const char* key, double step, const char* larger_key, double larger) {
    if (step <= larger) return;
    char text[160];
    std::snprintf(text, sizeof text, "%s = %.3g s is larger than %s = %.3g s", key, step, larger_key, larger);
    throw BadStep(key, "step-order", text, "time.step_min <= time.step_cracking <= time.step <= time.end");
}

/// Thirty years of a step a microsecond; a double still counts them exactly.
constexpr double most_steps = 1e15;

/// Steps until the end, where they are as large as `step` [s].
std::int64_t count(const char* key, double end, double step, const char* note) {
    const double n = std::ceil(end / step * (1 - 1e-12));
    if (n <= most_steps) return std::max<std::int64_t>(1, static_cast<std::int64_t>(n));
    char text[160];
    std::snprintf(text, sizeof text, "time.end = %.3g s in steps of %.3g s would be %.2g steps; %.0g is the most", end, step, n, most_steps);
    throw BadStep(key, "too-many-steps", text, note);
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
    if (!(stable_step >= 0))
        throw BadStep("mesh", "no-stable-step", "the stable step of the mesh is no number", "E, nu and density of a material, or mesh.size, are beyond what numbers can hold");
    const double wanted = wanted_step(time, stable_step);
    const std::int64_t n = time.step.value > 0
                               ? count("time.step", time.end, wanted, "a larger time.step, or a smaller time.end")
                               : count("time.end", time.end, wanted, "a smaller time.end; the step follows from time.safety, mesh.size, and E and density of the materials");
    // equal steps, as long as none is cut; one that is given in seconds is taken as it is, and the last ones may be shorter
    const double step = time.step.value > 0 && !time.step.of_stable_step ? std::min(wanted, time.end) : time.end / static_cast<double>(n);

    const double cracking = time.step_cracking.value > 0 ? time.step_cracking.seconds(stable_step) : wanted;
    const double smallest = time.step_min.value > 0 ? time.step_min.seconds(stable_step) : std::ldexp(std::min(cracking, step), -20);
    check_order("time.step_cracking", cracking, "time.step", wanted);
    check_order("time.step_min", smallest, "time.step_cracking", cracking);
    count("time.step_cracking", time.end, cracking, "a larger time.step_cracking, or a smaller time.end");
    const double end = std::min(time.end, until);
    return {.limits = {.largest = step, .cracking = std::min(cracking, step), .smallest = std::min(smallest, step), .end = time.end},
            .n_steps = std::min(n, static_cast<std::int64_t>(std::ceil(end / step * (1 - 1e-12)))),
            .stable_step = stable_step};
}

namespace {

/// [s] The stable step of the median triangle, in wave passages through the size that is wanted where it lies, times the shortest of these passages.
double usual_step(const Scenario& scenario, const Model& model, const std::vector<double>& stable) {
    if (scenario.given) return 0;
    const SizeField size(scenario.mesh, 1);
    std::vector<double> speed, in_passages;
    for (const Elastic& material : model.materials) speed.push_back(material.dilatational_speed(model.plane));
    double shortest = std::numeric_limits<double>::infinity();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const Vec2 x = model.mesh.centroid(t);
        const double passage = size(x) / speed[model.mesh.region[t]];
        shortest = std::min(shortest, passage);
        in_passages.push_back(stable[t] / passage);
    }
    const auto middle = in_passages.begin() + static_cast<std::ptrdiff_t>(in_passages.size() / 2);
    std::nth_element(in_passages.begin(), middle, in_passages.end());
    return *middle * shortest;
}

}  // namespace

/// Of the usual step. The worst triangle of a good mesh has a third of it; of two lines a tenth of an edge apart, with what meshes scatter, surely less than this.
constexpr double far_below = 1. / 7;

StepPlan plan_of(const ReadResult& read, const Model& model, double until) {
    const std::vector<double> stable = stable_steps(model.mesh, model.materials, model.plane);
    const auto least = std::min_element(stable.begin(), stable.end());
    try {
        StepPlan plan = plan_steps(read.scenario, *least, until);
        plan.usual_step = usual_step(read.scenario, model, stable);
        for (Index t = 0; t < model.mesh.n_triangles(); ++t)
            if (stable[t] < far_below * plan.usual_step) plan.slow.push_back({t, stable[t]});
        std::stable_sort(plan.slow.begin(), plan.slow.end(), [](const SlowTriangle& a, const SlowTriangle& b) { return a.step < b.step; });
        return plan;
    } catch (const BadStep& error) {
        throw UserError({read.at(error.key, error.diagnostics.front())});
    }
}

}  // namespace knap
