#include "stepper/implicit/corner_partition.hpp"

#include "base/reserve_capacity.hpp"

#include <span>

namespace knap {

void partition_corners(const Model& model, const std::vector<std::uint8_t>& active, CornerPartition& partition) {
    constexpr Index no_node = -1, starts_node = -2;
    partition.active = active;
    partition.corner_of_node.clear();
    reserve_capacity(model.mesh.n_corners(), partition.corner_of_node, partition.motion, partition.prescribed);
    std::vector<Index>& node_of = partition.node_of_corner;
    node_of.assign(model.mesh.n_corners(), no_node);
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        const Index* corner = &model.fan_corners[fan.first_corner];
        bool any = false;
        for (const FanPoint& point : std::span(model.fan_points).subspan(fan.first_point, fan.n_points)) {
            if (!active[f] || point.after == rigid_support) continue;
            if (point.before == rigid_support || !unbreakable(model, point))
                node_of[point.after] = starts_node, any = true;
        }
        if (!fan.closed || !any) node_of[corner[0]] = starts_node;
        Index first = 0;
        while (node_of[corner[first]] != starts_node) ++first;
        for (Index k = 0; k < fan.n_corners; ++k) {  // counterclockwise; the last node of a closed fan may span its end
            const Index c = corner[(first + k) % fan.n_corners];
            if (node_of[c] == starts_node) partition.corner_of_node.push_back(c);
            node_of[c] = partition.n_nodes() - 1;
        }
    }

    partition.motion.clear();
    partition.prescribed.clear();
    for (const Index corner : partition.corner_of_node) {
        const Index motion = model.prescribed_of_corner[corner];
        partition.motion.push_back(motion);
        partition.prescribed.push_back(motion < 0 ? std::array{false, false} : model.prescribed[motion].component);
    }
    for (const FanPoint& point : model.fan_points) {
        if ((point.before != rigid_support && point.after != rigid_support) || !unbreakable(model, point)) continue;
        const Index node = node_of[point.before == rigid_support ? point.after : point.before];
        partition.motion[node] = -1;
        partition.prescribed[node] = {true, true};
    }
}

}  // namespace knap
