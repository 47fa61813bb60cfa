#pragma once
// Means of the displacement at a place, or along a boundary, as sums over corners.
#include "mesh/mesh.hpp"

#include <string>
#include <vector>

namespace knap {

struct State;

struct CornerWeight {
    Index corner;
    double part;  // all of a mean add up to 1
};

/// As the displacement is in the triangle that the place lies in, so that it stays the same place on every mesh; the mean of all of them on an
/// edge or at a vertex. Outside of the body the nearest vertex.
std::vector<CornerWeight> weights_at(const Mesh& mesh, const Vec2& place);

/// The mean along the length of a boundary; empty where the mesh has none of this name.
std::vector<CornerWeight> weights_along(const Mesh& mesh, const std::string& boundary);

Vec2 mean_place(const std::vector<CornerWeight>& weights, const Mesh& mesh);                   // [m] reference
Vec2 mean_displacement(const std::vector<CornerWeight>& weights, const State& state);          // [m]
Vec2 mean_velocity(const std::vector<CornerWeight>& weights, const State& state);              // [m/s]

}  // namespace knap
