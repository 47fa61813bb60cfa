#pragma once
// All solvers with one signature, each in a file of its name, and the table from which `knap lcp`, its help and its
// tests read them.
#include "lcp/problem.hpp"

#include <span>

namespace knap {

LcpSolution solve_by_default(const LcpProblem& problem, const LcpOptions& options = {});
LcpSolution solve_by_lemke(const LcpProblem& problem, const LcpOptions& options = {});
LcpSolution solve_by_newton(const LcpProblem& problem, const LcpOptions& options = {});
LcpSolution solve_by_interior_point(const LcpProblem& problem, const LcpOptions& options = {});

/// Lemke's pivots for small problems, without equilibration: M and q should be of order one, and the caller judges z.
/// False where every path ends on a ray: then there is hardly a solution. Up to 96 unknowns nothing is allocated.
/// `stiff`: some rows have a compliance far below the others, and the path must tell its ratios apart.
bool solve_lcp_by_lemke(const Eigen::Ref<const Eigen::MatrixXd>& M, const Eigen::Ref<const Eigen::VectorXd>& q,
                        Eigen::Ref<Eigen::VectorXd> z, bool stiff = false);

inline constexpr int max_dense_unknowns = 3000;  // of a tableau, or of a factor without zeros: minutes

struct LcpSolver {
    std::string_view name, description;
    bool uses_start;   // whether a warm start has an effect
    int max_unknowns;  // up to which it takes minutes at most; beyond, it runs only by its name
    LcpSolution (*solve)(const LcpProblem&, const LcpOptions&);
};

/// The first is the one to use; the default solver tries the others in this order.
std::span<const LcpSolver> lcp_solvers();

/// nullptr where no solver has that name.
const LcpSolver* find_lcp_solver(std::string_view name);

}  // namespace knap
