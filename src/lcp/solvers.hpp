#pragma once
// All solvers of this floor by name, each with its own default options. The first one is the one to use.
#include "lcp/problem.hpp"

#include <functional>
#include <span>

namespace knap {

struct LcpSolver {
    std::string_view name;
    bool uses_start;    // whether a warm start changes anything
    int most_unknowns;  // up to which it takes minutes at most; beyond, only who names it runs it
    std::string_view needs;  // what its method needs of a problem that it is applicable to
    std::function<LcpSolution(const LcpProblem&, const Eigen::VectorXd& start)> run;

    /// `start`: z of a similar problem; empty: none.
    LcpSolution solve(const LcpProblem& problem, const Eigen::VectorXd& start = {}) const { return run(problem, start); }
};

std::span<const LcpSolver> lcp_solvers();

/// nullptr where no solver has that name.
const LcpSolver* find_lcp_solver(std::string_view name);

}  // namespace knap
