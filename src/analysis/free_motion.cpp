#include "analysis/free_motion.hpp"

#include "stepper/common/pieces_of_body.hpp"

#include <cmath>

namespace knap {

std::vector<Fragment> free_fragments(const Model& model, const State& state) {
    std::vector<Fragment> found = find_fragments(model, state).pieces;
    const std::vector<std::uint8_t> held = pieces_of_body(model, state, {}).held;
    std::erase_if(found, [&](const Fragment& piece) { return held[piece.first_triangle] != 0; });
    return found;
}

FreeMotion free_motion(const Model& model, const State& state) {
    FreeMotion sum;
    for (const Fragment& piece : free_fragments(model, state)) {
        const double spin = piece.spin(), angular = std::abs(piece.angular_momentum);
        sum.energy += piece.energy_of_translation() + piece.energy_of_rotation();
        sum.angular_momentum += angular;
        sum.squared_spins += angular * spin * spin;
    }
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        sum.energy += kinetic_energy(model.obstacles[o], state.obstacles[o].velocity);
    return sum;
}

}  // namespace knap
