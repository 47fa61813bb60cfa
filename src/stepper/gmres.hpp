#pragma once
// GMRES without restart (Y. Saad, M. Schultz 1986): A x = b with A known by what it does, for matrices close to the unit matrix.
#include <Eigen/Core>

#include <functional>
#include <optional>

namespace knap {

/// Nothing, where the residual is not below `tolerance` times |b| after `most_steps` products.
std::optional<Eigen::VectorXd> gmres(const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& product, const Eigen::VectorXd& b,
                                     int most_steps, double tolerance);

}  // namespace knap
