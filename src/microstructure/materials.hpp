#pragma once
// Materials of triangles: minerals of grains, and a picture of pixels laid over the body.
#include "mesh/mesh.hpp"

namespace knap {

struct Mineral {
    Index region = 0;     // material index
    double fraction = 0;  // [-] of the area of the grains; the rest keeps its material
};

/// For the grains from number `first` on. Random, with the area fractions met as well as whole grains allow: the
/// largest grains first, with probabilities proportional to the areas still missing, so that size and mineral are
/// independent.
void assign_minerals(Mesh& mesh, const std::vector<Mineral>& minerals, Index first, std::uint64_t seed);

struct MaterialMap {
    Vec2 low = Vec2::Zero(), high = Vec2::Zero();  // [m] the rectangle
    int width = 0, height = 0;                     // [pixel]
    std::vector<Index> material;                   // per pixel, rows from the top; -1 = unchanged

    /// -1 outside the rectangle.
    Index at(const Vec2& x) const;
};

/// Every triangle takes the material that covers most of it (of 25 points), so borders run along edges of the mesh and
/// the mesh stays as good as it was.
void paint(const MaterialMap& map, Mesh& mesh);

}  // namespace knap
