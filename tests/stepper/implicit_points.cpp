// The implicit scheme on one cohesive point with exact answers: quasi-static bars (A2, A4), shear with friction (A3), the best unit test
// of the step (B1, E5), a step beyond Assumption 1 (E9), closure (E6), a stuck point under a rotating load (E8).
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace knap;
using namespace knap::tests;

namespace {

constexpr CohesionScheme explicit_beta = CohesionScheme::explicit_beta, implicit_beta = CohesionScheme::implicit_beta;

/// All but massless, so that every step of theta = 1 ends in equilibrium.
constexpr double no_mass = 1e-24;

void check_books(const Run& run, double tolerance = 1e-12, double works = 1e-14) {
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
        REQUIRE(run.last.refusal == Refusal::none);
    }
}

}  // namespace

TEST_CASE("A2 quasi-static bar with a cohesive end by the implicit scheme") {
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
    for (const double k : {5.0, 0.6}) {
        const SpringBody body{.law = law, .mass = no_mass, .stiffness = k};
        ModelInput input = spring_body(body);
        drive(input, body.motion, {{0, 1, 3, 8}, {0, 0.5, -0.5, 2}});
        Run run(input, implicit(1));
        const PointView point(run);
        const double h = 1e-2;
        const auto softening = [&](double U) { return (k * U - law.sigma_c) / (k - law.sigma_c / law.delta_c()); };  // u of k (U - u) = sigma_c (1 - u)
        const double onset = law.sigma_c / k;                                                                      // U
        while (run.now.time < 7) {
            run.step(h);
            REQUIRE(run.last.refusal == Refusal::none);
            const double t = run.now.time, U = t < 1 ? t / 2 : t < 3 ? 1 - t / 2 : -2 + t / 2, most = std::max(t < 1 ? U : 0.5, t > 5 ? U : 0.0);
            const double damaged = std::clamp(softening(most), 0.0, 1.0), beta = most < onset ? 1 : most >= 1 ? 0 : 1 - damaged;
            // unloading: k (U - u) = sigma_c beta until it closes
            const double u = std::max(0.0, U - law.sigma_c * beta / k);
            CHECK(std::abs(point.u() - u) <= 1e-12);
            CHECK(std::abs(point.beta() - beta) <= 1e-12);
            CHECK(std::abs(point.traction().x() + k * (U - u)) <= 1e-12 * k);
            if (k == 5 && std::abs(t - 1) < 1e-6) {
                CHECK(point.u() == doctest::Approx(0.444444444444).epsilon(1e-11));
                CHECK(point.traction().x() == doctest::Approx(-0.277777777778).epsilon(1e-11));
            }
            if (k == 5 && std::abs(t - 3) < 1e-6) CHECK(point.traction().x() == doctest::Approx(2.5).epsilon(1e-12));
        }
        CHECK(point.beta() == 0);
        CHECK(run.ledger.row().surface == relative(2 * law.G_c, 1e-12));
        check_books(run);
    }
}

TEST_CASE("A3 mode II with friction by the implicit scheme") {
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    ModelInput input = point_masses(law, true);
    input.loads = {load(Load::Kind::displacement, "base", 1.0, std::nullopt, {{0, 1, 2, 6}, {0, 0.5, 0, -2}}),
                   load(Load::Kind::body_force, "", 0.0, -3.0)};  // area 1 shared by three corners: a force of -1 on each
    Run run(input, implicit());
    const PointView point(run);
    const double h = 1e-2;
    // the tractions are means over a step: at its middle the slip is h/4 from the turning points
    const auto friction = [&] { return std::abs(point.traction().y()) - law.sigma_c * point.beta(); };
    run.step(h);
    CHECK(std::abs(point.traction().y()) == relative(0.75 + 0.5 - (1 + law.friction) * law.sigma_c * h / 4, 1e-12));
    go(run, 1, h);
    CHECK(point.beta() == relative(0.5, 1e-12));
    CHECK(std::abs(point.traction().y()) == relative(0.625 + 0.25 + 1.5 * law.sigma_c * h / 4, 1e-12));
    CHECK(point.traction().y() > 0);  // T points to -x
    CHECK(run.ledger.row().friction_work == relative(-2 * 0.34375, 1e-12));
    go(run, 1 + h, h);
    CHECK(point.traction().y() == relative(0.25 - 0.625, 1e-12));  // the friction has turned, the cohesion has not
    go(run, 2, h);
    CHECK(point.beta() == relative(0.5, 1e-12));
    CHECK(run.ledger.row().friction_work == relative(-2 * 0.65625, 1e-12));
    go(run, 3, h);
    CHECK(run.ledger.row().friction_work == relative(-2 * 0.96875, 1e-12));
    go(run, 4, h);
    CHECK(point.beta() <= 1e-12);
    CHECK(run.ledger.row().friction_work == relative(-2 * 1.25, 1e-12));
    CHECK(run.ledger.row().surface == relative(2 * law.G_c, 1e-12));
    go(run, 6, h);
    CHECK(friction() == relative(0.5, 1e-12));
    check_books(run);
}

TEST_CASE("A4 quasi-static shear spring by the implicit scheme") {
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    const double k = 4.5, N = 5;
    for (const double stiffness : {k, 0.8}) {
        const SpringBody body{.law = law, .mass = no_mass, .stiffness = stiffness, .motion = Motion::slip};
        ModelInput input = spring_body(body);
        press(input, N);
        drive(input, body.motion, {{0, 20}, {0, 10}});
        Run run(input, implicit(1));
        const PointView point(run);
        const double h = 1e-2, onset = (0.75 + 2.5) / stiffness, broken = 1 + 2.5 / stiffness;  // of U
        while (run.now.time < 2 * broken + 1) {
            run.step(h);
            REQUIRE(run.last.refusal == Refusal::none);
            const double U = 0.5 * run.now.time;
            // k (U - u) = (gamma + mu) sigma_c (1 - u) + mu N
            const double u = U < onset ? 0 : U < broken ? (stiffness * (U - onset)) / (stiffness - 0.75) : U - 2.5 / stiffness;
            const double beta = std::clamp(1 - u, 0.0, 1.0);
            CHECK(std::abs(point.u(Motion::slip) - u) <= 1e-10);
            CHECK(std::abs(point.beta() - beta) <= 1e-10);
            if (U > onset + h) CHECK(std::abs(point.traction().y()) == doctest::Approx(0.75 * beta + 2.5).epsilon(1e-10));
            CHECK(point.asymmetry() <= 1e-12);
        }
        if (stiffness == k) CHECK(2 * onset == doctest::Approx(1.444444444));
        if (stiffness == k) CHECK(2 * broken == doctest::Approx(3.111111111));
        check_books(run, 1e-12, 1e-13);  // a pressure of 5 times the rounding of the contact rate
    }
}

TEST_CASE("B1 one mass under constant force by the implicit scheme") {
    // m (v+ - v)/h = F - sigma_c beta_theta, u+ - u = h v_theta and beta = 1 - u/delta at both ends: the trapezoidal rule of
    // u'' = kappa^2 (A + u), so u_n = A (cosh(n a) - 1), a = 2 artanh(h kappa/2), up to the step that breaks
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    const double A = 0.5;
    double previous = 0, previous_h = 0;
    for (const double h : {0.1, 0.05, 0.025, 0.0123}) {
        ModelInput input = point_masses(law, true);
        input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
        Run run(input, implicit());
        const PointView point(run);
        const double a = 2 * std::atanh(h / 2);
        double largest_speed = 0;
        while (true) {
            const double speed = point.v();
            run.step(h);
            REQUIRE(run.last.refusal == Refusal::none);
            CHECK(point.v() > speed);  // no ringing
            if (point.beta() == 0) break;
            CHECK(point.u() == relative(2 * A * std::pow(std::sinh(0.5 * a * static_cast<double>(run.now.n_steps)), 2), 1e-12));
            largest_speed = point.v();
        }
        // E5, the step that breaks: overshoot of the work over w, in [0, (v h/delta)^2/4]
        const double overshoot = run.ledger.row().cohesive_work / (2 * law.G_c) - 1;
        CHECK(overshoot >= -1e-14);
        CHECK(overshoot <= std::pow(1.1 * largest_speed * h, 2) / 4);
        CHECK(run.ledger.row().surface == relative(2 * law.G_c, 1e-12));
        CHECK(run.now.time == doctest::Approx(1.7627471740).epsilon(2 * h));
        CHECK(point.v() == doctest::Approx(std::sqrt(2.0)).epsilon(2 * h));
        check_books(run, 1e-14);
        const int n = static_cast<int>(std::floor(1.5 / h));
        const double error = std::abs(std::cosh(n * a) - std::cosh(n * h)) / std::sinh(n * h) / (n * h);
        if (previous > 0) CHECK(std::log(error / previous) / std::log(h / previous_h) == doctest::Approx(2).epsilon(0.025));
        previous = error, previous_h = h;
    }
}

TEST_CASE("B1 larger theta breaks without ringing and dissipates") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    for (const double theta : {0.5, 0.75, 1.0})
        for (const double h : {0.1, 0.05, 0.025, 0.0123}) {
            ModelInput input = point_masses(law, true);
            input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.5)};
            Run run(input, implicit(theta));
            const PointView point(run);
            double speed = 0, beta = 1;
            while (run.now.time < 3) {
                run.step(h);
                REQUIRE(run.last.refusal == Refusal::none);
                CHECK(point.v() > speed);
                CHECK(point.beta() <= beta);
                CHECK(point.beta() >= 0);
                speed = point.v(), beta = point.beta();
            }
            CHECK(point.beta() == 0);
            CHECK(speed == doctest::Approx(std::sqrt(2.0) + 1.5 * (3 - 1.7627471740)).epsilon(h));
            CHECK(run.ledger.row().scheme_dissipation >= 0);
            CHECK((run.ledger.row().scheme_dissipation > 0) == (theta > 0.5));
            check_books(run, 1e-13);
        }
}

TEST_CASE("E9 a step beyond Assumption 1 is refused or holds and never breaks below the strength") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    for (const double theta : {0.5, 0.75, 1.0}) {
        const double h = 1.5 / theta;  // h theta kappa = 1.5
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
                if (report.refusal == Refusal::assumption_1) continue;
                REQUIRE(report.refusal == Refusal::none);
                std::swap(now, end);
                CHECK(cohesion(model, now, 0) == 1);
                CHECK(cohesion(model, now, 1) == 1);
                CHECK(now.displacement[now.node_of_corner[0]].norm() <= 1e-12);
            }
        }
    }
}

TEST_CASE("E9 above the strength a step beyond Assumption 1 is refused and a smaller one is taken") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5};
    ModelInput input = point_masses(law, true);
    input.loads = {load(Load::Kind::body_force, "", 0.0, 3 * 1.1)};
    const Model model = make_model(input);
    MoreauJean stepper(model, implicit());
    const State now = initial_state(model);
    State end;
    CHECK(stepper.step(now, 3.0, end).refusal == Refusal::assumption_1);
    CHECK(stepper.step(now, 0.5, end).refusal == Refusal::none);
    CHECK(cohesion(model, end, 0) > 0);
    CHECK(cohesion(model, end, 0) < 1);
}

TEST_CASE("E6 a point that closes stays closed and does not chatter") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 0.5, .gamma = 1, .friction = 0.3};
    for (const double theta : {0.5, 0.75, 1.0})
        for (const CohesionScheme cohesion : {explicit_beta, implicit_beta}) {
            ModelInput input = point_masses(law, true);
            input.loads = {load(Load::Kind::body_force, "", 0.0, 3.0, {{0, 0.8, 0.9, 5}, {1.5, 1.5, -2, -2}})};  // pulled half open, pushed back
            Run run(input, implicit(theta, cohesion));
            const PointView point(run);
            const double h = 0.01;
            int flips = 0;
            bool closed = true;
            double fastest = 0;
            while (run.now.time < 5) {
                fastest = std::max(fastest, std::abs(point.v()));
                run.step(h);
                REQUIRE(run.last.refusal == Refusal::none);
                const bool now_closed = point.traction().x() > -law.sigma_c * point.beta() + 1e-9;  // contact carries
                flips += now_closed != closed;
                closed = now_closed;
            }
            CHECK(closed);
            CHECK(flips <= 4);  // opens, closes, and at most twice more
            CHECK(point.beta() > 0.2);
            CHECK(point.beta() < 0.95);
            CHECK(std::abs(point.u()) <= 2 * fastest * h);
            CHECK(run.ledger.worst().penetration <= fastest * h);
            CHECK(std::abs(point.v()) <= 1e-12);
            check_books(run);
        }
}

TEST_CASE("E8 a stuck point under a rotating load does not drift with the implicit scheme") {
    const int periods = 100;
    const double h = 0.01, sigma_c = 2, delta = 1e-3;
    const CohesiveLaw law{.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta, .gamma = 0.7, .friction = 0.4};
    const auto wave = [&](double phase) { return sampled([&](double t) { return std::sin(2 * M_PI * t + phase); }, h, 100 * periods); };
    for (const double theta : {0.5, 0.6})
        for (const bool glued : {false, true}) {
            ModelInput input = point_masses(law, glued);
            // contact: pressure 3 +- 1, shear up to .99 mu (3 - 1); glued: 0.99 of the inner circle of the strength polygon
            const double shear = (law.gamma + law.friction) * sigma_c / std::sqrt(1 + law.friction * law.friction);
            const double normal = glued ? 0.99 * std::min(sigma_c, shear) : 1, tangential = glued ? normal : 0.99 * law.friction * 2;
            input.loads = {load(Load::Kind::body_force, "", 3 * tangential, std::nullopt, wave(0)),
                           load(Load::Kind::body_force, "", std::nullopt, 3 * normal, wave(M_PI / 2)),
                           load(Load::Kind::body_force, "", 0.0, glued ? 0.0 : -9.0)};
            Run run(input, implicit(theta));
            for (int i = 0; i < 100 * periods; ++i) {
                run.step(h);
                REQUIRE(run.last.refusal == Refusal::none);
            }
            CHECK(run.u(0, 0).norm() <= 1e-12 * delta);
            CHECK(run.u(0, 1).norm() <= 1e-12 * delta);
            if (glued) CHECK(PointView(run).beta() == 1);
            check_books(run);
        }
}
