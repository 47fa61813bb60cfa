#pragma once
// Excavation: triangles vanish between two steps.
//
// The forces R that they exerted on the corners that stay act on as loads, which the caller multiplies by a factor that
// decreases from 1 to 0. R follows from a trial step of the whole body, from v to v+, over the time k (damping alpha):
//
//     in a split fan     the tractions at the points that vanish, on the corner that stays; by components the smaller
//                        of this step and the one before, zero where the signs differ: an impact is no lasting force
//     in a bonded fan    per run of corners that vanish, with the forces F - K u on them
//                            sum of R = sum of F - K u - m ((1 + d) v+ - (1 - d) v - 2 d W)/k,     d = k alpha/2
//                        (implicit: -r(w)/(theta h)) as the tractions of the mean stress at the two ends; they
//                        are not in equilibrium,
//                        and what is missing is shared by the areas of the ends
//
// With the factor 1 the next step of a bonded fan is the one that it would have had.
//
// between free faces   on a vertex or the ends of an edge that stays, by one that vanishes: the mean over some trial
//                          steps, by components the smaller one of their first and second half, likewise
//
// A prescribed component of a fan has no R, since the drive of each corner carries its part.
//
// A fluid in cracks flows on as its source says; where it pressed on a face that stays and does no more, its force is
// released with the others. Heat does not cross the new faces, and what left keeps its own.
//
// The energies of what stays are those of the scheme (common/elastic_energy.hpp), so that the energy identity goes on
// with the energy that left as one more term.
#include "stepper/moreau_jean.hpp"

#include <span>

namespace knap {

/// [N] Per corner that stays: of contacts between free faces with what vanishes, [0/1] per triangle; over 64 steps of h
/// [s] from `begin`, the first of which ends at `trial`. Empty: there are none.
std::vector<Vec2> lasting_contacts(const Model& model, MoreauJean& stepper, const State& begin, const State& trial,
                                   double h, std::span<const std::uint8_t> vanishes);

/// [N] R at the corners that stay, in their order, for release(). `end`: of a trial step from `begin`; `vanishes`
/// [0/1]: per triangle; `contacts` [N]: of lasting_contacts.
std::vector<CornerLoad> released_forces(const Model& model, const State& begin, const State& end,
                                        const SchemeOptions& scheme, std::span<const std::uint8_t> vanishes,
                                        std::span<const Vec2> contacts = {});

/// [N] Likewise of fluids in cracks that the model `rest_model` without the region has no more.
std::vector<CornerLoad> released_pressures(const Model& model, const State& state, const Model& rest_model,
                                           const State& rest);

/// [J] Of what stays, and of the points that vanish.
struct ExcavationEnergies {
    double kinetic = 0, strain = 0;
    double dissipated = 0, recoverable = 0, interface_elastic = 0;
};

struct Excavated {
    Model model;
    State state;
    ExcavationEnergies energies;
};
/// Without the released forces. `mass`: of implicit steps.
Excavated excavate(const Model& model, const State& state, std::span<const Index> triangles,
                   MassMatrix mass = MassMatrix::lumped);

/// Adds released forces to the loads, with a history of their own: 1 at `time`, 0 after the ramp [s].
void release(std::span<const CornerLoad> forces, double time, double ramp, Model& model);

}  // namespace knap
