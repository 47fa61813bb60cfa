#include "stepper/implicit/corner_partition.hpp"

namespace knap {

void partition_corners(const Model& model, const std::vector<std::uint8_t>& fan_is_active, CornerPartition& partition) {
    constexpr Index no_node = -1, begins_part = -2;
    partition.node_of_corner.assign(model.mesh.n_corners(), no_node);
    partition.corner_of_node.clear();
    partition.corner_of_node.reserve(model.mesh.n_corners());
    const auto new_node = [&](Index corner) {
        partition.corner_of_node.push_back(corner);
        return partition.n_nodes() - 1;
    };
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        const Index* corner = &model.fan_corners[fan.first_corner];
        if (!fan_is_active[f]) {
            const Index node = new_node(corner[0]);
            for (Index i = 0; i < fan.n_corners; ++i) partition.node_of_corner[corner[i]] = node;
            continue;
        }
        // the points are in the order of the corners: a part begins behind every point that can break
        const FanPoint* point = model.fan_points.data() + fan.first_point;
        const auto parts = [&](Index j) { return point[j].after != rigid_support && (point[j].before == rigid_support || !unbreakable(model, point[j])); };
        const auto mark = [&](Index c) -> Index& { return partition.node_of_corner[corner[c]]; };
        bool any = false;
        for (Index j = 0, c = 0; j < fan.n_points; ++j) {
            while (c < fan.n_corners && corner[c] != point[j].after) ++c;
            if (c < fan.n_corners && parts(j)) mark(c) = begins_part, any = true;
        }
        if (!fan.closed || !any) mark(0) = begins_part;
        Index first = 0;
        while (mark(first) != begins_part) ++first;
        Index node = -1;
        for (Index k = 0; k < fan.n_corners; ++k) {  // a closed fan goes on over its end
            const Index i = (first + k) % fan.n_corners;
            if (mark(i) == begins_part) node = new_node(corner[i]);
            mark(i) = node;
        }
    }
}

}  // namespace knap
