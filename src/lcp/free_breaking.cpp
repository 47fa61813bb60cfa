#include "lcp/free_breaking.hpp"

#include "lcp/scaling.hpp"

#include <algorithm>
#include <vector>

namespace knap {
namespace {

/// The row has no entry but, perhaps, a zero on the diagonal and something in column `only`.
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
        if (M.coeff(plus, chi) <= 0 || M.coeff(plus + 1, chi) <= 0 || M.coeff(chi, plus) >= 0 || M.coeff(chi, plus + 1) >= 0) return false;
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

FreeBreaking free_breaking(const LcpProblem& problem, const Eigen::VectorXd& z, const CohesiveLayout& layout, double tolerance) {
    const ScaledLcp scaled = equilibrated(problem);
    const Eigen::VectorXd given = scaled.scaled_z(z);
    Eigen::VectorXd lowered = given;
    lowered.tail(layout.n_cohesive).setZero();
    // rows of r_T+ and r_T- without chi: u_T and -u_T, in units of their factor of chi. Not chi - |u_T|: a free chi can be huge.
    const Eigen::VectorXd w = scaled.problem.M * lowered + scaled.problem.q;
    FreeBreaking found;
    std::vector<int> loose;
    for (int i = 0; i < layout.n_cohesive; ++i) {
        const int plus = layout.first_tangential() + 2 * i, chi = layout.first_chi() + i;
        const double slip = std::max({0.0, -w[plus] / scaled.problem.M.coeff(plus, chi), -w[plus + 1] / scaled.problem.M.coeff(plus + 1, chi)});
        const double excess = given[chi] - slip;
        lowered[chi] = given[chi];
        if (excess <= tolerance * std::max(1.0, given[chi])) continue;
        loose.push_back(i);
        lowered[chi] = slip;
        found.largest_excess = std::max(found.largest_excess, excess);
    }
    found.n_loose = static_cast<int>(loose.size());
    const Eigen::VectorXd bond = scaled.problem.M * lowered + scaled.problem.q;
    for (const int i : loose) {
        const double lack = -bond[layout.first_beta() + i];
        if (lack <= 0) continue;
        // where there was no bond before either, its multiplier takes what chi gives back
        if (scaled.problem.q[i] <= tolerance) lowered[i] += lack / scaled.problem.M.coeff(layout.first_beta() + i, i);
        else if (lack > tolerance) ++found.n_free;
    }
    found.tightened = loose.empty() ? z : scaled.original_z(lowered);
    return found;
}

}  // namespace knap
