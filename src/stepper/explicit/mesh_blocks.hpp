#pragma once
// Blocks of neighbouring triangles, small enough that the forces on their corners stay in the cache until the fans
// inside have read them: on a large mesh memory bandwidth limits the explicit step, and these forces would be more than
// half of the traffic.
#include "stepper/explicit/bond_criteria.hpp"

#include <cstdint>

namespace knap {

/// The blocks do not depend on the number of threads, so neither do sums over them.
struct MeshBlock {
    struct BlockFan {
        double mass;  // [kg]
        Index fan, n_corners;
    };
    using Corner = std::uint16_t;  // from the first corner of the block on
    static constexpr Index look_ahead = 24;

    Index first, last;            // triangles from `first` to before `last`
    Index first_load, last_load;  // on their corners, into Model::corner_loads
    // fans with all corners in the block and without loads, dashpots, prescribed motion and obstacles; by fan
    std::vector<BlockFan> inner;
    std::vector<Corner> inner_corners;
    std::vector<InscribedCircle> inner_circles;
    // all other fans whose first corner is in the block; corners fan by fan, and look_ahead more to prefetch
    std::vector<BlockFan> bordering;
    std::vector<Index> bordering_corners;
    std::vector<InscribedCircle> bordering_circles;
    std::vector<Corner> kept;  // the corners of the block that belong to bordering fans of any block
};

std::vector<MeshBlock> make_blocks(const Model& model, std::span<const Dashpot> dashpots = {});

}  // namespace knap
