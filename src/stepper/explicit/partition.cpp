#include "stepper/explicit/partition.hpp"

#include <algorithm>
#include <utility>

namespace knap {

void copy_partition(const Model& model, const State& begin, State& end) {
    const std::size_t known = end.split_fans.size();
    const bool continues = end.node_of_corner.size() == begin.node_of_corner.size() &&
                           known <= begin.split_fans.size() &&
                           std::equal(end.split_fans.begin(), end.split_fans.end(), begin.split_fans.begin());
    if (!continues) {
        end.node_of_corner = begin.node_of_corner;
        end.split_fans = begin.split_fans;
        end.first_point = begin.first_point;
        end.split_rank = begin.split_rank;
    }
    for (std::size_t rank = known; continues && rank < begin.split_fans.size(); ++rank) {
        const Index f = begin.split_fans[rank];
        end.split_fans.push_back(f);
        end.first_point.push_back(begin.first_point[rank]);
        end.split_rank[f] = begin.split_rank[f];
        for (const Index corner : model.corners(model.fans[f]))
            end.node_of_corner[corner] = begin.node_of_corner[corner];
    }
    end.displacement.resize(begin.displacement.size());
    end.velocity.resize(begin.velocity.size());
    end.points.resize(begin.points.size());
    end.incubation = begin.incubation;
    end.rate.clear();  // of the implicit scheme, where the run changed from it
    end.reaction.assign(model.prescribed.size(), Vec2::Zero());
}

void order_split_fans(const Model& model, State& state, State& before) {
    constexpr std::ptrdiff_t max_part = 16;  // one in so many may be out of order
    const std::ptrdiff_t n_ordered = std::ranges::is_sorted_until(state.split_fans) - state.split_fans.begin();
    const auto n_split = static_cast<std::ptrdiff_t>(state.split_fans.size());
    if (max_part * (n_split - n_ordered) <= n_split) return;
    std::swap(before, state);  // so that both get memory for all fans
    state = before;
    std::ranges::sort(state.split_fans);
    std::size_t node = model.fans.size();
    Index point = 0;
    for (std::size_t rank = 0; rank < state.split_fans.size(); ++rank) {
        const Index f = state.split_fans[rank];
        const Fan& fan = model.fans[f];
        for (const Index corner : model.corners(fan).subspan(1)) {  // the first corner has the node of the fan
            const Index from = before.node_of_corner[corner];
            state.node_of_corner[corner] = static_cast<Index>(node);
            state.displacement[node] = before.displacement[from];
            state.velocity[node] = before.velocity[from];
            if (state.has_end_velocities()) state.rate[node] = before.rate[from];
            ++node;
        }
        std::copy_n(before.points.begin() + before.first_point[before.split_rank[f]], fan.n_points,
                    state.points.begin() + point);
        state.split_rank[f] = static_cast<Index>(rank);
        state.first_point[rank] = point;
        point += fan.n_points;
    }
}

}  // namespace knap
