#include "lcp/spurious_breaking.hpp"

#include "lcp/scaling.hpp"

#include <algorithm>
#include <vector>

namespace knap {
namespace {

/// Whether the row has an entry in column `only` and no other that is not zero.
bool couples_only_to(const LcpMatrix& M, int row, int only) {
    bool coupled = false;
    for (LcpMatrix::InnerIterator entry(M, row); entry; ++entry) {
        if (entry.value() == 0) continue;
        if (entry.col() != only) return false;
        coupled = true;
    }
    return coupled;
}

bool has_zero_diagonal(const LcpMatrix& M, int first, int count) {
    for (int i = first; i < first + count; ++i)
        if (M.coeff(i, i) != 0) return false;
    return true;
}

bool fits(const LcpMatrix& M, const CohesiveLayout& layout) {
    const int m = layout.n_cohesive;
    for (int i = 0; i < m; ++i) {
        if (!couples_only_to(M, i, m + i)) return false;
        const int chi = layout.first_chi() + i, plus = layout.first_tangential() + 2 * i;
        if (M.coeff(plus, chi) <= 0 || M.coeff(plus + 1, chi) <= 0 || M.coeff(chi, plus) >= 0 ||
            M.coeff(chi, plus + 1) >= 0)
            return false;
    }
    return has_zero_diagonal(M, layout.first_chi(), m);
}

}  // namespace

std::optional<CohesiveLayout> cohesive_layout(const LcpProblem& problem) {
    const int n = problem.size();
    for (int m = n / 5; m >= 1; --m) {
        const CohesiveLayout layout{.n_cohesive = m, .n_contacts = (n - 5 * m) / 4};
        if ((n - 5 * m) % 4 == 0 && fits(problem.M, layout)) return layout;
    }
    return std::nullopt;
}

SpuriousBreaking spurious_breaking(const LcpProblem& problem, const Eigen::VectorXd& z, const CohesiveLayout& layout,
                                   double tolerance) {
    const ScaledLcp scaled = equilibrated(problem);
    const LcpMatrix& M = scaled.problem.M;
    const Eigen::VectorXd given = scaled.scaled_z(z);
    Eigen::VectorXd lowered = given;
    lowered.tail(layout.n_cohesive).setZero();
    // rows of r_T+ and r_T- without chi: u_T and -u_T times their factor of chi. Not chi - |u_T|: an excess can be
    // huge.
    const Eigen::VectorXd w = M * lowered + scaled.problem.q;
    SpuriousBreaking found;
    std::vector<int> with_excess;
    for (int i = 0; i < layout.n_cohesive; ++i) {
        const int plus = layout.first_tangential() + 2 * i, chi = layout.first_chi() + i;
        const double slip = std::max({0.0, -w[plus] / M.coeff(plus, chi), -w[plus + 1] / M.coeff(plus + 1, chi)});
        const bool has_excess = given[chi] - slip > tolerance * std::max(1.0, given[chi]);
        lowered[chi] = has_excess ? slip : given[chi];
        if (has_excess) with_excess.push_back(i);
    }
    found.n_excess = static_cast<int>(with_excess.size());
    const Eigen::VectorXd bond = M * lowered + scaled.problem.q;
    for (const int i : with_excess) {
        const double lack = -bond[layout.first_beta() + i];
        if (lack <= 0) continue;
        // where there was no bond before either, its multiplier takes what chi gives back
        if (scaled.problem.q[i] <= tolerance)
            lowered[i] += lack / M.coeff(layout.first_beta() + i, i);
        else if (lack > tolerance)
            ++found.n_spurious;
    }
    found.tightened = with_excess.empty() ? z : scaled.original_z(lowered);
    return found;
}

}  // namespace knap
