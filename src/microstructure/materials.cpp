#include "microstructure/materials.hpp"

#include "base/random.hpp"
#include "base/union_find.hpp"
#include "microstructure/grain_mesh.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace knap {

void assign_minerals(Mesh& mesh, const std::vector<Mineral>& minerals, Index first, std::uint64_t seed) {
    std::vector<double> areas = grain_areas(mesh);
    areas.erase(areas.begin(), areas.begin() + std::min<std::ptrdiff_t>(first, std::ssize(areas)));
    const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
    constexpr Index unchanged = -1;
    std::vector<Index> regions{unchanged};
    std::vector<double> missing{total};  // [m2] per entry of regions
    for (const Mineral& mineral : minerals) {
        regions.push_back(mineral.region);
        missing.push_back(mineral.fraction * total);
        missing[0] -= mineral.fraction * total;
    }
    std::vector<std::size_t> order(areas.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t grain) { return areas[grain]; });

    Random random(seed, "minerals");
    std::vector<Index> of_grain(areas.size(), unchanged);
    for (const std::size_t grain : order) {
        double sum = 0;
        for (const double area : missing) sum += std::max(0.0, area);
        double left = random.uniform() * sum;
        auto drawn = static_cast<std::size_t>(std::ranges::max_element(missing) - missing.begin());
        for (std::size_t i = 0; i < missing.size(); ++i) {
            if (missing[i] > 0 && left < missing[i]) {
                drawn = i;
                break;
            }
            left -= std::max(0.0, missing[i]);
        }
        of_grain[grain] = regions[drawn];
        missing[drawn] -= areas[grain];
    }
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Index grain = mesh.grain[t] - first;
        if (mesh.grain[t] >= first && of_grain[grain] != unchanged) mesh.region[t] = of_grain[grain];
    }
}

Index MaterialMap::find_patches(const std::vector<std::uint8_t>& rgb) {
    const auto n = static_cast<Index>(material.size());
    const auto same = [&](Index a, Index b) {
        return material[a] >= 0 && material[b] >= 0 && std::equal(&rgb[3 * a], &rgb[3 * a] + 3, &rgb[3 * b]);
    };
    UnionFind joined(n);
    for (Index i = 0; i < n; ++i) {
        if (i % width + 1 < width && same(i, i + 1)) joined.join(i, i + 1);
        if (i + width < n && same(i, i + width)) joined.join(i, i + width);
    }
    std::vector<Index> n_pixels(n, 0);
    for (Index i = 0; i < n; ++i) ++n_pixels[joined.find(i)];
    constexpr Index small = -2;
    patch.assign(n, -1);
    std::vector<Index> number(n, -1);  // of a patch, by its representative
    Index n_patches = 0;
    for (Index i = 0; i < n; ++i) {
        if (material[i] < 0) continue;
        const Index one = joined.find(i);
        if (n_pixels[one] < least_pixels) patch[i] = small;
        else patch[i] = number[one] >= 0 ? number[one] : number[one] = n_patches++;
    }
    // what is too small shrinks from its rim, pixel by pixel
    for (bool changed = true; changed;) {
        changed = false;
        const std::vector<Index> before = patch;
        for (Index i = 0; i < n; ++i) {
            if (before[i] != small) continue;
            for (const auto& [is_there, j] : {std::pair(i % width > 0, i - 1), std::pair(i % width + 1 < width, i + 1),
                                              std::pair(i >= width, i - width), std::pair(i + width < n, i + width)})
                if (is_there && before[j] >= 0) {
                    patch[i] = before[j], material[i] = material[j], changed = true;
                    break;
                }
        }
    }
    std::ranges::replace(patch, small, -1);
    return n_patches;
}

Index MaterialMap::at(const Vec2& x) const {
    const Vec2 part = (x - low).cwiseQuotient(high - low);
    if (!(part.minCoeff() >= 0 && part.maxCoeff() <= 1)) return -1;
    const int column = std::min(width - 1, static_cast<int>(part.x() * width));
    const int row = std::min(height - 1, static_cast<int>((1 - part.y()) * height));
    return labels()[static_cast<std::size_t>(row) * width + column];
}

namespace {

/// The line between the pixels of two labels in a disc of radius R round x: its normal points from the centroid of the
/// first to that of the second one, and it cuts off the part f of the disc that the first one has of both,
///
///     f = 1/2 + (s sqrt(1 - s^2) + asin s)/pi,     s = distance of the line from x over R.
Grains::Border border_in(const MaterialMap& map, Index a, Index b, const Vec2& x, double R) {
    const Vec2 pixel = (map.high - map.low).cwiseQuotient(Vec2(map.width, map.height));
    const auto column = [&](double at) { return static_cast<int>(std::floor((at - map.low.x()) / pixel.x())); };
    const auto row = [&](double at) { return static_cast<int>(std::floor((map.high.y() - at) / pixel.y())); };
    Vec2 sum_a = Vec2::Zero(), sum_b = Vec2::Zero();
    double n_a = 0, n_b = 0;
    for (int r = std::max(0, row(x.y() + R)); r <= std::min(map.height - 1, row(x.y() - R)); ++r)
        for (int c = std::max(0, column(x.x() - R)); c <= std::min(map.width - 1, column(x.x() + R)); ++c) {
            const Vec2 arm(map.low.x() + (c + 0.5) * pixel.x() - x.x(), map.high.y() - (r + 0.5) * pixel.y() - x.y());
            if (arm.squaredNorm() > R * R) continue;
            const Index label = map.labels()[static_cast<std::size_t>(r) * map.width + c];
            if (label == a) sum_a += arm, ++n_a;
            if (label == b) sum_b += arm, ++n_b;
        }
    if (n_a == 0 || n_b == 0) return {Vec2::Zero(), 0};  // they do not meet here: no line
    const Vec2 way = sum_b / n_b - sum_a / n_a;
    if (way.squaredNorm() < 1e-6 * R * R) return {Vec2::Zero(), 0};
    const double f = n_a / (n_a + n_b);
    double low = -1, high = 1;
    for (int i = 0; i < 40; ++i) {
        const double s = 0.5 * (low + high);
        (0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / std::numbers::pi < f ? low : high) = s;
    }
    const Vec2 normal = way.normalized();
    return {normal, normal.dot(x) + 0.5 * (low + high) * R};
}

}  // namespace

void paint(const MaterialMap& map, Mesh& mesh, std::span<const Index> fixed) {
    constexpr int n = 5;  // votes of the centroids of n^2 triangles of a fifth of its size
    std::vector<Index> label(mesh.triangles.size(), -1);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Vec2 a = mesh.corner(t, 0), along = (mesh.corner(t, 1) - a) / n, across = (mesh.corner(t, 2) - a) / n;
        std::map<Index, int> votes;
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j) {
                ++votes[map.at(a + (i + 1.0 / 3) * along + (j + 1.0 / 3) * across)];
                if (i + j + 1 < n) ++votes[map.at(a + (i + 2.0 / 3) * along + (j + 2.0 / 3) * across)];
            }
        label[t] = std::ranges::max_element(votes, {}, &std::pair<const Index, int>::second)->first;
    }
    if (map.smooth) {
        // an edge long, and some pixels: less sees steps of pixels, more sees other borders
        const Vec2 pixel = (map.high - map.low).cwiseQuotient(Vec2(map.width, map.height));
        const double R = std::max(mean_edge(mesh), 3 * pixel.maxCoeff());
        fit_borders(
            mesh, label, [&](Index a, Index b, const Vec2& x) { return border_in(map, a, b, x, R); }, fixed);
    }
    if (!map.grains) {
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            if (label[t] >= 0) mesh.region[t] = label[t];
        return;
    }
    std::vector<Index> material(map.patch.size(), -1);  // of patches
    for (std::size_t i = 0; i < map.patch.size(); ++i)
        if (map.patch[i] >= 0) material[map.patch[i]] = map.material[i];
    if (mesh.grain.empty()) mesh.grain.assign(mesh.triangles.size(), -1);
    const Index first = 1 + std::ranges::max(mesh.grain);
    std::map<Index, Index> number;  // of grains, without gaps
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        if (label[t] < 0) continue;
        const auto next = first + static_cast<Index>(number.size());
        mesh.grain[t] = number.try_emplace(label[t], next).first->second;
        mesh.region[t] = material[label[t]];
    }
}

}  // namespace knap
