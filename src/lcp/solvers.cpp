#include "lcp/solvers.hpp"

#include "lcp/gauss_seidel.hpp"
#include "lcp/interior_point.hpp"
#include "lcp/lemke.hpp"
#include "lcp/newton.hpp"

#include <array>

namespace knap {

std::span<const LcpSolver> lcp_solvers() {
    static const std::array solvers{
        LcpSolver{"lemke", [](const LcpProblem& problem) { return solve_by_lemke(problem); }},
        LcpSolver{"gauss_seidel", [](const LcpProblem& problem) { return solve_by_gauss_seidel(problem); }},
        LcpSolver{"newton", [](const LcpProblem& problem) { return solve_by_newton(problem); }},
        LcpSolver{"interior_point", [](const LcpProblem& problem) { return solve_by_interior_point(problem); }},
    };
    return solvers;
}

}  // namespace knap
