#include "app/setup/step_plan.hpp"

#include "analysis/energy_ledger.hpp"
#include "analysis/rest_watch.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/mass_scaling.hpp"
#include "model/time_tables.hpp"
#include "stepper/adapt/adaptation.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

void check_order(const char* key, double step, const char* larger_key, double larger) {
    if (step > larger)
        throw BadStep(key, "step-order",
                      formatted("%s = %s is larger than %s = %s", key, readable(step, "s").c_str(), larger_key,
                                readable(larger, "s").c_str()),
                      "time.step_min <= time.step_cracking <= time.step <= time.end");
}

// bulk = "auto"
constexpr double smallest_implicit_multiple = 200;  // [-] of the stable step: an implicit step costs about so many
constexpr double steps_of_run = 400;                // [-] implicit, with step = "auto": as many as lines of the tables
constexpr double quiet_passages = 2;                // [-] of a shear wave

/// Thirty years of steps of a microsecond; a double counts them exactly.
constexpr double max_steps = 1e15;

/// Number of steps of size `step` [s] until the end.
std::int64_t count(const char* key, double end, double step, const char* cure) {
    const double n = std::ceil(end / step * (1 - 1e-12));
    if (n > max_steps)
        throw BadStep(key, "too-many-steps",
                      formatted("time.end = %s in steps of %s would be %.2g steps; the maximum is %.0g",
                                readable(end, "s").c_str(), readable(step, "s").c_str(), n, max_steps),
                      cure);
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(n));
}

/// Implicit steps end at corners of tables over time.
void count_corners(const Model& model, double end, StepPlan& plan) {
    constexpr std::int64_t many = 1'000'000;  // beside which corners do not count
    std::int64_t n = 0;
    for (double t = 0; t < end * (1 - 1e-12) && plan.n_steps < many; ++n) {
        const double h = step_to_corner(model, t, plan.limits.largest);
        plan.n_at_corners += h < plan.limits.largest;
        t += h;
    }
    if (plan.n_at_corners > 0) plan.n_steps = n;
}

/// [s] The requested time.step.
double requested_step(const TimeOptions& time, double stable_step) {
    const bool implicit = time.scheme.takes_implicit_steps();
    double step = (time.step.value > 0 ? time.step : automatic_step(time)).seconds(stable_step);
    if (time.step.value == 0 && time.scheme.bulk == BulkScheme::automatic)
        step = std::max(step, smallest_implicit_multiple * stable_step);
    if (!implicit && step > stable_step)
        throw BadStep("time.step", "unstable-step",
                      formatted("time.step = %s exceeds the stable step of the explicit bulk, %s",
                                readable(step, "s").c_str(), readable(stable_step, "s").c_str()),
                      "use step = \"auto\", a smaller step, a coarser mesh, or bulk = \"implicit\"");
    return step;
}

/// D/c of the largest body. What is held and may break is not rigid before its loads have settled. What is as fast as a
/// tenth of a wave moves by a twentieth of an edge in half a stable step.
StepLimits::Rigid rigid_limits(const RigidOptions& rigid, const Model& model, double end, double stable_step) {
    constexpr double smallest_part = 1. / 64;
    State start = initial_state(model);
    const FrozenPieces frozen = freeze(model, start);
    double passage = 0, not_before = -infinity;
    for (const FrozenBody::Piece& piece : frozen.body->pieces) {
        const Elastic& material = model.materials[model.mesh.region[piece.first_triangle]];
        passage = std::max(passage, std::sqrt(piece.area * material.density / material.E));
        if (piece.held && piece.weakest < infinity) not_before = settling_time(model);
    }
    const double step = std::min(rigid.step, end);
    return {.step = step,
            .smallest = std::min(smallest_part * step, 0.5 * stable_step),
            .hold = rigid.hold * passage,
            .not_before = not_before};
}

}  // namespace

StepLength automatic_step(const TimeOptions& time) {
    switch (time.scheme.bulk) {
        case BulkScheme::automatic: return {.value = time.end / steps_of_run};
        case BulkScheme::implicit_theta: return {.value = automatic_multiple, .of_stable_step = true};
        case BulkScheme::explicit_lumped: break;
    }
    return {.value = time.safety, .of_stable_step = true};
}

bool may_scale_masses(const Scenario& scenario) {
    const TimeOptions& time = scenario.time;
    const bool is_given = time.step.value > 0 && !time.step.of_stable_step && !time.scheme.takes_implicit_steps();
    return time.mass_scaling == 0 && time.scheme.takes_explicit_steps() && !scenario.adapt.active() && !is_given;
}

StepPlan plan_steps(const TimeOptions& time, double stable_step, double until) {
    if (!(stable_step >= 0))
        throw BadStep("mesh", "no-stable-step", "the stable step of the mesh is not a number",
                      "E, nu or density of a material, or mesh.size, is too large or too small for double precision");
    const double requested = requested_step(time, stable_step);
    const std::int64_t n =
        time.step.value > 0 ? count("time.step", time.end, requested, "use a larger time.step, or a smaller time.end")
                            : count("time.end", time.end, requested,
                                    "use a smaller time.end; the step follows from time.safety, mesh.size, and E and "
                                    "density of the materials");
    // equal steps, unless one is cut; a step given in seconds is used as it is, and the last ones may be shorter
    const double step = time.step.value > 0 && !time.step.of_stable_step ? std::min(requested, time.end)
                                                                         : time.end / static_cast<double>(n);
    const bool changes = time.scheme.bulk == BulkScheme::automatic;
    const double cracking = time.step_cracking.value > 0 ? time.step_cracking.seconds(stable_step)
                            : changes                    ? std::min(requested, smallest_implicit_multiple * stable_step)
                                                         : requested;
    const double smallest =
        time.step_min.value > 0 ? time.step_min.seconds(stable_step) : std::ldexp(std::min(cracking, step), -20);
    check_order("time.step_cracking", cracking, "time.step", requested);
    check_order("time.step_min", smallest, "time.step_cracking", cracking);
    count("time.step_cracking", time.end, cracking, "use a larger time.step_cracking, or a smaller time.end");
    const double end = std::min(time.end, until);
    SchemeChangeOptions change = time.change;
    change.explicit_step = changes ? time.safety * stable_step : 0, change.largest_step = std::min(step, end);
    return {.limits = {.largest = step,
                       .cracking = std::min(cracking, step),
                       .smallest = std::min(smallest, step),
                       .end = time.end,
                       .change = change},
            .n_steps = std::min(n, static_cast<std::int64_t>(std::ceil(end / step * (1 - 1e-12)))),
            .stable_step = stable_step};
}

StepPlan plan_steps(const TimeOptions& time, const AdaptOptions& adapt, const Model& model, double until) {
    std::vector<double> stable = stable_steps(model);
    double smallest = std::ranges::min(stable);
    if (adapt.active())  // the step holds for all refinements
        smallest = std::min(smallest, guaranteed_step(adapt.size, model.materials, model.plane));
    StepPlan plan = plan_steps(time, smallest, until);
    for (const FanPoint& point : model.fan_points)
        if (const CohesiveLaw& law = model.laws[point.law]; law.breakable() && !point.cracked && law.delta_c() > 0)
            plan.limits.critical_opening = std::min(plan.limits.critical_opening, law.delta_c());
    plan.limits.passage = shear_passage(model);
    if (double& quiet_for = plan.limits.change.quiet_for; plan.limits.changes() && quiet_for == 0)
        quiet_for = quiet_passages * plan.limits.passage;
    plan.limits.change.weakest_point = weakest_point(model);
    if (const RigidOptions& rigid = time.scheme.rigid; rigid.active())
        plan.limits.rigid = rigid_limits(rigid, model, time.end, smallest);
    plan.stable_of_triangle = std::move(stable);
    if (time.scheme.takes_implicit_steps()) count_corners(model, std::min(time.end, until), plan);
    return plan;
}

}  // namespace knap
