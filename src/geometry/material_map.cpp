#include "geometry/material_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace knap {

Index MaterialMap::at(const Vec2& x) const {
    const Vec2 part = (x - low).cwiseQuotient(high - low);
    if (!(part.minCoeff() >= 0 && part.maxCoeff() <= 1)) return -1;
    const int column = std::min(width - 1, static_cast<int>(part.x() * width)), row = std::min(height - 1, static_cast<int>((1 - part.y()) * height));
    return material[static_cast<std::size_t>(row) * width + column];
}

void paint(const MaterialMap& map, Mesh& mesh) {
    constexpr int n = 5;  // n^2 triangles of a fifth of its size; their centroids
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Vec2 a = mesh.corner(t, 0), along = (mesh.corner(t, 1) - a) / n, across = (mesh.corner(t, 2) - a) / n;
        std::map<Index, int> votes;
        for (int i = 0; i < n; ++i)
            for (int j = 0; i + j < n; ++j) {
                ++votes[map.at(a + (i + 1.0 / 3) * along + (j + 1.0 / 3) * across)];
                if (i + j + 1 < n) ++votes[map.at(a + (i + 2.0 / 3) * along + (j + 2.0 / 3) * across)];
            }
        const auto most = std::max_element(votes.begin(), votes.end(), [](const auto& v, const auto& w) { return v.second < w.second; });
        if (most->first >= 0) mesh.region[t] = most->first;
    }
}

}  // namespace knap
