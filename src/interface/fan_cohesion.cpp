#include "interface/fan_cohesion.hpp"

#include "interface/fan_ramps.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_cohesion_solves = 1000;  // tens are usual
constexpr double beta_tolerance = 1e-14;   // [-] change of beta
constexpr double tolerated = 1e-10;        // [-] gap of a step that is accepted: the gate of every run
constexpr double worth_mixing = 0.9;       // ratio of gaps; above, softening outweighs inertia and the secant diverges

/// beta+ by the law at the end openings of a solved problem.
double cohesion_after(const SolvedFan& fan, const LinkCohesion& at) {
    const FanLink& link = fan.problem.links[at.link];
    const Vec2 rate = fan.result.across(link);
    const double h = fan.problem.drift_time;
    return at.law->next_cohesion(at.start, link.u_N + h * link.normal.dot(rate),
                                 link.u_T + h * link.tangent().dot(rate), h);
}

}  // namespace

FanSolution solve_softening(SolvedFan& fan, FanSolver& solver, std::vector<LinkCohesion>& cohesion, double theta) {
    for (LinkCohesion& at : cohesion) at.guess = at.start;
    double last_gap = 0;
    int iterations = 0;
    for (int solve = 1;; ++solve) {
        FanSolution solution = solve_on_ramps(fan, solver);
        iterations += solution.iterations;
        double gap = 0, product = 0, top = 0, bottom = 0;
        for (LinkCohesion& at : cohesion) {
            at.answer = cohesion_after(fan, at);
            const double change = at.gap() - at.last_gap;
            gap = std::max(gap, std::abs(at.gap()));
            product += at.gap() * at.last_gap;  // negative: the secant interpolates between the last two answers
            top += at.gap() * change;
            bottom += change * change;
        }
        if (gap <= beta_tolerance || solve == max_cohesion_solves) {
            solution.iterations = iterations;
            solution.residual = std::max(solution.residual, gap);
            solution.settled = gap <= tolerated;
            return solution;
        }
        // part of the last change of the answers to take back, so that the gaps cancel as well as they can
        const bool mixes = solve > 1 && bottom > 0 && (gap < worth_mixing * last_gap || product < 0);
        const double mixed = mixes ? top / bottom : 0;
        for (LinkCohesion& at : cohesion) {
            const double next = at.answer - mixed * (at.answer - at.last_answer);
            at.last_gap = at.gap();
            at.last_answer = at.answer;
            at.guess = std::clamp(next, 0.0, at.start);
            fan.problem.links[at.link].cohesive = at.strength * (theta * at.guess + (1 - theta) * at.start) / at.start;
        }
        last_gap = gap;
    }
}

}  // namespace knap
