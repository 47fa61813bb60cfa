#pragma once
// A model that replaces another one during a run, and the way of a state from the one to the other.
#include "mesh/refine.hpp"
#include "model/state.hpp"

#include <span>

namespace knap {

/// The model without some triangles, which vanish with their masses, loads, supports and interfaces (Model::vanished).
/// Triangles, corners and points keep their numbers; fans and nodes get new ones. The new faces of the rest are edges
/// of the mesh boundary, without a name and without loads.
Model without(Model model, std::span<const Index> triangles);

/// The same motion, cohesion and contacts of all corners and points that `to` still has. Scalars are copied.
State carried_over(const Model& from, const State& state, const Model& to);

/// On a refined mesh: what came apart has not changed there, and new vertices, which are bonded, get linear means, also
/// of temperatures that conduction has led there. Without contacts between free faces.
State carried_over(const Model& from, const State& state, const Model& to, const RefinedMesh& refined);

}  // namespace knap
