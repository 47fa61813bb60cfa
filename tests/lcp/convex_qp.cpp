#include "base/random.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <doctest/doctest.h>

namespace convex_qp_test {

using namespace knap;

namespace {

/// A rope over an obstacle: n points with tension between them, pushed against it by their weight.
LcpProblem rope(int n) {
    LcpProblem problem{LcpMatrix(n, n), Eigen::VectorXd(n)};
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < n; ++i) {
        entries.emplace_back(i, i, 2.0);
        if (i > 0) entries.emplace_back(i, i - 1, -1.0);
        if (i + 1 < n) entries.emplace_back(i, i + 1, -1.0);
        problem.q[i] = i < n / 3 ? -1e-3 : 2e-3;
    }
    problem.M.setFromTriplets(entries.begin(), entries.end());
    return problem;
}

/// Mode I with the law eliminated to 0 <= x <= cap: rows that cap, then rows of the openings.
LcpProblem capped(const Eigen::MatrixXd& M, const Eigen::VectorXd& q, const Eigen::VectorXd& cap) {
    const int n = static_cast<int>(q.size());
    Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    whole.topRightCorner(n, n) = -Eigen::MatrixXd::Identity(n, n);
    whole.bottomLeftCorner(n, n) = Eigen::MatrixXd::Identity(n, n);
    whole.bottomRightCorner(n, n) = M;
    Eigen::VectorXd right(2 * n);
    right << cap, q;
    return lcp_problem(whole, right);
}

}  // namespace

TEST_CASE("convex QP finds the contact of a rope and uses a start") {
    const LcpProblem problem = rope(2000);
    const LcpSolution solution = solve_by_convex_qp(problem);
    CHECK(solution.status == LcpStatus::solved);
    CHECK(scaled_residual(problem, solution.z) <= 1e-10);
    CHECK((solution.z.array() > 0).count() > 666);
    LcpProblem next = problem;
    next.q *= 1.001;
    next.q[0] -= 1e-4;
    const int warm = solve_by_convex_qp(next, {.start = solution.z}).iterations;
    CHECK(warm < solve_by_convex_qp(next).iterations);
}

TEST_CASE("convex QP solves box problems of any rank as Lemke does") {
    Random random(5, "convex qp");
    for (int count = 0; count < 60; ++count) {
        const int n = 1 + count % 20, rank = count % 2 ? n : (n + 1) / 2;
        const Eigen::MatrixXd H = Eigen::MatrixXd::NullaryExpr(n, rank, [&] { return random.uniform(-1, 1); });
        const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(-1, 1); });
        const Eigen::VectorXd cap =
            Eigen::VectorXd::NullaryExpr(n, [&] { return count % 3 ? random.uniform(0, 1) : 0.5; });
        const LcpProblem problem = capped(H * H.transpose(), q, cap);
        const LcpSolution solution = solve_by_convex_qp(problem), other = solve_by_lemke(problem);
        CAPTURE(count);
        REQUIRE(solution.status == LcpStatus::solved);
        CHECK(scaled_residual(problem, solution.z) <= 1e-10);
        // the forces are not unique, their effect is
        CHECK((H.transpose() * (solution.z.tail(n) - other.z.tail(n))).cwiseAbs().maxCoeff() <= 1e-8);
    }
}

TEST_CASE("convex QP reports problems to which it does not apply") {
    Eigen::Matrix2d M;
    M << 1, .5, 0, 1;
    CHECK(solve_by_convex_qp(lcp_problem(M, -Eigen::Vector2d::Ones())).status == LcpStatus::not_applicable);
    M << 1, 2, 2, 1;  // symmetric, indefinite
    CHECK(solve_by_convex_qp(lcp_problem(M, -Eigen::Vector2d::Ones())).status == LcpStatus::not_applicable);
}

}  // namespace convex_qp_test
