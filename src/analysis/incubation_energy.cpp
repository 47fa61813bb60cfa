#include "analysis/incubation_energy.hpp"

namespace knap {

double incubation_energy(const Model& model, const State& state) {
    double sum = 0;
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const double phi = state.strength_factor(state.split_fans[s]);
        if (phi == 1) continue;
        const auto points = model.points(model.fans[state.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const CohesiveLaw& law = law_of(model, state, points[j]);
            if (points[j].cracked || !law.breakable() || law.sigma_c <= 0) continue;
            const PointState& known = state.points[state.first_point[s] + j];
            sum += (phi - 1) * points[j].area *
                   law.consumed(known.cohesion, law.ramp(known.cohesion, known.largest_opening));
        }
    }
    return sum;
}

}  // namespace knap
