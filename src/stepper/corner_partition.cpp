#include "stepper/corner_partition.hpp"

namespace knap {

CornerPartition partition_corners(const Model& model, const std::vector<std::uint8_t>& fan_is_loose) {
    CornerPartition partition;
    partition.node_of_corner.assign(model.mesh.n_corners(), -1);
    const auto new_node = [&](Index corner) {
        partition.corner_of_node.push_back(corner);
        return partition.n_nodes() - 1;
    };
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        const Index* corner = &model.fan_corners[fan.first_corner];
        if (!fan_is_loose[f]) {
            const Index node = new_node(corner[0]);
            for (Index i = 0; i < fan.n_corners; ++i) partition.node_of_corner[corner[i]] = node;
            continue;
        }
        // the points are in the order of the corners: a part begins behind every point that can break
        const FanPoint* point = &model.fan_points[fan.first_point];
        const auto begins_part = [&](Index j) { return point[j].after != ground && (point[j].before == ground || !unbreakable(model, point[j])); };
        std::vector<std::uint8_t> begins(fan.n_corners, 0);
        bool any = false;
        for (Index j = 0, c = 0; j < fan.n_points; ++j) {
            while (c < fan.n_corners && corner[c] != point[j].after) ++c;
            if (c < fan.n_corners && begins_part(j)) begins[c] = any = true;
        }
        if (!fan.closed) begins[0] = any = true;
        if (!any) begins[0] = true;
        Index first = 0;
        while (!begins[first]) ++first;
        Index node = -1;
        for (Index k = 0; k < fan.n_corners; ++k) {  // a closed fan goes on over its end
            const Index i = (first + k) % fan.n_corners;
            if (begins[i]) node = new_node(corner[i]);
            partition.node_of_corner[corner[i]] = node;
        }
    }
    return partition;
}

}  // namespace knap
