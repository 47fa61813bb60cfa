#include "geometry/grains.hpp"

#include "base/random.hpp"
#include "geometry/polygon.hpp"

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

/// Areas of circles with lognormal diameters of mean 1, until they fill `total`, which they then do exactly.
std::vector<double> areas(const GrainOptions& options, double total, Random& random) {
    const double variance = std::log(1 + options.spread * options.spread), mean_area = 0.25 * std::numbers::pi * std::exp(variance);
    const auto n = static_cast<std::size_t>(std::max(1.0, std::round(total / (mean_area * options.size * options.size))));
    std::vector<double> areas(n);
    for (double& area : areas) {
        const double diameter = std::exp(std::sqrt(variance) * random.normal() - 0.5 * variance);
        area = diameter * diameter;
    }
    const double sum = std::accumulate(areas.begin(), areas.end(), 0.0);
    for (double& area : areas) area *= total / sum;
    return areas;
}

Vec2 centroid(const std::vector<Vec2>& polygon) {
    const Vec2 o = polygon.front();
    Vec2 moment = Vec2::Zero();
    double twice_area = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const Vec2 a = polygon[i] - o, b = polygon[i + 1] - o;
        twice_area += cross(a, b);
        moment += cross(a, b) * (a + b) / 3;
    }
    return twice_area > 0 ? Vec2(o + moment / twice_area) : o;
}

PowerDiagram grown(const GrainOptions& options, const Eigen::Matrix2d& to_round, const Vec2& low, const Vec2& high, std::uint64_t seed) {
    Vec2 from = to_round * low, to = from;
    for (const Vec2& corner : {Vec2(high.x(), low.y()), high, Vec2(low.x(), high.y())}) {
        from = from.cwiseMin(to_round * corner);
        to = to.cwiseMax(to_round * corner);
    }
    const double more = 1.5 * options.size * (1 + options.spread);
    from.array() -= more, to.array() += more;
    Random random(seed, "grains");
    const Vec2 extent = to - from;
    const std::vector<double> wanted = areas(options, extent.x() * extent.y(), random);
    std::vector<Vec2> sites(wanted.size());
    std::vector<double> weights(wanted.size());
    for (std::size_t i = 0; i < sites.size(); ++i) {
        sites[i] = from + Vec2(random.uniform() * extent.x(), random.uniform() * extent.y());
        weights[i] = wanted[i] / std::numbers::pi;
    }
    for (int move = 0; move < n_moves; ++move) {
        const PowerDiagram diagram(sites, weights, from, to);
        for (Index i = 0; i < diagram.n_sites(); ++i) {
            const std::vector<Vec2> cell = diagram.cell(i);
            const double area = cell.empty() ? 0 : signed_area(cell);
            // the area of a cell grows by the weight times half the sum of side over distance: about 1.7 for a hexagon
            weights[i] += 0.5 * (wanted[i] - area);
            if (area > 0 && move < n_moves - 20) sites[i] = centroid(cell);  // in the end only areas are mended
        }
    }
    return {std::move(sites), std::move(weights), from, to};
}

}  // namespace

Grains::Grains(const GrainOptions& options, const Vec2& low, const Vec2& high, std::uint64_t seed)
    : to_round_(to_round(options)), diagram_(grown(options, to_round_, low, high, seed)) {}

double Grains::area(Index grain) const {
    const std::vector<Vec2> cell = diagram_.cell(grain);
    return cell.empty() ? 0 : signed_area(cell);
}

Grains::Border Grains::border(Index a, Index b) const {
    // |y - p_a|^2 - w_a = |y - p_b|^2 - w_b with y = A x:  (p_b - p_a).A x = (|p_b|^2 - |p_a|^2 + w_a - w_b)/2
    const Vec2 between = diagram_.site(b) - diagram_.site(a), normal = to_round_.transpose() * between;
    const double offset = 0.5 * (between.dot(diagram_.site(a) + diagram_.site(b)) + diagram_.weight(a) - diagram_.weight(b));
    return {normal / normal.norm(), offset / normal.norm()};
}

}  // namespace knap
