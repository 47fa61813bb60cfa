#pragma once
// What acts on a body from outside, before it meets a mesh.
#include "mesh/polygon.hpp"

#include <array>
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
};

/// A step of size h [s] from `begin` [s], as far as prescribed motions need it.
struct StepTimes {
    double begin, h;
    double theta = 1;                  // of the theta scheme
    bool central_differences = false;  // velocities live at the middle of the step, displacements at its end
};

/// One component of a prescribed motion over a step.
struct PrescribedRate {
    double rate;          // [m/s] or [rad/s]; the displacement at the end is the one at the begin plus h times it
    double end_velocity;  // likewise
};

/// `value` times `history` is the displacement or the velocity of the component; `displacement` [m] or [rad] at the begin of the step.
PrescribedRate prescribed_rate(bool is_displacement, double value, const TimeFunction& history, double displacement, const StepTimes& step);

/// Where something acts: a named boundary, or all inside a box, or everywhere.
struct Selection {
    std::string boundary;    // empty: not by name
    std::optional<Box> box;  // with a boundary name: the part of it inside the box
};

struct Load {
    enum class Kind {
        traction,      // [Pa] on boundary edges
        stress,        // [Pa] on boundary edges: the traction that a stress has there
        force,         // [N] shared equally by boundary vertices (or all vertices in a box)
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

    bool drives() const { return kind == Kind::velocity || kind == Kind::displacement; }
};

/// A rigid, fixed support that a boundary stands on, glued by a cohesive law or only in contact.
struct Support {
    Selection on;
    Index law = 0;       // index into the model's laws
    bool glued = false;  // false: cohesion zero from the start, contact and friction only
    double gap = 0;      // [m] initial distance along the outward normal
};

struct InitialVelocity {
    Selection on;  // triangles whose centroid lies inside the box; everywhere without one
    Vec2 value;    // [m/s]
};

}  // namespace knap
