#include "interface/fan_ramps.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_ramp_solves = 30;          // three are usual
constexpr double ramp_tolerance = 1e-12;     // [-] error of r
constexpr double speed_rounding = 1e-13;     // [-] of the speeds, in the opening that r is taken at
constexpr double touching_envelope = 1e-12;  // [-] of kappa: a point this near to it is on the softening branch

/// A link whose energy is linear at the end of its step and was quadratic at its start gets the tangent of r at the
/// `rate` found [m/s], or with `damping` < 1 nearer to where its last one touches; the others their ramp. Returns the
/// error of the r that they bear [-], less what errors of the `speed` [m/s] explain.
double follow_energy(double h, const Vec2& rate, double borne, double damping, double speed, FanLink& link) {
    const double mean = 0.25 * h * (link.ramp * link.ramp_part(rate) - link.ramp_shift);            // [m] opening
    const double opened = std::max(link.middle.x(), 0.0) + link.gamma * std::abs(link.middle.y());  // s-
    const double a = link.kappa - opened, d = 2 * (mean - opened);
    const auto part_at = [&](double passed) { return 1 - 0.5 * a * a / (link.kappa * passed); };
    const bool may_pass = a > touching_envelope * link.kappa;
    const double part = may_pass && d > a ? part_at(d) : mean / link.kappa;
    const double last = may_pass ? a * std::sqrt(0.25 * h * link.ramp / link.kappa) : 0;  // d of the tangent
    const double next = last + damping * (std::max(d, a) - last);
    link.set_ramp(h);
    double shift = 0;
    if (may_pass && next > a) {
        link.ramp *= (next / a) * (next / a);
        shift = part_at(next) * link.ramp - 4 / h * (0.5 * next + opened);
    }
    link.ramp_start.x() += shift - link.ramp_shift;
    link.ramp_shift = shift;
    return std::max(
        0.0, std::abs(borne / link.cohesive - std::clamp(part, 0.0, 1.0)) - speed_rounding * h * speed / link.kappa);
}

}  // namespace

FanSolution solve_on_ramps(SolvedFan& fan, FanSolver& solver, double rest) {
    FanProblem& problem = fan.problem;
    const FanResult& result = fan.result;
    FanSolution solution = solver.solve(problem, fan.result, rest);
    if (!problem.has_ramps) return solution;
    double damping = 1, last_error = 1, speed = 0;
    for (const FanBody& body : problem.bodies)
        speed = std::max({speed, body.velocity.norm(), body.free_velocity.norm()});
    for (int solve = 1;; ++solve) {
        double error = 0;
        for (std::size_t i = 0; i < problem.links.size(); ++i)
            if (FanLink& link = problem.links[i]; link.kappa > 0 && link.cohesive > 0)
                error = std::max(error, follow_energy(problem.drift_time, result.across(link), result.links[i].borne,
                                                      damping, speed, link));
        if (error <= ramp_tolerance || solve == max_ramp_solves) {
            solution.residual = std::max(solution.residual, error > ramp_tolerance ? error : 0);
            return solution;
        }
        // the states of several links may jump to and fro between stiff and soft tangents
        if (solve > 2) damping = error > 0.5 * last_error ? std::max(0.5 * damping, 0.1) : std::min(2 * damping, 1.0);
        last_error = error;
        const int before = solution.iterations;
        solution = solver.solve(problem, fan.result, rest);
        solution.iterations += before;
    }
}

}  // namespace knap
