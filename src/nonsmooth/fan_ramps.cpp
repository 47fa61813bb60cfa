#include "nonsmooth/fan_ramps.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_ramp_solves = 30;  // up to seven are usual

/// A link whose energy is linear at the end of its step and was quadratic at its start gets a tangent of r as its ramp,
/// the others their ramp. The solution lies on the last tangent, above r: the r that is sought is below the one found,
/// and its opening d above. So the next tangent touches between these two, at the geometric mean of the d found and the
/// d that belongs to the r found (r is a hyperbola).
/// Returns the distance of the `rate` found [m/s] and the r that the link bears from the law [-], with velocities over
/// `speed` [m/s]: on stiff ramps the rounding of velocities is many errors of r.
double follow_energy(double h, const Vec2& rate, double cohesive_impulse, double speed, FanLink& link) {
    const double mean = 0.25 * h * (link.ramp * link.ramp_part(rate) - link.ramp_shift);            // [m] opening
    const double opened = std::max(link.middle.x(), 0.0) + link.gamma * std::abs(link.middle.y());  // s-
    const double a = link.kappa - opened, d = 2 * (mean - opened), found = cohesive_impulse / link.cohesive;
    const auto part_at = [&](double passed) { return 1 - 0.5 * a * a / (link.kappa * passed); };
    const bool may_pass = a > relative_tolerance * link.kappa, passes = may_pass && d > a;
    const double softer = passes ? (d / a) * (d / a) : 1;  // the slope of r here is that of the ramp over this
    double touch = 0;                                      // [m] d of the tangent; up to a it is the ramp
    if (may_pass) {
        const double by_opening = std::max(d, a),
                     by_force = found < 1 ? 0.5 * a * a / (link.kappa * (1 - found)) : by_opening;
        touch = std::sqrt(by_opening * std::max(by_force, a));
    }
    link.set_ramp(h);
    const double part = passes ? part_at(d) : std::clamp(mean / link.kappa, 0.0, 1.0), off = std::abs(found - part),
                 as_speed = off * softer * link.ramp / speed;
    double shift = 0;
    if (may_pass && touch > a) {
        link.ramp *= (touch / a) * (touch / a);
        shift = part_at(touch) * link.ramp - 4 / h * (0.5 * touch + opened);
    }
    link.ramp_start.x() += shift - link.ramp_shift;
    link.ramp_shift = shift;
    return as_speed <= 10 * relative_tolerance ? 0 : std::min(off, as_speed);
}

}  // namespace

FanSolution solve_on_ramps(SolvedFan& fan, FanSolver& solver, double rest) {
    FanProblem& problem = fan.problem;
    const FanResult& result = fan.result;
    FanSolution solution = solver.solve(problem, fan.result, rest);
    if (!problem.has_ramps) return solution;
    const double speed = scales_of(problem, rest).speed;
    for (int solve = 1;; ++solve) {
        double error = 0;
        for (std::size_t i = 0; i < problem.links.size(); ++i)
            if (FanLink& link = problem.links[i]; link.kappa > 0 && link.cohesive > 0)
                error = std::max(error, follow_energy(problem.drift_time, result.across(link),
                                                      result.links[i].cohesive_impulse, speed, link));
        if (error <= relative_tolerance || solve == max_ramp_solves) {
            solution.residual = std::max(solution.residual, error > relative_tolerance ? error : 0);
            return solution;
        }
        const int before = solution.iterations;
        solution = solver.solve(problem, fan.result, rest);
        solution.iterations += before;
    }
}

}  // namespace knap
