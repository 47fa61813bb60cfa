#pragma once
// The edges of the body that meet obstacles: sides of triangles, of second order in two halves. A side leads from a to
// b, with its triangle to the left.
#include "model/model.hpp"

namespace knap {

/// Calls visit(a, b) with the corners at the ends.
void visit_side(const Mesh& mesh, Index triangle, Index side, const auto& visit) {
    const Index first = mesh.corners_per_triangle() * triangle, a = first + side, b = first + (side + 1) % 3;
    if (mesh.order == 1) return visit(a, b);
    const Index middle = first + 3 + side;
    visit(a, middle), visit(middle, b);
}

/// Calls visit(triangle, side) for both sides of an interface between triangles.
void visit_faces(const Mesh& mesh, const Interface& interface, const auto& visit) {
    for (const Index t : interface.triangle)
        for (Index k = 0; k < 3; ++k)
            if (edge_key(mesh.side_vertices(t, k)) == edge_key(interface.vertex)) visit(t, k);
}

}  // namespace knap
