#pragma once
// Blocks of triangles that are neighbours, small enough that the forces on their corners stay in the cache until the fans inside have taken them: on a large
// mesh memory sets the pace of the explicit step, and these forces would be more than half of what goes through it.
#include "model/model.hpp"

#include <span>

namespace knap {

/// The blocks do not depend on the number of threads, so neither do sums over them.
class MeshBlocks {
public:
    struct Block {
        Index first, last;                        // triangles from `first` to before `last`
        std::int32_t first_inner, last_inner;     // likewise
        std::int32_t first_corner;                // of the first inner fan
        std::int32_t first_kept, last_kept;
        std::int32_t first_bordering, last_bordering;
        std::int32_t first_bordering_corner;
        std::int32_t first_load, last_load;       // into Model::corner_loads
    };
    struct BlockFan {
        double mass;  // [kg]
        Index fan, n_corners;
    };
    using Corner = std::uint16_t;  // from the first corner of the block on

    explicit MeshBlocks(const Model& model);

    Index max_corners() const { return max_corners_; }  // of a block
    std::span<const Block> blocks() const { return blocks_; }
    /// Fans all of whose corners are in the block.
    std::span<const BlockFan> inner(const Block& block) const { return std::span(inner_).subspan(block.first_inner, block.last_inner - block.first_inner); }
    /// The corners of its inner fans, one fan after the other.
    const Corner* corners(const Block& block) const { return inner_corners_.data() + block.first_corner; }
    /// The corners of fans that are not inner ones.
    std::span<const Corner> kept(const Block& block) const { return std::span(kept_).subspan(block.first_kept, block.last_kept - block.first_kept); }

    /// Fans that begin in the block and go on in others, and all in it that loads, drives or obstacles may act on.
    std::span<const BlockFan> bordering(const Block& block) const {
        return std::span(bordering_).subspan(block.first_bordering, block.last_bordering - block.first_bordering);
    }
    /// Their corners, one fan after the other, and as many more as one may look ahead.
    const Index* bordering_corners(const Block& block) const { return bordering_corners_.data() + block.first_bordering_corner; }
    static constexpr Index look_ahead = 24;

private:
    Index max_corners_;
    std::vector<Block> blocks_;
    std::vector<BlockFan> inner_, bordering_;
    std::vector<Corner> inner_corners_, kept_;
    std::vector<Index> bordering_corners_;
};

}  // namespace knap
