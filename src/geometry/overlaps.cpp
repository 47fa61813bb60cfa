// Where two sheets of a mesh lie over each other, the region that they cover twice ends at edges of the boundary, and the triangle of such an edge is in that
// region: so it is enough to compare the triangles with an edge on the boundary with all others. Candidates are found by cutting the body in two until few are left: at
// the median along an axis; where that goes through too many, as through slivers that lie askew side by side, along the longest edge of one of them. Triangles
// that do not overlap cross no such line but where it leaves its triangle, so few are in both parts (M. S. Paterson and F. F. Yao 1990).
#include "geometry/overlaps.hpp"

#include <algorithm>
#include <limits>

namespace knap {
namespace {

constexpr double deepest = 0.1;      // of the height of the smaller triangle
constexpr std::size_t n_tries = 16;  // of edges to cut along

class OverlapSearch {
public:
    explicit OverlapSearch(const Mesh& mesh) : mesh_(mesh), at_boundary_(mesh.triangles.size(), false) {
        for (const BoundaryEdge& edge : mesh.boundary_edges) at_boundary_[edge.triangle] = true;
    }

    std::optional<std::array<Index, 2>> among(const std::vector<Index>& triangles) const {
        if (std::none_of(triangles.begin(), triangles.end(), [&](Index t) { return at_boundary_[t]; })) return std::nullopt;
        if (triangles.size() <= 16) return in_pairs(triangles);
        for (const int axis : {wider_axis(triangles), 1 - wider_axis(triangles)})
            if (const Halves half = at_median(triangles, axis); is_worth_it(half, triangles)) return in_halves(half);
        for (std::size_t i = 0; i < n_tries; ++i)
            if (const Halves half = along_edge(triangles, triangles[(2 * i + 1) * triangles.size() / (2 * n_tries)]); is_worth_it(half, triangles)) return in_halves(half);
        return in_pairs(triangles);
    }

private:
    double low(Index t, int axis) const { return std::min({mesh_.corner(t, 0)[axis], mesh_.corner(t, 1)[axis], mesh_.corner(t, 2)[axis]}); }
    double high(Index t, int axis) const { return std::max({mesh_.corner(t, 0)[axis], mesh_.corner(t, 1)[axis], mesh_.corner(t, 2)[axis]}); }

    int wider_axis(const std::vector<Index>& triangles) const {
        Vec2 from = mesh_.corner(triangles[0], 0), to = from;
        for (const Index t : triangles) from = from.cwiseMin(mesh_.corner(t, 0)), to = to.cwiseMax(mesh_.corner(t, 0));
        return to.x() - from.x() >= to.y() - from.y() ? 0 : 1;
    }

    /// What the cut goes through is in both.
    using Halves = std::array<std::vector<Index>, 2>;

    Halves at_median(const std::vector<Index>& triangles, int axis) const {
        std::vector<double> place;
        for (const Index t : triangles) place.push_back(mesh_.corner(t, 0)[axis]);
        std::nth_element(place.begin(), place.begin() + static_cast<std::ptrdiff_t>(place.size() / 2), place.end());
        const double cut = place[place.size() / 2];
        Halves half;
        for (const Index t : triangles) {
            if (low(t, axis) <= cut) half[0].push_back(t);
            if (high(t, axis) > cut) half[1].push_back(t);
        }
        return half;
    }

    /// What only touches the line is on one side of it.
    Halves along_edge(const std::vector<Index>& triangles, Index of) const {
        const auto edge = [&](Index k) { return Vec2(mesh_.corner(of, (k + 1) % 3) - mesh_.corner(of, k)); };
        const Index longest = std::max({0, 1, 2}, [&](Index a, Index b) { return edge(a).squaredNorm() < edge(b).squaredNorm(); });
        const Vec2 from = mesh_.corner(of, longest), along = edge(longest);
        Halves half;
        for (const Index t : triangles) {
            const auto aside = [&](Index k) { return cross(along, mesh_.corner(t, k) - from); };
            const auto [right, left] = std::minmax({aside(0), aside(1), aside(2)});
            if (left > 0) half[0].push_back(t);
            if (right < 0) half[1].push_back(t);
        }
        return half;
    }

    /// Else cutting on would cost more than all pairs.
    static bool is_worth_it(const Halves& half, const std::vector<Index>& triangles) {
        const auto n = static_cast<double>(triangles.size()), below = static_cast<double>(half[0].size()), above = static_cast<double>(half[1].size());
        return std::max(below, above) <= 0.9 * n && below + above <= 1.4 * n;
    }

    std::optional<std::array<Index, 2>> in_halves(const Halves& half) const {
        const auto found = among(half[0]);
        return found ? found : among(half[1]);
    }

    std::optional<std::array<Index, 2>> in_pairs(const std::vector<Index>& triangles) const {
        for (const Index a : triangles)
            for (const Index b : triangles)
                if (at_boundary_[a] && a != b && overlap(a, b)) return std::array{a, b};
        return std::nullopt;
    }

    bool overlap(Index a, Index b) const {
        for (int axis = 0; axis < 2; ++axis)
            if (low(a, axis) >= high(b, axis) || low(b, axis) >= high(a, axis)) return false;
        const double depth = std::min(depth_behind_edges(a, b), depth_behind_edges(b, a));
        return depth > deepest * std::min(height(a), height(b));
    }

    /// [m] How far b reaches behind the edge of a that it reaches behind the least; convex bodies are apart where that is nothing for an edge of either.
    double depth_behind_edges(Index a, Index b) const {
        double least = std::numeric_limits<double>::infinity();
        for (Index k = 0; k < 3; ++k) {
            const Vec2 from = mesh_.corner(a, k), along = (mesh_.corner(a, (k + 1) % 3) - from).normalized();
            double reach = 0;
            for (Index j = 0; j < 3; ++j) reach = std::max(reach, cross(along, mesh_.corner(b, j) - from));
            least = std::min(least, reach);
        }
        return least;
    }

    /// [m] The smallest.
    double height(Index t) const {
        double longest = 0;
        for (Index k = 0; k < 3; ++k) longest = std::max(longest, (mesh_.corner(t, (k + 1) % 3) - mesh_.corner(t, k)).norm());
        return 2 * mesh_.area(t) / longest;
    }

    const Mesh& mesh_;
    std::vector<bool> at_boundary_;
};

}  // namespace

std::optional<std::array<Index, 2>> find_overlap(const Mesh& mesh) {
    std::vector<Index> all(mesh.triangles.size());
    for (Index t = 0; t < mesh.n_triangles(); ++t) all[t] = t;
    return OverlapSearch(mesh).among(all);
}

}  // namespace knap
