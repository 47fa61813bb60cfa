#include "base/random.hpp"
#include "lcp/solvers.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace lemke_test {

using namespace knap;
using knap::tests::relative;

namespace {

double residual(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& z) {
    return (M * z + q).cwiseMin(z).cwiseAbs().maxCoeff();
}

/// Empty where there is no solution.
Eigen::VectorXd solved(const Eigen::MatrixXd& M, const Eigen::VectorXd& q) {
    Eigen::VectorXd z(q.size());
    return solve_lcp_by_lemke(M, q, z) ? z : Eigen::VectorXd();
}

Eigen::MatrixXd random_matrix(Random& random, int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform(-1, 1); });
}

}  // namespace

TEST_CASE("Lemke solves positive definite and rank-deficient problems with ties") {
    Random random(1, "lcp");
    for (int count = 0; count < 300; ++count) {
        const int n = 1 + static_cast<int>(random.uniform(0, 30)), rank = count % 2 ? n : (n + 1) / 2;
        const Eigen::MatrixXd H = random_matrix(random, n, rank);
        const Eigen::MatrixXd M = H * H.transpose();
        Eigen::VectorXd q = H * random_matrix(random, rank, 1);                 // in the range of H: solvable
        if (count % 5 == 0) q = -H * H.transpose() * Eigen::VectorXd::Ones(n);  // many solutions, ties
        const Eigen::VectorXd z = solved(M, q);
        REQUIRE(z.size() == n);
        CHECK(residual(M, q, z) <= 1e-10);
    }
}

TEST_CASE("Lemke finds solutions with friction and reports when there is none") {
    // one contact that slides: 0 <= p perp q_N + p, friction mu p against q_T (rows p, forward, backward, slack)
    const double mu = 0.5;
    Eigen::MatrixXd M(4, 4);
    M << 1, 0, 0, 0, 0, 1, -1, 1, 0, -1, 1, 1, mu, -1, -1, 0;
    Eigen::VectorXd q(4);
    q << -1, 3, -3, 0;
    const Eigen::VectorXd z = solved(M, q);
    REQUIRE(z.size() == 4);
    CHECK(z[0] == relative(1));
    CHECK(z[2] == relative(mu));
    CHECK(z[1] == 0);
    Eigen::MatrixXd wedge(1, 1);
    wedge << -1;
    CHECK(solved(wedge, Eigen::VectorXd::Constant(1, -1)).size() == 0);
    CHECK(solved(wedge, Eigen::VectorXd::Constant(1, 2)).isZero());
}

}  // namespace lemke_test
