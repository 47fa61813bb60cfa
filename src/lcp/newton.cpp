// Semismooth Newton on the natural map of the box form: every unknown is free, at its lower or at its upper bound, and
// in given states the problem is linear; this is the primal-dual active set method (Hintermueller, Ito, Kunisch 2002;
// Facchinei, Pang, Finite-Dimensional Variational Inequalities, 9). A proximal term makes rank-deficient and indefinite
// matrices harmless and vanishes with convergence (Rockafellar 1976); a nonmonotone line search on the norm of the map
// keeps the steps useful.
#include "lcp/linear_system.hpp"
#include "lcp/presolve.hpp"
#include "lcp/solvers.hpp"

#include <algorithm>
#include <array>

namespace knap {
namespace {

constexpr double first_proximal = 1e-10, min_proximal = 1e-12, max_proximal = 1.0;
constexpr int max_newton_halvings = 4;
constexpr int n_remembered = 6;  // norms that the line search compares with
constexpr int first_sweeps = 5;

enum State : signed char { lower = -1, free = 0, upper = 1 };

class BoxNewton {
public:
    BoxNewton(const BoxLcp& box, double tolerance) : box_(box), tolerance_(tolerance), n_(box.size()), states_(n_) {}

    LcpStatus run(int limit, Eigen::VectorXd& x, int& n_solves) {
        Eigen::VectorXd F = box_.value(x), map = box_.natural_map(x, F);
        std::array<double, n_remembered> norms;
        norms.fill(map.norm());
        double proximal = first_proximal;
        for (int count = 0; count < limit; ++count) {
            if (map.cwiseAbs().maxCoeff() <= tolerance_) return LcpStatus::solved;
            choose_states(x, F);
            ++n_solves;
            Eigen::VectorXd next;
            const bool found = solve_in_states(x, proximal, next);
            if (found && search(x, F, map, next - x, *std::ranges::max_element(norms))) {
                norms[count % n_remembered] = map.norm();
                proximal = std::max(min_proximal, 0.1 * proximal);
            } else if (proximal >= max_proximal) {
                return found ? LcpStatus::stalled : LcpStatus::singular;
            } else {
                proximal = std::min(max_proximal, 100 * std::max(proximal, 1e-8));
            }
        }
        return map.cwiseAbs().maxCoeff() <= tolerance_ ? LcpStatus::solved : LcpStatus::iteration_limit;
    }

private:
    void choose_states(const Eigen::VectorXd& x, const Eigen::VectorXd& F) {
        for (int i = 0; i < n_; ++i) {
            const double b = box_.upper(i, x), target = x[i] - F[i];
            states_[i] = target > b ? upper : target <= box_.lower(i, b) ? lower : free;
            if (box_.unknowns[i].two_sided && target == -b) states_[i] = b > 0 ? free : lower;
        }
    }

    /// The x of the chosen states: x = T y + c with the free unknowns y, for which R (M x + q) + proximal (y - y_old)
    /// is zero.
    bool solve_in_states(const Eigen::VectorXd& x, double proximal, Eigen::VectorXd& next) {
        std::vector<int> free_unknowns, place(n_, -1);
        for (int i = 0; i < n_; ++i)
            if (states_[i] == free) place[i] = static_cast<int>(free_unknowns.size()), free_unknowns.push_back(i);
        const int size = static_cast<int>(free_unknowns.size());
        Eigen::VectorXd c = Eigen::VectorXd::Zero(n_);
        std::vector<Eigen::Triplet<double>> of_T, of_R;
        for (int i = 0; i < n_; ++i) {
            const BoxUnknown& u = box_.unknowns[i];
            if (states_[i] == free) of_T.emplace_back(i, place[i], 1.0);
            if (states_[i] == free || (states_[i] == lower && !u.two_sided)) continue;
            const double sign = states_[i];
            c[i] = sign * u.upper;
            if (u.bound_by < 0) continue;
            if (states_[u.bound_by] == free) of_T.emplace_back(i, place[u.bound_by], sign * u.bound_factor);
            if (states_[u.bound_by] == upper) c[i] += sign * u.bound_factor * box_.unknowns[u.bound_by].upper;
        }
        for (int k = 0; k < size; ++k) {
            of_R.emplace_back(k, free_unknowns[k], 1.0);
            for (const int t : box_.fed_by[free_unknowns[k]])  // |F_t| is F_t at the lower and -F_t at the upper bound
                if (states_[t] != free) of_R.emplace_back(k, t, -states_[t] * box_.unknowns[t].feed_factor);
        }
        LcpMatrix T(n_, size), R(size, n_);
        T.setFromTriplets(of_T.begin(), of_T.end());
        R.setFromTriplets(of_R.begin(), of_R.end());
        const LcpMatrix rows = R * box_.M;
        if (!system_.factorise(rows * T, Eigen::VectorXd::Constant(size, proximal))) return false;
        const Eigen::VectorXd residual = rows * c + R * box_.q;
        next = T * system_.solve(proximal * x(free_unknowns) - residual) + c;
        return next.allFinite();
    }

    bool search(Eigen::VectorXd& x, Eigen::VectorXd& F, Eigen::VectorXd& map, const Eigen::VectorXd& step,
                double reference) const {
        double length = 1;
        for (int count = 0; count <= max_newton_halvings; ++count, length *= 0.5) {
            const Eigen::VectorXd next = x + length * step, next_F = box_.value(next),
                                  next_map = box_.natural_map(next, next_F);
            if (!(next_map.norm() <= (1 - 1e-3 * length) * reference)) continue;
            x = next, F = next_F, map = next_map;
            return true;
        }
        return false;
    }

    const BoxLcp& box_;
    double tolerance_;
    int n_;
    std::vector<State> states_;
    LinearSystem system_;
};

}  // namespace

LcpStatus solve_box_by_newton(const BoxLcp& box, double tolerance, int limit, Eigen::VectorXd& x, int& count) {
    if (box.size() == 0) return LcpStatus::solved;
    return BoxNewton(box, tolerance).run(limit, x, count);
}

/// Newton on the whole problem, without presolve, from the result of a few Gauss-Seidel sweeps on its box form; where
/// its diagonal does not permit sweeps, from intact bonds (x = upper).
LcpSolution solve_by_newton(const LcpProblem& problem, const LcpOptions& options) {
    const BoxLcp whole = without_presolve(problem), box = presolve(problem);
    const bool is_warm = options.start.size() == problem.size(), can_sweep = box.has_positive_diagonal();
    Eigen::VectorXd start = box.box_start(options.start), x = whole.box_start(options.start);
    for (int i = 0; !can_sweep && i < box.size(); ++i)
        if (box.unknowns[i].is_capped()) start[i] = box.unknowns[i].upper;
    if (!is_warm) {
        if (can_sweep) Sweeps(box).run(start, first_sweeps);
        x = whole.box_start(box.lcp_point(start));
    }
    int n_solves = 0;
    const LcpStatus status = solve_box_by_newton(whole, options.tolerance, options.limit(max_iterations), x, n_solves);
    return lcp_solution(problem, status, whole.lcp_point(x), n_solves);
}

}  // namespace knap
