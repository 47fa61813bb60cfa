#include "stepper/step_report.hpp"

#include <algorithm>

namespace knap {

StepReport& StepReport::operator+=(const StepReport& other) {
    kinetic += other.kinetic;
    strain += other.strain;
    dissipated += other.dissipated;
    recoverable += other.recoverable;
    external_work += other.external_work;
    cohesive_work += other.cohesive_work;
    crossing_loss += other.crossing_loss;
    impact_work += other.impact_work;
    friction_work += other.friction_work;
    step_change_work += other.step_change_work;
    scheme_dissipation += other.scheme_dissipation;
    worst_impact_work = std::max(worst_impact_work, other.worst_impact_work);
    worst_friction_work = std::max(worst_friction_work, other.worst_friction_work);
    residual = std::max(residual, other.residual);
    penetration = std::max(penetration, other.penetration);
    largest_speed = std::max(largest_speed, other.largest_speed);
    largest_beta_growth = std::max(largest_beta_growth, other.largest_beta_growth);
    if (other.largest_drop > largest_drop) largest_drop = other.largest_drop, drop_corner = other.drop_corner;
    fan_solves += other.fan_solves;
    fan_iterations += other.fan_iterations;
    fan_fallbacks += other.fan_fallbacks;
    bound_tests += other.bound_tests;
    released += other.released;
    softened += other.softened;
    linear_solves += other.linear_solves;
    factorisations += other.factorisations;
    if (refusal == Refusal::none) refusal = other.refusal, where = other.where;
    return *this;
}

}  // namespace knap
