#include "geometry/mesh.hpp"

#include "geometry/shape.hpp"

namespace knap {

namespace {

/// Sides of triangles, listed under the smaller vertex of each (counting sort).
struct SidesByVertex {
    std::vector<Index> begin;                            // per vertex, and one more
    std::vector<std::pair<Index, Index>> triangle_side;  // in the order of the triangles

    explicit SidesByVertex(const Mesh& mesh) : begin(mesh.vertices.size() + 1, 0), triangle_side(3 * mesh.triangles.size()) {
        for_each(mesh, [&](Index lower, Index, Index) { ++begin[lower + 1]; });
        for (std::size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
        std::vector<Index> next(begin.begin(), begin.end() - 1);
        for_each(mesh, [&](Index lower, Index t, Index k) { triangle_side[next[lower]++] = {t, k}; });
    }

    template <class Visit>
    static void for_each(const Mesh& mesh, Visit visit) {
        for (Index t = 0; t < mesh.n_triangles(); ++t)
            for (Index k = 0; k < 3; ++k) visit(std::min(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]), t, k);
    }
};

}  // namespace

void find_edges(Mesh& mesh) {
    mesh.interior_edges.clear();
    mesh.boundary_edges.clear();
    const SidesByVertex sides(mesh);
    for (Index t = 0; t < mesh.n_triangles(); ++t)
        for (Index k = 0; k < 3; ++k) {
            const Index a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            Index other = -1, other_side = -1;
            for (Index i = sides.begin[std::min(a, b)]; i < sides.begin[std::min(a, b) + 1]; ++i) {
                const auto [s, m] = sides.triangle_side[i];
                const Index c = mesh.triangles[s][m], d = mesh.triangles[s][(m + 1) % 3];
                if (s == t && m == k) continue;
                if (c == a && d == b) throw ShapeError("mesh", "two triangles lie on the same side of one edge");
                if (c == b && d == a) {
                    other = s;
                    other_side = m;
                }
            }
            if (other < 0) mesh.boundary_edges.push_back({t, k, 0});
            if (other > t) mesh.interior_edges.push_back({{t, other}, {k, other_side}, false});
        }
}

}  // namespace knap
