#pragma once
// Joint sets and veins: random traces about one direction, in rows a spacing apart, with bridges of rock between them.
#include "geometry/shape.hpp"

#include <cstdint>
#include <optional>

namespace knap {

struct JointOptions {
    double direction = 0;      // [rad] of the traces, from x
    double spread = 0;         // [rad] standard deviation of it
    double spacing = 0;        // [m] mean distance across
    double persistence = 1;    // [-] part of a row that is joint; 1 = from end to end
    double length = 0;         // [m] mean trace length, where persistence < 1
    Index joint = -1;          // number of the set, where it has a law; -1 = cracked from the start
    double thickness = 0;      // [m] of veins
    std::optional<Index> tag;  // material of veins
    double nearest = 0;        // [m] traces come no nearer to the ends and corners of other lines
};

/// Adds the traces to a shape as cracks, or as regions (veins). A trace that would cross another line under less than 15 degree or pass
/// nearer than `nearest` is drawn again, and left out after twenty times. Returns how many were left out. Throws ShapeError for
/// more than a million traces.
int place_joints(Shape& shape, const JointOptions& options, std::uint64_t seed, const std::string& part);

}  // namespace knap
