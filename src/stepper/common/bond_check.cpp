#include "stepper/common/bond_check.hpp"

namespace knap {

bool BondCheck::is_bonded(Index f, const State& begin, std::span<const Vec2> required, double time) {
    const Fan& fan = model_->fans[f];
    const auto points = model_->points(fan);
    const auto required_by = [&](Index j) -> const Vec2& { return required[j]; };
    const auto breakable = [&](Index j) { return law_of(*model_, begin, points[j]).breakable(); };
    const auto strength = [&](Index j) {
        const CohesiveLaw& law = law_of(*model_, begin, points[j]);
        const double cohesive = law.sigma_c * points[j].area * time;
        return StrengthPolygon::at_rest(law, points[j].normal, cohesive, points[j].area * time);
    };
    impulse_.resize(fan.n_points);
    const auto walk = [&](const Vec2& first) {
        walk_chain(fan.n_points, fan.closed, first, required_by,
                   [&](Index j, const Vec2& P) { return impulse_[j] = P, true; });
    };

    const Vec2 least_norm =
        least_norm_start(fan.n_points, fan.closed, required_by, [&](Index j) { return points[j].area; });
    walk(least_norm);
    bool admissible = true;
    for (Index j = 0; j < fan.n_points && admissible; ++j)
        admissible = !breakable(j) || strength(j).smallest_slack(impulse_[j]) >= 0;
    if (admissible || !fan.closed) return admissible;

    planes_.clear();
    walk(Vec2::Zero());
    for (Index j = 0; j < fan.n_points; ++j)
        if (breakable(j)) strength(j).add_half_planes(j, impulse_[j], Vec2::Ones(), planes_);
    const SelfStress found = find_self_stress(planes_, least_norm);
    walk(found.c);
    return found.slack >= 0;
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
