#include "lcp/residual.hpp"

#include "lcp/scaling.hpp"

#include <limits>

namespace knap {

double natural_residual(const LcpProblem& problem, const Eigen::VectorXd& z) {
    if (z.size() != problem.q.size() || !z.allFinite()) return std::numeric_limits<double>::infinity();
    if (problem.size() == 0) return 0;
    return (problem.M * z + problem.q).cwiseMin(z).cwiseAbs().maxCoeff();
}

double scaled_residual(const LcpProblem& problem, const Eigen::VectorXd& z) {
    if (z.size() != problem.q.size()) return std::numeric_limits<double>::infinity();
    const ScaledLcp scaled = equilibrated(problem);
    return natural_residual(scaled.problem, scaled.scaled_z(z));
}

}  // namespace knap
