#pragma once
// Internal forces of the bulk, one corner at a time, and the screen of the interfaces: linear_triangles.hpp or quadratic_triangles.hpp,
// as the order of the mesh says.
#include "bulk/linear_triangles.hpp"
#include "bulk/quadratic_triangles.hpp"

#include <variant>

namespace knap {

class ElasticForces {
public:
    ElasticForces(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness)
        : triangles_(mesh.order == 1 ? Triangles(LinearTriangles(mesh, materials, plane, thickness))
                                     : Triangles(QuadraticTriangles(mesh, materials, plane, thickness))) {}

    /// The screen: a fan needs no test while forces on its corners are no larger than stresses |sigma|_F^2 <= threshold can make them.
    /// [Pa^2] per fan.
    void set_screen(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner) {
        std::visit([&](auto& triangles) { triangles.set_screen(threshold_of_fan, fan_of_corner); }, triangles_);
    }

    /// corner_force [N], per corner; fan_is_hot [0/1], per fan, set where the screen does not clear the fan.
    void evaluate(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, std::vector<Vec2>& corner_force,
                  std::vector<std::uint8_t>& fan_is_hot) const {
        std::visit([&](const auto& triangles) { triangles.evaluate(displacement, node_of_corner, corner_force, fan_is_hot); }, triangles_);
    }

private:
    using Triangles = std::variant<LinearTriangles, QuadraticTriangles>;
    Triangles triangles_;
};

}  // namespace knap
