#include "geometry/mesh.hpp"

#include "geometry/shape.hpp"

#include <algorithm>
#include <compare>
#include <span>

namespace knap {

namespace {

/// Side k of a triangle, with the larger of its vertices.
struct Side {
    Index upper, triangle, k;
    auto operator<=>(const Side&) const = default;
};

/// Sides of triangles, listed under the smaller vertex of each (counting sort) and there by the larger: a vertex may have thousands of edges.
struct SidesByVertex {
    std::vector<Index> begin;  // per vertex, and one more
    std::vector<Side> sides;

    explicit SidesByVertex(const Mesh& mesh) : begin(mesh.vertices.size() + 1, 0), sides(3 * mesh.triangles.size()) {
        for_each(mesh, [&](Index lower, const Side&) { ++begin[lower + 1]; });
        for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
        std::vector<Index> next(begin.begin(), begin.end() - 1);
        for_each(mesh, [&](Index lower, const Side& side) { sides[next[lower]++] = side; });
        for (std::size_t v = 0; v + 1 < begin.size(); ++v) std::sort(sides.begin() + begin[v], sides.begin() + begin[v + 1]);
    }

    /// In the order of the triangles.
    std::span<const Side> between(Index a, Index b) const {
        const auto [lower, upper] = std::minmax(a, b);
        const auto of_this = [upper = upper](const Side& side) { return side.upper == upper; };
        const auto end = sides.begin() + begin[lower + 1];
        const auto first = std::partition_point(sides.begin() + begin[lower], end, [upper = upper](const Side& side) { return side.upper < upper; });
        return {first, std::find_if_not(first, end, of_this)};
    }

    template <class Visit>
    static void for_each(const Mesh& mesh, Visit visit) {
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            for (Index k = 0; k < 3; ++k) {
                const auto [lower, upper] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
                visit(lower, Side{upper, t, k});
            }
    }
};

}  // namespace

void find_edges(Mesh& mesh) {
    mesh.interior_edges.clear();
    mesh.boundary_edges.clear();
    const SidesByVertex by_vertex(mesh);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (Index k = 0; k < 3; ++k) {
            const Index a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            Index other = -1, other_side = -1;
            for (const Side& side : by_vertex.between(a, b)) {
                if (side.triangle == t && side.k == k) continue;
                if (mesh.triangles[side.triangle][side.k] == a) throw ShapeError("mesh", "two triangles lie on the same side of one edge");
                other = side.triangle;
                other_side = side.k;
            }
            if (other < 0) mesh.boundary_edges.push_back({t, k, 0});
            if (other > t) mesh.interior_edges.push_back({{t, other}, {k, other_side}, false});
        }
}

}  // namespace knap
