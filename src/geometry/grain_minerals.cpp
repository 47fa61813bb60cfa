#include "geometry/grain_minerals.hpp"

#include "base/random.hpp"
#include "geometry/grain_report.hpp"

#include <algorithm>
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
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });

    Random random(seed, "minerals");
    std::vector<Index> of_grain(areas.size(), unchanged);
    for (const std::size_t grain : order) {
        double sum = 0;
        for (const double area : missing) sum += std::max(0.0, area);
        double lot = random.uniform() * sum;
        std::size_t drawn = static_cast<std::size_t>(std::max_element(missing.begin(), missing.end()) - missing.begin());
        for (std::size_t i = 0; i < missing.size(); ++i) {
            if (missing[i] <= 0) continue;
            if (lot < missing[i]) {
                drawn = i;
                break;
            }
            lot -= missing[i];
        }
        of_grain[grain] = regions[drawn];
        missing[drawn] -= areas[grain];
    }
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        if (const Index grain = mesh.grain[t] - first; mesh.grain[t] >= first && of_grain[grain] != unchanged) mesh.region[t] = of_grain[grain];
}

}  // namespace knap
