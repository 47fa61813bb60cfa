#include "stepper/common/fluid_pressures.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double tolerance = 1e-9;  // [-] of the volumes
constexpr int max_trials = 60, max_rounds = 20;

enum class Outcome { as_it_was, changed, failed };

Outcome settle(std::size_t fluid, const CrackForces& forces, const FluidStep& step) {
    double p = forces.injected_pressures()[fluid];
    FluidBalance balance = step.balance(fluid);
    const auto holds = [&] {
        return std::abs(balance.excess) <= tolerance * balance.scale || (p == 0 && balance.excess >= 0);
    };
    if (holds()) return Outcome::as_it_was;
    const double storage = forces.storage(fluid), guess = step.compliance(fluid),
                 by_storage = std::max(0.0, p - balance.excess / storage);
    double low = std::min(p, by_storage), high = std::max(p, by_storage), slope = guess;
    for (int i = 0; i < max_trials; ++i) {
        double next = p - balance.excess / slope;
        if (next < 0 && low == 0 && p > 0) next = 0;  // the cracks may have more room than there is fluid
        else if (!(next >= low && next <= high) || next == p) next = 0.5 * (low + high);
        const double before = balance.excess;
        if (!step.solve_with(fluid, next)) return Outcome::failed;
        balance = step.balance(fluid);
        slope = next == p ? guess : std::max((balance.excess - before) / (next - p), storage);
        p = next;
        if (holds()) return Outcome::changed;
        (balance.excess < 0 ? low : high) = p;
    }
    return Outcome::failed;
}

}  // namespace

std::optional<std::size_t> unsettled_fluid(const CrackForces& forces, const FluidStep& step) {
    const std::vector<std::size_t> injected = forces.injected_fluids();
    std::optional<std::size_t> last;
    for (int round = 0; round < max_rounds; ++round) {  // they press on one body
        last.reset();
        for (const std::size_t f : injected) {
            const Outcome outcome = settle(f, forces, step);
            if (outcome == Outcome::failed) return f;
            if (outcome == Outcome::changed) last = f;
        }
        if (!last || injected.size() == 1) return std::nullopt;
    }
    return last;
}

}  // namespace knap
