#include "stepper/explicit/bond_criteria.hpp"

#include "element/shape_functions.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

/// [N] At all temperatures. As a function of mu the shear part has no minimum inside an interval.
double sure_strength(const CohesiveLaw& law, double area) {
    if (!law.breakable()) return infinity;
    if (law.sigma_c == 0) return 0;
    if (law.coupling == Coupling::norm) return area * law.sigma_c * law.smallest_phi() * std::min(1.0, law.gamma);
    double shear = 1;
    const double weakest = law.sigma_c * law.smallest_phi();
    for (const double mu : law.friction_range())
        law.visit_friction_lines(mu, [&](const FrictionLine& line) {
            shear = std::min(shear,
                             (law.gamma + line.slope + line.offset / weakest) / std::sqrt(1 + line.slope * line.slope));
        });
    return area * law.sigma_c * law.smallest_phi() * shear;
}

constexpr Index most_corners = 1000;  // of a fan whose reactions are found one by one

/// [Pa]
double threshold_of(const Model& model, const Fan& fan) {
    const Mesh& mesh = model.mesh;
    const auto corners = model.corners(fan);
    const auto points = model.points(fan);
    const auto unit_force = [&](Index i) {
        const Index t = mesh.triangle_of(corners[i]);
        return force_of_unit_stress(shape_gradients(mesh, t), mesh.area(t) * model.thickness, mesh.order,
                                    mesh.place_in_triangle(corners[i]));
    };
    std::vector<double> sum(fan.n_points, 0);    // [m2] sum_i |a_ji| L_i
    std::vector<double> reaction(fan.n_points);  // a_ji
    if (fan.n_corners > most_corners) {          // |a_ji| <= 2, in linear time
        for (Index i = 0; i < fan.n_corners; ++i) sum[0] += 2 * unit_force(i);
        std::ranges::fill(sum, sum[0]);
    }
    for (Index i = 0; i < fan.n_corners && fan.n_corners <= most_corners; ++i) {
        double walked = 0, weighted = 0, weight = 0;
        for (Index j = 0; j < fan.n_points; ++j) {
            // R_after = R_before - (m a - f): point j lies before corner j of a closed fan, after that of an open one
            const Index body = fan.closed ? j - 1 : j;
            if (body >= 0) walked -= model.corner_mass[corners[body]] / fan.mass - (body == i ? 1 : 0);
            reaction[j] = walked;
            weighted += 1 / points[j].area * walked;
            weight += 1 / points[j].area;
        }
        const double self_stress = fan.closed ? -weighted / weight : 0;
        const double L = unit_force(i);
        for (Index j = 0; j < fan.n_points; ++j) sum[j] += std::abs(reaction[j] + self_stress) * L;
    }
    double stress = infinity;
    for (Index j = 0; j < fan.n_points; ++j) {
        const double strength = sure_strength(model.laws[points[j].law], points[j].area);
        if (strength < infinity) stress = std::min(stress, strength / sum[j]);
    }
    return stress;
}

}  // namespace

std::vector<double> stress_thresholds(const Model& model, std::span<const Dashpot> dashpots) {
    std::vector<double> thresholds;
    for (const Fan& fan : model.fans) {
        const double stress = fan.split_at_start ? infinity : threshold_of(model, fan);
        thresholds.push_back(stress * stress);
    }
    const auto always_test = [&](Index fan) {
        if (thresholds[fan] < infinity) thresholds[fan] = -1;
    };
    for (const CornerLoad& load : model.corner_loads) always_test(model.fan_of_corner[load.corner]);
    for (const CrackFluid& fluid : model.crack_fluids)
        for (const Index p : fluid.joint_points)
            always_test(model.fan_of_corner[model.fan_points[model.fan_point_of[p]].corner()]);
    for (const PrescribedMotion& motion : model.prescribed) always_test(motion.fan);
    for (const Dashpot& dashpot : dashpots) always_test(dashpot.fan);
    return thresholds;
}

void add_inscribed_circles(const Model& model, const Fan& fan, std::vector<InscribedCircle>& circles) {
    constexpr double unknown = -1;
    const auto corners = model.corners(fan);
    const bool driven = model.motion_of(corners[0]);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index j = fan.closed ? (i + 1) % fan.n_points : i;
        double strength = infinity;
        if (j < fan.n_points) {
            const FanPoint& after = model.points(fan)[j];
            strength = sure_strength(model.laws[after.law], after.area) * (1 - relative_tolerance);
        }
        circles.push_back(
            {.share = model.corner_mass[corners[i]] / fan.mass, .strength2 = driven ? unknown : strength * strength});
    }
}

}  // namespace knap
