#pragma once
// Inclusions and pores: random discs or polygons that do not overlap, the largest placed first (random sequential
// addition, which jams at an area fraction of about 0.55 for equal discs; M. D. Rintoul, S. Torquato, J. Chem. Phys.
// 105 (1996) 9258: 0.547, from memory). Joint sets and veins: random traces about one direction, in rows a spacing
// apart, with bridges of rock between them.
#include "mesh/shape.hpp"
#include "mesh/size_field.hpp"

#include <optional>

namespace knap {

struct InclusionOptions {
    double size = 0;                  // [m] mean diameter, of the circle of equal area
    double spread = 0;                // [-] standard deviation of the diameters (lognormal) over their mean
    double fraction = 0;              // [-] of the area of the body; or
    int number = 0;                   // of inclusions; 0 = as many as the fraction requires
    double distance = 0;              // [m] smallest distance between them, and from borders and cracks
    int corners = 0;                  // of random polygons; 0 = discs
    bool convex = false;              // polygons are replaced by their convex hull
    double elongation = 1;            // [-] length over width
    std::optional<double> direction;  // [rad] of the length; none = random
    std::optional<Index> tag;         // material; none = pores
    Index boundary = 0;               // boundary name of pores
    MeshOptions mesh;                 // sides of the polygon that approximates a disc have the local mesh size
};

struct PlacedInclusions {
    int n = 0;
    double fraction = 0;  // [-] of the area of the body before
};

/// Adds inclusions to a shape as regions, or pores as holes, until the fraction is met (to half an inclusion) or all
/// are placed. `part` names the random stream and the offender. Throws ShapeError where there is no room.
PlacedInclusions place_inclusions(Shape& shape, const InclusionOptions& options, std::uint64_t seed,
                                  const std::string& part);

struct JointOptions {
    double direction = 0;      // [rad] of the traces, from x
    double spread = 0;         // [rad] standard deviation of it
    double spacing = 0;        // [m] mean distance across
    double persistence = 1;    // [-] part of a row that is joint; 1 = from end to end
    double length = 0;         // [m] mean trace length, where persistence < 1
    Index joint = -1;          // number of the set, where it has a law; -1 = cracked from the start
    double thickness = 0;      // [m] of veins
    std::optional<Index> tag;  // material of veins
    double nearest = 0;        // [m] smallest distance of traces from the ends and corners of other lines
};

/// Adds traces to a shape as cracks, or as regions (veins). A trace that would cross another line at less than 15
/// degree or pass nearer than `nearest` is drawn again, and left out after twenty trials. Returns the number left out.
/// Throws ShapeError for more than a million traces.
int place_joints(Shape& shape, const JointOptions& options, std::uint64_t seed, const std::string& part);

}  // namespace knap
