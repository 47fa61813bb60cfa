#include "microstructure/grains.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

double farthest(const std::vector<Vec2>& polygon, const Vec2& p) {
    double squared = 0;
    for (const Vec2& q : polygon) squared = std::max(squared, (q - p).squaredNorm());
    return std::sqrt(squared);
}

Eigen::Matrix2d to_round(const GrainOptions& options) {
    const double stretch = std::sqrt(options.elongation);
    const Vec2 along(std::cos(options.direction), std::sin(options.direction)), across = turned_left(along);
    return along * along.transpose() / stretch + across * across.transpose() * stretch;
}

/// Areas of circles with lognormal diameters of mean 1, scaled so that they fill `total`.
std::vector<double> areas(const GrainOptions& options, double total, Random& random) {
    const double mean_area = 0.25 * std::numbers::pi * (1 + options.spread * options.spread);
    const auto n =
        static_cast<std::size_t>(std::max(1.0, std::round(total / (mean_area * options.size * options.size))));
    std::vector<double> areas(n);
    for (double& area : areas) {
        const double diameter = random.lognormal(options.spread);
        area = diameter * diameter;
    }
    const double sum = std::accumulate(areas.begin(), areas.end(), 0.0);
    for (double& area : areas) area *= total / sum;
    return areas;
}

/// The image of a box in the plane where grains are round, and a margin.
Box round_box(const GrainOptions& options, const Eigen::Matrix2d& to_round, const Box& body) {
    std::vector<Vec2> corners = body.corners();
    for (Vec2& p : corners) p = to_round * p;
    Box box = bounding_box(corners);
    const double margin = 1.5 * options.size * (1 + options.spread);
    box.low.array() -= margin, box.high.array() += margin;
    return box;
}

}  // namespace

PowerDiagram round_cells(const GrainOptions& options, const Box& box, std::uint64_t seed, std::string_view stream) {
    constexpr int n_moves = 100, n_last = 20;  // the last moves correct areas only
    Random random(seed, stream);
    const Vec2 extent = box.extent();
    const std::vector<double> requested = areas(options, extent.x() * extent.y(), random);
    std::vector<Vec2> sites(requested.size());
    std::vector<double> weights(requested.size());
    for (std::size_t i = 0; i < sites.size(); ++i) {
        sites[i] = box.low + Vec2(random.uniform() * extent.x(), random.uniform() * extent.y());
        weights[i] = requested[i] / std::numbers::pi;
    }
    for (int move = 0; move < n_moves; ++move) {
        const PowerDiagram diagram(sites, weights, box);
        for (Index i = 0; i < diagram.n_sites(); ++i) {
            const std::vector<Vec2> cell = diagram.cell(i);
            const double area = signed_area(cell);
            // the area of a cell grows by the weight times half the sum of side over distance: about 1.7 for a hexagon
            weights[i] += 0.5 * (requested[i] - area);
            if (area > 0 && move < n_moves - n_last) sites[i] = centroid(cell);
        }
    }
    return {std::move(sites), std::move(weights), box};
}

PowerDiagram::PowerDiagram(std::vector<Vec2> sites, std::vector<double> weights, const Box& box)
    : sites_(std::move(sites)), weights_(std::move(weights)), box_(box) {
    const Vec2 extent = box.extent();
    bin_ = std::sqrt(extent.x() * extent.y() / static_cast<double>(std::max<std::size_t>(1, sites_.size())));
    bin_ = std::max(bin_, 1e-3 * extent.maxCoeff());  // a long box with few sites
    for (const int axis : {0, 1}) n_bins_[axis] = std::max(1, static_cast<int>(std::ceil(extent[axis] / bin_)));
    sites_of_bins_ = Grouped<Index>(static_cast<std::size_t>(n_bins_[0]) * n_bins_[1], [&](const auto& visit) {
        for (Index i = 0; i < n_sites(); ++i)
            visit(static_cast<std::size_t>(bin_along(1, sites_[i].y())) * n_bins_[0] + bin_along(0, sites_[i].x()), i);
    });
    largest_weight_ = weights_.empty() ? 0 : std::ranges::max(weights_);
}

int PowerDiagram::bin_along(int axis, double x) const {
    return std::clamp(static_cast<int>(std::floor((x - box_.low[axis]) / bin_)), 0, n_bins_[axis] - 1);
}

template <class Visit>
bool PowerDiagram::visit_ring(const Vec2& x, int ring, Visit visit) const {
    const int i = bin_along(0, x.x()), j = bin_along(1, x.y());
    const auto [n_x, n_y] = n_bins_;
    if (i - ring < 0 && i + ring >= n_x && j - ring < 0 && j + ring >= n_y) return false;
    for (int v = std::max(0, j - ring); v <= std::min(n_y - 1, j + ring); ++v) {
        const bool whole_row = v == j - ring || v == j + ring;
        for (int u = i - ring; u <= i + ring; u += whole_row || ring == 0 ? 1 : 2 * ring) {
            if (u < 0 || u >= n_x) continue;
            for (const Index site : sites_of_bins_[static_cast<std::size_t>(v) * n_x + u]) visit(site);
        }
    }
    return true;
}

Index PowerDiagram::cell_at(const Vec2& x) const {
    Index best = -1;
    double smallest = infinity;
    for (int ring = 0;; ++ring) {
        const double reach = std::max(0, ring - 1) * bin_;  // nothing in this ring is nearer
        if (reach * reach - largest_weight_ > smallest) return best;
        const bool any = visit_ring(x, ring, [&](Index i) {
            const double power = (x - sites_[i]).squaredNorm() - weights_[i];
            if (power < smallest || (power == smallest && i < best)) smallest = power, best = i;
        });
        if (!any) return best;
    }
}

std::vector<Vec2> PowerDiagram::cell(Index i) const {
    const Vec2 p = sites_[i];
    std::vector<Vec2> polygon = box_.corners(), scratch;
    for (int ring = 0; !polygon.empty(); ++ring) {
        // a site at distance d cuts along a line that is (d^2 + w_i - w_j)/(2 d) away
        const double d = std::max(0, ring - 1) * bin_, reach = farthest(polygon, p);
        if (d > 0 && d * d + weights_[i] - largest_weight_ > 2 * d * reach) break;
        const bool any = visit_ring(p, ring, [&](Index j) {
            if (j == i || polygon.empty()) return;
            const Vec2 n = sites_[j] - p;
            const double offset = n.dot(p) + 0.5 * (n.squaredNorm() + weights_[i] - weights_[j]);
            clip(
                polygon, [&](const Vec2& x) { return n.dot(x) - offset; }, scratch);
        });
        if (!any) break;
    }
    return polygon;
}

Grains::Grains(const GrainOptions& options, const Box& box, std::uint64_t seed)
    : to_round_(to_round(options)),
      diagram_(round_cells(options, round_box(options, to_round_, box), seed, "grains")) {}

Grains::Border Grains::border(Index a, Index b) const {
    // |y - p_a|^2 - w_a = |y - p_b|^2 - w_b with y = A x:  (p_b - p_a).A x = (|p_b|^2 - |p_a|^2 + w_a - w_b)/2
    const Vec2 between = diagram_.site(b) - diagram_.site(a), normal = to_round_.transpose() * between;
    const double offset =
        0.5 * (between.dot(diagram_.site(a) + diagram_.site(b)) + diagram_.weight(a) - diagram_.weight(b));
    return {normal / normal.norm(), offset / normal.norm()};
}

}  // namespace knap
