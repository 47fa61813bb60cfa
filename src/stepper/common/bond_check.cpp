#include "stepper/common/bond_check.hpp"

namespace knap {

namespace {

StrengthPolygon strength_of(const CohesiveLaw& law, const FanPoint& point, double time) {
    const double cohesive = law.sigma_c * point.area * time;
    return StrengthPolygon::at_rest(law, point.normal, cohesive, point.area * time);
}

}  // namespace

bool BondCheck::is_bonded(Index f, const State& begin, std::span<const Vec2> required, double time) {
    const Fan& fan = model_->fans[f];
    const auto points = model_->points(fan);
    const auto required_by = [&](Index j) -> const Vec2& { return required[j]; };
    impulse_.resize(fan.n_points);
    const Vec2 least_norm =
        least_norm_start(fan.n_points, fan.closed, required_by, [&](Index j) { return points[j].area; });
    bool admissible = true;
    walk_chain(fan.n_points, fan.closed, least_norm, required_by, [&](Index j, const Vec2& P) {
        impulse_[j] = P;
        if (!admissible) return true;
        const CohesiveLaw& law = law_of(*model_, begin, points[j]);
        admissible = !law.breakable() || strength_of(law, points[j], time).smallest_slack(P) >= 0;
        return true;
    });
    return admissible || (fan.closed && find_best(fan, begin, required, time, least_norm));
}

bool BondCheck::find_best(const Fan& fan, const State& begin, std::span<const Vec2> required, double time,
                          const Vec2& least_norm) {
    const auto points = model_->points(fan);
    const auto walk = [&](const Vec2& first, const auto& visit) {
        walk_chain(
            fan.n_points, true, first, [&](Index j) -> const Vec2& { return required[j]; }, visit);
    };
    planes_.clear();
    walk(Vec2::Zero(), [&](Index j, const Vec2& P) {
        const CohesiveLaw& law = law_of(*model_, begin, points[j]);
        if (law.breakable()) strength_of(law, points[j], time).add_half_planes(j, P, Vec2::Ones(), planes_);
        return true;
    });
    const SelfStress found = find_self_stress(planes_, least_norm);
    walk(found.c, [&](Index j, const Vec2& P) { return impulse_[j] = P, true; });
    return found.slack >= 0;
}

double BondCheck::margin(Index f, const State& begin, double time) {
    const auto points = model_->points(model_->fans[f]);
    planes_.clear();
    double smallest = infinity;
    for (std::size_t j = 0; j < points.size(); ++j) {
        const CohesiveLaw& law = law_of(*model_, begin, points[j]);
        if (!law.breakable()) continue;
        const StrengthPolygon strength = strength_of(law, points[j], time);
        if (strength.is_curved()) {
            strength.add_half_planes(static_cast<Index>(j), impulse_[j], Vec2::Ones(), planes_);
        } else {
            const double slope = std::sqrt(1 + law.friction * law.friction);  // the largest gradient of a slack
            smallest = std::min(smallest, strength.smallest_slack(impulse_[j]) / slope);
        }
    }
    for (const HalfPlane& plane : planes_) smallest = std::min(smallest, plane.value / plane.gradient.norm());
    return smallest;
}

/// With the cohesion U C the half planes of a point are g . P + U C >= 0 and, in shear, g . P + U (gamma + mu) C >= 0.
/// Divided by their strengths they have the smallest slack U + min g . P/strength, whose largest value is 0.
double BondCheck::utilisation(Index f, const State& begin, std::span<const Vec2> required, double time) {
    const Fan& fan = model_->fans[f];
    const auto points = model_->points(fan);
    const auto required_by = [&](Index j) -> const Vec2& { return required[j]; };
    const Vec2 least_norm =
        least_norm_start(fan.n_points, fan.closed, required_by, [&](Index j) { return points[j].area; });
    planes_.clear();
    walk_chain(fan.n_points, fan.closed, Vec2::Zero(), required_by, [&](Index j, const Vec2& P) {
        const CohesiveLaw& law = law_of(*model_, begin, points[j]);
        if (!law.breakable()) return true;
        const double strength = law.sigma_c * points[j].area * time;
        law.visit_friction_lines([&](const FrictionLine& line) {
            const auto first = static_cast<std::ptrdiff_t>(planes_.size());
            const StrengthPolygon admissible{
                {.jump = line.offset * points[j].area * time, .contact_jump = line.slope}, points[j].normal, 0};
            admissible.add_half_planes(j, P, fan.closed ? Vec2::Ones() : Vec2::Zero(), planes_);
            for (HalfPlane& plane : std::span(planes_).subspan(first)) {
                const double unit = plane.shear == 0 ? strength : (law.gamma + line.slope) * strength;
                plane.value /= unit, plane.gradient /= unit;
            }
        });
        return true;
    });
    return std::max(0.0, -find_self_stress(planes_, least_norm).slack);
}

}  // namespace knap
