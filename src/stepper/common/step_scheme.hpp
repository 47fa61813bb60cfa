#pragma once
// The schemes of the bulk and of the cohesion, two independent choices of which all four pairs are allowed, and the
// interface between the stepper and a scheme.
#include "element/mass_matrix.hpp"
#include "model/state.hpp"
#include "stepper/common/step_report.hpp"

namespace knap {

/// Automatic: a run changes between the two (stepper/scheme_change.hpp), each with its cohesion of second order:
/// explicit bulk and beta, implicit bulk and beta.
enum class BulkScheme { explicit_lumped, implicit_theta, automatic };
constexpr const char* name_of(BulkScheme bulk) {
    return bulk == BulkScheme::automatic ? "auto" : bulk == BulkScheme::implicit_theta ? "implicit" : "explicit";
}
/// As a scenario has it: bulk = "auto"
inline std::string words_of(BulkScheme bulk) { return std::string("bulk = \"") + name_of(bulk) + "\""; }
enum class CohesionScheme { explicit_beta, implicit_beta };
constexpr const char* name_of(CohesionScheme cohesion) {
    return cohesion == CohesionScheme::implicit_beta ? "implicit" : "explicit";
}

/// What damping acts on in pieces that nothing holds: their vibration alone (explicit/free_pieces.hpp,
/// implicit/carried_motion.hpp), or their motion as a whole too.
enum class DampingOf { vibration, motion };

/// Pieces of the body that move as rigid ones while nothing can break them (stepper/rigid).
struct RigidOptions {
    double step = 0;      // [s] largest step; 0: the body is always deformable
    double thaw = 0.3;    // [-] k of the blow k sigma_c/(rho c) min(1, sqrt(10 L/D)) from which on it is deformable
    double hold = 20;     // [-] passages D/c for which it stays so after the last blow
    double smallest = 0;  // [m] smaller pieces never break
    double sleep = 0.02;  // [m/s] slower pieces fall asleep; 0: none does
    double restitution = 0.9;  // [-] of pieces that cannot break, where nothing else gives one

    bool active() const { return step > 0 && thaw > 0; }
};

struct SchemeOptions {
    BulkScheme bulk = BulkScheme::explicit_lumped;
    CohesionScheme cohesion = CohesionScheme::explicit_beta;
    double theta = 0.5;                    // [-] in [1/2, 1/(1 + e)], of the implicit bulk and of the implicit cohesion
    MassMatrix mass = MassMatrix::lumped;  // of the implicit bulk
    double damping = 0;                    // [1/s] alpha of the forces -alpha M v
    DampingOf damping_of = DampingOf::vibration;
    std::vector<Selection> absorbing;  // boundaries that let waves out
    RigidOptions rigid;
    bool respect_assumption_1 = true;  // reject steps with several solutions; false: continue with one of them

    bool takes_implicit_steps() const { return bulk != BulkScheme::explicit_lumped; }
    bool takes_explicit_steps() const { return bulk != BulkScheme::implicit_theta; }
};

/// Size of the present factor of an implicit step.
struct FactorSize {
    std::int64_t unknowns = 0, entries = 0;  // entries: of the triangular factor
};

/// Polled during a long step: true gives the step up.
using GiveUp = bool (*)();

/// Thrown by a step that is given up; the state at its start is unchanged.
struct StepGivenUp {};

class StepScheme {
public:
    virtual ~StepScheme() = default;

    /// From `begin` over h [s] to everything in `end` but its times. After a rejection `end` is void.
    virtual StepReport step(const State& begin, double h, State& end) = 0;
    virtual FactorSize factor_size() const { return {}; }
    virtual void give_up_when(GiveUp) {}  // ignored by a scheme with short steps
    virtual void set_theta(double) {}     // of the implicit bulk, from now on; at first that of the options
};

}  // namespace knap
