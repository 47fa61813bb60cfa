#pragma once
// Random Delaunay meshes of a Shape (CGAL), conforming to its rings, cracks and region borders.
#include "geometry/mesh.hpp"
#include "geometry/shape.hpp"

#include <cstdint>
#include <vector>

namespace knap {

struct RefineBox {
    Vec2 low, high;  // [m]
    double size;     // [m] wanted mean edge length inside
};

struct MeshOptions {
    double size = 0;                // [m] wanted mean edge length, met within 5 %
    std::vector<RefineBox> refine;  // the smallest size wins where boxes overlap
    double grading = 0.3;           // [-] growth of the size per distance away from a refine box
    double min_angle = 20;          // [degree] wanted smallest angle, at most 30
    std::uint64_t seed = 1;
};

/// Throws ShapeError for a shape that cannot be meshed (self-crossing, needle, too fine, empty). Cracks are cut off at the border of the
/// body; an end within 1e-6 of the body's diagonal from a border or another crack is moved onto it. The same seed gives the same bits.
Mesh triangulate(const Shape& shape, const MeshOptions& options);

}  // namespace knap
