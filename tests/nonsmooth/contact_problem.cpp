// Contacts and the points of fans as one problem, against the solver of single fans.
#include "nonsmooth/contact_problem.hpp"
#include "nonsmooth/fan_solver.hpp"
#include "support/fan_judge.hpp"
#include "support/random_fans.hpp"

#include <doctest/doctest.h>

namespace contact_problem_test {

using namespace knap;
using namespace knap::tests;

namespace {

struct Found {
    double error = 0;     // [-] largest difference of velocities, over the speeds of the fan
    double residual = 0;  // [-] likewise
};

/// The motion of a fan by ContactProblem, from zero impulses or with the links that stick in FanSolver's solution, beside
/// that solution.
Found against_fan_solver(const FanProblem& fan, bool stuck_stays) {
    FanResult result;
    if (FanSolver().solve(fan, result).status == FanSolution::Status::failed) return {1, 1};
    const double speed = FanJudge(fan, result).speed_scale();
    const auto n = static_cast<Index>(fan.bodies.size());
    SolvedFan start{fan, result};
    if (!stuck_stays) {
        std::ranges::fill(start.result.velocity, Vec2::Zero());
        std::ranges::fill(start.result.links, LinkResult());
    }
    ContactProblem problem;
    problem.clear();
    const Index first = problem.add_fan(start, n, stuck_stays);
    problem.assemble();
    Found found{.residual = problem.solve(speed, 0) / speed};
    for (Index i = 0; i < n; ++i)
        found.error = std::max(found.error, (problem.velocity(first + i) - result.velocity[i]).norm() / speed);
    return found;
}

}  // namespace

TEST_CASE("points of random fans move as their own solver says") {
    enum class Friction { none, coulomb, over_pressure };
    for (const bool prescribed : {false, true})
        for (const Friction kind : {Friction::none, Friction::coulomb, Friction::over_pressure})
            for (const bool stuck_stays : {false, true}) {
                const int n = 1500;
                int n_other = 0;
                double worst = 0;
                const bool friction = kind != Friction::none, over_pressure = kind == Friction::over_pressure;
                for (int seed = 0; seed < n; ++seed) {
                    RandomFan random(seed, {.friction = friction,
                                            .prescribed = prescribed,
                                            .units = false,
                                            .over_pressure = over_pressure});
                    const Found found = against_fan_solver(random.problem(), stuck_stays);
                    if (found.residual > 1e-10) ++n_other;
                    else if (!friction) worst = std::max(worst, found.error);
                    else n_other += found.error > 1e-7;
                }
                MESSAGE("friction ", friction, ", over pressure ", over_pressure, ", prescribed ", prescribed,
                        ", stuck stays ", stuck_stays, ": ", n_other, " of ", n,
                        " not solved or otherwise, largest difference ", worst);
                CHECK(worst < 1e-9);
                CHECK(n_other <= (friction ? 0.03 * n : 0));  // with friction there may be several solutions
            }
}

// Why both methods stand: src/nonsmooth/README.md has the numbers.
TEST_CASE("of random fans the method of clusters leaves a few with friction and their own solver none" *
          doctest::test_suite("slow")) {
    for (const bool friction : {false, true}) {
        const int n = 5000;
        int n_left = 0, n_pivots = 0, n_failed = 0;
        for (int seed = 0; seed < n; ++seed) {
            const FanProblem fan = RandomFan(seed, {.friction = friction}).problem();
            FanResult result;
            const FanSolution::Status status = FanSolver().solve(fan, result).status;
            n_failed += status == FanSolution::Status::failed;
            n_pivots += status == FanSolution::Status::by_lemke;
            n_left += against_fan_solver(fan, false).residual > 1e-10;
        }
        MESSAGE("friction ", friction, ": the method of clusters solves ", n - n_left, " of ", n,
                ", the solver of fans ", n - n_failed, ", ", n_pivots, " of them by Lemke's method");
        CHECK(n_failed == 0);
        CHECK(n_left <= (friction ? 0.01 * n : 0));
    }
}

}  // namespace contact_problem_test
