// Where the method of multipliers finds no solution of a step, in small bodies: the step as one linear complementarity problem (step_lcp.hpp), whose solution by
// pivots is where the method of multipliers begins anew. So what is taken is found to its tolerance and judged like any other step.
#include "lcp/solvers.hpp"
#include "stepper/implicit/implicit_scheme.hpp"
#include "stepper/implicit/step_lcp.hpp"

#include <cmath>

namespace knap {
namespace {

constexpr std::size_t max_points = 100;  // of fans, in the body: up to nine unknowns each, and the last resort is a dense tableau

/// Units of the rows of the problem and of its unknowns, in those of the body: which path the solver takes must not depend on the user's.
struct Units {
    Eigen::VectorXd row, unknown;

    Units(const StepLcpLayout& at, double mass, double length, double time) : row(at.size()), unknown(at.size()) {
        const double speed = length / time, impulse = mass * speed, force = impulse / time, area = length * length;
        const auto set = [&](int first, int n, double of_row, double of_unknown) {
            row.segment(first, n).setConstant(of_row);
            unknown.segment(first, n).setConstant(of_unknown);
        };
        if (at.implicit_beta) set(at.bond(0), at.m(), 1, force * length), set(at.beta(0), at.m(), force / length, area);
        set(at.normal(0), at.c(), speed, impulse);
        if (at.friction) set(at.slip(0), 2 * at.c(), speed, impulse), set(at.slip_rate(0), at.c(), impulse, speed);
        if (at.tangential) set(at.tangent(0), 2 * at.m(), length, force), set(at.offset(0), at.m(), force, length);
        set(at.opening(0), static_cast<int>(at.landing.size()), length, length);
    }
};

double power_of_two(double x) { return std::exp2(std::ilogb(x)); }

}  // namespace

bool ImplicitScheme::start_from_lemke(const State& begin, double h) {
    if (model_.fan_points.size() > max_points || !model_.obstacles.empty()) return false;
    const StepLcp step = step_lcp(model_, begin, h, options_);
    const double length = (model_.mesh.corner(1) - model_.mesh.corner(0)).norm();
    const Units unit(step.layout, power_of_two(model_.corner_mass[0]), power_of_two(length), power_of_two(h));
    const Eigen::VectorXd scale = unit.row.cwiseInverse();
    const LcpMatrix M(scale.asDiagonal() * step.problem.M * unit.unknown.asDiagonal());
    const LcpSolution found = solve_by_default({M, scale.cwiseProduct(step.problem.q)}, {.exhaustive = false});
    if (found.status != LcpStatus::solved) return false;
    const StepLcpEnd end = recover(step, model_, begin, h, unit.unknown.cwiseProduct(found.z));
    corner_rate_ = end.rate;
    active_.assign(model_.fans.size(), 1);
    has_guess_.assign(model_.fan_points.size(), 1);
    for (std::size_t i = 0; i < model_.fan_points.size(); ++i) {
        const Index point = model_.fan_points[i].point;
        guess_[i] = options_.theta * Vec2(end.contact[point], end.impulse[point].y());
    }
    return true;
}

}  // namespace knap
