#include "analysis/history_columns.hpp"

#include <array>
#include <limits>

namespace knap {
namespace {

using E = EnergyMoment;
using C = CrackMoment;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

constexpr std::array energy{
    Measure<E>{"time", "s", "end of the step", [](const E& m) { return m.energy.time; }},
    Measure<E>{"kinetic", "J", "kinetic energy; of the explicit bulk in the middle of the step", [](const E& m) { return m.energy.kinetic; }},
    Measure<E>{"strain", "J", "elastic energy; of the explicit bulk in the middle of the step", [](const E& m) { return m.energy.strain; }},
    Measure<E>{"surface", "J", "energy Psi of broken and damaged interfaces: dissipated + recoverable", [](const E& m) { return m.energy.surface(); }},
    Measure<E>{"dissipated", "J", "energy that broken and damaged interfaces have taken for ever: G_c (1 - beta)^2", [](const E& m) { return m.energy.dissipated; }},
    Measure<E>{"recoverable", "J", "energy that damaged interfaces give back when they close: beta sigma_c s", [](const E& m) { return m.energy.recoverable; }},
    Measure<E>{"external_work", "J", "work of loads and prescribed motions so far", [](const E& m) { return m.energy.external_work; }},
    Measure<E>{"cohesive_work", "J", "work against the cohesion so far", [](const E& m) { return m.energy.cohesive_work; }},
    Measure<E>{"friction_work", "J", "work of friction so far, never positive", [](const E& m) { return m.energy.friction_work; }},
    Measure<E>{"impact_work", "J", "work of all impacts so far, never positive", [](const E& m) { return m.energy.impact_work; }},
    Measure<E>{"residual", "J", "error of the discrete energy identity", [](const E& m) { return m.energy.residual; }},
    Measure<E>{"law_lag_energy", "J", "cohesive work less crossing loss and surface energy: what finite steps make of the law", [](const E& m) { return m.energy.law_lag; }},
    Measure<E>{"crossing_loss_energy", "J", "cohesive work lost where slips cross zero, so far", [](const E& m) { return m.energy.crossing_loss; }},
    Measure<E>{"scheme_dissipation", "J", "what theta > 1/2 took away so far, never negative", [](const E& m) { return m.energy.scheme_dissipation; }},
    Measure<E>{"step_change_work", "J", "what changes of the step did to the energy of the leapfrog so far", [](const E& m) { return m.energy.step_change_work; }},
    Measure<E>{"step", "s", "length of the last step", [](const E& m) { return m.step; }},
};

constexpr std::array cracks{
    Measure<C>{"time", "s", "of the line", [](const C& m) { return m.time; }},
    Measure<C>{"main_length", "m", "length of the main crack, along chords", [](const C& m) { return m.history.pattern().main_length; }},
    Measure<C>{"crack_length", "m",
                "length of all arms of cracks, along edges, without twigs and single broken interfaces; at the end what counts then is known from its first edge on",
                [](const C& m) { return m.history.pattern().crack_length; }},
    Measure<C>{"broken_length", "m", "length of all broken interfaces", [](const C& m) { return m.history.pattern().broken_length; }},
    Measure<C>{"damaged_length", "m", "length of all interfaces that are damaged but not broken", [](const C& m) { return m.history.pattern().damaged_length; }},
    Measure<C>{"tips", "", "number of crack tips that have not arrived at a boundary or at another crack",
                [](const C& m) { return static_cast<double>(m.history.pattern().tips.size()); }},
    Measure<C>{"branches", "", "number of branchings", [](const C& m) { return static_cast<double>(m.history.pattern().n_branches); }},
    Measure<C>{"tip_x", "m", "place of the tip of the main crack; at the end that of the main one then,"
                " from its first edge on", [](const C& m) { return m.history.pattern().main_end ? m.history.pattern().main_end->position.x() : none; }},
    Measure<C>{"tip_y", "m", "likewise", [](const C& m) { return m.history.pattern().main_end ? m.history.pattern().main_end->position.y() : none; }},
    Measure<C>{"tip_speed", "m/s", "of the tip of the main crack, from a quarter of a window of growth on", [](const C& m) { return m.history.tip_speed(); }},
    Measure<C>{"tip_speed_over_cR", "", "the same over the Rayleigh speed", [](const C& m) { return m.rayleigh_speed > 0 ? m.history.tip_speed() / m.rayleigh_speed : none; }},
    Measure<C>{"n_broken", "", "number of broken interfaces", [](const C& m) { return static_cast<double>(m.history.pattern().n_broken); }},
    Measure<C>{"n_damaged", "", "number of interfaces that are damaged but not broken", [](const C& m) { return static_cast<double>(m.history.pattern().n_damaged); }},
};

}  // namespace

std::span<const Measure<EnergyMoment>> energy_columns() { return energy; }
std::span<const Measure<CrackMoment>> crack_columns() { return cracks; }

}  // namespace knap
