#include "microstructure/grains.hpp"

#include "base/random.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace knap {
namespace {

constexpr int n_moves = 100;

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

PowerDiagram grown(const GrainOptions& options, const Eigen::Matrix2d& to_round, const Box& body, std::uint64_t seed) {
    const auto& [low, high] = body;
    Box box = bounding_box(
        {to_round * low, to_round * Vec2(high.x(), low.y()), to_round * high, to_round * Vec2(low.x(), high.y())});
    const double margin = 1.5 * options.size * (1 + options.spread);
    box.low.array() -= margin, box.high.array() += margin;
    Random random(seed, "grains");
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
            const double area = cell.empty() ? 0 : signed_area(cell);
            // the area of a cell grows by the weight times half the sum of side over distance: about 1.7 for a hexagon
            weights[i] += 0.5 * (requested[i] - area);
            if (area > 0 && move < n_moves - 20) sites[i] = centroid(cell);  // the last moves correct areas only
        }
    }
    return {std::move(sites), std::move(weights), box};
}

}  // namespace

Grains::Grains(const GrainOptions& options, const Box& box, std::uint64_t seed)
    : to_round_(to_round(options)), diagram_(grown(options, to_round_, box, seed)) {}

double Grains::area(Index grain) const {
    const std::vector<Vec2> cell = diagram_.cell(grain);
    return cell.empty() ? 0 : signed_area(cell);
}

Grains::Border Grains::border(Index a, Index b) const {
    // |y - p_a|^2 - w_a = |y - p_b|^2 - w_b with y = A x:  (p_b - p_a).A x = (|p_b|^2 - |p_a|^2 + w_a - w_b)/2
    const Vec2 between = diagram_.site(b) - diagram_.site(a), normal = to_round_.transpose() * between;
    const double offset =
        0.5 * (between.dot(diagram_.site(a) + diagram_.site(b)) + diagram_.weight(a) - diagram_.weight(b));
    return {normal / normal.norm(), offset / normal.norm()};
}

}  // namespace knap
