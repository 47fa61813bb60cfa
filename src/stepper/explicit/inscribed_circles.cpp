#include "stepper/explicit/inscribed_circles.hpp"

#include "stepper/explicit/stress_criterion.hpp"


namespace knap {

InscribedCircles::InscribedCircles(const Model& model, const MeshBlocks& blocks)
    : inner_(blocks.corners(blocks.blocks().front())), bordering_(blocks.bordering_corners(blocks.blocks().front())) {
    for (const MeshBlocks::Block& block : blocks.blocks())
        for (const MeshBlocks::BlockFan& inner : blocks.inner(block)) add(model, model.fans[inner.fan]);
    n_inner_ = places_.size();
    for (const MeshBlocks::Block& block : blocks.blocks())
        for (const MeshBlocks::BlockFan& bordering : blocks.bordering(block)) add(model, model.fans[bordering.fan]);
}

void InscribedCircles::add(const Model& model, const Fan& fan) {
    constexpr double rounding = 1e-12, nothing_known = -1;
    const Index* corner = &model.fan_corners[fan.first_corner];
    const bool driven = !model.prescribed.empty() && model.prescribed_of_corner[*corner] >= 0;
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index j = fan.closed ? (i + 1) % fan.n_points : i;
        double strength = std::numeric_limits<double>::infinity();
        if (j < fan.n_points) {
            const FanPoint& after = model.fan_points[fan.first_point + j];
            strength = sure_strength(model.laws[after.law], after.area) * (1 - rounding);
        }
        places_.push_back({.share = model.corner_mass[corner[i]] / fan.mass, .strength2 = fan.split_at_start || driven ? nothing_known : strength * strength});
    }
}

}  // namespace knap
