#include "lcp/folded_newton.hpp"

#include "lcp/linear_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace knap {
namespace {

constexpr double least_proximal = 1e-12, largest_proximal = 1.0;
constexpr int n_halvings = 4;
constexpr int n_remembered = 6;  // norms that the line search looks back at

enum State : signed char { lower = -1, free = 0, upper = 1 };

class Newton {
public:
    Newton(const FoldedLcp& problem, const FoldedNewtonOptions& options)
        : problem_(problem), options_(options), n_(problem.size()), states_(n_), place_(n_) {}

    LcpStatus run(Eigen::VectorXd& x, int& n_solves) {
        Eigen::VectorXd F = problem_.value(x);
        double norm = measure(x, F);
        std::array<double, n_remembered> norms;
        norms.fill(norm);
        double proximal = options_.proximal;
        for (int count = 0; count < options_.max_iterations; ++count) {
            if (problem_.natural_map(x, F).cwiseAbs().maxCoeff() <= options_.tolerance) return LcpStatus::solved;
            choose_states(x, F);
            ++n_solves;
            Eigen::VectorXd next;
            const bool found = linear_solution(x, proximal, next);
            if (found && search(x, F, next - x, *std::max_element(norms.begin(), norms.end()), norm)) {
                norms[count % n_remembered] = norm;
                proximal = std::max(least_proximal, 0.1 * proximal);
            } else if (proximal >= largest_proximal) {
                return found ? LcpStatus::stalled : LcpStatus::singular;
            } else {
                proximal = std::min(largest_proximal, 100 * std::max(proximal, 1e-8));
            }
        }
        return problem_.natural_map(x, F).cwiseAbs().maxCoeff() <= options_.tolerance ? LcpStatus::solved : LcpStatus::iteration_limit;
    }

private:
    double measure(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const { return problem_.natural_map(x, F).norm(); }

    void choose_states(const Eigen::VectorXd& x, const Eigen::VectorXd& F) {
        for (int i = 0; i < n_; ++i) {
            const double b = problem_.upper(i, x), wanted = x[i] - F[i];
            states_[i] = wanted > b ? upper : wanted <= problem_.lower(i, b) ? lower : free;
            if (problem_.unknowns[i].two_sided && wanted == -b) states_[i] = b > 0 ? free : lower;
        }
    }

    /// Sign that |F| has in its linearisation: at the upper bound F < 0.
    double sign_of_rate(int i) const { return -static_cast<double>(states_[i]); }

    /// x of the given states, all at once: bounds are put in, free rows are zero up to the proximal term.
    bool linear_solution(const Eigen::VectorXd& x, double proximal, Eigen::VectorXd& next) {
        int size = 0;
        for (int i = 0; i < n_; ++i) place_[i] = states_[i] == free ? size++ : -1;
        constant_ = Eigen::VectorXd::Zero(n_);
        follows_.assign(n_, -1);
        slope_.assign(n_, 0.0);
        for (int i = 0; i < n_; ++i) {
            if (states_[i] == free) continue;
            const FoldedUnknown& u = problem_.unknowns[i];
            if (states_[i] == lower && !u.two_sided) continue;
            const double sign = states_[i] == upper ? 1.0 : -1.0;
            constant_[i] = sign * u.upper;
            if (u.bound_by < 0) continue;
            // the unknown that bounds it may itself be at a bound
            const int l = u.bound_by;
            if (states_[l] == free) follows_[i] = l, slope_[i] = sign * u.bound_factor;
            else if (states_[l] == upper) constant_[i] += sign * u.bound_factor * problem_.unknowns[l].upper;
        }
        entries_.clear();
        Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
        for (int i = 0; i < n_; ++i) {
            if (place_[i] < 0) continue;
            b[place_[i]] = proximal * x[i];
            entries_.emplace_back(place_[i], place_[i], proximal);
            add_row(i, 1, place_[i], b);
            for (const int t : problem_.fed_by[i])
                if (states_[t] != free) add_row(t, problem_.unknowns[t].feed_factor * sign_of_rate(t), place_[i], b);
        }
        Eigen::SparseMatrix<double> A(size, size);
        A.setFromTriplets(entries_.begin(), entries_.end());
        if (!system_.factorise(A)) return false;
        const Eigen::VectorXd solved = system_.solve(b);
        next = constant_;
        for (int i = 0; i < n_; ++i)
            if (place_[i] >= 0) next[i] = solved[place_[i]];
        for (int i = 0; i < n_; ++i)
            if (follows_[i] >= 0) next[i] += slope_[i] * next[follows_[i]];
        return next.allFinite();
    }

    /// weight times row i of M x + q = 0 into a row of the system.
    void add_row(int i, double weight, int row, Eigen::VectorXd& b) {
        double known = problem_.q[i];
        for (LcpMatrix::InnerIterator entry(problem_.M, i); entry; ++entry) {
            const int j = static_cast<int>(entry.col());
            if (place_[j] >= 0) {
                entries_.emplace_back(row, place_[j], weight * entry.value());
                continue;
            }
            known += entry.value() * constant_[j];
            if (follows_[j] >= 0) entries_.emplace_back(row, place_[follows_[j]], weight * entry.value() * slope_[j]);
        }
        b[row] -= weight * known;
    }

    bool search(Eigen::VectorXd& x, Eigen::VectorXd& F, const Eigen::VectorXd& step, double reference, double& norm) const {
        double length = 1;
        for (int count = 0; count <= n_halvings; ++count, length *= 0.5) {
            const Eigen::VectorXd next = x + length * step;
            const Eigen::VectorXd next_F = problem_.value(next);
            const double next_norm = measure(next, next_F);
            if (!(next_norm <= (1 - 1e-3 * length) * reference)) continue;
            x = next;
            F = next_F;
            norm = next_norm;
            return true;
        }
        return false;
    }

    const FoldedLcp& problem_;
    const FoldedNewtonOptions& options_;
    int n_;
    std::vector<State> states_;
    std::vector<int> place_, follows_;
    std::vector<double> slope_;
    Eigen::VectorXd constant_;
    std::vector<Eigen::Triplet<double>> entries_;
    LinearSystem system_;
};

}  // namespace

LcpStatus solve_folded_by_newton(const FoldedLcp& problem, const FoldedNewtonOptions& options, Eigen::VectorXd& x, int& n_solves) {
    if (problem.size() == 0) return LcpStatus::solved;
    return Newton(problem, options).run(x, n_solves);
}

}  // namespace knap
