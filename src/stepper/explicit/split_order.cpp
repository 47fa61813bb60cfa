#include "stepper/explicit/split_order.hpp"

#include <algorithm>
#include <utility>

namespace knap {

void order_split_fans(const Model& model, State& state, State& before) {
    constexpr std::ptrdiff_t most = 16;  // one in so many may be out of order
    const std::ptrdiff_t n_ordered = std::ranges::is_sorted_until(state.split_fans) - state.split_fans.begin();
    const auto n_split = static_cast<std::ptrdiff_t>(state.split_fans.size());
    if (most * (n_split - n_ordered) <= n_split) return;
    std::swap(before, state);  // so that both come to have room for all fans
    state = before;
    std::ranges::sort(state.split_fans);
    std::size_t node = model.fans.size();
    Index point = 0;
    for (std::size_t rank = 0; rank < state.split_fans.size(); ++rank) {
        const Index f = state.split_fans[rank];
        const Fan& fan = model.fans[f];
        for (Index i = 1; i < fan.n_corners; ++i, ++node) {  // the first corner has the node of the fan
            const Index corner = model.fan_corners[fan.first_corner + i], from = before.node_of_corner[corner];
            state.node_of_corner[corner] = static_cast<Index>(node);
            state.displacement[node] = before.displacement[from];
            state.velocity[node] = before.velocity[from];
            if (!state.rate.empty()) state.rate[node] = before.rate[from];
        }
        std::copy_n(before.points.begin() + before.first_point[before.split_rank[f]], fan.n_points, state.points.begin() + point);
        state.split_rank[f] = static_cast<Index>(rank);
        state.first_point[rank] = point;
        point += fan.n_points;
    }
}

}  // namespace knap
