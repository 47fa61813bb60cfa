#pragma once
// What a scenario prescribes of temperatures, and how well a mesh and a time factor resolve the conduction of heat.
#include "model/model.hpp"
#include "scenario/scenario.hpp"

#include <array>
#include <string>
#include <vector>

namespace knap {

/// Scales of one material; times are those of the heat, time_factor times those of the motion.
struct HeatScales {
    std::string material;
    double diffusivity;  // [m2/s] kappa_T = k/(rho c), the largest of the tables
    double passage;      // [s] L^2/kappa_T, L: the way of heat through the body
    double duration;     // [s] of the run
    double edge;         // [m] finest one
    double convection;   // [m] smallest k/(coefficient of convection): a face cools in the time of this depth; or 0
    double c_R;          // [m/s]
    double step;         // [s] of the motion, in which backward Euler is one step; 0 with the explicit bulk
    bool damped;         // waves die during the run, by time.damping, the implicit scheme or absorbing boundaries

    /// [m] Depth that heat reaches in the run.
    double layer() const;
    /// [m/s] 2 kappa_T/l: a crack at the depth sqrt(4 kappa_T t) of the heat, when that is an edge. Later ones are
    /// slower, shorter ones are not resolved.
    double crack_speed() const { return 2 * diffusivity / edge; }
    double radiated(double time_factor) const { return time_factor * crack_speed() / c_R; }  // [-] see below
    /// [-] Of c_R. A crack at a speed v radiates about v/c_R of what it releases, as G(v) = (1 - v/c_R) G(0).
    /// Where these waves die, 2 % only make it that much tougher. In a free body they stay, and cracks that follow heat
    /// take some three times the strain energy in the end: 0.3 % of it leave 1 % of the strain energy kinetic.
    double largest_speed() const { return damped ? 0.02 : 0.003; }
    /// [-] With it such cracks run at that speed: the motion stays quasi-static.
    double largest_time_factor() const { return largest_speed() * c_R / crack_speed(); }
};

/// Empty without conduction. `step`: [s] the largest one of the run.
std::vector<HeatScales> judge_heat(const Scenario& scenario, const Mesh& mesh, double step);

/// [K] Lowest and highest temperature that the body can have until time.end; infinite where heat is given or taken.
std::array<double, 2> temperatures_of_run(const Scenario& scenario, const Mesh& mesh);

/// Temperatures and strains; with conduction a line or two for each material. Empty without heat.
std::string heat_text(const Scenario& scenario, const Mesh& mesh, double step);

}  // namespace knap
