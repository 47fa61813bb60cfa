#include "lcp/solvers.hpp"

#include <algorithm>
#include <limits>

namespace knap {

std::span<const LcpSolver> lcp_solvers() {
    constexpr int any = std::numeric_limits<int>::max(), dense = max_dense_unknowns;
    static constexpr LcpSolver solvers[]{
        {"default", "presolve, sweeps, Newton, proximal points, then every other solver", true, any, solve_by_default},
        {"newton", "semismooth Newton (primal-dual active set)", true, dense, solve_by_newton},
        {"lemke", "Lemke's pivots, lexicographic, from several covering vectors", false, dense, solve_by_lemke},
        {"interior_point", "primal-dual path following with predictor and corrector", false, dense,
         solve_by_interior_point},
    };
    return solvers;
}

const LcpSolver* find_lcp_solver(std::string_view name) {
    const auto found = std::ranges::find(lcp_solvers(), name, &LcpSolver::name);
    return found == lcp_solvers().end() ? nullptr : &*found;
}

}  // namespace knap
