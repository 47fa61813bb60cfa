#pragma once
// Materials of triangles: minerals of grains, and a picture of pixels laid over the body.
#include "mesh/mesh.hpp"

#include <span>

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
    bool grains = false;                           // patches of one colour are grains
    int least_pixels = 16;                         // of a grain
    bool smooth = false;                           // borders
    std::vector<Index> patch = {};                 // per pixel, with grains: number of its patch; -1 = unchanged

    /// Of pixels with colours `rgb` (three a pixel): those that join along sides and have one colour and a material.
    /// Patches of fewer than `least_pixels` take the number of their neighbours. Returns the number of patches.
    Index find_patches(const std::vector<std::uint8_t>& rgb);
    const std::vector<Index>& labels() const { return grains ? patch : material; }
    /// A value of labels(); -1 outside the rectangle.
    Index at(const Vec2& x) const;
};

/// Every triangle takes the label that covers most of it (of 25 points): its material, and with grains its grain. So
/// borders run along edges of the mesh, and the mesh stays as good as it was. Smooth borders: fit_borders() with the
/// lines that fit the pixels round a place. `fixed` vertices stay.
void paint(const MaterialMap& map, Mesh& mesh, std::span<const Index> fixed = {});

}  // namespace knap
