#pragma once
// Inclusions and pores: random discs or polygons that do not overlap, the largest placed first (random sequential addition, which jams at an
// area fraction of about 0.55 for equal discs; M. D. Rintoul, S. Torquato, J. Chem. Phys. 105 (1996) 9258: 0.547, from memory).
#include "geometry/shape.hpp"
#include "geometry/triangulate.hpp"

#include <cstdint>
#include <optional>

namespace knap {

struct InclusionOptions {
    double size = 0;                  // [m] mean diameter, of the circle of equal area
    double spread = 0;                // [-] standard deviation of the diameters (lognormal) over their mean
    double fraction = 0;              // [-] of the area of the body; or
    int number = 0;                   // how many; 0 = as many as the fraction asks for
    double distance = 0;              // [m] least distance between them, and from borders and cracks
    int corners = 0;                  // of random polygons; 0 = discs
    double elongation = 1;            // [-] length over width
    std::optional<double> direction;  // [rad] of the length; none = at random
    std::optional<Index> tag;         // material; none = pores
    Index boundary = 0;               // boundary name of pores
    MeshOptions mesh;                 // sides of the polygon that stands for a disc have the local mesh size
};

struct PlacedInclusions {
    int n = 0;
    double fraction = 0;  // [-] of the area of the body before
};

/// Adds them to a shape as regions, or as holes, until the fraction is met (to half an inclusion) or all are there. Throws ShapeError where
/// there is no room.
PlacedInclusions place_inclusions(Shape& shape, const InclusionOptions& options, std::uint64_t seed, const std::string& part);

}  // namespace knap
