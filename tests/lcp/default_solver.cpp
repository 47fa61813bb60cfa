// The default solver: presolve, warm starts, sizes beyond dense methods.
#include "base/random.hpp"
#include "lcp/infeasibility.hpp"
#include "lcp/matrix_market.hpp"
#include "lcp/presolve.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"
#include "lcp/spurious_breaking.hpp"
#include "support/cohesive_lcp.hpp"

#include <doctest/doctest.h>

#include <string>

namespace default_solver_test {

using namespace knap;
using knap::tests::CohesiveBody;
using knap::tests::CohesiveScene;

namespace {

LcpProblem stored(const std::string& name) {
    return read_lcp(std::string(KNAP_SOURCE_DIR) + "/tests/lcp/data/" + name);
}

void check_solved(const LcpProblem& problem, const LcpSolution& solution) {
    CHECK(solution.status == LcpStatus::solved);
    CHECK(scaled_residual(problem, solution.z) <= max_residual);
    if (const auto layout = cohesive_layout(problem))
        CHECK(spurious_breaking(problem, solution.z, *layout).n_spurious == 0);
}

}  // namespace

TEST_CASE("the box form of a cohesive problem has two unknowns a point and two a contact") {
    for (const char* name : {"line_4", "all_2", "line_16_si"}) {
        const LcpProblem problem = stored(name);
        const CohesiveLayout layout = cohesive_layout(problem).value();
        const BoxLcp box = presolve(problem);
        CHECK(box.size() == 2 * layout.n_cohesive + 2 * layout.n_contacts);
        for (int i = 0; i < box.size(); ++i) CHECK(box.M.coeff(i, i) <= 2);
    }
}

TEST_CASE("presolve and its inverse keep a solution") {
    const LcpProblem problem = stored("all_2");
    const LcpSolution solution = solve_by_lemke(problem);
    const BoxLcp box = presolve(problem);
    const Eigen::VectorXd x = box.box_start(solution.z);
    CHECK(box.residual(x) <= 1e-12);
    CHECK(scaled_residual(problem, box.lcp_point(x)) <= 1e-12);
}

TEST_CASE("rows that are not bounds stay in the box form") {
    Eigen::MatrixXd M(4, 4);  // a contact with friction; the last row is the bound of the two before it
    M << 1, .8, -.8, 0, .8, 1, -1, 1, -.8, -1, 1, 1, .5, -1, -1, 0;
    const Eigen::Vector4d q(.3, 1, -1, 0);
    CHECK(presolve(lcp_problem(M, q)).size() == 2);
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            if (row == 0 && column == 0) continue;
            Eigen::MatrixXd other = M;
            other(row, column) += 0.25;
            const bool still =
                (row == 3 && column == 0) ||
                (row == 0 && column == 3);  // another friction coefficient, or the slack feeds the contact
            CAPTURE(row);
            CAPTURE(column);
            CHECK(presolve(lcp_problem(other, q)).size() == (still ? 2 : 4));
        }
    CHECK(presolve(lcp_problem(M, Eigen::Vector4d(.3, 1, -1, -1))).size() == 4);  // a bound below zero
    CHECK(presolve(lcp_problem(M, Eigen::Vector4d(.3, 1, -.9, 0))).size() == 4);
    CHECK(presolve(lcp_problem(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0))).size() == 0);
}

TEST_CASE("large redundant problems are solved without spurious bond breaking") {
    struct Size {
        CohesiveScene scene;
        int least;
    };
    for (const Size& size : {Size{{.n_x = 8, .n_y = 8}, 3000}, Size{{.n_x = 14, .n_y = 14}, 10000},
                             Size{{.n_x = 8, .n_y = 8, .step = 4, .theta = 0.5}, 3000}}) {
        CohesiveBody body(size.scene);
        Eigen::VectorXd start;
        for (int step = 0; step < 3; ++step) {
            const LcpProblem problem = body.problem();
            CHECK(problem.size() > size.least);
            const LcpSolution solution = solve_by_default(problem, {.start = start});
            check_solved(problem, solution);
            body.advance(solution.z);
            start = body.start();
        }
        CHECK(body.n_damaged() > body.n_points() / 20);  // bonds have broken
    }
}

TEST_CASE("a problem whose inequalities contradict each other ends with a ray that proves it") {
    Random random(11, "infeasible lcp");
    int n_proven = 0, n_solved = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const int n = 2 + trial % 7;
        Eigen::MatrixXd M = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.uniform(-1, 1); });
        Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(-1, 1); });
        const bool contradicts = trial % 2 == 0;
        if (contradicts) {  // the rows add up to a sum that is negative for every z >= 0
            M.row(n - 1) = -M.topRows(n - 1).colwise().sum();
            q[n - 1] = -q.head(n - 1).sum() - 0.3;
        } else if (trial % 4 == 1) {  // z = 0 solves it
            q = q.cwiseAbs();
        }
        LcpProblem problem = lcp_problem(M, q);
        const LcpSolution found = solve_by_default(problem);
        CAPTURE(trial);
        CHECK((found.status == LcpStatus::ray) == (found.ray.size() > 0));
        if (contradicts) CHECK(found.status == LcpStatus::ray);
        if (found.status != LcpStatus::ray) {
            n_solved += found.status == LcpStatus::solved;
            continue;
        }
        ++n_proven;
        CHECK(proves_infeasibility(problem, found.ray));
        for (const LcpSolver& solver : lcp_solvers()) CHECK(solver.solve(problem, {}).status != LcpStatus::solved);
        int largest = 0;
        found.ray.maxCoeff(&largest);
        Eigen::VectorXd other = found.ray;
        other[largest] = -other[largest];
        CHECK(!proves_infeasibility(problem, other));
        problem.q = problem.q.cwiseAbs();  // now z = 0 is a solution
        CHECK(!proves_infeasibility(problem, found.ray));
        CHECK(find_infeasible_ray(problem).size() == 0);
    }
    CHECK(n_proven >= 30);
    CHECK(n_solved >= 15);
}

TEST_CASE("problems with a skew matrix end with a solution or with a ray that proves that there is none") {
    Random random(12, "skew lcp");  // solvable where the inequalities do not contradict each other
    int n_solved = 0, n_proven = 0;
    for (int trial = 0; trial < 800; ++trial) {
        const int n = 2 + trial % 14;
        const Eigen::MatrixXd half = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.uniform(-1, 1); });
        const Eigen::VectorXd q = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(-1, 1); });
        const LcpProblem problem = lcp_problem(half - half.transpose(), q);
        const LcpSolution found = solve_by_default(problem);
        n_solved += found.status == LcpStatus::solved;
        n_proven += found.status == LcpStatus::ray && proves_infeasibility(problem, found.ray);
    }
    CHECK(n_solved + n_proven == 800);
    CHECK(n_solved >= 300);
    CHECK(n_proven >= 300);
}

TEST_CASE("Newton on the box form converges after a few sweeps") {
    for (const char* name : {"line_4", "all_2", "line_16_si", "trajH_s020"}) {
        CAPTURE(std::string(name));
        const LcpProblem problem = stored(name);
        const BoxLcp box = presolve(problem);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(box.size());
        Sweeps(box).run(x, 5);
        int n_solves = 0;
        CHECK(solve_box_by_newton(box, 1e-12, 60, x, n_solves) == LcpStatus::solved);
        CHECK(n_solves < 20);
        check_solved(problem, {.z = box.lcp_point(x)});
    }
}

TEST_CASE("steps beyond Assumption 1 are solved") {
    int n_beyond = 0;
    for (const double stiffness : {3.0, 10.0, 30.0})
        for (const double step : {5.0, 20.0})
            for (const double stretch : {0.0, 2.0}) {
                CAPTURE(stiffness);
                CAPTURE(step);
                CAPTURE(stretch);
                const CohesiveBody body({.n_x = 3,
                                         .n_y = 2,
                                         .step = step,
                                         .theta = 0.5,
                                         .stiffness = stiffness,
                                         .stretch = stretch,
                                         .shear = 0,
                                         .notch = 0,
                                         .noise = 0.01});
                const LcpProblem problem = body.problem();
                const Eigen::VectorXd curvature = problem.M.diagonal().segment(body.n_points(), body.n_points());
                n_beyond += curvature.minCoeff() < 0;
                const LcpSolution solution = solve_by_default(problem);
                check_solved(problem, solution);
            }
    CHECK(n_beyond >= 8);
}

TEST_CASE("a large step far beyond Assumption 1 with friction takes few rounds of proximal points") {
    const CohesiveBody body(
        {.n_x = 8, .n_y = 5, .step = 100, .theta = 0.5, .stiffness = 1, .stretch = 0, .shear = 0.5, .noise = 0.01});
    const LcpProblem problem = body.problem();
    const LcpSolution solution = solve_by_default(problem);
    check_solved(problem, solution);
    CHECK(solution.iterations <= 400);  // 6382 where a round ended before its convex problem was solved
}

TEST_CASE("solvers that use a start need no iterations from the solution") {
    const LcpProblem problem = stored("all_2");
    const Eigen::VectorXd z = solve_by_lemke(problem).z;
    for (const LcpSolver& solver : lcp_solvers()) {
        CAPTURE(std::string(solver.name));
        const int cold = solver.solve(problem, {}).iterations, warm = solver.solve(problem, {.start = z}).iterations;
        if (solver.uses_start) CHECK(warm == 0);
        else CHECK(warm == cold);
    }
}

TEST_CASE("a warm start is nearer to the solution along a run") {
    CohesiveBody body({.n_x = 6, .n_y = 6});
    double cold = 0, warm = 0;  // change of the tenth sweep
    for (int step = 0; step < 6; ++step) {
        const LcpProblem problem = body.problem();
        const Eigen::VectorXd start = body.start();
        const LcpSolution solution = solve_by_default(problem, {.start = start});
        check_solved(problem, solution);
        if (step > 0) {
            const BoxLcp box = presolve(problem);
            Eigen::VectorXd from_nothing = Eigen::VectorXd::Zero(box.size()), from_before = box.box_start(start);
            cold += Sweeps(box).run(from_nothing, 10);
            warm += Sweeps(box).run(from_before, 10);
        }
        body.advance(solution.z);
    }
    CAPTURE(cold);
    CAPTURE(warm);
    CHECK(warm < 0.5 * cold);
}

TEST_CASE("proximal points separate redundant conditions of a monotone problem") {
    // as the slips of the polygon of coupling = "norm": more unknowns than directions of motion
    Random random(13, "redundant lcp");
    for (int n = 4; n <= 40; n += 4) {
        const Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(n, n / 2, [&] { return random.uniform(-1, 1); });
        const Eigen::VectorXd slack = Eigen::VectorXd::NullaryExpr(n, [&] { return random.uniform(-1, 1); }),
                              q = slack.cwiseMax(0) - rows * (rows.transpose() * (-slack).cwiseMax(0));
        const LcpProblem problem = lcp_problem(rows * rows.transpose(), q);  // solved by z = max(-slack, 0)
        const BoxLcp box = without_presolve(problem);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
        int count = 0;
        CHECK(solve_box_by_proximal_points(box, 1e-11, x, count) == LcpStatus::solved);
        CHECK(scaled_residual(problem, box.lcp_point(x)) <= 1e-10);
    }
}

}  // namespace default_solver_test
