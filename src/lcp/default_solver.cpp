#include "lcp/default_solver.hpp"

#include "lcp/fold.hpp"
#include "lcp/folded_newton.hpp"
#include "lcp/folded_sweeps.hpp"
#include "lcp/lemke.hpp"

#include <cstdio>
#include <cstdlib>

namespace knap {

LcpSolution solve_by_default(const LcpProblem& problem, const DefaultSolverOptions& options) {
    const FoldedLcp folded = fold(problem);
    Eigen::VectorXd x = options.start.size() == problem.size() ? folded.folded(options.start) : Eigen::VectorXd::Zero(folded.size());
    int count = 0;
    const bool can_sweep = has_positive_diagonal(folded);
    static const bool verbose = getenv("LCPV");
    for (int attempt = 0; attempt < 4; ++attempt) {
        if (can_sweep) { int ns = 10 << (2 * attempt); double d = sweep(folded, x, ns); if (verbose) printf("  sweeps %d change %.2e map %.2e\n", ns, d, folded.natural_map(x, folded.value(x)).cwiseAbs().maxCoeff()); }
        Eigen::VectorXd found = x;
        const LcpStatus status = solve_folded_by_newton(folded, {.tolerance = options.tolerance}, found, count);
        if (verbose) printf("  newton %s solves %d map %.2e\n", std::string(name(status)).c_str(), count, folded.natural_map(found, folded.value(found)).cwiseAbs().maxCoeff());
        if (status == LcpStatus::solved) return lcp_solution(problem, status, folded.unfolded(found), count);
        if (!can_sweep) break;
    }
    if (problem.size() > options.largest_dense) return lcp_solution(problem, LcpStatus::stalled, folded.unfolded(x), count);
    return solve_by_lemke(problem);
}

}  // namespace knap
