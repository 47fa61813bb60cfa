#pragma once
// Pieces that nothing holds, moving as whole ones: a flight, a fall and a spin are no vibration, and theta above 1/2
// brakes a spin. An implicit step of h that turns a piece by w h changes its angular momentum about its centre by
//
//     L+ - L = (theta - 1/2) h sum of m (v+ - v) x v = -(theta - 1/2) h sin(w h) w L
//
// since the forces have no moment about the middle of the step, and rates are not the mean velocities.
#include "analysis/fragments.hpp"

namespace knap {

/// Fragments that no support and no prescribed motion holds (stepper/common/pieces_of_body.hpp).
std::vector<Fragment> free_fragments(const Model& model, const State& state);

struct FreeMotion {
    double energy = 0;            // [J] kinetic, of translation and spin, also of obstacles
    double angular_momentum = 0;  // [kg m2/s] sum of the magnitudes of the fragments, about their centres
    double squared_spins = 0;     // [kg m2/s3] likewise, each times the square of the spin
};
FreeMotion free_motion(const Model& model, const State& state);

/// [1/s] Part of the angular momentum of a piece with this spin [rad/s] that steps of h [s] take per time.
inline double braked_per_time(double theta, double h, double spin) { return (theta - 0.5) * h * spin * spin; }

}  // namespace knap
