// The implicit scheme on bodies with exact motions: two masses on a cohesive point (B2, B3, B5), a bouncing bar (B11),
// an impacting stick (B15). Times of events are found between steps.
#include "figures/chart.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"
#include "support/springs.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

namespace implicit_dynamics_test {

using namespace knap;
using namespace knap::tests;

namespace {

void check_energy_balance(const Run& run, double tolerance = 1e-12) {
    const double scale = run.ledger.largest_energy();
    CHECK(run.ledger.largest_residual() <= tolerance * scale);
    CHECK(run.ledger.worst().worst_friction_work <= 1e-14 * scale);
    CHECK(run.ledger.worst().worst_impact_work <= 1e-14 * scale);
    CHECK(run.ledger.worst().largest_beta_growth == 0);
    CHECK(run.ledger.worst().residual <= 1e-10);
}

void take(Run& run, double h) {
    run.step(h);
    REQUIRE_MESSAGE(run.last.rejection == Rejection::none, "rejected at the step after ", run.now.n_steps, " steps of ",
                    h);
}

}  // namespace

TEST_CASE("B2 statically ill-posed and dynamically regular") {
    describe(
        "Two masses of .25 with a spring k = .5 (the limit of snap-back), sigma_c = .5, delta_c = 1, e = 0; the second "
        "mass is driven by U = t/2, 1 - t/2, -2 + t/2 (kinks at t = 1, 3). It "
        "opens at t = 6, then u_1 = (t - 6)^3/6.");
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1};
    const SpringBody body{.law = law, .mass = 0.25, .stiffness = 0.5};
    const auto open = [&](const SchemeOptions& path, double h, double previous) {
        on_path(path);
        const bool is_explicit = path.bulk == BulkScheme::explicit_lumped;
        ModelInput input = spring_body(body);
        drive(input, body.motion, {{0, 1, 3, 8}, {0, 0.5, -0.5, 2}});
        Run run(input, path);
        const PointView point(run);
        const std::string at = ", h = " + digits(h);
        double worst_r = 0, worst_u = 0;
        while (run.now.time < 5.99) {
            take(run, h);
            const double t = run.now.time - (is_explicit ? 1 : 0.5) * h,
                         U = t < 1   ? t / 2
                             : t < 3 ? 1 - t / 2
                                     : -2 + t / 2;  // forces are those of the begin, or means over the step
            const bool kink = std::abs(t - 1) < h || std::abs(t - 3) < h;
            if (!kink) worst_r = std::max(worst_r, std::abs(point.traction().x() + 0.5 * U));
            worst_u = std::max(worst_u, std::abs(point.u()));
        }
        double opens = 0, at_7_5 = 0;
        while (point.beta() > 0) {
            take(run, h);
            if (opens == 0 && point.u() > 0)
                opens =
                    run.now.time - (is_explicit ? h : 0);  // central differences apply forces at the start of a step
            if (std::abs(run.now.time - 7.5) < 0.1 * h) at_7_5 = point.u();
            REQUIRE(run.now.time < 9);
        }
        verify_small("error of the force before it opens, worst of all steps" + at, worst_r, {1e-12});
        CHECK(worst_u == 0);
        verify_near("opens, within a step" + at, opens, 6, {h * (1 + 1e-9), h * (1 + 1e-9)});
        verify_near("broken, within a step" + at, run.now.time, 7.81712059, {h, h});
        verify_near("v_1 when broken" + at, point.v(), 1.65096362, {2 * h, h});
        const double error = std::abs(at_7_5 - 0.5625);
        verify_near("u_1(7.5)" + at, at_7_5, 0.5625, {h < 3e-3 ? 1e-5 : 2e-4});
        if (previous > 0) verify_near("order of u_1(7.5)" + at, std::log2(previous / error), 2, {0.2, 0.05});
        CHECK(point.asymmetry() <= 1e-12);
        check_energy_balance(run);
        return error;
    };
    for (const SchemeOptions& path : both_paths()) {
        double previous = 0;
        for (const double h : {1e-2, 5e-3, 2.5e-3}) previous = open(path, h, previous);
    }
}

namespace {

/// One opening of B3: when it starts, its peak, when it is over and with what impulse.
struct Opening {
    double opens = 0, peak_time = 0, peak = 0, beta = 0, closes = 0, impulse = 0;
};

/// B3 until it breaks. An opening is a time of at least 20 steps without a contact force; the last one has no close.
std::vector<Opening> openings_of_b3(
    Run& run, double h, double until, const std::function<void()>& look = [] {}) {
    const PointView point(run);
    std::vector<double> u{0}, beta{1}, contact{1};  // at the ends of the steps; impulse of the contact in the step
    while (run.now.time < until - 0.5 * h && point.beta() > 0) {
        take(run, h);
        look();
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
            if (contact[end + 4] > 0)
                made.impulse -= 3 * contact[end + 4];  // it stays closed: what the force gives all the time
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
    push(input, body.motion,
         sampled([](double t) { return 1.5 * std::exp(t / 4) * std::sin(M_PI * t); }, h, static_cast<int>(8.5 / h)));
    return input;
}

/// Numbers in mm, g and ms to numbers in SI.
ModelInput in_si(ModelInput input) {
    const double length = 1e-3, mass = 1e-3, time = 1e-3, pressure = mass / (length * time * time);
    for (Vec2& x : input.mesh.vertices) x *= length;
    input.thickness *= length;
    for (Elastic& material : input.materials)
        material.density *= mass / (length * length * length), material.E *= pressure;
    input.laws[0].sigma_c *= pressure, input.laws[0].G_c *= pressure * length;
    for (Load& each : input.loads) {
        if (each.on.box) each.on.box->low *= length, each.on.box->high *= length;
        for (auto& value : each.value)
            if (value) *value *= each.kind == Load::Kind::traction ? pressure : length;
        for (double& t : each.history.time) t *= time;
    }
    return input;
}

}  // namespace

TEST_CASE("B3 four openings and three impacts") {
    describe(
        "Masses 2.5 and 2.5 with a spring k = 10, sigma_c = delta_c = 1, e = 0, the force 1.5 exp(t/4) sin(pi t) on "
        "the outer mass; theta = 1/2, h = 2e-3. Reference: the event-driven "
        "solution.");
    on_path(both_implicit);
    const double h = 2e-3;
    Run run(b3_body(h), implicit());
    const PointView point(run);
    std::vector<double> time, opened, beta;
    const std::vector<Opening> found = openings_of_b3(
        run, h, 8, [&] { time.push_back(run.now.time), opened.push_back(point.u()), beta.push_back(point.beta()); });
    REQUIRE(found.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
        const Opening &is = found[i], &exact = b3_exact[i];
        const std::string at = ", opening " + std::to_string(i + 1);
        verify_near("opens" + at, is.opens, exact.opens, {2 * h, h});
        if (i == 3) continue;
        verify_near("time of the peak" + at, is.peak_time, exact.peak_time, {2 * h});
        verify_near("u_1 at the peak" + at, is.peak, exact.peak, {2e-3});
        verify_near("beta after the peak" + at, is.beta, exact.beta, {2e-3});
        verify_near("impact" + at, is.closes, exact.closes, {2 * h, h});
        verify("impulse of the impact" + at, is.impulse, exact.impulse, {0.01});
    }
    verify_near("broken", run.now.time, 7.64444233, {2 * h, h});
    verify_near("v_1 when broken", point.v(), 2.02508544, {5e-3});
    verify_small("energy residual", run.ledger.largest_residual() / run.ledger.largest_energy(), {1e-12});
    if (const auto file = picture("B3.png")) {
        Chart chart{.title = "B3: opening and cohesion",
                    .x_quantity = "time",
                    .x_unit = "s",
                    .y_quantity = "u_{1}, beta",
                    .y_unit = ""};
        chart.curves = {{"opening", time, opened, curve_colour(0)}, {"beta", time, beta, curve_colour(1)}};
        draw_chart(chart, *file, 640);
    }
    CHECK(point.asymmetry() <= 1e-12);
    check_energy_balance(run);
}

TEST_CASE("E20 B3 has the same events in SI and in mm and g and ms") {
    const double h = 2e-3;
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        Run in_mm(b3_body(h), path), in_m(in_si(b3_body(h)), path);
        const PointView a(in_mm), b(in_m);
        double worst_u = 0, worst_beta = 0;
        bool same_events = true;
        while (in_mm.now.time < 8 && a.beta() > 0) {
            take(in_mm, h);
            take(in_m, 1e-3 * h);
            worst_u = std::max(worst_u, std::abs(a.u() - 1e3 * b.u()));
            worst_beta = std::max(worst_beta, std::abs(a.beta() - b.beta()));
            same_events = same_events && (in_mm.last.softened == in_m.last.softened) && (a.u() == 0) == (b.u() == 0);
        }
        verify_that("the same steps soften, open and close", same_events);
        verify_small("largest difference of u_1 over delta_c", worst_u, {1e-10});
        verify_small("largest difference of beta", worst_beta, {1e-10});
    }
}

TEST_CASE("B5 shear with an oscillating force") {
    describe(
        "Masses of .25, k = 4.5, pressure 5, mu = .5, gamma = 1, sigma_c = .5, delta_c = 1, a force .375 exp(t/4) "
        "sin(pi t): it slips forth, back, and forth until it breaks; h = 1e-3. "
        "Reference: the event-driven solution.");
    const CohesiveLaw law{.sigma_c = 0.5, .G_c = 0.25, .gamma = 1, .friction = 0.5};
    const SpringBody body{.law = law, .mass = 0.25, .stiffness = 4.5, .motion = SpringMotion::slip};
    const double h = 1e-3;
    ModelInput input = spring_body(body);
    press(input, 5);
    push(input, body.motion, sampled([](double t) { return 0.375 * std::exp(t / 4) * std::sin(M_PI * t); }, h, 11000));
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        Run run(input, path);
        const PointView point(run);
        // while it sticks the velocity of theta = 1/2 rings, so starts and stops are told by where it rests
        struct Rest {
            double time, u, beta;
        };
        const std::vector<Rest> exact = {
            {6.44, 0, 1}, {7.1, 0.148312, 0.851688}, {8.3, -0.903693, 0.096307}, {9.28, 0.254583, 0.096307}};
        std::vector<double> u, beta;
        double opens = 0, zero = 0, last = 0;
        while (point.beta() > 0) {
            REQUIRE(run.now.time < 11);
            take(run, h);
            if (u.size() < exact.size() && run.now.time >= exact[u.size()].time)
                u.push_back(point.u(SpringMotion::slip)), beta.push_back(point.beta());
            if (opens == 0 && point.beta() < 1) opens = run.now.time;
            if (zero == 0 && last > 0 && point.u(SpringMotion::slip) <= 0) zero = run.now.time;
            last = point.u(SpringMotion::slip);
        }
        REQUIRE(u.size() == exact.size());
        for (std::size_t i = 0; i < exact.size(); ++i) {
            verify_near("u at rest " + std::to_string(i + 1), u[i], exact[i].u, {5e-3});
            verify_near("beta at rest " + std::to_string(i + 1), beta[i], exact[i].beta, {5e-3});
        }
        verify_near("first slip", opens, 6.447449, {2 * h, h});
        verify_near("back through u = 0", zero, 7.546911, {5 * h, h});
        verify_near("broken", run.now.time, 9.958122, {5 * h, h});
        CHECK(point.asymmetry() <= 1e-10);
        check_energy_balance(run);
    }
}

TEST_CASE("B11 a bar falls and bounces twice") {
    // E = 900, rho = 1, L = 10, g = 10, gap 5 (c = 30): falls 1 s; waves run through the bar while it stands, which
    // also weighs
    describe(
        "A bar, E = 900, rho = 1, L = 10, g = 10, falls by 5: contact on [1, 5/3] with 300 -> 500, rises to its height "
        "at 5 - with waves in it - and is in contact again on [11/3, 13/3] with "
        "500 -> 300; apex 5 at 16/3. 100 elements.");
    on_path(both_implicit);
    const int n = 100;
    const double L = 10, g = 10, height = 0.1;
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = symmetric_bar_mesh(n, L, height);
    input.materials = {{.density = 1, .E = 900, .nu = 0}};
    input.laws = {{.sigma_c = 0}, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1}};
    input.supports = {{.on = {.boundary = "left", .box = {}}, .law = 0, .glued = false, .gap = 5}};
    input.loads = {load(Load::Kind::acceleration, "", -g, 0.0)};
    Run run(input, implicit());
    const double h = 1.0 / 600;
    const auto pressure = [&] {
        return std::max(0.0, 0.5 * (traction(run.model, run.now, run.model.n_points() - 2).x() +
                                    traction(run.model, run.now, run.model.n_points() - 1).x()));
    };
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
    verify_near("first contact begins", first, 1, {2 * h, h});
    verify_near("first contact ends (waves are late by some elements)", last, 5.0 / 3, {5 * L / n / 30, L / n / 30});
    verify("second contact begins", again, 11.0 / 3, {0.01});
    verify("second contact ends", over, 13.0 / 3, {0.01});
    verify("impulse of the first contact", impulse[0], 400 * 2.0 / 3, {0.01});
    verify("impulse of the second contact", impulse[1], 400 * 2.0 / 3, {0.02});
    verify("pressure in the first quarter of the first contact", early[0], 325, {0.02});
    verify("in its last quarter", late[0], 475, {0.02});
    verify("pressure in the first quarter of the second contact", early[1], 475, {0.05});
    verify("in its last quarter, second contact", late[1], 325, {0.05});
    verify("apex (e = 0 takes the motion of the first layer at each impact)", apex, 5, {0.04});
    check_energy_balance(run);
}

TEST_CASE("B15 an impacting stick gains nothing from friction") {
    // a stick of length 1 and mass 1 under 45 degrees stands with its foot near a rough floor (small rotations: the
    // floor meets it in its first position); it flies with (-.5, .1) and turns with .1, falls, and bounces with e = 1
    // and mu = .01
    describe(
        "A rod of length 1 and mass 1 at 45 degrees flies with (-.5, .1) and turns with .1 onto a rough floor, g = 10, "
        "e = 1, mu = .01, h = 1e-4 or the stable step: friction in an impact takes energy, always.");
    const int n = 12;
    const double width = 0.02, s = std::sqrt(0.5);
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = bar_mesh(n, 1, 1, 1);
    for (Vec2& x : input.mesh.vertices)
        x = Vec2(s * x.x() + width * x.y(), s * x.x());  // the foot is the side "left", at y = 0
    input.materials = {{.density = 1 / (s * width), .E = 1e4 / width, .nu = 0.3}};
    input.laws = {{.sigma_c = 0, .friction = 0.01, .restitution = 1}, CohesiveLaw::unbreakable()};
    input.law_of_pair = {{1}};
    input.supports = {{.on = {.boundary = "left", .box = {}}, .law = 0, .glued = false}};
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
    const Vec2 centre(0.5 * (s + width), 0.5 * s);
    Mesh turned = input.mesh;
    // a parallelogram counts its corners clockwise after the shear: turn every triangle round
    for (auto& triangle : turned.triangles) std::swap(triangle[1], triangle[2]);
    name_sides(turned, 1, 1);
    for (BoundaryEdge& edge : turned.boundary_edges)
        edge.boundary =
            0.5 * (turned.corner(edge.triangle, edge.side) + turned.corner(edge.triangle, (edge.side + 1) % 3)).y() <
                    1e-9
                ? 0
                : 1;
    input.mesh = turned;
    for (Index t = 0; t < input.mesh.n_triangles(); ++t) {
        const Vec2 middle = (input.mesh.corner(t, 0) + input.mesh.corner(t, 1) + input.mesh.corner(t, 2)) / 3;
        input.initial_velocities.push_back(
            {.on = {.boundary = "", .box = Box{middle - Vec2(1e-6, 1e-6), middle + Vec2(1e-6, 1e-6)}},
             .value = Vec2(-0.5, 0.1) + 0.1 * turned_left(middle - centre)});
    }
    for (const SchemeOptions& path : both_paths()) {
        on_path(path);
        Run run(input, path);
        CHECK(std::accumulate(run.model.corner_mass.begin(), run.model.corner_mass.end(), 0.0) == relative(1));
        const double h =
            path.bulk == BulkScheme::explicit_lumped ? std::min(1e-4, 0.8 * run.stepper.stable_step()) : 1e-4;
        double friction = 0, impact = 0, first = 0;  // residual of the first step, which joins the corners of the foot
        int n_impacts = 0, n_steps = 0;
        bool touched = false;
        while (n_steps++ < 1 / h) {
            take(run, h);
            if (n_steps == 1) first = run.ledger.row().residual;
            friction = std::max(friction, run.last.worst_friction_work);
            impact = std::max(impact, run.last.worst_impact_work);
            const bool touches = run.last.friction_work < 0;
            n_impacts += touches && !touched;
            touched = touches;
        }
        const double scale = run.ledger.largest_energy();
        verify_at_least("impacts in 1 s", n_impacts, 2);
        verify_at_most("largest friction work of a step", friction, 0);
        verify_at_most("largest impact work of a step over the energy", impact / scale, 1e-14);
        CHECK(run.ledger.row().friction_work < 0);
        verify_small("impact work of all, e = 1, over the energy", run.ledger.row().impact_work / scale, {1e-12});
        CHECK(std::abs(run.ledger.row().residual - first) <= 1e-11 * scale);
        CHECK(run.ledger.worst().residual <= 1e-10);
    }
}

}  // namespace implicit_dynamics_test
