// The implicit scheme on bodies with exact motions: two masses on a cohesive point (B2, B3, B5), a bouncing bar (B11), an impacting
// stick (B15). Times of events are found between steps.
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

using namespace knap;
using namespace knap::tests;

namespace {

void check_books(const Run& run, double tolerance = 1e-12) {
    const double scale = run.ledger.largest_energy();
    CHECK(run.ledger.largest_residual() <= tolerance * scale);
    CHECK(run.ledger.worst().worst_friction_work <= 1e-14 * scale);
    CHECK(run.ledger.worst().worst_impact_work <= 1e-14 * scale);
    CHECK(run.ledger.worst().largest_beta_growth == 0);
    CHECK(run.ledger.worst().residual <= 1e-10);
}

void take(Run& run, double h) {
    run.step(h);
    REQUIRE_MESSAGE(run.last.refusal == Refusal::none, "refused at the step after ", run.now.n_steps, " steps of ", h);
}

}  // namespace

TEST_CASE("B2 statically ill-posed and dynamically regular") {
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
    const SpringBody body{.law = law, .mass = 0.25, .stiffness = 0.5};
    double previous = 0;
    for (const double h : {1e-2, 5e-3, 2.5e-3}) {
        ModelInput input = spring_body(body);
        drive(input, body.motion, {{0, 1, 3, 8}, {0, 0.5, -0.5, 2}});
        Run run(input, implicit());
        const PointView point(run);
        while (run.now.time < 5.99) {
            take(run, h);
            const double t = run.now.time - 0.5 * h, U = t < 1 ? t / 2 : t < 3 ? 1 - t / 2 : -2 + t / 2;  // means over the step
            const bool kink = std::abs(t - 1) < h || std::abs(t - 3) < h;
            if (!kink) CHECK(point.traction().x() == doctest::Approx(-0.5 * U).epsilon(1e-12));
            CHECK(point.u() == 0);
        }
        double opens = 0, at_7_5 = 0;
        while (point.beta() > 0) {
            take(run, h);
            if (opens == 0 && point.u() > 0) opens = run.now.time;
            if (std::abs(run.now.time - 7.5) < 0.1 * h) at_7_5 = point.u();
            REQUIRE(run.now.time < 9);
        }
        CHECK(std::abs(opens - 6) <= h * (1 + 1e-9));
        CHECK(std::abs(run.now.time - 7.81712059) <= h);
        CHECK(std::abs(point.v() - 1.65096362) <= 2 * h);
        // second order in h
        const double error = std::abs(at_7_5 - 0.5625);
        CHECK(error <= (h < 3e-3 ? 1e-5 : 2e-4));
        if (previous > 0) CHECK(std::log2(previous / error) == doctest::Approx(2).epsilon(0.1));
        previous = error;
        CHECK(point.asymmetry() <= 1e-12);
        check_books(run);
        MESSAGE("B2 h ", h, ": opens ", opens, ", u(7.5) - .5625 = ", at_7_5 - 0.5625, ", broken ", run.now.time, ", v ", point.v());
    }
}

namespace {

/// One opening of B3: when it starts, its peak, when it is over and with what impulse.
struct Opening {
    double opens = 0, peak_time = 0, peak = 0, beta = 0, closes = 0, impulse = 0;
};

/// B3 until it breaks. An opening is a time of at least 20 steps without a contact force; the last one has no close.
std::vector<Opening> openings_of_b3(Run& run, double h, double until) {
    const PointView point(run);
    std::vector<double> u{0}, beta{1}, contact{1};  // at the ends of the steps; impulse of the contact in the step
    while (run.now.time < until - 0.5 * h && point.beta() > 0) {
        take(run, h);
        u.push_back(point.u());
        contact.push_back((point.traction().x() + run.model.laws[0].sigma_c * 0.5 * (point.beta() + beta.back())) * h);
        beta.push_back(point.beta());
    }
    std::vector<Opening> found;
    const std::size_t n = u.size();
    for (std::size_t i = 1; i < n;) {
        std::size_t end = i;
        while (end < n && contact[end] <= 1e-6 * h) ++end;
        if (end - i < 20) {
            i = end + 1;
            continue;
        }
        Opening made{.opens = h * static_cast<double>(i - 1), .beta = beta[end - 1]};
        const std::size_t top = std::max_element(u.begin() + i, u.begin() + end) - u.begin();
        if (end < n) {  // a parabola through three values; steps i .. end - 1 are without contact
            const double curvature = u[top - 1] - 2 * u[top] + u[top + 1], slope = 0.5 * (u[top + 1] - u[top - 1]);
            made.peak_time = h * (static_cast<double>(top) - slope / curvature);
            made.peak = u[top] - 0.5 * slope * slope / curvature;
            made.closes = h * static_cast<double>(end - 1);
            for (std::size_t j = end; j < std::min(end + 3, n); ++j) made.impulse += contact[j];
            if (contact[end + 4] > 0) made.impulse -= 3 * contact[end + 4];  // it stays closed: what the force gives all the time
        }
        found.push_back(made);
        i = end;
    }
    return found;
}

const std::vector<Opening> b3_exact = {{.76397902, 1.84797937, .08621670, .91378330, 2.24515333, 1.15314369},
                                       {2.98973446, 4.18260980, .24905838, .75094162, 4.77443591, 1.64230760},
                                       {4.77443591, 6.09671180, .58911671, .41088329, 6.79589389, 2.73950736},
                                       {6.79589389, 0, 0, 0, 0, 0}};

ModelInput b3_body(double h) {
    const SpringBody body{.law = {.sigma_c = 1, .G_c = 0.5, .gamma = 1}, .mass = 2.5, .stiffness = 10};
    ModelInput input = spring_body(body);
    push(input, body.motion, sampled([](double t) { return 1.5 * std::exp(t / 4) * std::sin(M_PI * t); }, h, static_cast<int>(8.5 / h)));
    return input;
}

}  // namespace

TEST_CASE("B3 four openings and three impacts") {
    const double h = 2e-3;
    Run run(b3_body(h), implicit());
    const PointView point(run);
    const std::vector<Opening> found = openings_of_b3(run, h, 8);
    REQUIRE(found.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
        const Opening &is = found[i], &exact = b3_exact[i];
        CHECK(std::abs(is.opens - exact.opens) <= 2 * h);
        if (i == 3) continue;
        CHECK(std::abs(is.peak_time - exact.peak_time) <= 2 * h);
        CHECK(std::abs(is.peak - exact.peak) <= 2e-3);
        CHECK(std::abs(is.beta - exact.beta) <= 2e-3);
        CHECK(std::abs(is.closes - exact.closes) <= 2 * h);
        CHECK(is.impulse == relative(exact.impulse, 0.01));
        MESSAGE("B3 opening ", i + 1, ": opens ", is.opens - exact.opens, ", peak ", is.peak - exact.peak, " at ", is.peak_time - exact.peak_time, ", beta ",
                is.beta - exact.beta, ", closes ", is.closes - exact.closes, ", impulse ", is.impulse / exact.impulse - 1, " (errors)");
    }
    CHECK(std::abs(run.now.time - 7.64444233) <= 2 * h);
    CHECK(point.v() == doctest::Approx(2.02508544).epsilon(5e-3));
    CHECK(point.asymmetry() <= 1e-12);
    check_books(run);
}

TEST_CASE("B5 shear with an oscillating force") {
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    const SpringBody body{.law = law, .mass = 0.25, .stiffness = 4.5, .motion = Motion::slip};
    const double h = 1e-3;
    ModelInput input = spring_body(body);
    press(input, 5);
    push(input, body.motion, sampled([](double t) { return 0.375 * std::exp(t / 4) * std::sin(M_PI * t); }, h, 11000));
    Run run(input, implicit());
    const PointView point(run);
    // while it sticks the velocity of theta = 1/2 rings, so starts and stops are told by where it rests
    struct Rest {
        double time, u, beta;
    };
    const std::vector<Rest> exact = {{6.44, 0, 1}, {7.1, 0.148312, 0.851688}, {8.3, -0.903693, 0.096307}, {9.28, 0.254583, 0.096307}};
    std::vector<double> u, beta;
    double opens = 0, zero = 0, last = 0;
    while (point.beta() > 0) {
        REQUIRE(run.now.time < 11);
        take(run, h);
        if (u.size() < exact.size() && run.now.time >= exact[u.size()].time) u.push_back(point.u(Motion::slip)), beta.push_back(point.beta());
        if (opens == 0 && point.beta() < 1) opens = run.now.time;
        if (zero == 0 && last > 0 && point.u(Motion::slip) <= 0) zero = run.now.time;
        last = point.u(Motion::slip);
    }
    REQUIRE(u.size() == exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) {
        CHECK(std::abs(u[i] - exact[i].u) <= 5e-3);
        CHECK(std::abs(beta[i] - exact[i].beta) <= 5e-3);
    }
    CHECK(std::abs(opens - 6.447449) <= 2 * h);
    CHECK(std::abs(zero - 7.546911) <= 5 * h);
    CHECK(std::abs(run.now.time - 9.958122) <= 5 * h);
    MESSAGE("B5 errors of u at rest ", u[1] - exact[1].u, " ", u[2] - exact[2].u, " ", u[3] - exact[3].u, ", of beta ", beta[1] - exact[1].beta, " ", beta[2] - exact[2].beta,
            ", opens ", opens - 6.447449, ", through zero ", zero - 7.546911, ", broken ", run.now.time - 9.958122);
    CHECK(point.asymmetry() <= 1e-10);
    check_books(run);
}

TEST_CASE("B11 a bar falls and bounces twice") {
    // E = 900, rho = 1, L = 10, g = 10, gap 5 (c = 30): falls 1 s; waves run through the bar while it stands, which also weighs
    const int n = 100;
    const double L = 10, g = 10, height = 0.1;
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = symmetric_bar_mesh(n, L, height);
    input.materials = {{.density = 1, .E = 900, .nu = 0}};
    input.laws = {{.sigma_c = 0}, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1}};
    input.foundations = {{.on = {.boundary = "left", .box = {}}, .law = 0, .glued = false, .gap = 5}};
    input.loads = {load(Load::Kind::acceleration, "", -g, 0.0)};
    Run run(input, implicit());
    const double h = 1.0 / 600;
    const auto pressure = [&] { return std::max(0.0, 0.5 * (traction(run.model, run.now, run.model.n_points() - 2).x() + traction(run.model, run.now, run.model.n_points() - 1).x())); };
    const auto end = [&] { return 5 + run.u(3, 1).x(); };  // of triangle left in cell 0: {d, a, middle}; corner a
    double first = 0, last = 0, again = 0, over = 0, impulse[2] = {}, early[2] = {}, late[2] = {}, apex = 0;
    while (run.now.time < 5.5) {
        take(run, h);
        const double t = run.now.time, p = pressure();
        const int which = t < 2.5;
        impulse[1 - which] += p * h;
        if (p > 0 && t < 2.5) first = first == 0 ? t - h : first, last = t;
        if (p > 0 && t > 2.5) again = again == 0 ? t - h : again, over = t;
        // p rises from 300 to 500 on [1, 5/3] and falls back on [11/3, 13/3]: means of the first and last quarter
        const double from = t < 2.5 ? 1 : 11.0 / 3, s = (t - 0.5 * h - from) * 1.5;
        if (s > 0 && s < 0.25) early[1 - which] += p * h / (0.25 / 1.5);
        if (s > 0.75 && s < 1) late[1 - which] += p * h / (0.25 / 1.5);
        if (t > 4.5) apex = std::max(apex, end());
    }
    MESSAGE("B11 contact from ", first, " to ", last, " and from ", again, " to ", over, ", impulses ", impulse[0], " ", impulse[1], ", p ", early[0], " ", late[0], ", ",
            early[1], " ", late[1], ", apex ", apex);
    CHECK(std::abs(first - 1) <= 2 * h);
    CHECK(std::abs(last - 5.0 / 3) <= 5 * L / n / 30);  // waves are late by some elements
    CHECK(std::abs(again - 11.0 / 3) <= 0.01 * 11 / 3);
    CHECK(std::abs(over - 13.0 / 3) <= 0.01 * 13 / 3);
    CHECK(impulse[0] == doctest::Approx(400 * 2.0 / 3).epsilon(0.01));
    CHECK(impulse[1] == doctest::Approx(400 * 2.0 / 3).epsilon(0.02));
    CHECK(early[0] == doctest::Approx(325).epsilon(0.02));
    CHECK(late[0] == doctest::Approx(475).epsilon(0.02));
    CHECK(early[1] == doctest::Approx(475).epsilon(0.05));
    CHECK(late[1] == doctest::Approx(325).epsilon(0.05));
    CHECK(apex == doctest::Approx(5).epsilon(0.04));  // e = 0 takes the motion of the first layer at each impact
    check_books(run);
}

TEST_CASE("B15 an impacting stick gains nothing from friction") {
    // a stick of length 1 and mass 1 under 45 degrees stands with its foot near a rough floor (small rotations: the floor meets it in
    // its first position); it flies with (-.5, .1) and turns with .1, falls, and bounces with e = 1 and mu = .01
    const int n = 12;
    const double width = 0.02, s = std::sqrt(0.5);
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = bar_mesh(n, 1, 1, 1);
    for (Vec2& x : input.mesh.vertices) x = Vec2(s * x.x() + width * x.y(), s * x.x());  // the foot is the side "left", at y = 0
    input.materials = {{.density = 1 / (s * width), .E = 1e4 / width, .nu = 0.3}};
    input.laws = {{.sigma_c = 0, .friction = 0.01, .restitution = 1}, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1}};
    input.foundations = {{.on = {.boundary = "left", .box = {}}, .law = 0, .glued = false}};
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
    const Vec2 centre(0.5 * (s + width), 0.5 * s);
    Mesh turned = input.mesh;
    // a parallelogram counts its corners clockwise after the shear: turn every triangle round
    for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
    name_sides(turned, 1, 1);
    for (BoundaryEdge& edge : turned.boundary_edges)
        edge.boundary = 0.5 * (turned.corner(edge.triangle, edge.side) + turned.corner(edge.triangle, (edge.side + 1) % 3)).y() < 1e-9 ? 0 : 1;
    input.mesh = turned;
    for (Index t = 0; t < input.mesh.n_triangles(); ++t) {
        const Vec2 middle = (input.mesh.corner(t, 0) + input.mesh.corner(t, 1) + input.mesh.corner(t, 2)) / 3;
        input.initial_velocities.push_back({.on = {.boundary = "", .box = Box{middle - Vec2(1e-6, 1e-6), middle + Vec2(1e-6, 1e-6)}},
                                            .value = Vec2(-0.5, 0.1) + 0.1 * turned_left(middle - centre)});
    }
    Run run(input, implicit());
    CHECK(std::accumulate(run.model.corner_mass.begin(), run.model.corner_mass.end(), 0.0) == doctest::Approx(1));
    const double h = 1e-4;
    double friction = 0, impact = 0, first = 0;  // residual of the first step, which joins the corners of the foot
    int n_impacts = 0, n_steps = 0;
    bool touched = false;
    while (n_steps++ < 10000) {
        take(run, h);
        if (n_steps == 1) first = run.ledger.row().residual;
        friction = std::max(friction, run.last.worst_friction_work);
        impact = std::max(impact, run.last.worst_impact_work);
        const bool touches = run.last.friction_work < 0;
        n_impacts += touches && !touched;
        touched = touches;
    }
    const double scale = run.ledger.largest_energy();
    MESSAGE("B15 impacts ", n_impacts, ", friction work ", run.ledger.row().friction_work / scale, ", largest single friction ", friction / scale, ", impact ", impact / scale,
            ", impact work ", run.ledger.row().impact_work / scale);
    CHECK(n_impacts >= 2);
    CHECK(friction <= 0);
    CHECK(run.ledger.row().friction_work < 0);
    CHECK(std::abs(run.ledger.row().impact_work) <= 1e-12 * scale);  // e = 1
    CHECK(std::abs(run.ledger.row().residual - first) <= 1e-11 * scale);
    CHECK(run.ledger.worst().residual <= 1e-10);
}
