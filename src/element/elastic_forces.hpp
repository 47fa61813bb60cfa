#pragma once
// Internal forces of the bulk, one corner at a time, and the stress criterion of the interfaces: linear_triangles.hpp or quadratic_triangles.hpp,
// as the order of the mesh says.
#include "element/linear_triangles.hpp"
#include "element/quadratic_triangles.hpp"

#include <algorithm>
#include <variant>

namespace knap {

class ElasticForces {
public:
    ElasticForces(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness)
        : triangles_(mesh.order == 1 ? Triangles(LinearTriangles(mesh, materials, plane, thickness))
                                     : Triangles(QuadraticTriangles(mesh, materials, plane, thickness))),
          n_triangles_(mesh.n_triangles()),
          corners_per_triangle_(mesh.corners_per_triangle()) {}

    /// The stress criterion: a fan needs no test while forces on its corners are no larger than stresses |sigma|_F^2 <= threshold can make them.
    /// [Pa^2] per fan.
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner) {
        std::visit([&](auto& triangles) { triangles.set_stress_criterion(threshold_of_fan, fan_of_corner); }, triangles_);
    }

    /// Of the triangles from `first` to before `last`: force [N] on their corners; fan_is_candidate [0/1], per fan, is set where the stress criterion does not clear
    /// the fan (from several threads at once).
    void evaluate(Index first, Index last, const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, Vec2* force,
                  std::vector<std::uint8_t>& fan_is_candidate) const {
        std::visit([&](const auto& triangles) { triangles.evaluate(first, last, displacement, node_of_corner, force, fan_is_candidate); }, triangles_);
    }

    /// Of all triangles: corner_force [N], per corner.
    void evaluate(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, std::vector<Vec2>& corner_force,
                  std::vector<std::uint8_t>& fan_is_candidate) const {
        constexpr Index block = 1024;
#pragma omp parallel for schedule(static) if (n_triangles_ > block)
        for (Index first = 0; first < n_triangles_; first += block)
            evaluate(first, std::min(first + block, n_triangles_), displacement, node_of_corner, &corner_force[corners_per_triangle_ * first], fan_is_candidate);
    }

private:
    using Triangles = std::variant<LinearTriangles, QuadraticTriangles>;
    Triangles triangles_;
    Index n_triangles_, corners_per_triangle_;
};

}  // namespace knap
