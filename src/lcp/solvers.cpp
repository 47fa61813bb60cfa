#include "lcp/solvers.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace knap {

std::span<const LcpSolver> lcp_solvers() {
    constexpr int any = std::numeric_limits<int>::max();
    static constexpr std::array solvers{
        LcpSolver{"default", "presolve, sweeps and Newton by turns, proximal points, then every other solver", true,
                  any, "", solve_by_default},
        LcpSolver{"newton", "semismooth Newton (primal-dual active set)", true, max_dense_unknowns, "",
                  solve_by_newton},
        LcpSolver{"lemke", "Lemke's pivots, lexicographic, from several covering vectors", false, max_dense_unknowns,
                  "", solve_by_lemke},
        LcpSolver{"interior_point", "primal-dual path following with predictor and corrector", false,
                  max_dense_unknowns, "", solve_by_interior_point},
        LcpSolver{
            "convex_qp", "projected Newton on the convex quadratic program of the box form", true, max_dense_unknowns,
            "a matrix that is symmetric and positive semidefinite once its bounds are eliminated", solve_by_convex_qp},
        LcpSolver{"gauss_seidel", "projected block Gauss-Seidel, with Lemke on the blocks", true, any,
                  "blocks of at most 200 unknowns that each have a solution", solve_by_gauss_seidel},
    };
    return solvers;
}

const LcpSolver* find_lcp_solver(std::string_view name) {
    const auto found = std::ranges::find(lcp_solvers(), name, &LcpSolver::name);
    return found == lcp_solvers().end() ? nullptr : &*found;
}

}  // namespace knap
