#pragma once
// Materials painted on a body: a picture of pixels with a material each, laid over a rectangle.
#include "geometry/mesh.hpp"

namespace knap {

struct MaterialMap {
    Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // [m] the rectangle
    int width = 0, height = 0;                     // [pixel]
    std::vector<Index> material;                   // per pixel, rows from the top; -1 = leaves what is there

    /// -1 outside the rectangle.
    Index at(const Vec2& x) const;
};

/// Every triangle takes the material that covers most of it (of 25 places), so borders run along edges of the mesh and the mesh stays as
/// good as it was.
void paint(const MaterialMap& map, Mesh& mesh);

}  // namespace knap
