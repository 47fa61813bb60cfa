#pragma once
// Internal forces of the bulk on the corners of its triangles, and the stress criterion of the interfaces.
#include "element/bulk_viscosity.hpp"
#include "element/constant_strain.hpp"
#include "element/elastic_of.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

namespace knap {

/// Constant strain in a triangle (constant_strain.hpp).
class ConstantStrainTriangles {
public:
    ConstantStrainTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness,
                            StrainMeasure measure)
        : ConstantStrainTriangles(mesh, materials, ElasticKinds(mesh, materials), plane, thickness, measure) {}
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner);
    double evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                    const std::vector<Index>& node_of_corner, Vec2* force, std::vector<std::uint8_t>& fan_is_candidate,
                    ViscousStep* viscous) const;

private:
    ConstantStrainTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, const ElasticKinds& kinds,
                            PlaneModel plane, double thickness, StrainMeasure measure);

    std::vector<LameConstants> stiffness_;  // per kind (elastic_of.hpp)
    std::vector<LayerStiffness> layers_;    // per kind; empty: all are isotropic
    ConstantStrainForces forces_, viscous_forces_;
    std::vector<ConstantStrainTriangle> triangles_;
    ViscousCoefficients viscosity_;
    std::vector<double> threshold_of_fan_;
    std::vector<Index> fan_of_corner_;
};

/// Order 2: three stresses at the middles of the edges and the stiffness R of the bubble (shape_functions.hpp).
class QuadraticTriangles {
public:
    QuadraticTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness);
    /// Compares the force on each corner with the largest force of a uniform stress at the threshold.
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner);
    double evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                    const std::vector<Index>& node_of_corner, Vec2* force, std::vector<std::uint8_t>& fan_is_candidate,
                    ViscousStep* viscous) const;

private:
    struct Triangle {
        Vec2 gradient1, gradient2;  // [1/m] of l_1 and l_2; that of l_0 is minus their sum
        double volume;              // [m3]
        double R_xx, R_yy, R_xy;    // [N/m]
        Index kind;
    };
    Eigen::Vector3d viscous_stress(Index t, Index k, const Index* node, const std::array<Vec2, 3>& g,
                                   const Eigen::Vector3d& strain, ViscousStep& viscous) const;

    std::vector<Triangle> triangles_;
    std::vector<LameConstants> stiffness_;                // per kind
    std::vector<std::optional<Eigen::Matrix3d>> layers_;  // per kind
    ViscousCoefficients viscosity_;
    std::vector<std::array<float, 6>> limit2_;  // [N^2] per triangle: squared threshold of the forces on corners 0 to 5
    std::vector<Index> fan_of_corner_;
};

class ElasticForces {
public:
    /// Large rotations: Green's strain, of order 1 only.
    ElasticForces(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness,
                  bool large_rotation = false);

    /// Fans need no further test while the forces on their corners do not exceed those that stresses with
    /// |sigma|_F^2 <= threshold cause. [Pa^2] per fan.
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner);

    /// Force [N] on the corners of the triangles from `first` to before `last`. Sets fan_is_candidate [0/1], per
    /// fan, where the stress criterion is exceeded; several threads may do so at once. Returns the elastic energy U
    /// [J] with large rotations, else zero: there it is 1/2 u' K u. With `viscous` artificial viscosity acts too.
    double evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                    const std::vector<Index>& node_of_corner, Vec2* force, std::vector<std::uint8_t>& fan_is_candidate,
                    ViscousStep* viscous = nullptr) const {
        return std::visit(
            [&](const auto& triangles) {
                return triangles.evaluate(first, last, displacement, node_of_corner, force, fan_is_candidate, viscous);
            },
            triangles_);
    }
    /// All triangles, in parallel: corner_force [N], per corner.
    void evaluate(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                  std::vector<Vec2>& corner_force, std::vector<std::uint8_t>& fan_is_candidate) const;

private:
    std::variant<ConstantStrainTriangles, QuadraticTriangles> triangles_;
    Index n_triangles_, corners_per_triangle_;
};

}  // namespace knap
