#pragma once
// Which mass matrix a triangle has. Of order 1, with the mass m per corner (a third of the triangle's):
//     lumped        m delta_ij I
//     consistent    m (delta_ij + 1)/4 I     the exact integral of N_i N_j
//     one point     m/3 I                    N_i N_j at the centroid: singular, inertia of the centroid only, as in the
//                                            code published with CMAME 400 (2022) 115545
// Masses of order 2 (shape_functions.hpp): those of the quadrature, the exact integral, or all of it at the centre.

namespace knap {

enum class MassMatrix { lumped, consistent, one_point };

constexpr const char* name_of(MassMatrix mass) {
    return mass == MassMatrix::lumped ? "lumped" : mass == MassMatrix::consistent ? "consistent" : "one point";
}

}  // namespace knap
