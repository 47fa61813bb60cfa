#include "element/bulk_viscosity.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double largest_compression = 0.02;  // of a triangle while a wave passes it

}  // namespace

ViscousCoefficients viscous_coefficients(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane) {
    ViscousCoefficients found;
    if (std::ranges::none_of(materials, &Elastic::has_viscosity)) return found;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Elastic& material = materials[mesh.region[t]];
        const auto& [b1, b2] = material.bulk_viscosity;
        const double h = viscous_length(mesh, t), impedance = material.density * h * material.dilatational_speed(plane);
        found.linear.push_back(impedance * b1);
        found.shear.push_back(impedance * material.shear_viscosity);
        found.quadratic.push_back(material.density * h * h * b2 * b2);
        found.largest_rate.push_back(largest_compression * material.dilatational_speed(plane) / h);
    }
    return found;
}

Viscosities largest_viscosities(const Elastic& material, PlaneModel plane, double h) {
    const auto& [b1, b2] = material.bulk_viscosity;
    const double impedance = material.density * h * material.dilatational_speed(plane);
    return {.bulk = impedance * (b1 + b2 * b2 * largest_compression), .shear = impedance * material.shear_viscosity};
}

}  // namespace knap
