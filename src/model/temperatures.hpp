#pragma once
// Temperatures and thermal strains of one moment, and the laws of the points at them.
#include "model/model.hpp"

#include <memory>
#include <vector>

namespace knap {

/// Temperatures and thermal strains at one moment. They never change once made, so that states share them.
struct Temperatures {
    double time = 0;                // [s]
    std::vector<double> of_corner;  // [K] equal at the corners of a node
    std::vector<double> strain;  // [-] e, the same in x and y, in the plane: mean of a triangle of order 1; of order 2
                                 // linear, at the middles opposite to its vertices (3 triangle + k)
    std::vector<CohesiveLaw> laws;  // per interface point, at the mean temperature of its sides; empty where no law
                                    // follows the temperature. Not in a checkpoint: fit_laws makes them again
    double free_energy =
        0;  // [J] 1/2 int e : D e, of prevented thermal strains: their energies cancel to the rounding of it
    // with conduction, since the start
    double heat = 0;        // [J] sum of C (T - T at the start)
    double heat_in = 0;     // [J] through boundaries and from sources
    double heat_moved = 0;  // [J] sum of |C dT| over all steps of the heat
    double heat_scale = 0;  // [J] largest sum of C |T| and of the flows in a step with it: the scale of rounding
    double range = 0;       // [K] largest difference between temperatures, those outside included
    double overshoot = 0;   // [K] largest excess of a temperature over those around it, where nothing is heated

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time, of_corner, strain, free_energy, heat, heat_in, heat_moved, heat_scale, range, overshoot);
    }
};
using SharedTemperatures = std::shared_ptr<const Temperatures>;

/// With the strains e = e(T) - e(reference), in plane strain (1 + nu) times that.
std::shared_ptr<Temperatures> make_temperatures(const Model& model, double time, std::vector<double> of_corner);
/// [K] Mean of the two sides of a point.
double temperature_at(const Temperatures& temperatures, const FanPoint& point);
/// The laws of the points at these temperatures.
void fit_laws(const Model& model, Temperatures& temperatures);
/// The field of the scenario; `factor`: of its history, where that is not the one of the time.
SharedTemperatures field_at(const Model& model, double time);
SharedTemperatures field_at(const Model& model, double time, double factor);

}  // namespace knap
