#include "lcp/spurious_breaking.hpp"

#include "lcp/scaling.hpp"

#include <algorithm>

namespace knap {
namespace {

/// Whether the row has an entry in column `only` and no other that is not zero.
bool couples_only_to(const LcpMatrix& M, int row, int only) {
    for (LcpMatrix::InnerIterator entry(M, row); entry; ++entry)
        if (entry.value() != 0 && entry.col() != only) return false;
    return M.coeff(row, only) != 0;
}

bool fits(const LcpMatrix& M, const CohesiveLayout& layout) {
    for (int i = 0; i < layout.n_cohesive; ++i) {
        const int chi = layout.chi(i), plus = layout.tangential(i), minus = plus + 1;
        if (!couples_only_to(M, i, layout.beta(i)) || M.coeff(chi, chi) != 0) return false;
        if (M.coeff(plus, chi) <= 0 || M.coeff(minus, chi) <= 0) return false;
        if (M.coeff(chi, plus) >= 0 || M.coeff(chi, minus) >= 0) return false;
    }
    return true;
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
    LcpProblem scaled = problem;
    const LcpScaling scaling = equilibrate(scaled);
    const auto& [M, q] = scaled;
    const Eigen::VectorXd given = scaling.scaled_z(z);
    Eigen::VectorXd lowered = given;
    lowered.tail(layout.n_cohesive).setZero();
    // rows of r_T+ and r_T- without chi: u_T and -u_T times their factor of chi. Not chi - |u_T|, as an excess can be
    // huge
    const Eigen::VectorXd w = M * lowered + q;
    SpuriousBreaking found;
    std::vector<int> with_excess;
    for (int i = 0; i < layout.n_cohesive; ++i) {
        const int plus = layout.tangential(i), chi = layout.chi(i);
        const double slip = std::max({0.0, -w[plus] / M.coeff(plus, chi), -w[plus + 1] / M.coeff(plus + 1, chi)});
        const bool has_excess = given[chi] - slip > tolerance * std::max(1.0, given[chi]);
        lowered[chi] = has_excess ? slip : given[chi];
        if (has_excess) with_excess.push_back(i);
    }
    found.n_excess = static_cast<int>(with_excess.size());
    const Eigen::VectorXd bond = M * lowered + q;
    for (const int i : with_excess) {
        const double lack = -bond[layout.beta(i)];
        if (lack <= 0) continue;
        // where the bond was broken before, its multiplier takes the part that chi gives back
        if (q[i] <= tolerance) lowered[i] += lack / M.coeff(layout.beta(i), i);
        else if (lack > tolerance) ++found.n_spurious;
    }
    found.tightened = with_excess.empty() ? z : scaling.original_z(lowered);
    return found;
}

}  // namespace knap
