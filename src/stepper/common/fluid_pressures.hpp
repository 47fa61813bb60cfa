#pragma once
// The pressures of injected fluids in a step. The balance of a fluid (crack_forces.hpp)
//
//     0 <= p  perp  g(p) = C p + V + h a' w(p) - Q(t + h) >= 0
//
// is that of the end of the step in both schemes: a pressure of its start, or a mean over it, would leave the volume to
// alternate about Q where C is small, as the opening of an interface that breaks comes at once, and faces that a stiff
// fluid throws apart would leave it without pressure. It has the rates w of the body under p. A body that is stable
// gives way under a pressure, a' dw/dp >= 0, so that g grows at least as C p: p - g(p)/C and p bracket the zero. g is
// nearly linear where cracks are open, and constant but for C p where they are closed; the secant method is exact in
// both, and halves of the bracket lead from one to the other.
//
// In the explicit scheme this adds (I + S/2) and S/2 (u+ - u-) to central differences, with S = h k M^-1 a a'/C: the
// stable step stays that of the body, and motions of the volume die the faster the stiffer the fluid is.
#include "stepper/common/crack_forces.hpp"

#include <functional>

namespace knap {

/// A step under given pressures; functions of the number of a fluid in Model::crack_fluids.
struct FluidStep {
    std::function<FluidBalance(std::size_t)> balance;     // under the present pressures
    std::function<double(std::size_t)> compliance;        // [m3/Pa] about dg/dp
    std::function<bool(std::size_t, double)> solve_with;  // renews the solution with this pressure [Pa]; false: none
};

/// The present pressures are those with which `forces` were found, and so are the last ones. Returns the fluid whose
/// pressure does not settle, or with which the step has no solution.
std::optional<std::size_t> unsettled_fluid(const CrackForces& forces, const FluidStep& step);

}  // namespace knap
