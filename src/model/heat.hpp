#pragma once
// Temperature: what a scenario prescribes, and the temperatures of one moment. A body without heat has none of it.
#include "base/expression.hpp"
#include "base/grid_table.hpp"
#include "material/cohesive_law.hpp"
#include "material/elastic.hpp"
#include "material/thermal.hpp"
#include "mesh/mesh.hpp"
#include "model/loads.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace knap {

/// T(x, y, t) = reference + history(t) (value(x, y, t) - reference)  [K]
struct TemperatureField {
    Expression value;
    TimeFunction history;
    std::shared_ptr<const GridTable> grid;  // in the place of the formula
    bool frozen = false;                    // in the place of both: those of the state at the start stay

    double value_at(const Vec2& place, double t) const {
        return grid ? (*grid)(place.x(), place.y(), t) : value(place.x(), place.y(), t);
    }
    bool is_constant() const {
        return frozen || (history.time.empty() && !(grid ? grid->depends_on_time() : value.depends_on_time()));
    }
    bool is_uniform() const { return frozen || (!grid && !value.depends_on_place()); }
};

/// Heat through a boundary, or into a region.
struct HeatExchange {
    enum class Kind {
        temperature,  // [K] prescribed, of boundary vertices (or of all vertices in a box)
        convection,   // [K] outside of boundary edges, with `transfer`
        flux,         // [W/m2] into boundary edges
        source        // [W/m3] of triangles
    };
    Kind kind = Kind::temperature;
    Selection on;
    double value = 0;
    double transfer = 0;   // [W/(m2 K)] of convection
    TimeFunction history;  // multiplies flux and source; temperatures follow TemperatureField's rule
};

struct Heat {
    double reference = 0;            // [K] free of thermal strain
    bool celsius = false;            // temperatures count from 0 C; false: from any zero, perhaps 0 K
    std::vector<Thermal> materials;  // by Mesh::region
    TemperatureField field;          // prescribed; with conduction at the start
    bool conduction = false;
    std::vector<HeatExchange> exchanges;
    double gap_conductivity = 0.025;  // [W/(m K)] of what fills open cracks
    double closed_conductance = -1;   // [W/(m2 K)] of closed points; -1: 50 conductivities over the length of the edge
    double time_factor = 1;           // [-] heat runs so many times faster than the motion
    int every = 10;                   // mechanical steps of the explicit bulk for one of the heat

    /// [K] A prescribed temperature of value `value`, with a factor of its history.
    double follow(double value, double factor) const { return reference + factor * (value - reference); }
    double field_at(const Vec2& place, double t, double factor) const {
        return follow(field.value_at(place, t), factor);
    }
    double field_at(const Vec2& place, double t) const { return field_at(place, t, field.history(t)); }
};

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

struct Model;
struct FanPoint;

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
