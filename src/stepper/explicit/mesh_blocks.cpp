#include "stepper/explicit/mesh_blocks.hpp"

#include <algorithm>

namespace knap {

namespace {

constexpr Index fewest = 3072, most = 24576;  // corners of a block: 50 to 400 kB of forces
constexpr Index blocks_of_a_body = 32;               // or more, so that several threads find work and meet without a wait

}  // namespace

MeshBlocks::MeshBlocks(const Model& model) {
    const Index per_triangle = model.mesh.corners_per_triangle();
    const Index triangles = std::clamp(model.mesh.n_corners() / blocks_of_a_body, fewest, most) / per_triangle;
    max_corners_ = triangles * per_triangle;
    std::vector<std::uint8_t> is_inner(model.fans.size(), 1);
    for (const CornerLoad& load : model.corner_loads) is_inner[model.fan_of_corner[load.corner]] = 0;
    for (const PrescribedMotion& motion : model.prescribed) is_inner[motion.fan] = 0;
    std::vector<std::vector<Index>> inner_of_block((model.mesh.n_triangles() + triangles - 1) / triangles), bordering_of_block(inner_of_block.size());
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const Fan& fan = model.fans[f];
        const Index* corner = &model.fan_corners[fan.first_corner];
        const Index block = *corner / max_corners_;
        const bool whole = std::all_of(corner, corner + fan.n_corners, [&](Index c) { return c / max_corners_ == block; });
        is_inner[f] = is_inner[f] && whole && (fan.closed || model.obstacles.empty());
        (is_inner[f] ? inner_of_block : bordering_of_block)[block].push_back(f);
    }
    for (Index b = 0; b < static_cast<Index>(inner_of_block.size()); ++b) {
        Block block{.first = b * triangles, .last = std::min((b + 1) * triangles, model.mesh.n_triangles())};
        block.first_inner = static_cast<Index>(inner_.size());
        block.first_corner = static_cast<Index>(inner_corners_.size());
        block.first_kept = static_cast<Index>(kept_.size());
        block.first_bordering = static_cast<Index>(bordering_.size());
        block.first_bordering_corner = static_cast<Index>(bordering_corners_.size());
        for (const Index f : bordering_of_block[b]) {
            const Fan& fan = model.fans[f];
            bordering_.push_back({.mass = fan.mass, .fan = f, .n_corners = fan.n_corners});
            for (Index i = 0; i < fan.n_corners; ++i) bordering_corners_.push_back(model.fan_corners[fan.first_corner + i]);
        }
        for (const Index f : inner_of_block[b]) {
            const Fan& fan = model.fans[f];
            inner_.push_back({.mass = fan.mass, .fan = f, .n_corners = fan.n_corners});
            for (Index i = 0; i < fan.n_corners; ++i) inner_corners_.push_back(static_cast<Corner>(model.fan_corners[fan.first_corner + i] - b * max_corners_));
        }
        for (Index c = per_triangle * block.first; c < per_triangle * block.last; ++c)
            if (!is_inner[model.fan_of_corner[c]]) kept_.push_back(static_cast<Corner>(c - b * max_corners_));
        block.last_inner = static_cast<Index>(inner_.size());
        block.last_kept = static_cast<Index>(kept_.size());
        block.last_bordering = static_cast<Index>(bordering_.size());
        const auto first_load_from = [&](Index corner) {
            return static_cast<Index>(std::ranges::lower_bound(model.corner_loads, corner, {}, &CornerLoad::corner) - model.corner_loads.begin());
        };
        block.first_load = first_load_from(per_triangle * block.first);
        block.last_load = first_load_from(per_triangle * block.last);
        blocks_.push_back(block);
    }
    bordering_corners_.resize(bordering_corners_.size() + look_ahead, 0);
}

}  // namespace knap
