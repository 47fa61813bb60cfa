#include "lcp/solvers.hpp"

#include "lcp/convex_qp.hpp"
#include "lcp/default_solver.hpp"
#include "lcp/gauss_seidel.hpp"
#include "lcp/interior_point.hpp"
#include "lcp/lemke.hpp"
#include "lcp/newton.hpp"

#include <algorithm>
#include <array>

namespace knap {
namespace {

using Start = Eigen::VectorXd;

}  // namespace

std::span<const LcpSolver> lcp_solvers() {
    static const std::array solvers{
        LcpSolver{"default", true, [](const LcpProblem& p, const Start& start) { return solve_by_default(p, {.start = start}); }},
        LcpSolver{"lemke", false, [](const LcpProblem& p, const Start&) { return solve_by_lemke(p); }},
        LcpSolver{"gauss_seidel", true, [](const LcpProblem& p, const Start& start) { return solve_by_gauss_seidel(p, {.start = start}); }},
        LcpSolver{"newton", true, [](const LcpProblem& p, const Start& start) { return solve_by_newton(p, {.start = start}); }},
        LcpSolver{"convex_qp", true, [](const LcpProblem& p, const Start& start) { return solve_by_convex_qp(p, {.start = start}); }},
        LcpSolver{"interior_point", false, [](const LcpProblem& p, const Start&) { return solve_by_interior_point(p); }},
    };
    return solvers;
}

const LcpSolver* find_lcp_solver(std::string_view name) {
    const std::span<const LcpSolver> all = lcp_solvers();
    const auto found = std::find_if(all.begin(), all.end(), [&](const LcpSolver& solver) { return solver.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace knap
