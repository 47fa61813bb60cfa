// The implicit scheme on one cohesive point with exact answers: quasi-static bars (A2, A4), shear with friction (A3),
// the best unit test of the step (B1, E5), a step beyond Assumption 1 (E9), closure (E6), a stuck point under a
// rotating load (E8).
#include "model/make_model.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace implicit_points_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr CohesionScheme explicit_beta = CohesionScheme::explicit_beta, implicit_beta = CohesionScheme::implicit_beta;

/// All but massless, so that every step of theta = 1 ends in equilibrium.
constexpr double no_mass = 1e-24;

void check_balance(const Run& run, double tolerance = 1e-12, double works = 1e-14) {
    const double scale = run.ledger.largest_energy();
    CHECK(run.ledger.largest_residual() <= tolerance * scale);
    CHECK(run.ledger.worst().worst_friction_work <= works * scale);
    CHECK(run.ledger.worst().worst_impact_work <= works * scale);
    CHECK(run.ledger.worst().largest_beta_growth == 0);
    CHECK(run.ledger.worst().residual <= 1e-10);
}

/// Steps of h to a time; every one must be taken.
void go(Run& run, double until, double h) {
    while (run.now.time < until - 0.5 * h) {
        run.step(h);
        REQUIRE(run.last.rejection == Rejection::none);
    }
}

}  // namespace

TEST_CASE("A2 quasi-static bar with a cohesive end by the implicit scheme") {
    on_path(both_implicit);
    describe(
        "A spring k, without mass, between a driven end U(t) (up to .5 at t = 1, down to -.5 at t = 3, up to 2) and a "
        "cohesive point with sigma_c = .5, delta_c = 1; theta = 1, h = 1/128. "
        "k = .5 would snap back. Statics: the explicit bulk has nothing to say, and beta frozen over a step lags "
        "behind by the step, so the other pairs cannot meet this.");
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
    for (const double k : {5.0, 0.6}) {
        const std::string at = ", k = " + digits(k);
        double worst_u = 0, worst_beta = 0, worst_r = 0;
        const SpringBody body{.law = law, .mass = no_mass, .stiffness = k};
        ModelInput input = spring_body(body);
        drive(input, body.motion, {{0, 1, 3, 8}, {0, 0.5, -0.5, 2}});
        Run run(input, implicit(1));
        const PointView point(run);
        const double h = 0x1p-7;  // adds up without rounding
        const auto softening = [&](double U) {
            return (k * U - law.sigma_c) / (k - law.sigma_c / law.delta_c());
        };                                     // u of k (U - u) = sigma_c (1 - u)
        const double onset = law.sigma_c / k;  // U
        while (run.now.time < 7) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            const double t = run.now.time,
                         U = t < 1   ? t / 2
                             : t < 3 ? 1 - t / 2
                                     : -2 + t / 2,
                         most = std::max(t < 1 ? U : 0.5, t > 5 ? U : 0.0);
            const double damaged = std::clamp(softening(most), 0.0, 1.0), beta = most < onset ? 1
                                                                                 : most >= 1  ? 0
                                                                                              : 1 - damaged;
            // unloading: k (U - u) = sigma_c beta until it closes
            const double u = std::max(0.0, U - law.sigma_c * beta / k);
            worst_u = std::max(worst_u, std::abs(point.u() - u));
            worst_beta = std::max(worst_beta, std::abs(point.beta() - beta));
            worst_r = std::max(worst_r, std::abs(point.traction().x() / k + U - u));
            if (k == 5 && std::abs(t - 1) < 1e-6) {
                verify("u at t = 1", point.u(), 4.0 / 9, {1e-12});
                verify("beta at t = 1", point.beta(), 5.0 / 9, {1e-12});
                verify("r_N at t = 1", point.traction().x(), -2.5 / 9, {1e-12});
            }
            if (k == 5 && std::abs(t - 3) < 1e-6) verify("r_N at t = 3", point.traction().x(), 2.5, {1e-12});
        }
        verify_small("error of u, worst of all steps" + at, worst_u, {1e-12});
        verify_small("error of beta, worst of all steps" + at, worst_beta, {1e-12});
        verify_small("error of r_N/k, worst of all steps" + at, worst_r, {1e-12});
        CHECK(point.beta() == 0);
        verify("G/G_c when broken" + at, run.ledger.row().dissipated / (2 * law.G_c), 1, {1e-12});
        check_balance(run);
    }
}

TEST_CASE("A3 mode II with friction by the implicit scheme") {
    on_path(both_implicit);
    describe(
        "sigma_c = .5, delta_c = 1, gamma = 1, mu = .5, pressure 1; the slip goes to .5 (t = 1), back to 0 (t = 2) and "
        "on to -2 (t = 6). Reference: the law by hand.");
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    ModelInput input = point_masses(law, true);
    input.loads = {
        load(Load::Kind::displacement, "base", 1.0, std::nullopt, {{0, 1, 2, 6}, {0, 0.5, 0, -2}}),
        load(Load::Kind::body_force, "", 0.0, -3.0)};  // area 1 shared by three corners: a force of -1 on each
    Run run(input, implicit());
    const PointView point(run);
    const double h = 1e-2;
    // the tractions are means over a step: at its middle the slip is h/4 from the turning points
    const auto friction = [&] { return std::abs(point.traction().y()) - law.sigma_c * point.beta(); };
    run.step(h);
    verify("|r_T|, mean of the first step", std::abs(point.traction().y()),
           0.75 + 0.5 - (1 + law.friction) * law.sigma_c * h / 4, {1e-12});
    go(run, 1, h);
    verify("beta at t = 1", point.beta(), 0.5, {1e-12});
    verify("|r_T|, mean of the last step before t = 1", std::abs(point.traction().y()),
           0.625 + 0.25 + 1.5 * law.sigma_c * h / 4, {1e-12});
    CHECK(point.traction().y() > 0);  // T points to -x
    verify("friction work at t = 1", run.ledger.row().friction_work / 2, -0.34375, {1e-12});
    go(run, 1 + h, h);
    verify("r_T, mean of the first step after t = 1", point.traction().y(), 0.25 - 0.625,
           {1e-12});  // the friction has turned, the cohesion has not
    go(run, 2, h);
    verify("beta at t = 2", point.beta(), 0.5, {1e-12});
    verify("friction work at t = 2", run.ledger.row().friction_work / 2, -0.65625, {1e-12});
    go(run, 3, h);
    verify("friction work at t = 3", run.ledger.row().friction_work / 2, -0.96875, {1e-12});
    go(run, 4, h);
    CHECK(point.beta() <= 1e-12);
    verify("friction work at t = 4", run.ledger.row().friction_work / 2, -1.25, {1e-12});
    verify("G/G_c at t = 4", run.ledger.row().surface() / (2 * law.G_c), 1, {1e-12});
    go(run, 6, h);
    verify("friction traction after t = 4", friction(), 0.5, {1e-12});
    check_balance(run);
}

TEST_CASE("A4 quasi-static shear spring by the implicit scheme") {
    on_path(both_implicit);
    describe(
        "A shear spring k, without mass, drives a point under a pressure of 5 by U = t/2; mu = .5, gamma = 1, sigma_c "
        "= .5, delta_c = 1, h = 1/128. k < .75 would snap. "
        "Statics, as A2: for both implicit only.");
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    const double k = 4.5, N = 5;
    for (const double stiffness : {k, 0.8}) {
        const std::string at = ", k = " + digits(stiffness);
        double worst_u = 0, worst_beta = 0, worst_r = 0, moves = 0, breaks = 0;
        const SpringBody body{.law = law, .mass = no_mass, .stiffness = stiffness, .motion = SpringMotion::slip};
        ModelInput input = spring_body(body);
        press(input, N);
        drive(input, body.motion, {{0, 20}, {0, 10}});
        Run run(input, implicit(1));
        const PointView point(run);
        const double h = 0x1p-7, onset = (0.75 + 2.5) / stiffness, broken = 1 + 2.5 / stiffness;  // of U
        while (run.now.time < 2 * broken + 1) {
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            const double U = 0.5 * run.now.time;
            // k (U - u) = (gamma + mu) sigma_c (1 - u) + mu N
            const double u = U < onset    ? 0
                             : U < broken ? (stiffness * (U - onset)) / (stiffness - 0.75)
                                          : U - 2.5 / stiffness;
            const double beta = std::clamp(1 - u, 0.0, 1.0);
            worst_u = std::max(worst_u, std::abs(point.u(SpringMotion::slip) - u));
            worst_beta = std::max(worst_beta, std::abs(point.beta() - beta));
            if (U > onset + h)
                worst_r = std::max(worst_r, std::abs(std::abs(point.traction().y()) - 0.75 * beta - 2.5));
            if (moves == 0 && point.u(SpringMotion::slip) > 0) moves = run.now.time;
            if (breaks == 0 && point.beta() == 0) breaks = run.now.time;
            CHECK(point.asymmetry() <= 1e-12);
        }
        verify_small("error of u, worst of all steps" + at, worst_u, {1e-10});
        verify_small("error of beta, worst of all steps" + at, worst_beta, {1e-10});
        verify_small("error of r_T while sliding, worst of all steps" + at, worst_r, {1e-10});
        verify_near("onset, within a step of 1/128" + at, moves, 2 * onset, {h, h});
        verify_near("broken, within a step of 1/128" + at, breaks, 2 * broken, {h, h});
        check_balance(run, 1e-12, 1e-13);  // a pressure of 5 times the rounding of the contact rate
    }
}

TEST_CASE("B1 one mass under constant force by the implicit scheme") {
    // m (v+ - v)/h = F - sigma_c beta_theta, u+ - u = h v_theta and beta = 1 - u/delta at both ends: the trapezoidal
    // rule of u'' = kappa^2 (A + u), so u_n = A (cosh(n a) - 1), a = 2 artanh(h kappa/2), up to the step that breaks
    on_path(both_implicit);
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    const double A = 0.5;
    double previous = 0, previous_h = 0;
    for (const double h : {0.1, 0.05, 0.025, 0.0123}) {
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
        Run run(input, implicit());
        const PointView point(run);
        const double a = 2 * std::atanh(h / 2);
        double largest_speed = 0, worst = 0;
        while (true) {
            const double speed = point.v();
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            CHECK(point.v() > speed);  // no ringing
            if (point.beta() == 0) break;
            worst = std::max(
                worst,
                std::abs(point.u() / (2 * A * std::pow(std::sinh(0.5 * a * static_cast<double>(run.now.n_steps)), 2)) -
                         1));
            largest_speed = point.v();
        }
        // E5, the step that breaks: overshoot of the work over w, in [0, (v h/delta)^2/4]
        const double overshoot = run.ledger.row().cohesive_work / (2 * law.G_c) - 1;
        const std::string at = ", h = " + digits(h);
        verify_small("relative error of u_n, worst of all steps" + at, worst, {1e-12});
        verify_at_least("work of the interface over G_c, less 1 (E5)" + at, overshoot, -1e-14);
        verify_at_most("work of the interface over G_c, less 1 (E5)" + at, overshoot,
                       std::pow(1.1 * largest_speed * h, 2) / 4);
        verify("G/G_c of the state" + at, run.ledger.row().surface() / (2 * law.G_c), 1, {1e-12});
        verify_near("time of breaking" + at, run.now.time, 1.7627471740, {2 * h, h});
        verify_near("speed at breaking" + at, point.v(), std::sqrt(2.0), {2 * h, h});
        verify_small("energy residual" + at, run.ledger.largest_residual() / run.ledger.largest_energy(),
                     {1e-14, 1e-15});
        check_balance(run, 1e-14);
        const int n = static_cast<int>(std::floor(1.5 / h));
        const double error = std::abs(std::cosh(n * a) - std::cosh(n * h)) / std::sinh(n * h) / (n * h);
        if (previous > 0)
            verify_near("order of u(1.5)" + at, std::log(error / previous) / std::log(h / previous_h), 2, {0.05});
        previous = error, previous_h = h;
    }
}

TEST_CASE("B1 larger theta breaks without ringing and dissipates") {
    describe(
        "The mass under constant force with theta = 1/2, 3/4 and 1: its speed grows and beta falls in every step, and "
        "at t = 3 it has the speed of the exact motion, within h.");
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    for (const double theta : {0.5, 0.75, 1.0}) {
        on_path(implicit(theta));
        for (const double h : {0.1, 0.05, 0.025, 0.0123}) {
            ModelInput input = point_masses(law, true);
            input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
            Run run(input, implicit(theta));
            const PointView point(run);
            double speed = 0, beta = 1;
            while (run.now.time < 3) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
                CHECK(point.v() > speed);
                CHECK(point.beta() <= beta);
                CHECK(point.beta() >= 0);
                speed = point.v(), beta = point.beta();
            }
            CHECK(point.beta() == 0);
            verify("speed at t = 3, theta = " + digits(theta) + ", h = " + digits(h), speed,
                   std::sqrt(2.0) + 1.5 * (3 - 1.7627471740), {h});
            CHECK(run.ledger.row().scheme_dissipation >= 0);
            CHECK((run.ledger.row().scheme_dissipation > 0) == (theta > 0.5));
            check_balance(run, 1e-13);
        }
    }
}

TEST_CASE("E9 a step beyond Assumption 1 is rejected or holds and never breaks below the strength") {
    describe(
        "One mass, h theta kappa = 1.5, under .9 of the strength: the step has three solutions, with beta = 1, .64 and "
        "0. It must be rejected, or hold.");
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    for (const double theta : {0.5, 0.75, 1.0}) {
        const double h = 1.5 / theta;  // h theta kappa = 1.5
        on_path(both_implicit);
        bool holds = true;
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 0.9)};
        for (const bool respected : {true, false}) {
            SchemeOptions options = implicit(theta);
            options.respect_assumption_1 = respected;
            const Model model = make_model(input);
            MoreauJean stepper(model, options);
            State now = initial_state(model), end;
            for (int i = 0; i < 20; ++i) {
                const StepReport report = stepper.step(now, h, end);
                if (report.rejection == Rejection::assumption_1) continue;
                REQUIRE(report.rejection == Rejection::none);
                std::swap(now, end);
                holds = holds && cohesion(model, now, 0) == 1 && cohesion(model, now, 1) == 1 &&
                        now.displacement[now.node_of_corner[0]].norm() <= 1e-12;
            }
        }
        verify_that("rejected or intact and at rest, 20 steps, theta = " + digits(theta), holds);
    }
}

TEST_CASE("E9 above the strength a step beyond Assumption 1 is rejected and a smaller one is taken") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    ModelInput input = point_masses(law, true);
    input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.1)};
    const Model model = make_model(input);
    MoreauJean stepper(model, implicit());
    const State now = initial_state(model);
    State end;
    on_path(both_implicit);
    verify_that("h kappa = 3 under 1.1 of the strength is rejected",
                stepper.step(now, 3.0, end).rejection == Rejection::assumption_1);
    verify_that("h kappa = .5 is taken", stepper.step(now, 0.5, end).rejection == Rejection::none);
    verify_that("and damages without breaking", cohesion(model, end, 0) > 0 && cohesion(model, end, 0) < 1);
}

TEST_CASE("E6 a point that closes stays closed and does not chatter") {
    describe(
        "A mass on a point is pulled half open by 1.5 sigma_c S and pushed back by 2: it closes, and may open and "
        "close once more; how far it penetrates is bounded by a step.");
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5, .gamma = 1, .friction = 0.3};
    std::vector<SchemeOptions> paths = {both_explicit, {.cohesion = implicit_beta}};
    for (const double theta : {0.5, 0.75, 1.0})
        for (const CohesionScheme cohesion : {explicit_beta, implicit_beta}) paths.push_back(implicit(theta, cohesion));
    for (const SchemeOptions& path : paths) {
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3.0,
                            {{0, 0.8, 0.9, 5}, {1.5, 1.5, -2, -2}})};  // pulled half open, pushed back
        on_path(path);
        Run run(input, path);
        const PointView point(run);
        const double h = 0.01;
        int flips = 0;
        bool closed = true;
        double fastest = 0;
        while (run.now.time < 5) {
            const double before = point.beta();
            fastest = std::max(fastest, std::abs(point.v()));
            run.step(h);
            REQUIRE(run.last.rejection == Rejection::none);
            const double beta =
                path.cohesion == explicit_beta ? before : point.beta();  // what pulls in this step, at least
            const bool now_closed = point.traction().x() > -law.sigma_c * beta + 1e-9;  // contact carries
            flips += now_closed != closed;
            closed = now_closed;
        }
        const std::string at = path.bulk == BulkScheme::explicit_lumped ? "" : ", theta = " + digits(path.theta);
        verify_that("closed at the end" + at, closed);
        verify_at_most("changes between open and closed after the first closure" + at, flips - 2, 2);
        CHECK(point.beta() > 0.2);
        CHECK(point.beta() < 0.95);
        verify_at_most("|u_N| at the end over the largest step |v| h" + at, std::abs(point.u()) / (fastest * h), 2);
        CHECK(run.ledger.worst().penetration <= fastest * h);
        verify_small("speed at the end" + at, point.v(), {1e-12});
        check_balance(run);
    }
}

TEST_CASE("E8 a stuck point under a rotating load does not drift with the implicit scheme") {
    const int periods = 100;
    const double h = 0.01, sigma_c = 2, delta = 1e-3;
    const CohesiveLaw law{.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta, .gamma = 0.7, .friction = 0.4};
    const auto wave = [&](double phase) {
        return sampled([&](double t) { return std::sin(2 * M_PI * t + phase); }, h, 100 * periods);
    };
    for (const double theta : {0.5, 0.6})
        for (const bool glued : {false, true}) {
            ModelInput input = point_masses(law, glued);
            // contact: pressure 3 +- 1, shear up to .99 mu (3 - 1); glued: 0.99 of the inner circle of the strength
            // polygon
            const double shear = (law.gamma + law.friction) * sigma_c / std::sqrt(1 + law.friction * law.friction);
            const double normal = glued ? 0.99 * std::min(sigma_c, shear) : 1,
                         tangential = glued ? normal : 0.99 * law.friction * 2;
            input.loads = {load(Load::Kind::body_force, "", 3 * tangential, std::nullopt, wave(0)),
                           load(Load::Kind::body_force, "", std::nullopt, 3 * normal, wave(M_PI / 2)),
                           load(Load::Kind::body_force, "", 0.0, glued ? 0.0 : -9.0)};
            on_path(both_implicit);
            Run run(input, implicit(theta));
            for (int i = 0; i < 100 * periods; ++i) {
                run.step(h);
                REQUIRE(run.last.rejection == Rejection::none);
            }
            verify_small(std::string("drift over delta_c in 10 000 steps, ") + (glued ? "glued" : "by friction alone") +
                             ", theta = " + digits(theta),
                         std::max(run.u(0, 0).norm(), run.u(0, 1).norm()) / delta, {1e-12});
            if (glued) CHECK(PointView(run).beta() == 1);
            check_balance(run);
        }
}

}  // namespace implicit_points_test
