#include "stepper/implicit/fluid_pressures.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double tolerance = 1e-9;  // [-] of the volumes
constexpr int max_trials = 60, max_rounds = 20;

enum class Outcome { as_it_was, changed, failed };

Outcome settle(std::size_t fluid, ImplicitBulk& bulk, const std::vector<Vec2>& rate,
               const std::function<bool()>& solve) {
    double p = bulk.fluid_pressure()[fluid];
    auto balance = bulk.fluid_balance(fluid, rate);
    const auto holds = [&] {
        return std::abs(balance.excess) <= tolerance * balance.scale || (p == 0 && balance.excess >= 0);
    };
    if (holds()) return Outcome::as_it_was;
    const double storage = bulk.fluid_storage(fluid), guess = bulk.fluid_compliance(fluid),
                 by_storage = std::max(0.0, p - balance.excess / storage);
    double low = std::min(p, by_storage), high = std::max(p, by_storage), slope = guess;
    for (int i = 0; i < max_trials; ++i) {
        double next = p - balance.excess / slope;
        if (next < 0 && low == 0 && p > 0) next = 0;  // the cracks may have more room than there is fluid
        else if (!(next >= low && next <= high) || next == p) next = 0.5 * (low + high);
        const double before = balance.excess;
        bulk.set_fluid_pressure(fluid, next);
        if (!solve()) return Outcome::failed;
        balance = bulk.fluid_balance(fluid, rate);
        slope = next == p ? guess : std::max((balance.excess - before) / (next - p), storage);
        p = next;
        if (holds()) return Outcome::changed;
        (balance.excess < 0 ? low : high) = p;
    }
    return Outcome::failed;
}

}  // namespace

bool settle_fluids(const Model& model, ImplicitBulk& bulk, const std::vector<Vec2>& rate,
                   const std::function<bool()>& solve) {
    const auto n_injected =
        std::ranges::count_if(model.crack_fluids, [](const CrackFluid& fluid) { return fluid.given.is_injected(); });
    for (int round = 0; round < max_rounds; ++round) {  // they press on one body
        bool changed = false;
        for (std::size_t f = 0; f < model.crack_fluids.size(); ++f) {
            if (!model.crack_fluids[f].given.is_injected()) continue;
            const Outcome outcome = settle(f, bulk, rate, solve);
            if (outcome == Outcome::failed) return false;
            changed = changed || outcome == Outcome::changed;
        }
        if (!changed || n_injected == 1) return true;
    }
    return false;
}

}  // namespace knap
