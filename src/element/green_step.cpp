#include "element/green_step.hpp"

#include "element/shape_functions.hpp"

namespace knap {
namespace {

Eigen::Matrix2d symmetric(const Eigen::Matrix2d& A) { return 0.5 * (A + A.transpose()); }

Eigen::Matrix2d green_strain(const Eigen::Matrix2d& H) { return symmetric(H) + 0.5 * H.transpose() * H; }

double product(const Eigen::Matrix2d& A, const Eigen::Matrix2d& B) { return A.cwiseProduct(B).sum(); }

}  // namespace

GreenStep::GreenStep(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness)
    : mesh_(mesh), thickness_(thickness) {
    ElasticKinds kinds(mesh, materials);
    for (const Elastic& kind : kinds.all) {
        stiffness_.push_back({kind.first_lame(plane), 2 * kind.shear_modulus()});
        layers_.push_back(kind.stiffness_of_layers(plane));
        expansion_.push_back(kind.expansion_in_plane(plane));
    }
    kind_ = std::move(kinds.of_triangle);
}

Eigen::Matrix2d GreenStep::stress_of(const Eigen::Matrix2d& strain, Index t) const {
    const LameConstants& elastic = stiffness_[kind_[t]];
    Eigen::Matrix2d stress =
        elastic.lambda * strain.trace() * Eigen::Matrix2d::Identity() + elastic.twice_shear * strain;
    if (const auto& layers = layers_[kind_[t]]) stress += stress_matrix(*layers * strain_of(strain));
    return stress;
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
    Eigen::Matrix2d strain = green_strain(at.begin) - (heated ? motion.thermal_strain[t] : 0) * expansion(t) +
                             motion.theta * symmetric(middle.transpose() * at.change);
    if (heated) strain -= motion.theta * motion.thermal_change[t] * expansion(t);
    const Eigen::Matrix2d P = (-mesh_.area(t) * thickness_) * middle * stress_of(strain, t);
    const auto g = shape_gradients(mesh_, t);
    force[1] = P * g[1], force[2] = P * g[2];
    force[0] = -(force[1] + force[2]);
}

GreenStep::Energies GreenStep::energies(Index t, const Motion& motion) const {
    const Gradients at = gradients(t, motion);
    const bool heated = !motion.thermal_strain.empty();
    const double volume = mesh_.area(t) * thickness_, thermal = heated ? motion.thermal_strain[t] : 0,
                 growth = heated ? motion.thermal_change[t] : 0;
    const Eigen::Matrix2d &A = expansion(t), before = green_strain(at.begin) - thermal * A,
                          change = symmetric(at.middle().transpose() * at.change) - growth * A,
                          after = green_strain(at.begin + at.change) - (thermal + growth) * A,
                          mean = before + motion.theta * change;
    return {.end = 0.5 * volume * product(after, stress_of(after, t)),
            .dissipated = (motion.theta - 0.5) * volume * product(change, stress_of(change, t)),
            .thermal = -growth * volume * product(stress_of(mean, t), A)};
}

Vec2 GreenStep::direction(Index t, const Motion& motion) const {
    const Eigen::Matrix2d F = gradients(t, motion).middle();
    return {F(0, 0) + F(1, 1), F(1, 0) - F(0, 1)};
}

}  // namespace knap
