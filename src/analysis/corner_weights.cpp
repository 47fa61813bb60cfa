#include "analysis/corner_weights.hpp"

#include "element/quadratic_triangles.hpp"
#include "model/state.hpp"

namespace knap {
namespace {

/// Barycentric coordinates of a place in a triangle.
Eigen::Vector3d barycentric(const Mesh& mesh, Index t, const Vec2& place) {
    const Vec2 a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a, ap = place - a;
    const double area = cross(ab, ac), b = cross(ap, ac) / area, c = cross(ab, ap) / area;
    return {1 - b - c, b, c};
}

/// Of corner k at barycentric coordinates l.
double shape_function(Index order, Index k, const Eigen::Vector3d& l) {
    if (order == 1) return l[k];
    const double bubble = 27 * l[0] * l[1] * l[2];
    const double quadratic = k < 3 ? l[k] * (2 * l[k] - 1) : k < 6 ? 4 * l[k - 3] * l[(k - 2) % 3] : 0;
    return quadratic + bubble_weight[k] * bubble;
}

Index nearest_vertex(const Mesh& mesh, const Vec2& place) {
    Index nearest = 0;
    for (std::size_t v = 1; v < mesh.vertices.size(); ++v)
        if ((mesh.vertices[v] - place).squaredNorm() < (mesh.vertices[nearest] - place).squaredNorm()) nearest = static_cast<Index>(v);
    return nearest;
}

/// sum of part * value(corner)
template <class Value>
Vec2 mean(const std::vector<CornerWeight>& weights, Value value) {
    Vec2 sum = Vec2::Zero();
    for (const CornerWeight& weight : weights) sum += weight.part * value(weight.corner);
    return sum;
}

}  // namespace

std::vector<CornerWeight> weights_at(const Mesh& mesh, const Vec2& place) {
    int n_triangles = 0;
    const auto found_at = [&](const Vec2& point) {
        std::vector<CornerWeight> weights;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const Eigen::Vector3d parts = barycentric(mesh, t, point);
            if (parts.minCoeff() < -1e-9) continue;
            ++n_triangles;
            for (Index k = 0; k < mesh.corners_per_triangle(); ++k)
                weights.push_back({mesh.corners_per_triangle() * t + k, shape_function(mesh.order, k, parts)});
        }
        return weights;
    };
    std::vector<CornerWeight> weights = found_at(place);
    if (weights.empty()) weights = found_at(mesh.vertices[nearest_vertex(mesh, place)]);
    for (CornerWeight& weight : weights) weight.part /= n_triangles;
    return weights;
}

std::vector<CornerWeight> weights_along(const Mesh& mesh, const std::string& boundary) {
    std::vector<CornerWeight> weights;
    double length = 0;
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        if (mesh.boundary_names[edge.boundary] != boundary) continue;
        const Index first = mesh.corners_per_triangle() * edge.triangle, a = edge.side, b = (edge.side + 1) % 3;
        const double l = (mesh.corner(edge.triangle, b) - mesh.corner(edge.triangle, a)).norm();
        length += l;
        // the trapezoidal rule, of second order Simpson's: exact for the displacement on the edge
        const double at_ends = mesh.order == 1 ? 0.5 : 1. / 6;
        for (const Index k : {a, b}) weights.push_back({first + k, at_ends * l});
        if (mesh.order == 2) weights.push_back({first + 3 + edge.side, 4. / 6 * l});
    }
    for (CornerWeight& weight : weights) weight.part /= length;
    return weights;
}

Vec2 mean_place(const std::vector<CornerWeight>& weights, const Mesh& mesh) {
    return mean(weights, [&](Index corner) -> Vec2 { return mesh.corner(corner); });
}

Vec2 mean_displacement(const std::vector<CornerWeight>& weights, const State& state) {
    return mean(weights, [&](Index corner) -> Vec2 { return state.displacement[state.node_of_corner[corner]]; });
}

Vec2 mean_velocity(const std::vector<CornerWeight>& weights, const State& state) {
    return mean(weights, [&](Index corner) -> Vec2 { return state.velocity[state.node_of_corner[corner]]; });
}

}  // namespace knap
