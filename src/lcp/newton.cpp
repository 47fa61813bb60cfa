#include "lcp/newton.hpp"

#include "lcp/gauss_seidel.hpp"
#include "lcp/linear_system.hpp"
#include "lcp/scaling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace knap {
namespace {

constexpr double least_proximal = 1e-11, largest_proximal = 1.0;
constexpr int n_halvings = 6;
constexpr int n_remembered = 6;  // merits that the line search looks back at

double natural(const Eigen::VectorXd& z, const Eigen::VectorXd& w) { return z.size() == 0 ? 0.0 : w.cwiseMin(z).cwiseAbs().maxCoeff(); }

/// Half the squared norm of the Fischer-Burmeister function z + w - sqrt(z^2 + w^2).
double merit(const Eigen::VectorXd& z, const Eigen::VectorXd& w) {
    return 0.5 * (z.array() + w.array() - (z.array().square() + w.array().square()).sqrt()).square().sum();
}

class Newton {
public:
    Newton(const LcpProblem& problem, const NewtonOptions& options) : problem_(problem), options_(options), n_(problem.size()) {}

    LcpStatus run(Eigen::VectorXd& z) {
        Eigen::VectorXd w = problem_.M * z + problem_.q;
        std::array<double, n_remembered> merits;
        merits.fill(merit(z, w));
        double proximal = least_proximal;
        for (int count = 0; count < options_.max_iterations; ++count) {
            if (natural(z, w) <= options_.tolerance) return LcpStatus::solved;
            ++n_solves;
            Eigen::VectorXd step;
            const bool found = direction(z, w, proximal, step);
            if (found && search(z, w, step, *std::max_element(merits.begin(), merits.end()))) {
                merits[count % n_remembered] = merit(z, w);
                proximal = std::max(least_proximal, 0.01 * proximal);
            } else if (proximal >= largest_proximal) {
                return found ? LcpStatus::stalled : LcpStatus::singular;
            } else {
                proximal = std::min(largest_proximal, 100 * std::max(proximal, 1e-8));
            }
        }
        return natural(z, w) <= options_.tolerance ? LcpStatus::solved : LcpStatus::iteration_limit;
    }

    int n_solves = 0;

private:
    /// (M_AA + proximal I) d_A = M_AI z_I - w_A,  d_I = -z_I  with A where z > w.
    bool direction(const Eigen::VectorXd& z, const Eigen::VectorXd& w, double proximal, Eigen::VectorXd& step) {
        std::vector<int> active, place(n_, -1);
        for (int i = 0; i < n_; ++i)
            if (z[i] > w[i]) {
                place[i] = static_cast<int>(active.size());
                active.push_back(i);
            }
        const int size = static_cast<int>(active.size());
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd b(size);
        for (int k = 0; k < size; ++k) {
            b[k] = -w[active[k]];
            entries.emplace_back(k, k, proximal);
            for (LcpMatrix::InnerIterator entry(problem_.M, active[k]); entry; ++entry) {
                if (place[entry.col()] >= 0) entries.emplace_back(k, place[entry.col()], entry.value());
                else b[k] += entry.value() * z[entry.col()];
            }
        }
        Eigen::SparseMatrix<double> A(size, size);
        A.setFromTriplets(entries.begin(), entries.end());
        if (!system_.factorise(A)) return false;
        const Eigen::VectorXd active_step = system_.solve(b);
        step = -z;
        for (int k = 0; k < size; ++k) step[active[k]] = active_step[k];
        return step.allFinite();
    }

    bool search(Eigen::VectorXd& z, Eigen::VectorXd& w, const Eigen::VectorXd& step, double reference) const {
        const Eigen::VectorXd w_step = problem_.M * step;
        double length = 1;
        for (int count = 0; count <= n_halvings; ++count, length *= 0.5) {
            const Eigen::VectorXd next_z = z + length * step, next_w = w + length * w_step;
            if (!(merit(next_z, next_w) <= (1 - 1e-3 * length) * reference)) continue;
            z = next_z;
            w = problem_.M * z + problem_.q;  // anew: the sum of increments would carry their rounding
            return true;
        }
        return false;
    }

    const LcpProblem& problem_;
    const NewtonOptions& options_;
    int n_;
    LinearSystem system_;
};

}  // namespace

LcpSolution solve_by_newton(const LcpProblem& problem, const NewtonOptions& options) {
    const int n = problem.size();
    const ScaledLcp scaled = equilibrated(problem);
    Newton newton(scaled.problem, options);
    Eigen::VectorXd start = options.start.size() == n ? scaled.scaled_z(options.start) : Eigen::VectorXd::Zero(n);
    LcpStatus status = LcpStatus::stalled;
    Eigen::VectorXd z;
    for (int attempt = 0; attempt < options.n_starts; ++attempt) {
        if (attempt > 0 || options.start.size() != n) {
            const int sweeps = 5 << (2 * attempt);
            start = solve_by_gauss_seidel(scaled.problem, {.tolerance = options.tolerance, .max_sweeps = sweeps, .start = start}).z;
        }
        z = start;
        status = newton.run(z);
        if (status == LcpStatus::solved) break;
    }
    return lcp_solution(problem, status, scaled.original_z(z), newton.n_solves);
}

}  // namespace knap
