#pragma once
// All solvers of this floor by name, each with its own default options.
#include "lcp/problem.hpp"

#include <functional>
#include <span>

namespace knap {

struct LcpSolver {
    std::string_view name;
    std::function<LcpSolution(const LcpProblem&)> solve;
};

std::span<const LcpSolver> lcp_solvers();

}  // namespace knap
