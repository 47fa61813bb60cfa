#pragma once
// Where the method of multipliers finds no solution of a step, in small bodies: the step as one linear complementarity problem (step_lcp.hpp).
// The method of multipliers begins anew at its solution, so that what is taken is found to its tolerance and judged like any other step.
#include "stepper/implicit/step_lcp.hpp"

#include <optional>

namespace knap {

/// Nothing where the body has obstacles or more than a hundred points, or where no solver finds a solution.
std::optional<StepLcpEnd> solve_by_lemke(const Model& model, const State& begin, double h, const SchemeOptions& options);

}  // namespace knap
