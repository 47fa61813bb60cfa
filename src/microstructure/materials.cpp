#include "microstructure/materials.hpp"

#include "base/random.hpp"
#include "microstructure/grain_mesh.hpp"

#include <map>
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

Index MaterialMap::at(const Vec2& x) const {
    const Vec2 part = (x - low).cwiseQuotient(high - low);
    if (!(part.minCoeff() >= 0 && part.maxCoeff() <= 1)) return -1;
    const int column = std::min(width - 1, static_cast<int>(part.x() * width));
    const int row = std::min(height - 1, static_cast<int>((1 - part.y()) * height));
    return material[static_cast<std::size_t>(row) * width + column];
}

void paint(const MaterialMap& map, Mesh& mesh) {
    constexpr int n = 5;  // votes of the centroids of n^2 triangles of a fifth of its size
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Vec2 a = mesh.corner(t, 0), along = (mesh.corner(t, 1) - a) / n, across = (mesh.corner(t, 2) - a) / n;
        std::map<Index, int> votes;
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j) {
                ++votes[map.at(a + (i + 1.0 / 3) * along + (j + 1.0 / 3) * across)];
                if (i + j + 1 < n) ++votes[map.at(a + (i + 2.0 / 3) * along + (j + 2.0 / 3) * across)];
            }
        const Index material = std::ranges::max_element(votes, {}, &std::pair<const Index, int>::second)->first;
        if (material >= 0) mesh.region[t] = material;
    }
}

}  // namespace knap
