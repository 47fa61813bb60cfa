#pragma once
// Which scheme steps the bulk and which the cohesion: two independent choices, all four pairs are legal.
#include "element/mass_matrix.hpp"

namespace knap {

enum class BulkScheme { explicit_lumped, implicit_theta };
enum class CohesionScheme { explicit_beta, implicit_beta };

struct SchemeOptions {
    BulkScheme bulk = BulkScheme::explicit_lumped;
    CohesionScheme cohesion = CohesionScheme::explicit_beta;
    double theta = 0.5;                     // [-] in [1/2, 1/(1 + e)], of the implicit bulk and of the implicit cohesion
    MassMatrix mass = MassMatrix::lumped;   // another one: implicit bulk only
    bool respect_assumption_1 = true;       // reject steps beyond it; else go on with one of their solutions
};

}  // namespace knap
