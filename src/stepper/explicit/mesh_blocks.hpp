#pragma once
// Blocks of neighbouring triangles, small enough that the forces on their corners stay in the cache until the fans
// inside have read them: on a large mesh memory bandwidth limits the explicit step, and these forces would be more than
// half of the traffic.
#include "stepper/explicit/bond_criteria.hpp"

#include <cstdint>

namespace knap {

/// Fans of a block with their corners. Each fan is padded to a multiple of `group` with a place that has no force; the
/// padding costs less than mispredicted loop ends.
template <class Corner>
struct BlockFans {
    struct BlockFan {
        double mass;  // [kg]
        Index fan;
        std::int16_t n_corners;
        bool is_free;  // without prescribed motion and dashpots
    };
    static constexpr Index group = 4, look_ahead = 24;  // places
    static Index n_places(const BlockFan& fan) { return (fan.n_corners + group - 1) / group * group; }

    std::vector<BlockFan> fans;            // ascending
    std::vector<Corner> corners;           // fan by fan; of bordering ones look_ahead more, to prefetch
    std::vector<InscribedCircle> circles;  // of corners
    Corner no_force = 0;

    void add(const Model& model, Index fan, Index first_corner, bool is_free);
};

/// The blocks do not depend on the number of threads, so neither do sums over them.
struct MeshBlock {
    using Corner = std::uint16_t;  // from the first corner of the block on

    Index first, last;            // triangles from `first` to before `last`
    Index first_load, last_load;  // on their corners, into Model::corner_loads
    BlockFans<Corner> inner;      // all corners in the block; without loads, dashpots, prescribed motion and obstacles
    BlockFans<Index> bordering;   // all others whose first corner is in the block
    std::vector<Corner> kept;     // the corners of the block that belong to bordering fans of any block
};

std::vector<MeshBlock> make_blocks(const Model& model, std::span<const Dashpot> dashpots = {});

}  // namespace knap
