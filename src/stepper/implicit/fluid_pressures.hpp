#pragma once
// The pressures of injected fluids in an implicit step. The balance of a fluid (stepper/common/crack_forces.hpp)
//
//     0 <= p  perp  g(p) = C p + V + h a' w(p) - Q(t + h) >= 0
//
// is that of the end of the step, whatever theta is: a mean over the step would leave the volume to alternate about Q
// where C is small, as the opening of an interface that breaks comes at once. It has the rates w of the body under p. A
// body that is stable gives way under a pressure, a' dw/dp >= 0, so that g grows at least as C p: p - g(p)/C and p
// bracket the zero. g is nearly linear where cracks are open, and constant but for C p where they are closed; the
// secant method is exact in both, and halves of the bracket lead from one to the other.
#include "stepper/implicit/implicit_bulk.hpp"

#include <functional>

namespace knap {

/// `rate` [m/s]: of the nodes, the solution under the present pressures; solve() renews it under others, and is false
/// where there is none. False also where the pressures do not settle.
bool settle_fluids(const Model& model, ImplicitBulk& bulk, const std::vector<Vec2>& rate,
                   const std::function<bool()>& solve);

}  // namespace knap
