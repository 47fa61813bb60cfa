#include "stepper/implicit/sticking_rates.hpp"

#include <algorithm>

namespace knap {

StickingRates::StickingRates(const Model& model) {
    Index max_nodes = 0;  // of a fan, and the support
    for (const Fan& fan : model.fans) max_nodes = std::max(max_nodes, fan.n_corners + 1);
    clusters_.resize(max_nodes);
    for (std::vector<Index>& cluster : clusters_) cluster.reserve(max_nodes);
}

void StickingRates::merge(std::span<const ActivePoint> points, const CornerPartition& nodes, std::vector<Vec2>& rates) {
    for (auto point = points.begin(); point != points.end();) {
        std::size_t n_clusters = 0;
        const auto cluster_of = [&](Index node) -> std::vector<Index>& {  // node -1: the support
            for (std::size_t i = 0; i < n_clusters; ++i)
                if (std::ranges::find(clusters_[i], node) != clusters_[i].end()) return clusters_[i];
            clusters_[n_clusters].assign(1, node);
            return clusters_[n_clusters++];
        };
        for (const Index fan = point->fan; point != points.end() && point->fan == fan; ++point) {
            if (!point->is_stationary() || !point->support_rate.isZero(0)) continue;
            std::vector<Index>&from = cluster_of(point->sides.before), &to = cluster_of(point->sides.after);
            if (&from == &to) continue;
            to.insert(to.end(), from.begin(), from.end());
            from.clear();
        }
        for (const std::vector<Index>& cluster : std::span(clusters_).first(n_clusters))
            for (int k = 0; k < 2 && cluster.size() > 1; ++k) {
                double sum = 0, given = 0;
                bool is_given = false;
                for (const Index node : cluster) {
                    if (node < 0) is_given = true, given = 0;
                    else if (!nodes.prescribed[node][k]) sum += rates[node][k];
                    else if (!is_given) is_given = true, given = rates[node][k];
                }
                const double rate = is_given ? given : sum / static_cast<double>(cluster.size());
                for (const Index node : cluster)
                    if (!nodes.is_prescribed(node, k)) rates[node][k] = rate;
            }
    }
}

}  // namespace knap
