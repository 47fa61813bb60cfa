#include "lcp/solvers.hpp"

#include "lcp/convex_qp.hpp"
#include "lcp/default_solver.hpp"
#include "lcp/gauss_seidel.hpp"
#include "lcp/interior_point.hpp"
#include "lcp/lemke.hpp"
#include "lcp/newton.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace knap {
namespace {

using Start = Eigen::VectorXd;

constexpr int any = std::numeric_limits<int>::max();
constexpr int dense = 3000;  // unknowns of a tableau or of a factor without zeros

}  // namespace

std::span<const LcpSolver> lcp_solvers() {
    static const std::array solvers{
        LcpSolver{"default", true, any, "nothing", [](const LcpProblem& p, const Start& start) { return solve_by_default(p, {.start = start}); }},
        LcpSolver{"lemke", false, dense, "nothing", [](const LcpProblem& p, const Start&) { return solve_by_lemke(p); }},
        LcpSolver{"gauss_seidel", true, any, "blocks of at most 200 unknowns that each have a solution",
                  [](const LcpProblem& p, const Start& start) { return solve_by_gauss_seidel(p, {.start = start}); }},
        LcpSolver{"newton", true, dense, "nothing", [](const LcpProblem& p, const Start& start) { return solve_by_newton(p, {.start = start}); }},
        LcpSolver{"convex_qp", true, dense, "a matrix that is symmetric and positive semidefinite once its bounds are folded away",
                  [](const LcpProblem& p, const Start& start) { return solve_by_convex_qp(p, {.start = start}); }},
        LcpSolver{"interior_point", false, dense, "nothing", [](const LcpProblem& p, const Start&) { return solve_by_interior_point(p); }},
    };
    return solvers;
}

const LcpSolver* find_lcp_solver(std::string_view name) {
    const std::span<const LcpSolver> all = lcp_solvers();
    const auto found = std::find_if(all.begin(), all.end(), [&](const LcpSolver& solver) { return solver.name == name; });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace knap
