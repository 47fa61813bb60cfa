#include "geometry/mesh_order.hpp"

#include "geometry/polygon.hpp"

#include <algorithm>

namespace knap {

namespace {

/// Place of the cell (x, y) of a 2^16 x 2^16 grid on the Hilbert curve.
std::uint32_t hilbert_index(std::uint32_t x, std::uint32_t y) {
    std::uint32_t index = 0;
    for (std::uint32_t s = 1u << 15; s > 0; s >>= 1) {
        const bool right = x & s, up = y & s;
        index += s * s * ((3 * right) ^ up);
        // turn the quadrant so that the curve inside it has the standard orientation
        if (!up) {
            if (right) {
                x = ~x;
                y = ~y;
            }
            std::swap(x, y);
        }
    }
    return index;
}

}  // namespace

std::vector<Index> order_along_curve(Mesh& mesh) {
    const Box box = bounding_box(mesh.vertices);
    const double scale = 65535.0 / (box.high - box.low).maxCoeff();
    std::vector<std::pair<std::uint32_t, Index>> keys;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const Vec2 centroid = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
        const Vec2 cell = (centroid - box.low) * scale;
        keys.emplace_back(hilbert_index(static_cast<std::uint32_t>(cell.x()), static_cast<std::uint32_t>(cell.y())), t);
    }
    std::sort(keys.begin(), keys.end());

    Mesh ordered;
    std::vector<Index> number(mesh.vertices.size(), -1);
    for (const auto& [key, t] : keys) {
        std::array<Index, 3> corners = mesh.triangles[t];
        for (Index& v : corners) {
            if (number[v] < 0) {
                number[v] = ordered.n_vertices();
                ordered.vertices.push_back(mesh.vertices[v]);
            }
            v = number[v];
        }
        ordered.triangles.push_back(corners);
        if (!mesh.region.empty()) ordered.region.push_back(mesh.region[t]);
    }
    mesh.vertices = std::move(ordered.vertices);
    mesh.triangles = std::move(ordered.triangles);
    mesh.region = std::move(ordered.region);
    return number;
}

}  // namespace knap
