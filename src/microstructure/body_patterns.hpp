#pragma once
// Outlines of many bodies: the blocks of a wall, the cells of a box, a heap of stones.
#include "microstructure/grains.hpp"
#include "microstructure/inclusions.hpp"

namespace knap {

using Outlines = std::vector<std::vector<Vec2>>;  // [m] polygons, counterclockwise

/// Rows of blocks; every second row is shifted along itself, with a shorter block at either end, so that all rows have
/// the same length.
struct WallOptions {
    int columns = 0, rows = 0;   // of whole blocks
    Vec2 block = Vec2::Zero();   // [m] width and height of a block
    double gap = 0;              // [m] between neighbours
    double bond = 0.5;           // [-] shift of every second row over block and gap; 0: columns of blocks
    Vec2 origin = Vec2::Zero();  // [m] lower left corner
};

/// Rows from the bottom, each from the left. The shorter blocks have the widths bond (w + gap) - gap and
/// (1 - bond) (w + gap) - gap.
Outlines wall(const WallOptions& options);

/// Cells of a power diagram that fill a box, a `gap` [m] apart and on its border. Vertices nearer than `nearest` [m] to
/// each other become one, in all cells that have them, so that no side is shorter than that.
Outlines cells_of_box(const GrainOptions& options, const Box& box, double gap, double nearest, std::uint64_t seed,
                      const std::string& part);

/// Random convex polygons or discs that keep a distance from each other and from the border of the box. Throws
/// ShapeError where there is no room. `part` names the random stream.
Outlines heap(InclusionOptions options, const Box& box, std::uint64_t seed, const std::string& part);

}  // namespace knap
