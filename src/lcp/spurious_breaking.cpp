#include "lcp/spurious_breaking.hpp"

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
    return spurious_breaking(problem, scaling_of(problem), z, layout, tolerance);
}

SpuriousBreaking spurious_breaking(const LcpProblem& problem, const LcpScaling& scaling, const Eigen::VectorXd& z,
                                   const CohesiveLayout& layout, double tolerance) {
    // all numbers are those of the equilibrated problem, whose factors are powers of two
    const auto entry = [&](int i, int j) { return problem.M.coeff(i, j) * scaling.factor[i] * scaling.factor[j]; };
    const auto value = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
        return scaling.scaled_w(product(problem.M, scaling.original_z(at)) + problem.q);
    };
    const Eigen::VectorXd given = scaling.scaled_z(z), q = scaling.scaled_w(problem.q);
    Eigen::VectorXd lowered = given;
    lowered.tail(layout.n_cohesive).setZero();
    // rows of r_T+ and r_T- without chi: u_T and -u_T times their factor of chi. Not chi - |u_T|, as an excess can be
    // huge
    const Eigen::VectorXd w = value(lowered);
    SpuriousBreaking found;
    std::vector<int> with_excess;
    for (int i = 0; i < layout.n_cohesive; ++i) {
        const int plus = layout.tangential(i), chi = layout.chi(i);
        const double slip = std::max({0.0, -w[plus] / entry(plus, chi), -w[plus + 1] / entry(plus + 1, chi)});
        const bool has_excess = given[chi] - slip > tolerance * std::max(1.0, given[chi]);
        lowered[chi] = has_excess ? slip : given[chi];
        if (has_excess) with_excess.push_back(i);
    }
    found.n_excess = static_cast<int>(with_excess.size());
    if (with_excess.empty()) {
        found.tightened = z;
        return found;
    }
    const Eigen::VectorXd bond = value(lowered);
    for (const int i : with_excess) {
        const double lack = -bond[layout.beta(i)];
        if (lack <= 0) continue;
        // where the bond was broken before, its multiplier takes the part that chi gives back
        if (q[i] <= tolerance) lowered[i] += lack / entry(layout.beta(i), i);
        else if (lack > tolerance) ++found.n_spurious;
    }
    found.tightened = scaling.original_z(lowered);
    return found;
}

}  // namespace knap
