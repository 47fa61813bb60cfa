#include "stepper/explicit/stress_criterion.hpp"

#include "element/shape_gradients.hpp"

#include <cmath>
#include <limits>

namespace knap {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// [m2] The largest force on a corner of a uniform stress of norm 1.
double largest_force(const Model& model, Index corner) {
    const Mesh& mesh = model.mesh;
    const Index t = mesh.triangle_of(corner);
    return force_of_unit_stress(shape_gradients(mesh, t), mesh.area(t) * model.thickness, mesh.order, mesh.place_in_triangle(corner));
}

double threshold_of(const Model& model, const Fan& fan) {
    // a_ji: reaction at point j for a unit force on corner i
    std::vector<double> worst(fan.n_points, 0);  // sum_i |a_ji| L_i
    std::vector<double> reaction(fan.n_points);
    for (Index i = 0; i < fan.n_corners; ++i) {
        double walked = 0, weighted = 0, weight = 0;
        for (Index j = 0; j < fan.n_points; ++j) {
            // R_after = R_before - (m a - f): round a closed fan point j lies before corner j, in an open one after it
            const Index body = fan.closed ? j - 1 : j;
            if (body >= 0) {
                const Index corner = model.fan_corners[fan.first_corner + body];
                walked -= model.corner_mass[corner] / fan.mass - (body == i ? 1 : 0);
            }
            reaction[j] = walked;
            const double w = 1 / model.fan_points[fan.first_point + j].area;
            weighted += w * walked;
            weight += w;
        }
        const double self_stress = fan.closed ? -weighted / weight : 0;
        const double most = largest_force(model, model.fan_corners[fan.first_corner + i]);
        for (Index j = 0; j < fan.n_points; ++j) worst[j] += std::abs(reaction[j] + self_stress) * most;
    }
    double stress = infinite;
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model.fan_points[fan.first_point + j];
        const double strength = sure_strength(model.laws[point.law], point.area);
        if (strength < infinite) stress = std::min(stress, strength / worst[j]);
    }
    return stress;
}

}  // namespace

double sure_strength(const CohesiveLaw& law, double area) {
    if (!law.breakable()) return infinite;
    const double shear = (law.gamma + law.friction) / std::sqrt(1 + law.friction * law.friction);
    return area * law.sigma_c * std::min(1.0, shear);
}

std::vector<double> stress_thresholds(const Model& model) {
    std::vector<double> thresholds(model.fans.size());
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        const double stress = fan.split_at_start ? -1 : threshold_of(model, fan);
        thresholds[f] = stress < 0 ? -1 : stress * stress;
    }
    const auto always_test = [&](Index fan) {
        if (thresholds[fan] < infinite) thresholds[fan] = -1;
    };
    for (const CornerLoad& load : model.corner_loads) always_test(model.fan_of_corner[load.corner]);
    for (const PrescribedMotion& motion : model.prescribed) always_test(motion.fan);
    return thresholds;
}

}  // namespace knap
