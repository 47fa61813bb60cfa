#pragma once
// Temperature: what a scenario prescribes. A body without heat has none of it.
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

    /// Whether temperatures may be others after the start.
    bool changes() const { return conduction || !field.is_constant(); }
    /// [K] A prescribed temperature of value `value`, with a factor of its history.
    double follow(double value, double factor) const { return reference + factor * (value - reference); }
    double field_at(const Vec2& place, double t, double factor) const {
        return follow(field.value_at(place, t), factor);
    }
    double field_at(const Vec2& place, double t) const { return field_at(place, t, field.history(t)); }
};

}  // namespace knap
