#pragma once
// Grains on a mesh, and their statistics.
#include "mesh/mesh.hpp"
#include "microstructure/grains.hpp"

#include <functional>
#include <span>

namespace knap {

/// Sets mesh.grain on the triangles of material `region` that have no grain yet: every triangle belongs to the grain
/// that contains its centroid. Then single teeth are smoothed away and vertices on borders move onto the true borders
/// (line between two grains, point where three meet) as far as their triangles stay good. The number of triangles
/// stays; the stable step may shrink a little, and borders stray by a fraction of an edge. Boundaries, cracks, borders
/// of materials and the `fixed` vertices stay. `mesh` needs its edges. Grains without a triangle are left out of the
/// numbers. Returns the number of the first new grain, which is the number of grains before.
Index put_grains(Mesh& mesh, const Grains& grains, Index region, std::span<const Index> fixed = {});

/// The line between two labels near a place.
using BorderBetween = std::function<Grains::Border(Index a, Index b, const Vec2& x)>;
/// The same for any labels of triangles (-1: none), whose borders are given.
void fit_borders(Mesh& mesh, std::vector<Index>& label, const BorderBetween& border, std::span<const Index> fixed = {});

struct GrainReport {
    Index n_grains = 0;
    Index n_whole = 0;         // not cut by a boundary; the rest is about these
    double mean_diameter = 0;  // [m] of the circle of equal area
    double spread = 0;         // [-] standard deviation of the diameters over their mean
    double elongation = 1;     // [-] length over width of the mean grain: root of the ratio of its mean second moments
    double direction = 0;      // [rad] of its length, -pi/2 to pi/2
    double border_length = 0;  // [m] between different grains
    Index min_triangles = 0;   // in a whole grain
};

GrainReport judge_grains(const Mesh& mesh);

/// Area of every grain [m2].
std::vector<double> grain_areas(const Mesh& mesh);

}  // namespace knap
