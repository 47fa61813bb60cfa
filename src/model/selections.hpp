#pragma once
// The edges, corners and triangles of a mesh that a selection of the scenario contains.
#include "model/model.hpp"

#include <cstddef>
#include <vector>

namespace knap {

/// Indices of the boundary edges of the boundary (or all) of the body whose middle is in the box.
std::vector<std::size_t> selected_edges(const Mesh& mesh, const Selection& on);

/// Per corner: it belongs to a selected edge, or (without a boundary name) to the body and lies in the box.
std::vector<char> selected_corners(const Mesh& mesh, const Selection& on);

/// Triangles of the body whose centroid is in the box.
std::vector<Index> selected_triangles(const Mesh& mesh, const Selection& on);

/// x lies in a triangle, or beyond its edges by no more than rounding.
bool in_triangle(const Mesh& mesh, Index t, const Vec2& x);

/// Per corner, the effect of a prescribed motion: the selected corners and, round each vertex, those bonded to them.
std::vector<char> held_corners(const Model& model, const Selection& on);

}  // namespace knap
