#pragma once
// Folding: rows of an LCP that only state bounds are taken out, and their unknowns with them. What is left is smaller, has fewer ways to be
// degenerate, and each of its unknowns has a state that means something. Two patterns, k being a row without diagonal:
//   cap         w_k = q_k - a z_i,  w_i = F_i + c z_k                                   0 <= x <= q_k / a           (x = z_i)
//   two sides   w_k = q_k + e z_l - a (z_i + z_j),  w_i = F + c z_k,  w_j = -F + c z_k  -b <= x <= b,  a b = q_k + e x_l  (x = z_i - z_j)
// where rows and columns i, j are each other's opposites. There z_k = |F| / c, and it may enter one more row r: F_r + f |F|. Taking z_k so
// is a choice where b = 0, which bounds it from below only; it is the one that excludes free bond breaking (free_breaking.hpp).
// Everything else stays 0 <= x, so that every LCP has a folded form. The folded problem is scaled to a diagonal and a q of order one.
#include "lcp/problem.hpp"

#include <vector>

namespace knap {

struct FoldedUnknown {
    int row = -1, opposite = -1, slack = -1;  // i, j, k of the LCP; -1: none
    bool two_sided = false;
    double upper = 0;        // cap, or the constant part of b; infinite: none
    int bound_by = -1;       // folded index of l
    double bound_factor = 0;
    int feeds = -1;          // folded index of r
    double feed_factor = 0;  // of |F|
    double slack_factor = 0; // c, unscaled
};

struct FoldedLcp {
    LcpMatrix M;        // [n, n] scaled
    Eigen::VectorXd q;  // [n] scaled
    std::vector<FoldedUnknown> unknowns;
    std::vector<std::vector<int>> fed_by;  // of each unknown, those that feed its row
    Eigen::VectorXd factor;                // x = unit factor x', F = unit F' / factor
    double unit = 1;
    int n_original = 0;

    int size() const { return static_cast<int>(q.size()); }
    double upper(int i, const Eigen::VectorXd& x) const {
        const FoldedUnknown& u = unknowns[i];
        return u.bound_by < 0 ? u.upper : u.upper + u.bound_factor * std::max(0.0, x[u.bound_by]);
    }
    double lower(int i, double upper) const { return unknowns[i].two_sided ? -upper : 0.0; }

    /// F(x) without what is fed back, and with it.
    Eigen::VectorXd linear_part(const Eigen::VectorXd& x) const { return M * x + q; }
    Eigen::VectorXd value(const Eigen::VectorXd& x) const;

    /// x - projection of x - F(x) on the bounds at x; zero at solutions.
    Eigen::VectorXd natural_map(const Eigen::VectorXd& x, const Eigen::VectorXd& F) const;

    Eigen::VectorXd folded(const Eigen::VectorXd& z) const;
    Eigen::VectorXd unfolded(const Eigen::VectorXd& x) const;  // z >= 0, whatever x is
};

FoldedLcp fold(const LcpProblem& problem);

}  // namespace knap
