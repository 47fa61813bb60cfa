#include "element/green_step.hpp"

#include "element/shape_functions.hpp"

namespace knap {
namespace {

/// D applied to a symmetric strain.
Eigen::Matrix2d stress_of(const Eigen::Matrix2d& strain, const LameConstants& elastic) {
    return elastic.lambda * strain.trace() * Eigen::Matrix2d::Identity() + elastic.twice_shear * strain;
}

Eigen::Matrix2d symmetric(const Eigen::Matrix2d& A) { return 0.5 * (A + A.transpose()); }

/// E - e I
Eigen::Matrix2d strain_at_begin(const Eigen::Matrix2d& H, double thermal) {
    return symmetric(H) + 0.5 * H.transpose() * H - thermal * Eigen::Matrix2d::Identity();
}

double product(const Eigen::Matrix2d& A, const Eigen::Matrix2d& B) { return A.cwiseProduct(B).sum(); }

}  // namespace

GreenStep::GreenStep(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness)
    : mesh_(mesh), thickness_(thickness) {
    for (const Elastic& material : materials)
        stiffness_.push_back({material.first_lame(plane), 2 * material.shear_modulus()});
}

GreenStep::Gradients GreenStep::gradients(Index t, const Motion& motion) const {
    const auto g = shape_gradients(mesh_, t);
    const auto gradient = [&](std::span<const Vec2> of_corner) -> Eigen::Matrix2d {
        const Vec2& origin = of_corner[3 * t];
        return (of_corner[3 * t + 1] - origin) * g[1].transpose() + (of_corner[3 * t + 2] - origin) * g[2].transpose();
    };
    return {.begin = gradient(motion.displacement), .change = gradient(motion.change)};
}

void GreenStep::find_forces(Index t, const Motion& motion, Vec2* force) const {
    const Gradients at = gradients(t, motion);
    const bool heated = !motion.thermal_strain.empty();
    const Eigen::Matrix2d middle = at.middle();
    Eigen::Matrix2d strain = strain_at_begin(at.begin, heated ? motion.thermal_strain[t] : 0) +
                             motion.theta * symmetric(middle.transpose() * at.change);
    if (heated) strain -= motion.theta * motion.thermal_change[t] * Eigen::Matrix2d::Identity();
    const Eigen::Matrix2d P = (-mesh_.area(t) * thickness_) * middle * stress_of(strain, stiffness_[mesh_.region[t]]);
    const auto g = shape_gradients(mesh_, t);
    force[1] = P * g[1], force[2] = P * g[2];
    force[0] = -(force[1] + force[2]);
}

GreenStep::Energies GreenStep::energies(Index t, const Motion& motion) const {
    const Gradients at = gradients(t, motion);
    const bool heated = !motion.thermal_strain.empty();
    const LameConstants& elastic = stiffness_[mesh_.region[t]];
    const double volume = mesh_.area(t) * thickness_, growth = heated ? motion.thermal_change[t] : 0;
    const Eigen::Matrix2d I = Eigen::Matrix2d::Identity(),
                          before = strain_at_begin(at.begin, heated ? motion.thermal_strain[t] : 0),
                          change = symmetric(at.middle().transpose() * at.change) - growth * I,
                          after = strain_at_begin(at.begin + at.change, heated ? motion.thermal_strain[t] + growth : 0),
                          mean = before + motion.theta * change;
    return {.end = 0.5 * volume * product(after, stress_of(after, elastic)),
            .dissipated = (motion.theta - 0.5) * volume * product(change, stress_of(change, elastic)),
            .thermal = -growth * volume * stress_of(mean, elastic).trace()};
}

Vec2 GreenStep::direction(Index t, const Motion& motion) const {
    const Eigen::Matrix2d F = gradients(t, motion).middle();
    return {F(0, 0) + F(1, 1), F(1, 0) - F(0, 1)};
}

}  // namespace knap
