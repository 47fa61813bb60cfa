#include "stepper/explicit/mesh_blocks.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr Index min_corners = 3072, max_corners = 24576;  // of a block: 50 to 400 kB of forces
constexpr Index blocks_of_a_body = 32;                    // or more, to keep several threads busy

}  // namespace

template <class Corner>
void BlockFans<Corner>::add(const Model& model, Index f, Index first_corner, bool is_free) {
    const Fan& fan = model.fans[f];
    fans.push_back(
        {.mass = fan.mass, .fan = f, .n_corners = static_cast<std::int16_t>(fan.n_corners), .is_free = is_free});
    for (const Index c : model.corners(fan)) corners.push_back(static_cast<Corner>(c - first_corner));
    corners.resize(corners.size() + n_places(fans.back()) - fan.n_corners, no_force);
    add_inscribed_circles(model, fan, circles);
    circles.resize(corners.size());
}

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

    for (MeshBlock& block : blocks) {
        block.inner.no_force = static_cast<MeshBlock::Corner>(per_triangle * blocks.front().last);
        block.bordering.no_force = model.mesh.n_corners();
    }
    std::vector<std::uint8_t> is_free(model.fans.size(), 1),
        is_loaded(model.fans.size(), !model.crack_fluids.empty());  // where a crack may come, a fluid may follow
    for (const CornerLoad& load : model.corner_loads) is_loaded[model.fan_of_corner[load.corner]] = 1;
    for (const PrescribedMotion& motion : model.prescribed) is_free[motion.fan] = 0;
    for (const Dashpot& dashpot : dashpots) is_free[dashpot.fan] = 0;
    std::vector<std::uint8_t> is_inner(model.fans.size());
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const Fan& fan = model.fans[f];
        const auto corners = model.corners(fan);
        const Index b = corners[0] / n_corners;
        const bool within = std::ranges::all_of(corners, [&](Index c) { return c / n_corners == b; });
        is_inner[f] = is_free[f] && !is_loaded[f] && within && (fan.closed || model.obstacles.empty());
        if (is_inner[f]) blocks[b].inner.add(model, f, b * n_corners, true);
        else blocks[b].bordering.add(model, f, 0, is_free[f]);
    }
    for (MeshBlock& block : blocks) {
        for (Index c = per_triangle * block.first; c < per_triangle * block.last; ++c)
            if (!is_inner[model.fan_of_corner[c]])
                block.kept.push_back(static_cast<MeshBlock::Corner>(c - per_triangle * block.first));
        block.bordering.corners.resize(block.bordering.corners.size() + block.bordering.look_ahead,
                                       block.bordering.no_force);
    }
    return blocks;
}

}  // namespace knap
