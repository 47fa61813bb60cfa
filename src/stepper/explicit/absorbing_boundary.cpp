#include "stepper/explicit/absorbing_boundary.hpp"

#include <Eigen/LU>

namespace knap {

Vec2 AbsorbingBoundary::end_velocity(Index f, const ExplicitStep& step, const Vec2& impulse,
                                     const Vec2& velocity) const {
    // (M + k/2 C) v+ = (M - k/2 C) v + k F; the damping belongs to both M
    const Fan& fan = model_.fans[f];
    const PrescribedMotion* motion = model_.motion_of(model_.corners(fan)[0]);
    Eigen::Matrix2d half = Eigen::Matrix2d::Zero();
    for (const Dashpot& dashpot : of_fan(f)) half += 0.5 * step.kick_time * dashpot.C;
    const Vec2 before = step.begin.velocity[f];
    Eigen::Matrix2d left = (1 + step.damping) * fan.mass * Eigen::Matrix2d::Identity() + half;
    Vec2 right = (1 - step.damping) * fan.mass * before - half * before + impulse;
    for (int k = 0; k < 2 && motion; ++k)
        if (motion->component[k]) left.row(k) = Vec2::Unit(k).transpose(), right[k] = velocity[k];
    return left.inverse() * right;
}

Vec2 AbsorbingBoundary::force_on_fan(Index fan, const Vec2& velocity) const {
    Vec2 force = Vec2::Zero();
    for (const Dashpot& dashpot : of_fan(fan)) force -= dashpot.C * velocity;
    return force;
}

void AbsorbingBoundary::account(const ExplicitStep& step, StepReport& report) const {
    for (const Dashpot& dashpot : dashpots_) {
        const Vec2 before = step.begin.velocity[step.begin.node_of_corner[dashpot.corner]],
                   after = step.end.velocity[step.end.node_of_corner[dashpot.corner]], mean = 0.5 * (before + after);
        report.radiated_work -= step.kick_time * mean.dot(dashpot.C * mean);
    }
}

Vec2 dashpot_force(Index corner, std::span<const Dashpot> dashpots, const Vec2& velocity) {
    const auto found = std::ranges::find(dashpots, corner, &Dashpot::corner);
    return found == dashpots.end() ? Vec2(Vec2::Zero()) : Vec2(-(found->C * velocity));
}

}  // namespace knap
