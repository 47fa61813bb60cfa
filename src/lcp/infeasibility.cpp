// The ray is what is missing at the point that comes nearest to the inequalities:
//
//     min 1/2 |y|^2,   y = w - M z - q,   z, w >= 0          optimal:  0 <= -M'y perp z >= 0,   0 <= y perp w >= 0
//
// so that q'y = -|y|^2. This convex problem always has a solution, and as a complementarity problem in (z, w) Lemke's
// pivots find it. What the rounding of large z leaves of M'y in the rows where z > 0 is removed from y.
#include "lcp/infeasibility.hpp"

#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <Eigen/QR>

#include <vector>

namespace knap {
namespace {

constexpr double smallest_ray = 1e-8;   // of q: a smaller distance from the inequalities is rounding
constexpr double rounding = 1e-10;      // of M'y compared with -q'y
constexpr int max_ray_unknowns = 1000;  // the pivots take seconds

/// The least change of y, where w = 0, that makes M'y zero where z > 0; y is zero elsewhere.
void remove_rounding(const Eigen::MatrixXd& M, const Eigen::VectorXd& z, const Eigen::VectorXd& w, Eigen::VectorXd& y) {
    std::vector<int> rows, columns;
    for (int i = 0; i < y.size(); ++i)
        if (y[i] > w[i]) rows.push_back(i);
        else y[i] = 0;
    const Eigen::VectorXd product = M.transpose() * y;
    for (int j = 0; j < y.size(); ++j)
        if (z[j] > -product[j]) columns.push_back(j);
    if (rows.empty() || columns.empty()) return;
    const Eigen::VectorXd excess = product(columns);
    y(rows) -= M(rows, columns).transpose().completeOrthogonalDecomposition().solve(excess);
    y = y.cwiseMax(0);
}

}  // namespace

bool proves_infeasibility(const LcpProblem& problem, const Eigen::VectorXd& y) {
    if (y.size() != problem.size() || y.size() == 0 || !y.allFinite() || y.minCoeff() < 0) return false;
    LcpProblem scaled = problem;
    const LcpScaling scaling = equilibrate(scaled);
    const Eigen::VectorXd ray = y.cwiseQuotient(scaling.factor);  // y'M z and y'q do not change but for the unit
    const double gain = -scaled.q.dot(ray);
    return gain > smallest_ray * ray.cwiseAbs().maxCoeff() &&
           (scaled.M.transpose() * ray).maxCoeff() <= rounding * gain;
}

Eigen::VectorXd find_infeasible_ray(const LcpProblem& problem) {
    const int n = problem.size();
    if (n == 0 || n > max_ray_unknowns) return {};
    LcpProblem scaled = problem;
    const LcpScaling scaling = equilibrate(scaled);
    const Eigen::MatrixXd M(scaled.M);
    Eigen::MatrixXd nearest(2 * n, 2 * n);
    nearest << M.transpose() * M, -M.transpose(), -M, Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd q(2 * n);
    q << M.transpose() * scaled.q, -scaled.q;
    const Eigen::VectorXd z = solve_by_lemke(lcp_problem(nearest, q)).z;
    Eigen::VectorXd y = (z.tail(n) - M * z.head(n) - scaled.q).cwiseMax(0);
    remove_rounding(M, z.head(n), z.tail(n), y);
    y = y.cwiseProduct(scaling.factor);
    if (y.maxCoeff() > 0) y /= y.maxCoeff();
    return proves_infeasibility(problem, y) ? y : Eigen::VectorXd();
}

}  // namespace knap
