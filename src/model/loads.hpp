#pragma once
// Loads, supports and initial velocities as a scenario gives them, before they are applied to a mesh.
#include "base/expression.hpp"
#include "material/thermal.hpp"
#include "mesh/polygon.hpp"
#include "model/place_field.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace knap {

/// A piecewise linear function of time; constant before its first and after its last point. No points: 1 everywhere.
struct TimeFunction {
    std::vector<double> time;   // [s], ascending
    std::vector<double> value;  // same length
    double operator()(double t) const;
    double slope_before(double t) const;  // [1/s] derivative from the left
    double integral(double t) const;      // [s] from 0 to t

    /// The mean over [begin, end] minus that of the values at both ends: what a step that knows its ends alone misses.
    /// 0 below a thousandth of the values around: such a step resolves the table, and keeps the bits of one without
    /// points inside.
    double beyond_trapezoid(double begin, double end) const;
    /// Value of a step with the theta scheme: (1 - theta) f(begin) + theta f(end) + beyond_trapezoid, within what f
    /// takes in between. With theta = 1/2 this is the mean of f.
    double over_step(double begin, double end, double theta) const;
    /// Value of a kick of central differences at `t`, between steps of `before` and `after` [s]: f(t) and half of what
    /// both steps miss. The sum of all kicks is the integral of f.
    double over_kick(double t, double before, double after) const;
    std::array<double, 2> range(double begin, double end) const;  // least and largest value in the interval
    /// [s] Where a step from `begin` to `end` had better end, at least `shortest` [s] after its begin: at the point
    /// farthest from the straight line of those that it may not pass over (table_corner.hpp). Else `end`.
    double corner(double begin, double end, double shortest) const;

private:
    template <class Visit>
    void for_each_piece(double begin, double end, const Visit& visit) const;
};

/// A step of size h [s] from `begin` [s], as far as prescribed motions need it.
struct StepTimes {
    double begin, h;
    double theta = 1;                  // of the theta scheme
    bool central_differences = false;  // velocities are those of mid-step, displacements of its end
};

/// One component of a prescribed motion over a step.
struct PrescribedRate {
    double rate;          // [m/s] or [rad/s]: displacement at the end minus that at the start, over h
    double end_velocity;  // likewise
};

/// `value` times `history` is the displacement or the velocity of the component; `displacement` [m] or [rad] is that at
/// the start of the step.
PrescribedRate prescribed_rate(bool is_displacement, double value, const TimeFunction& history, double displacement,
                               const StepTimes& step);

/// A named boundary, everything inside a box, a body or a group of bodies, what they have in common, or everything.
struct Selection {
    std::string boundary;  // empty: not by name
    std::optional<Box> box;
    std::string body;  // of Mesh::parts; empty: all
};

/// [Pa] Traction of the stress (xx, yy, xy) on an edge with this normal; or its force, with the normal times an area.
inline Vec2 stress_times(const std::array<double, 3>& stress, const Vec2& normal) {
    return {stress[0] * normal.x() + stress[2] * normal.y(), stress[2] * normal.x() + stress[1] * normal.y()};
}

struct Load {
    enum class Kind {
        traction,  // [Pa] on boundary edges
        stress,  // [Pa] on boundary edges: the traction of this stress there, with large rotations on the present edge
        force,   // [N] shared equally by boundary vertices (or all vertices in a box)
        velocity,      // [m/s] of boundary vertices (or of all vertices in a box)
        displacement,  // [m] likewise
        body_force,    // [N/m3]
        acceleration   // [m/s2] a body force proportional to the density (gravity)
    };
    std::string name;  // empty: "load" and its number, from 0
    Kind kind = Kind::traction;
    Selection on;
    std::array<std::optional<double>, 2> value;  // x, y; absent = free (velocity, displacement) or zero
    std::array<double, 3> stress{};              // xx, yy, xy; tension positive
    TimeFunction history;                        // multiplies the value
    std::shared_ptr<const PlaceField> field;     // a traction, stress or pressure that varies, in their place

    bool drives() const { return kind == Kind::velocity || kind == Kind::displacement; }
    Vec2 vector() const { return {value[0].value_or(0), value[1].value_or(0)}; }
    /// Of a traction or stress on an edge with this normal; or its force, with the normal times an area.
    Vec2 traction_on(const Vec2& normal, const Vec2& place, double t) const {
        if (!field) return kind == Kind::stress ? stress_times(stress, normal) : Vec2(vector() * normal.norm());
        const std::array<double, 3> given = field->at(place, t);
        if (field->n_values == 1) return -given[0] * normal;
        if (kind == Kind::stress) return stress_times(given, normal);
        return Vec2(given[0], given[1]) * normal.norm();
    }
};

/// A fluid in cracks: it presses on both faces of all broken interfaces that broken interfaces connect to its source,
/// and on those of the joints that it fills, broken or not. Its pressure is given, or it follows from the volume Q that
/// has entered and the volume V of the cracks that it fills: storage p = Q - V, or 0 where that is negative.
struct CrackPressure {
    std::string name = {};                   // empty: "fluid" and its number, from 0
    double pressure = 0;                     // [Pa]
    TemperatureTable over_temperature = {};  // [Pa] in its place: that of ice, at the temperature of the point
    std::shared_ptr<const PlaceField> field = nullptr;  // [Pa] in its place
    double rate = 0;               // [m2/s] volume per thickness that enters in a time; with a storage
    double storage = 0;            // [m2/Pa] compressibility times volume of the fluid per thickness; 0: p is given
    double gradient = 0;           // [Pa/m] what is added for each metre below `level`; the sum then is at least 0
    double level = 0;              // [m] y
    bool in_process_zone = false;  // it also fills what has begun to open and still holds in part
    std::optional<Selection> from = {};  // the source: cracks that begin on this boundary or in this box
    Index joint_law = -1;                // the source: all joints with this law; neither: all cracks
    TimeFunction history = {};           // multiplies the pressure, or the rate

    bool is_injected() const { return storage > 0; }
};

/// A rigid, fixed support of a boundary, glued by a cohesive law or in contact only.
struct Support {
    Selection on;
    Index law = 0;       // index into the model's laws
    bool glued = false;  // false: cohesion zero from the start, contact and friction only
    double gap = 0;      // [m] initial distance along the outward normal
    double beyond = 0;   // [m] with contact between free faces: how far it goes on straight where it ends
};

/// A region that vanishes. The forces that it exerted on the rest of the body decrease linearly to zero.
struct Excavation {
    std::vector<Vec2> outline;  // [m] of the region, closed polygon
    double at = 0;              // [s]
    double ramp = 0;            // [s] of the forces; 0: at once
};

struct InitialVelocity {
    Selection on;                         // triangles of the body whose centroid lies inside the box
    Vec2 value;                           // [m/s]
    double spin = 0;                      // [rad/s] about the centre of mass of these triangles, counterclockwise
    std::array<double, 3> strain_rate{};  // [1/s] xx, yy, xy, about the same centre
};

/// A stress that the undeformed body has.
struct InitialStress {
    Selection on;      // triangles of the body whose centroid lies inside the box
    PlaceField field;  // [Pa] xx, yy, xy
};

}  // namespace knap
