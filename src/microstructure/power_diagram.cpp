#include "microstructure/power_diagram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {
namespace {

/// Cuts a convex polygon to its part in n.x <= offset; `kept` is scratch.
void cut(std::vector<Vec2>& polygon, const Vec2& n, double offset, std::vector<Vec2>& kept) {
    kept.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double over_a = n.dot(a) - offset, over_b = n.dot(b) - offset;
        if (over_a <= 0) kept.push_back(a);
        if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0))
            kept.push_back(a + over_a / (over_a - over_b) * (b - a));
    }
    if (kept.size() < 3) kept.clear();
    polygon.swap(kept);
}

double farthest(const std::vector<Vec2>& polygon, const Vec2& p) {
    double squared = 0;
    for (const Vec2& q : polygon) squared = std::max(squared, (q - p).squaredNorm());
    return std::sqrt(squared);
}

}  // namespace

PowerDiagram::PowerDiagram(std::vector<Vec2> sites, std::vector<double> weights, const Box& box)
    : sites_(std::move(sites)), weights_(std::move(weights)), box_(box) {
    const Vec2 extent = box.extent();
    bin_ = std::sqrt(extent.x() * extent.y() / static_cast<double>(std::max<std::size_t>(1, sites_.size())));
    bin_ = std::max(bin_, 1e-3 * extent.maxCoeff());  // a long box with few sites
    n_x_ = std::max(1, static_cast<int>(std::ceil(extent.x() / bin_)));
    n_y_ = std::max(1, static_cast<int>(std::ceil(extent.y() / bin_)));
    bins_ = Grouped<Index>(static_cast<std::size_t>(n_x_) * n_y_, [&](const auto& visit) {
        for (Index i = 0; i < n_sites(); ++i)
            visit(static_cast<std::size_t>(bin_along(1, sites_[i].y())) * n_x_ + bin_along(0, sites_[i].x()), i);
    });
    largest_weight_ = weights_.empty() ? 0 : *std::max_element(weights_.begin(), weights_.end());
}

int PowerDiagram::bin_along(int axis, double x) const {
    return std::clamp(static_cast<int>(std::floor((x - box_.low[axis]) / bin_)), 0, (axis == 0 ? n_x_ : n_y_) - 1);
}

template <class Visit>
bool PowerDiagram::visit_ring(const Vec2& x, int ring, Visit visit) const {
    const int i = bin_along(0, x.x()), j = bin_along(1, x.y());
    if (i - ring < 0 && i + ring >= n_x_ && j - ring < 0 && j + ring >= n_y_) return false;
    for (int v = std::max(0, j - ring); v <= std::min(n_y_ - 1, j + ring); ++v) {
        const bool whole_row = v == j - ring || v == j + ring;
        for (int u = i - ring; u <= i + ring; u += whole_row || ring == 0 ? 1 : 2 * ring) {
            if (u < 0 || u >= n_x_) continue;
            for (const Index site : bins_[static_cast<std::size_t>(v) * n_x_ + u]) visit(site);
        }
    }
    return true;
}

Index PowerDiagram::cell_at(const Vec2& x) const {
    Index best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (int ring = 0;; ++ring) {
        const double reach = std::max(0, ring - 1) * bin_;  // nothing in this ring is nearer
        if (reach * reach - largest_weight_ > least) break;
        const bool any = visit_ring(x, ring, [&](Index i) {
            const double power = (x - sites_[i]).squaredNorm() - weights_[i];
            if (power < least || (power == least && i < best)) least = power, best = i;
        });
        if (!any) break;
    }
    return best;
}

std::vector<Vec2> PowerDiagram::cell(Index i) const {
    const Vec2 p = sites_[i];
    const auto& [low, high] = box_;
    std::vector<Vec2> polygon{low, {high.x(), low.y()}, high, {low.x(), high.y()}}, kept;
    for (int ring = 0; !polygon.empty(); ++ring) {
        // a site at distance d cuts along a line that is (d^2 + w_i - w_j)/(2 d) away
        const double d = std::max(0, ring - 1) * bin_, reach = farthest(polygon, p);
        if (d > 0 && d * d + weights_[i] - largest_weight_ > 2 * d * reach) break;
        const bool any = visit_ring(p, ring, [&](Index j) {
            if (j == i || polygon.empty()) return;
            const Vec2 n = sites_[j] - p;
            cut(polygon, n, n.dot(p) + 0.5 * (n.squaredNorm() + weights_[i] - weights_[j]), kept);
        });
        if (!any) break;
    }
    return polygon;
}

}  // namespace knap
