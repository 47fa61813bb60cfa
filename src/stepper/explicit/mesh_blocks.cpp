#include "stepper/explicit/mesh_blocks.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr Index min_corners = 3072, max_corners = 24576;  // of a block: 50 to 400 kB of forces
constexpr Index blocks_of_a_body = 32;                    // or more, to keep several threads busy

}  // namespace

std::vector<MeshBlock> make_blocks(const Model& model, std::span<const Dashpot> dashpots) {
    const Index per_triangle = model.mesh.corners_per_triangle(), n_triangles = model.mesh.n_triangles();
    const Index triangles =
        std::clamp(model.mesh.n_corners() / blocks_of_a_body, min_corners, max_corners) / per_triangle;
    const Index n_corners = triangles * per_triangle;
    const auto first_load_from = [&](Index corner) {
        return static_cast<Index>(std::ranges::lower_bound(model.corner_loads, corner, {}, &CornerLoad::corner) -
                                  model.corner_loads.begin());
    };
    std::vector<MeshBlock> blocks;
    for (Index first = 0; first < n_triangles; first += triangles) {
        const Index last = std::min(first + triangles, n_triangles);
        blocks.push_back({.first = first,
                          .last = last,
                          .first_load = first_load_from(per_triangle * first),
                          .last_load = first_load_from(per_triangle * last)});
    }

    std::vector<std::uint8_t> is_inner(model.fans.size(), 1);
    for (const CornerLoad& load : model.corner_loads) is_inner[model.fan_of_corner[load.corner]] = 0;
    for (const PrescribedMotion& motion : model.prescribed) is_inner[motion.fan] = 0;
    for (const Dashpot& dashpot : dashpots) is_inner[dashpot.fan] = 0;
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const Fan& fan = model.fans[f];
        const auto corners = model.corners(fan);
        const Index b = corners[0] / n_corners;
        const bool within = std::ranges::all_of(corners, [&](Index c) { return c / n_corners == b; });
        is_inner[f] = is_inner[f] && within && (fan.closed || model.obstacles.empty());
        MeshBlock& block = blocks[b];
        const MeshBlock::BlockFan in_block{.mass = fan.mass, .fan = f, .n_corners = fan.n_corners};
        if (is_inner[f]) {
            block.inner.push_back(in_block);
            for (const Index c : corners)
                block.inner_corners.push_back(static_cast<MeshBlock::Corner>(c - b * n_corners));
            add_inscribed_circles(model, fan, block.inner_circles);
        } else {
            block.bordering.push_back(in_block);
            block.bordering_corners.insert(block.bordering_corners.end(), corners.begin(), corners.end());
            add_inscribed_circles(model, fan, block.bordering_circles);
        }
    }
    for (MeshBlock& block : blocks) {
        for (Index c = per_triangle * block.first; c < per_triangle * block.last; ++c)
            if (!is_inner[model.fan_of_corner[c]])
                block.kept.push_back(static_cast<MeshBlock::Corner>(c - per_triangle * block.first));
        block.bordering_corners.resize(block.bordering_corners.size() + MeshBlock::look_ahead, 0);
    }
    return blocks;
}

}  // namespace knap
