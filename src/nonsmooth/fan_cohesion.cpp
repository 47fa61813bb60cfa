#include "nonsmooth/fan_cohesion.hpp"

#include "nonsmooth/fan_ramps.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_cohesion_solves = 1000;  // tens are usual
constexpr double beta_tolerance = 1e-14;   // [-] change of beta

/// beta+ by the law at the end openings of a solved problem.
double cohesion_after(const SolvedFan& fan, const LinkCohesion& at) {
    const FanLink& link = fan.problem.links[at.link];
    const Vec2 rate = fan.result.across(link);
    const double h = fan.problem.drift_time;
    return at.law->next_cohesion(at.start, link.u_N + h * link.normal.dot(rate),
                                 link.u_T + h * link.tangent().dot(rate), h);
}

}  // namespace

FanSolution solve_softening(SolvedFan& fan, FanSolver& solver, std::vector<LinkCohesion>& cohesion, double theta,
                            double rest) {
    for (LinkCohesion& at : cohesion) at.guess = at.start;
    int iterations = 0;
    for (int solve = 1;; ++solve) {
        FanSolution solution = solve_on_ramps(fan, solver, rest);
        iterations += solution.iterations;
        double gap = 0;
        for (LinkCohesion& at : cohesion) {
            const double answer = cohesion_after(fan, at);
            gap = std::max(gap, std::abs(answer - at.guess));
            at.guess = std::clamp(answer, 0.0, at.start);
        }
        if (gap <= beta_tolerance || solve == max_cohesion_solves) {
            solution.iterations = iterations;
            solution.residual = std::max(solution.residual, gap);
            solution.settled = gap <= max_residual;
            return solution;
        }
        for (const LinkCohesion& at : cohesion)
            fan.problem.links[at.link].cohesive = at.strength * (theta * at.guess + (1 - theta) * at.start) / at.start;
    }
}

}  // namespace knap
