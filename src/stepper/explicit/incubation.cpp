#include "stepper/explicit/incubation.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double interval = 0.05;  // [-] of tau, between two values of U

/// [s]
double incubation_time(const Model& model, const Fan& fan) {
    double time = infinity;
    for (const FanPoint& point : model.points(fan)) {
        const CohesiveLaw& law = model.laws[point.law];
        if (!law.breakable()) continue;
        if (law.sigma_c == 0 || law.gamma + law.friction_range()[0] == 0) return 0;
        time = std::min(time, law.incubation_time);
    }
    return fan.split_at_start || time == infinity ? 0 : time;
}

}  // namespace

IncubationClock::IncubationClock(const Model& model) {
    if (!has_incubation(model)) return;
    for (const Fan& fan : model.fans) time_.push_back(incubation_time(model, fan));
}

void IncubationClock::mark_due_fans(const State& begin, std::vector<std::uint8_t>& is_candidate) const {
    for (std::size_t f = 0; f < time_.size(); ++f)
        if (time_[f] > 0 && begin.split_rank[f] < 0 &&
            begin.time - begin.incubation[f].time >= interval * time_[f] * (1 - 1e-9))
            is_candidate[f] = 1;
}

/// Exact for a linear U:  q+ = U+ - (U+ - U) (1 - e^-x)/x + (q - U) e^-x,   x = (time since U)/tau.
bool IncubationClock::is_held(Index fan, double U, double now, Incubation& memory) const {
    const double x = (now - memory.time) / time_[fan];
    if (x > 0)
        memory.memory =
            U + (U - memory.utilisation) * std::expm1(-x) / x + (memory.memory - memory.utilisation) * std::exp(-x);
    memory.utilisation = U, memory.time = now;
    return U <= 1 || memory.memory < 1;
}

}  // namespace knap
