#include "stepper/implicit/lemke_fallback.hpp"

#include "lcp/solvers.hpp"

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

std::optional<StepLcpEnd> solve_by_lemke(const Model& model, const State& begin, double h, const SchemeOptions& options) {
    if (model.fan_points.size() > max_points || !model.obstacles.empty()) return std::nullopt;
    const StepLcp step = step_lcp(model, begin, h, options);
    const double length = (model.mesh.corner(1) - model.mesh.corner(0)).norm();
    const Units unit(step.layout, power_of_two(model.corner_mass[0]), power_of_two(length), power_of_two(h));
    const Eigen::VectorXd scale = unit.row.cwiseInverse();
    const LcpMatrix M(scale.asDiagonal() * step.problem.M * unit.unknown.asDiagonal());
    const LcpSolution found = solve_by_default({M, scale.cwiseProduct(step.problem.q)}, {.exhaustive = false});
    if (found.status != LcpStatus::solved) return std::nullopt;
    return recover(step, model, begin, h, unit.unknown.cwiseProduct(found.z));
}

}  // namespace knap
