#pragma once
// Thermal strains e A (A = I without layers: Elastic::expansion_in_plane) in linear triangles: sigma = D (eps - e A) =
// D eps - p P with the thermal pressure p = 2 (lambda + mu) e and P = D A/(2 (lambda + mu)), I without layers. They add
// the forces  V p P grad l_k  to those of ElasticForces (order 2: the mean of that over the middles of the edges, with
// middle_gradients), and these forces are constant while the temperature is.
//
// With large rotations (of order 1): S = D (E - e A), forces V p F P grad l_k, which turn with the body.
//
// Strains are given as in Temperatures: one per triangle, or three at the middles of its edges for order 2.
#include "element/elastic_of.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace knap {

class ThermalStress {
public:
    ThermalStress(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness,
                  bool large_rotation = false);
    /// As in ElasticForces, which must not have one of its own: there only D eps is known.
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner);

    /// Adds `factor` times the forces [N] of a strain to those on all corners; of small rotations.
    void add_forces(std::span<const double> strain, double factor, std::vector<Vec2>& force) const;

    /// [J] Integral of sigma : other A, with the stress sigma (large rotations: S) at `displacement` and `strain`, over
    /// the triangles from `first` to before `last`.
    double product(Index first, Index last, const std::vector<Vec2>& displacement,
                   const std::vector<Index>& node_of_corner, std::span<const double> strain,
                   std::span<const double> other) const;
    double product(const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                   std::span<const double> strain, std::span<const double> other) const {
        return product(0, n_triangles(), displacement, node_of_corner, strain, other);
    }

    /// [J] What the strain adds to the elastic energy: the integral of 1/2 (eps - e A) : D (eps - e A) - 1/2 eps : D
    /// eps.
    double energy(Index first, Index last, const std::vector<Vec2>& displacement,
                  const std::vector<Index>& node_of_corner, std::span<const double> strain) const;

    /// The same forces for the triangles from `first` to before `last`, added to the elastic ones [N] on their
    /// corners, and the stress criterion of the sum (as ElasticForces::evaluate). Returns the product with `other`.
    double evaluate(Index first, Index last, const std::vector<Vec2>& displacement,
                    const std::vector<Index>& node_of_corner, std::span<const double> strain,
                    std::span<const double> other, Vec2* force, std::vector<std::uint8_t>& fan_is_candidate) const;

private:
    struct Triangle {
        Vec2 edge1, edge2;     // [m] from vertex 0
        double half_pressure;  // [N/m] (lambda + mu) times the thickness: p t/2 of a unit strain
        double threshold;      // [N2 m2] of |V sigma|^2; order 1
        double volume;         // [m3]
    };
    Index n_triangles() const { return static_cast<Index>(triangles_.size()); }
    Index n_corners() const { return order_ == 1 ? 3 : 7; }
    Index n_strains() const { return order_ == 1 ? 1 : 3; }
    template <class Add>
    void for_each_weight(Index triangle, const Add& add) const;
    void add_forces_of(Index triangle, std::span<const double> strain, double factor, Vec2* force) const;
    double product_of(Index triangle, const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner,
                      std::span<const double> strain, std::span<const double> other) const;

    /// Gradient of the displacement.
    Eigen::Matrix2d gradient(Index triangle, const std::vector<Vec2>& displacement,
                             const std::vector<Index>& node_of_corner) const;

    struct Directions {
        Eigen::Matrix2d strain, stress;  // [-] A, P
        double product;                  // [-] A : P
    };
    const Directions& directions(Index triangle) const { return directions_[kind_[triangle]]; }

    const Mesh& mesh_;
    std::vector<Directions> directions_;  // per kind (elastic_of.hpp)
    std::vector<Index> kind_;             // per triangle
    Index order_;
    bool large_rotation_;
    std::vector<Triangle> triangles_;
    std::vector<double> threshold_of_fan_;  // [Pa2]
    std::vector<Index> fan_of_corner_;
};

}  // namespace knap
