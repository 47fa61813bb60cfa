#pragma once
// The columns of energy.csv and cracks.csv: name, unit, meaning and value of each, in order.
#include "analysis/crack_history.hpp"
#include "analysis/energy_ledger.hpp"
#include "output/outputs.hpp"

namespace knap {

/// What a line of energy.csv is about.
struct EnergyMoment {
    const EnergyRow& energy;
    double step;  // [s] the last one
};
std::span<const Measure<EnergyMoment>> energy_columns();

/// What a line of cracks.csv is about.
struct CrackMoment {
    double time;  // [s]
    const CrackHistory& history;
    double rayleigh_speed;  // [m/s], 0: not known
};
std::span<const Measure<CrackMoment>> crack_columns();

}  // namespace knap
