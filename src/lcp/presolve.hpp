#pragma once
// Presolve: the box form of an LCP. Rows that only state bounds are eliminated together with their multipliers. Two
// patterns are recognised; k is a row without diagonal entry:
//   cap        w_k = q_k - a z_i,  w_i = F_i + c z_k                                0 <= x <= q_k / a,  x = z_i
//   two-sided  w_k = q_k + e z_l - a (z_i + z_j),  w_i = F + c z_k,  w_j = -F + c z_k
//              -b <= x <= b,  a b = q_k + e x_l,  x = z_i - z_j
// In the second pattern rows and columns i, j are opposite, z_k = |F| / c, and z_k may feed one more row r: F_r + f
// |F|. Where b = 0 the LCP bounds z_k from below only; z_k = |F| / c excludes spurious bond breaking
// (spurious_breaking.hpp). Every other unknown keeps 0 <= x, so every LCP has a box form.
#include "lcp/scaling.hpp"

#include <vector>

namespace knap {

struct BoxUnknown {
    int row = -1, opposite = -1, slack = -1;  // i, j, k of the LCP; -1: none
    bool two_sided = false;
    double upper = 0;         // cap, or the constant part of b; infinite: none
    int bound_by = -1;        // l, as an index of the box form; -1: none
    double bound_factor = 0;  // e / a
    int feeds = -1;           // r, as an index of the box form; -1: none
    double feed_factor = 0;   // f
    double slack_factor = 0;  // c of the LCP; all other numbers are scaled

    bool is_capped() const { return slack >= 0 && !two_sided; }
};

struct BoxLcp {
    LcpMatrix M;                           // [n, n] equilibrated
    Eigen::VectorXd q;                     // [n] equilibrated
    std::vector<BoxUnknown> unknowns;      // [n]
    std::vector<std::vector<int>> fed_by;  // [n] the unknowns that feed each row
    LcpScaling scaling;                    // z = unit factor x, w = unit F / factor
    int n_original = 0;                    // unknowns of the LCP

    int size() const { return static_cast<int>(q.size()); }
    double upper(int i, const Eigen::VectorXd& x) const {
        const BoxUnknown& u = unknowns[i];
        return u.bound_by < 0 ? u.upper : u.upper + u.bound_factor * std::max(0.0, x[u.bound_by]);
    }
    double lower(int i, double upper) const { return unknowns[i].two_sided ? -upper : 0.0; }
    bool has_positive_diagonal() const;

    /// F(x) = M x + q, with f |F| in the rows that are fed.
    Eigen::VectorXd value(const Eigen::VectorXd& x) const;

    /// x - projection of x - F on the bounds at x; zero at solutions.
    Eigen::VectorXd natural_map(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const;

    /// The largest entry of the natural map; infinite where x is not finite.
    double residual(const Eigen::VectorXd& x) const { return residual(x, value(x)); }
    double residual(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const;

    /// x of a solution z of the LCP; zero where z has another size (no warm start).
    Eigen::VectorXd box_start(const Eigen::VectorXd& z) const;

    /// z >= 0 of the LCP, for any x.
    Eigen::VectorXd lcp_point(const Eigen::VectorXd& x) const { return lcp_point(x, value(x)); }
    Eigen::VectorXd lcp_point(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const;
};

BoxLcp presolve(const LcpProblem& problem);

/// The box form in which nothing is eliminated: 0 <= x for every unknown.
BoxLcp without_presolve(const LcpProblem& problem);

// Methods on the box form, of which the solvers of solvers.hpp are made. Each takes x as the starting point and leaves
// the last iterate in it, for every status; `count` is increased by the sweeps or linear solves.

/// Projected Gauss-Seidel sweeps, for a positive diagonal: one unknown after the other moves to the zero of its row
/// within its bounds. The matrix of the box form may not change while they are used. In gauss_seidel.cpp.
class Sweeps {
public:
    explicit Sweeps(const BoxLcp& box);

    /// Returns the largest |change of x| of the last sweep, in units of the diagonal.
    double run(Eigen::VectorXd& x, int n_sweeps = 1) const {
        double largest = 0;
        for (int count = 0; count < n_sweeps; ++count) largest = run_once(x);
        return largest;
    }

private:
    double run_once(Eigen::VectorXd& x) const;

    const BoxLcp& box_;
    Eigen::VectorXd diagonal_, coupling_;  // coupling: of the row of an unknown to the unknown that it feeds
};

inline constexpr int max_newton_steps = 60;  // on the box form; more of them hardly ever end at a solution

/// Until the largest entry of the natural map is `tolerance` or less. In newton.cpp.
LcpStatus solve_box_by_newton(const BoxLcp& box, double tolerance, int max_iterations, Eigen::VectorXd& x, int& count);

/// For capped unknowns whose rows have a negative curvature; starts from intact bonds, x = upper, whatever x is.
LcpStatus solve_box_by_proximal_points(const BoxLcp& box, double tolerance, Eigen::VectorXd& x, int& count);

}  // namespace knap
