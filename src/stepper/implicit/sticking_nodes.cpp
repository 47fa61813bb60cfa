#include "stepper/implicit/sticking_nodes.hpp"

#include <algorithm>
#include <span>

namespace knap {

StickingNodes::StickingNodes(const Model& model) : model_(model) {
    Index max_nodes = 0;  // of a fan, and the support
    for (const Fan& fan : model.fans) max_nodes = std::max(max_nodes, fan.n_corners + 1);
    clusters_.resize(max_nodes);
    for (std::vector<Index>& cluster : clusters_) cluster.reserve(max_nodes);
    other_.reserve(max_nodes);
}

void StickingNodes::merge(const std::vector<std::uint8_t>& fan_is_active, const std::vector<Index>& active_point_of, const std::vector<ActivePoint>& points,
                          const std::vector<std::array<bool, 2>>& prescribed, std::vector<Vec2>& rate) {
    for (std::size_t f = 0; f < model_.fans.size(); ++f) {
        if (!fan_is_active[f]) continue;
        const Fan& fan = model_.fans[f];
        std::size_t n_clusters = 0;  // of nodes; -1 is the support
        const auto cluster_of = [&](Index node) -> std::vector<Index>& {
            for (std::size_t i = 0; i < n_clusters; ++i)
                if (std::find(clusters_[i].begin(), clusters_[i].end(), node) != clusters_[i].end()) return clusters_[i];
            clusters_[n_clusters].assign(1, node);
            return clusters_[n_clusters++];
        };
        for (Index j = 0; j < fan.n_points; ++j) {
            const Index i = active_point_of[fan.first_point + j];
            if (i < 0) continue;
            const ActivePoint& point = points[i];
            if (!point.holds_still() || point.before == point.after) continue;
            other_ = cluster_of(point.before);
            if (std::find(other_.begin(), other_.end(), point.after) != other_.end()) continue;
            cluster_of(point.before).clear();
            auto& whole = cluster_of(point.after);
            whole.insert(whole.end(), other_.begin(), other_.end());
        }
        for (const auto& cluster : std::span(clusters_).first(n_clusters))
            for (int k = 0; k < 2 && cluster.size() > 1; ++k) {
                double sum = 0, given = 0;
                bool is_given = false;
                for (const Index node : cluster) {
                    if (node < 0) is_given = true, given = 0;
                    else if (prescribed[node][k] && !is_given) is_given = true, given = rate[node][k];
                    else sum += rate[node][k];
                }
                for (const Index node : cluster)
                    if (node >= 0 && !prescribed[node][k]) rate[node][k] = is_given ? given : sum / static_cast<double>(cluster.size());
            }
    }
}

}  // namespace knap
