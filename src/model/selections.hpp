#pragma once
// What a selection of a scenario (a boundary, a box, a boundary inside a box) takes hold of on a mesh.
#include "model/model.hpp"

#include <cstddef>
#include <vector>

namespace knap {

/// Indices of the boundary edges whose middle is selected.
std::vector<std::size_t> selected_edges(const Mesh& mesh, const Selection& on);

/// Per corner, whether it is an end of a selected edge or lies in the box.
std::vector<char> selected_corners(const Mesh& mesh, const Selection& on);

/// Per corner, whether a load that prescribes motion holds it: the selected ones, and round each vertex those that are bonded to them.
std::vector<char> held_corners(const Model& model, const Selection& on);

}  // namespace knap
