#pragma once
// The ground of contact from the supports of a model.
#include "model/model.hpp"

#include <vector>

namespace knap {

/// Every edge of a support, at its gap from the body, and its straight continuation where the support ends
/// (Interface::beyond). Edges that meet at a mesh vertex are one polyline. At its ends a side of the ground leads
/// straight away from the body: bodies beyond its end are not supported. Throws UserError where a continuation crosses
/// the body.
Ground make_ground(const Model& model);

/// The faces of the ground as fixed obstacles, which free ones meet: a polyline for every stretch of one law.
std::vector<Obstacle> obstacles_of_ground(const Model& model);

}  // namespace knap
