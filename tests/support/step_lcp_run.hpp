#pragma once
// Runs that build and solve the full, unreduced problem of every implicit step: the reference of the implicit path. Every fan is split
// from the start, so that each corner has a node of its own.
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"
#include "model/make_model.hpp"
#include "support/implicit_judge.hpp"
#include "support/meshes.hpp"

#include <Eigen/QR>

#include <doctest/doctest.h>

namespace knap::tests {

inline constexpr SchemeOptions implicit_scheme{.bulk = BulkScheme::implicit_theta,
                                               .cohesion = CohesionScheme::implicit_beta};

/// Scales that make the diagonal 1, and the largest coupling of rows without one. Row norms alone leave multipliers and their bounds (r_T
/// and chi) a common factor, which hides u_T+ beside chi where the step is short.
inline Eigen::VectorXd scales_of_diagonal(const LcpProblem& problem) {
    const Eigen::VectorXd diagonal = problem.M.diagonal();
    Eigen::VectorXd scale(problem.size());
    for (int i = 0; i < problem.size(); ++i) scale[i] = diagonal[i] > 0 ? 1 / std::sqrt(diagonal[i]) : 0;
    Eigen::VectorXd found = scale;
    for (int i = 0; i < problem.size(); ++i) {
        if (scale[i] > 0) continue;
        double largest = 0;
        for (LcpMatrix::InnerIterator entry(problem.M, i); entry; ++entry)
            largest = std::max(largest, std::abs(entry.value()) * scale[entry.col()]);
        found[i] = largest > 0 ? 1 / largest : 1;
    }
    return found;
}

/// Lemke's method, then the linear system of the basis that it found once more: pivots leave rounding behind.
inline LcpSolution solve_step(const LcpProblem& problem) {
    if (problem.size() == 0) return solve_by_lemke(problem);
    const Eigen::VectorXd scale = scales_of_diagonal(problem);
    const LcpProblem scaled{LcpMatrix(scale.asDiagonal() * problem.M * scale.asDiagonal()),
                            scale.cwiseProduct(problem.q)};
    LcpSolution found = solve_by_lemke(scaled);
    if (found.status == LcpStatus::solved) {
        Eigen::VectorXd z = found.z;
        std::vector<int> basic;
        for (int i = 0; i < scaled.size(); ++i)
            if (z[i] > found.w[i]) basic.push_back(i);
            else z[i] = 0;
        if (!basic.empty()) {
            const Eigen::MatrixXd M_basic = Eigen::MatrixXd(scaled.M)(basic, basic);
            const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factor(
                M_basic);  // redundant points: singular
            for (int i = 0; i < 2; ++i) z(basic) -= factor.solve(Eigen::VectorXd((scaled.M * z + scaled.q)(basic)));
        }
        if (scaled_residual(scaled, z) < scaled_residual(scaled, found.z)) found.z = z;
        if (scaled_residual(scaled, found.z) > 1e-10) found.status = LcpStatus::stalled;
    }
    return lcp_solution(problem, found.status, scale.cwiseProduct(found.z), found.iterations);
}

/// A state in which every fan is split.
inline State split_everywhere(const Model& model, State state) {
    for (std::size_t f = 0; f < model.fans.size(); ++f)
        if (state.split_rank[f] < 0) split(model, static_cast<Index>(f), state);
    return state;
}

/// `begin` must be split everywhere.
inline State end_state(const Model& model, const State& begin, double h, const StepLcpEnd& end) {
    State next = begin;
    next.time += h;
    next.last_step = h;
    ++next.n_steps;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Index node = begin.node_of_corner[c];
        next.displacement[node] = begin.displacement[node] + h * end.rate[c];
        next.velocity[node] = end.velocity[c];
    }
    for (std::size_t f = 0; f < model.fans.size(); ++f)
        for (Index j = 0; j < model.fans[f].n_points; ++j) {
            const Index first = next.first_point[next.split_rank[f]];
            next.points[first + j].cohesion = end.cohesion[model.fan_points[model.fans[f].first_point + j].point];
        }
    return next;
}

class StepLcpRun {
public:
    explicit StepLcpRun(const ModelInput& input, const SchemeOptions& options = implicit_scheme)
        : model(make_model(input)), options(options), now(split_everywhere(model, initial_state(model))) {}
    StepLcpRun(const StepLcpRun&) = delete;

    /// Builds, solves, judges and takes the step. False, and nothing happens, where the problem was not solved.
    bool step(double h) {
        const StepLcp made(model, now, h, options);
        const LcpSolution solution = solve_step(made.problem());
        n_rows = made.problem().size();
        if (solution.status != LcpStatus::solved) return false;
        end = made.end(solution.z);
        verdict = ImplicitJudge(model, now, h, options).verdict(end);
        identity = energy_gain(h);
        now = end_state(model, now, h, end);
        identity += energy();
        return true;
    }

    Vec2 u(Index corner) const { return now.displacement[now.node_of_corner[corner]]; }
    Vec2 v(Index corner) const { return now.velocity[now.node_of_corner[corner]]; }
    Vec2 opening_of(Index point) const { return opening(model, now, point); }
    double cohesion_of(Index point) const { return cohesion(model, now, point); }

    /// [J] kinetic and strain energy, lumped mass.
    double energy() const {
        double sum = 0;
        std::vector<Vec2> force(model.mesh.n_corners());
        std::vector<std::uint8_t> candidate(model.fans.size());
        ElasticForces(model.mesh, model.materials, model.plane, model.thickness)
            .evaluate(now.displacement, now.node_of_corner, force, candidate);
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            sum += 0.5 * model.corner_mass[c] * v(c).squaredNorm() - 0.5 * force[c].dot(u(c));
        return sum;
    }
    double surface() const {
        double sum = 0;
        for (const FanPoint& at : model.fan_points) {
            const CohesiveLaw& law = model.laws[at.law];
            const Vec2 jump = opening_of(at.point);
            if (!at.cracked && law.sigma_c > 0)
                sum += at.area * law.surface_energy(cohesion_of(at.point), jump.x(), jump.y());
        }
        return sum;
    }

    Model model;
    SchemeOptions options;
    State now;
    StepLcpEnd end;
    ImplicitVerdict verdict;
    double identity =
        0;  // [J] energy gained in the last step less the work of loads and points; 0 for theta = 1/2, nothing prescribed
    int n_rows = 0;

private:
    /// [J] minus: the energy at the begin, and the work of the loads and of the points over the step.
    double energy_gain(double h) const {
        double work = 0;
        for (const CornerLoad& load : model.corner_loads) {
            const TimeFunction& history = model.histories[load.history];
            const double mean = history.over_step(now.time, now.time + h, options.theta);
            work += h * mean * load.force.dot(end.rate[load.corner]);
        }
        for (const FanPoint& at : model.fan_points) {
            const auto rate = [&](Index corner) -> Vec2 {
                return corner == rigid_support ? Vec2::Zero() : end.rate[corner];
            };
            const Vec2 w = rate(at.after) - rate(at.before);
            work += end.impulse[at.point].dot(Vec2(at.normal.dot(w), turned_left(at.normal).dot(w)));
        }
        return -energy() - work;
    }
};

}  // namespace knap::tests
