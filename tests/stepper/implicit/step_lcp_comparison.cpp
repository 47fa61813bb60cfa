// The implicit stepper against the full, unreduced complementarity problem of each of its steps, solved by Lemke's
// method: on random small bodies both find the same motion and the same cohesion. Where they do not, both must satisfy
// the equations: with friction a step may have several solutions.
#include "model/make_model.hpp"
#include "support/random_bodies.hpp"
#include "support/softening_shapes.hpp"
#include "support/step_lcp_run.hpp"

#include <doctest/doctest.h>

namespace step_lcp_comparison_test {

using namespace knap;
using namespace knap::tests;

namespace {

struct Tally {
    int n_steps = 0;
    int n_refused = 0, n_not_converged = 0;         // steps that the stepper did not take
    int n_unsolved = 0;                             // that Lemke's method did not solve, or not to 1e-11
    int n_inexact = 0;                              // that the stepper solved to 1e-8 and not to 1e-10
    int n_several = 0;                              // with another solution, as good
    int n_wrong = 0;                                // with another motion that is none
    int n_damaged = 0, n_broken = 0, n_closed = 0;  // points at the ends of steps; what was tried at all
    int n_on_ramp = 0;                              // at the start of a step, below their largest opening
};

State random_start(const Model& model, const RandomBody& body) {
    State state = initial_state(model);
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        Vec2& velocity = state.velocity[state.node_of_corner[c]];
        const auto& vertex = model.mesh.triangles[model.mesh.triangle_of(c)];
        const Eigen::Vector3d at = coordinates(model.mesh, c);
        velocity.setZero();
        for (int k = 0; k < 3; ++k) velocity += at[k] * body.velocity[vertex[k]];
        if (!model.prescribed.empty() && model.prescribed_of_corner[c] >= 0) velocity.setZero();
    }
    return state;
}

/// What the stepper found, in the words of the reference; the impulses are not known.
StepLcpEnd words_of(const Model& model, const State& begin, const State& end, const SchemeOptions& scheme, double h) {
    StepLcpEnd found;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Index from = begin.node_of_corner[c], to = end.node_of_corner[c];
        const Vec2 mean = scheme.theta * end.velocity[to] + (1 - scheme.theta) * begin.velocity[from];
        const bool driven = !model.prescribed.empty() && model.prescribed_of_corner[c] >= 0;
        found.velocity.push_back(end.velocity[to]);
        found.rate.push_back(driven ? Vec2((end.displacement[to] - begin.displacement[from]) / h) : mean);
    }
    for (Index p = 0; p < model.n_points(); ++p) {
        found.opening.push_back(opening(model, end, p));
        found.cohesion.push_back(cohesion(model, end, p));
    }
    found.impulse.assign(model.n_points(), Vec2::Zero());
    found.contact.assign(model.n_points(), 0);
    return found;
}

/// Largest difference of the velocities and of the cohesions, relative.
double difference(const Model& model, double h, double speed, const StepLcpEnd& a, const StepLcpEnd& b) {
    double worst = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        worst = std::max(worst, (a.velocity[c] - b.velocity[c]).norm() / speed);
    for (Index p = 0; p < model.n_points(); ++p) {
        const CohesiveLaw& law = model.laws[model.interfaces[model.interface_of(p)].law];
        if (law.breakable())
            worst = std::max(worst, std::abs(a.cohesion[p] - b.cohesion[p]) / std::max(1.0, h * speed / law.delta_c()));
    }
    return worst;
}

void count_points(const Model& model, const StepLcpEnd& end, Tally& tally) {
    for (Index p = 0; p < model.n_points(); ++p) {
        if (!model.laws[model.interfaces[model.interface_of(p)].law].breakable()) continue;
        tally.n_damaged += end.cohesion[p] > 0 && end.cohesion[p] < 1;
        tally.n_broken += end.cohesion[p] == 0;
        tally.n_closed += end.cohesion[p] == 0 && end.contact[p] > 0;
    }
}

/// Steps of one random body, each from where the stepper got.
void compare(std::uint64_t seed, const RandomBodyOptions& options, int n_steps, Tally& tally) {
    const RandomBody body = RandomBodies(seed, options).body();
    const Model model = make_model(body.input);
    const double h = body.step;
    MoreauJean stepper(model, body.scheme);
    State begin = random_start(model, body), end;
    for (int n = 0; n < n_steps; ++n, std::swap(begin, end)) {
        CAPTURE(seed);
        CAPTURE(n);
        const Rejection rejection = stepper.step(begin, h, end).rejection;
        tally.n_refused += rejection == Rejection::assumption_1;
        tally.n_not_converged += rejection == Rejection::not_converged;
        if (rejection != Rejection::none) return;
        const StepLcp reference_step(model, begin, h, body.scheme);
        const LcpSolution solution = solve_step(reference_step.problem());
        if (solution.status != LcpStatus::solved) return void(++tally.n_unsolved);
        const StepLcpEnd reference = reference_step.end(solution.z);
        StepLcpEnd found = words_of(model, begin, end, body.scheme, h);
        ImplicitJudge judge(model, begin, h, body.scheme);
        const double reference_verdict = judge.verdict(reference).worst();
        if (!options.over_pressure) CHECK(reference_verdict < 1e-8);  // of seed 1544 the reference is 7e-6 off
        if (reference_verdict > 1e-11) return void(++tally.n_unsolved);
        ++tally.n_steps;
        count_points(model, reference, tally);
        for (Index p = 0; p < model.n_points(); ++p) {
            const CohesiveLaw& law = model.laws[model.interfaces[model.interface_of(p)].law];
            const PointState* known = state_of(model, begin, p);
            const Vec2 u = opening(model, begin, p);
            const double kappa = known ? law.ramp(known->cohesion, known->largest_opening) : 0;
            tally.n_on_ramp += law.equivalent_opening(u.x(), u.y()) < 0.99 * kappa;
        }
        const double apart = difference(model, h, judge.speed_scale(), reference, found);
        if (apart <= 1e-10) continue;
        if (apart <= 1e-8) return void(++tally.n_inexact);
        if (options.over_pressure)
            return void(++tally.n_several);  // the judge searches impulses of Coulomb's law alone
        judge.explain(found);
        const double verdict = judge.verdict(found).worst();
        if (verdict < 1e-8) return void(++tally.n_several);
        ++tally.n_wrong;
        CAPTURE(apart);
        CHECK(verdict < 1e-8);
        return;
    }
}

}  // namespace

TEST_CASE("implicit stepper: without friction random small bodies move as the full complementarity problem says") {
    Tally tally;
    for (int seed = 0; seed < 80; ++seed) compare(seed, {.friction = false}, 8, tally);
    CHECK(tally.n_wrong == 0);
    CHECK(tally.n_several == 0);  // inside Assumption 1 the motion is unique
    CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 2);
    CHECK(tally.n_steps > 600);
    CHECK(tally.n_damaged > 3000);
    CHECK(tally.n_broken > 300);
    CHECK(tally.n_closed > 30);
}

TEST_CASE("implicit stepper: with friction random small bodies move as the full complementarity problem says") {
    Tally tally;
    for (int seed = 1000; seed < 1080; ++seed) compare(seed, {}, 8, tally);
    CHECK(tally.n_wrong == 0);
    CHECK(tally.n_several <= 4);
    CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 4);
    CHECK(tally.n_steps > 500);
    CHECK(tally.n_damaged > 3000);
    CHECK(tally.n_broken > 300);
    CHECK(tally.n_closed > 30);
}

TEST_CASE("implicit stepper: with friction over pressure bodies move as the full complementarity problem says") {
    Tally tally;
    for (int seed = 1500; seed < 1580; ++seed) compare(seed, {.over_pressure = true}, 8, tally);
    CHECK(tally.n_several <= 3);
    CHECK(tally.n_wrong == 0);
    CHECK(tally.n_not_converged + tally.n_refused + tally.n_inexact == 0);
    CHECK(tally.n_unsolved <= 10);  // by Lemke's method: bends of points with little of the area of a vertex
    CHECK(tally.n_steps > 350);
    CHECK(tally.n_damaged > 2000);
    CHECK(tally.n_broken > 150);
    CHECK(tally.n_closed > 15);
}

TEST_CASE("implicit stepper: bodies of second order move as the full complementarity problem says") {
    Tally tally;
    for (int seed = 4000; seed < 4030; ++seed)
        compare(seed, {.friction = seed % 2 == 0, .max_cells = 2, .order = 2}, 6, tally);
    CHECK(tally.n_wrong == 0);
    CHECK(tally.n_several <= 2);
    CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 3);
    CHECK(tally.n_steps > 140);
    CHECK(tally.n_damaged > 400);
    CHECK(tally.n_broken > 80);
}

TEST_CASE("implicit stepper: with every softening shape bodies move as the full complementarity problem says") {
    std::uint64_t seed = 5000;
    int n_broken = 0;  // of all shapes: a plateau is left late
    for (const auto& [name, softening] : all_softening_shapes()) {
        CAPTURE(name);
        Tally tally;
        for (int i = 0; i < 5; ++i, ++seed)
            compare(seed, {.friction = seed % 3 == 0, .max_cells = 2, .softening = softening}, 8, tally);
        CHECK(tally.n_wrong == 0);
        CHECK(tally.n_several <= 1);
        CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 1);
        CHECK(tally.n_steps > 25);
        CHECK(tally.n_damaged > 10);
        n_broken += tally.n_broken;
    }
    CHECK(n_broken > 27);
}

TEST_CASE("implicit stepper: with delayed softening bodies move as the full complementarity problem says") {
    std::uint64_t seed = 6000;
    auto shapes = all_softening_shapes();
    shapes.emplace_back("linear", nullptr);
    for (const auto& [name, softening] : shapes) {
        CAPTURE(name);
        Tally tally;
        for (int i = 0; i < 4; ++i, ++seed)
            compare(seed, {.friction = seed % 3 == 0, .max_cells = 2, .softening = softening, .delay = i % 2 ? 0.2 : 3},
                    8, tally);
        CHECK(tally.n_wrong == 0);
        CHECK(tally.n_several <= 1);
        CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 1);
        CHECK(tally.n_steps > 20);
        CHECK(tally.n_damaged > 4);  // a plateau is left late
    }
}

TEST_CASE("implicit stepper: with secant unloading bodies move as the full complementarity problem says") {
    for (const bool friction : {false, true}) {
        Tally tally;
        for (int seed = 7000; seed < 7060; ++seed)
            compare(seed, {.friction = friction, .max_cells = 2, .secant = true}, 12, tally);
        CAPTURE(friction);
        CHECK(tally.n_wrong == 0);
        CHECK(tally.n_several <= (friction ? 3 : 0));
        CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 3);
        CHECK(tally.n_steps > 500);
        CHECK(tally.n_damaged > 1000);
        CHECK(tally.n_on_ramp > 200);
    }
}

TEST_CASE("implicit stepper: two thousand random bodies move as the full complementarity problem says" *
          doctest::test_suite("slow")) {
    for (const bool friction : {false, true}) {
        Tally tally;
        for (int seed = 2000; seed < 3000; ++seed) compare(seed, {.friction = friction}, 8, tally);
        CHECK(tally.n_wrong == 0);
        CHECK(tally.n_several <=
              (friction ? 20
                        : 2));  // without friction one in 8000 steps, not explained: both motions satisfy the equations
        CHECK(tally.n_unsolved + tally.n_not_converged + tally.n_refused + tally.n_inexact <= 30);
        CHECK(tally.n_steps > 7000);
    }
}

}  // namespace step_lcp_comparison_test
