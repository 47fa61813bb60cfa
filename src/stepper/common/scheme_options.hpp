#pragma once
// The schemes of the bulk and of the cohesion: two independent choices, all four pairs are allowed. Apart from
// step_scheme.hpp because reading a scenario needs no model.
#include "element/mass_matrix.hpp"
#include "model/loads.hpp"

namespace knap {

enum class BulkScheme { explicit_lumped, implicit_theta };
enum class CohesionScheme { explicit_beta, implicit_beta };

struct SchemeOptions {
    BulkScheme bulk = BulkScheme::explicit_lumped;
    CohesionScheme cohesion = CohesionScheme::explicit_beta;
    double theta = 0.5;                    // [-] in [1/2, 1/(1 + e)], of the implicit bulk and of the implicit cohesion
    MassMatrix mass = MassMatrix::lumped;  // of the implicit bulk
    double damping = 0;                    // [1/s] alpha of the forces -alpha M v, of the explicit bulk
    std::vector<Selection> absorbing;      // boundaries that let waves out, of the explicit bulk
    bool respect_assumption_1 = true;      // reject steps with several solutions; false: continue with one of them
};

}  // namespace knap
