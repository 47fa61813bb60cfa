#pragma once
// Internal forces of constant-strain triangles, one corner at a time, and the stress criterion of the interfaces.
//     strain = sum_k sym(grad N_k (x) u_k),   sigma = D strain,   f_k = -V sigma grad N_k   (force on the corner), sum_k f_k = 0
#include "material/elastic.hpp"
#include "mesh/mesh.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace knap {

class LinearTriangles {
public:
    LinearTriangles(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane, double thickness);

    /// The stress criterion: fans whose triangles all have |sigma|_F^2 <= threshold need no test. [Pa^2] per fan.
    void set_stress_criterion(const std::vector<double>& threshold_of_fan, const std::vector<Index>& fan_of_corner);

    /// Of the triangles from `first` to before `last`, as in ElasticForces.
    void evaluate(Index first, Index last, const std::vector<Vec2>& displacement, const std::vector<Index>& node_of_corner, Vec2* force,
                  std::vector<std::uint8_t>& fan_is_candidate) const;

private:
    struct Triangle {
        Vec2 gradient1, gradient2;     // [1/m] of the shape functions of corners 1 and 2; corner 0 has minus their sum
        double volume;                 // [m3]
        float threshold;               // [Pa^2] smallest of the three fans', rounded down
        Index material;
    };
    static_assert(sizeof(Triangle) == 48);  // on large meshes memory sets the pace
    struct Stiffness {
        double lame, twice_shear;  // [Pa] lambda of the plane law, 2 mu
    };
    std::vector<Triangle> triangles_;
    std::vector<Stiffness> stiffness_;  // per material
    std::vector<double> threshold_of_fan_;
    std::vector<Index> fan_of_corner_;
};

}  // namespace knap
