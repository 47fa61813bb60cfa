#pragma once
// The mass matrix of a triangle of first order whose corners have the mass m each (a third of the triangle's): M_ij = m (own delta_ij + shared) I.
// Of second order (triangle_matrices.hpp): the masses of corner_share, the exact integral, or all of it at the centre.
//
//     lumped        own 1,    shared 0
//     consistent    own 1/4,  shared 1/4    the exact integral of N_i N_j
//     one point     own 0,    shared 1/3    N_i N_j at the centroid alone; singular, as a triangle has inertia only where its centroid moves
//
// The last is what the code published with CMAME 400 (2022) 115545 takes for triangles.

namespace knap {

enum class MassMatrix { lumped, consistent, one_point };

struct MassShares {
    double own, shared;
};

constexpr MassShares shares_of(MassMatrix mass) {
    switch (mass) {
        case MassMatrix::consistent: return {.own = 0.25, .shared = 0.25};
        case MassMatrix::one_point: return {.own = 0, .shared = 1.0 / 3};
        case MassMatrix::lumped: break;
    }
    return {.own = 1, .shared = 0};
}

constexpr const char* name_of(MassMatrix mass) {
    return mass == MassMatrix::lumped ? "lumped" : mass == MassMatrix::consistent ? "consistent" : "one point";
}

}  // namespace knap
