#include "interface/fan_cohesion.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_solves = 1000;  // tens are usual
constexpr double settled = 1e-14;      // [-] change of beta
constexpr double worth_mixing = 0.9;   // the gap must have shrunk to this part: where softening outweighs inertia the secant points back
constexpr double tolerated = 1e-10;    // [-] gap of a step that is kept: the gate of every run

/// What the law says at the end openings of a solved problem.
void ask_law(const FanProblem& problem, LinkCohesion& at) {
    const FanLink& link = problem.links[at.link];
    const Vec2 rate = problem.velocity_after(link.after) - problem.velocity_after(link.before);
    at.answer = at.law->next_cohesion(at.begin, link.u_N + problem.drift_time * link.normal.dot(rate), link.u_T + problem.drift_time * link.tangent().dot(rate));
}

double largest_gap(const std::vector<LinkCohesion>& cohesion) {
    double largest = 0;
    for (const LinkCohesion& at : cohesion) largest = std::max(largest, std::abs(at.gap()));
    return largest;
}

/// Whether the secant only interpolates between the last two answers.
bool lies_between(const std::vector<LinkCohesion>& cohesion) {
    double product = 0;
    for (const LinkCohesion& at : cohesion) product += at.gap() * at.last_gap;
    return product < 0;
}

/// Part of the last change of the answers to take back, so that the gaps cancel as well as they can.
double mixing(const std::vector<LinkCohesion>& cohesion) {
    double top = 0, bottom = 0;
    for (const LinkCohesion& at : cohesion) {
        const double change = at.gap() - at.last_gap;
        top += at.gap() * change;
        bottom += change * change;
    }
    return bottom > 0 ? top / bottom : 0;
}

}  // namespace

FanSolution solve_softening(FanProblem& problem, FanSolver& solver, std::vector<LinkCohesion>& cohesion, double theta) {
    for (LinkCohesion& at : cohesion) at.guess = at.begin;
    double last = 0;
    int iterations = 0;
    for (int solve = 1;; ++solve) {
        FanSolution solution = solver.solve(problem);
        iterations += solution.iterations;
        for (LinkCohesion& at : cohesion) ask_law(problem, at);
        const double gap = largest_gap(cohesion);
        if (gap <= settled || solve == max_solves) {
            solution.iterations = iterations;
            solution.residual = std::max(solution.residual, gap);
            solution.settled = gap <= tolerated;
            return solution;
        }
        const bool mixes = solve > 1 && (gap < worth_mixing * last || lies_between(cohesion));
        const double mixed = mixes ? mixing(cohesion) : 0;
        for (LinkCohesion& at : cohesion) {
            const double next = at.answer - mixed * (at.answer - at.last_answer);
            at.last_gap = at.gap();
            at.last_answer = at.answer;
            at.guess = std::clamp(next, 0.0, at.begin);
            problem.links[at.link].cohesive = at.strength * (theta * at.guess + (1 - theta) * at.begin) / at.begin;
        }
        last = gap;
    }
}

}  // namespace knap
