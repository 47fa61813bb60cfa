#include "material/elastic.hpp"

#include <cmath>

namespace knap {

double Elastic::first_lame(PlaneModel model) const {
    return model == PlaneModel::strain ? E * nu / ((1 + nu) * (1 - 2 * nu)) : E * nu / (1 - nu * nu);
}

double Elastic::plane_modulus(PlaneModel model) const { return model == PlaneModel::strain ? E / (1 - nu * nu) : E; }

double Elastic::dilatational_speed(PlaneModel model) const {
    return std::sqrt((first_lame(model) + 2 * shear_modulus()) / density);
}

double Elastic::shear_speed() const { return std::sqrt(shear_modulus() / density); }

double Elastic::rayleigh_speed(PlaneModel model) const {
    // (2 - x)^2 = 4 sqrt(1 - x k) sqrt(1 - x),  x = (c/c_s)^2, k = (c_s/c_d)^2; one root in (0, 1), found by bisection
    const double k = std::pow(shear_speed() / dilatational_speed(model), 2);
    double low = 1e-3, high = 1 - 1e-15;
    for (int i = 0; i < 200; ++i) {
        const double x = 0.5 * (low + high);
        const double f = (2 - x) * (2 - x) - 4 * std::sqrt(1 - x * k) * std::sqrt(1 - x);
        (f < 0 ? low : high) = x;
    }
    return shear_speed() * std::sqrt(0.5 * (low + high));
}

Eigen::Matrix3d Elastic::stiffness(PlaneModel model) const {
    const double l = first_lame(model), g = shear_modulus();
    return (Eigen::Matrix3d() << l + 2 * g, l, 0, l, l + 2 * g, 0, 0, 0, g).finished();
}

}  // namespace knap
