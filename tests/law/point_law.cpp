// The law of one point over an implicit step: its derivative against differences of the law, and its ramp.
#include "law/point_law.hpp"

#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace point_law_test {

using namespace knap;
using knap::tests::relative;

namespace {

const CohesiveLaw material{.sigma_c = 2, .G_c = 1, .gamma = 0.7, .friction = 0.4};  // delta_c = 1

const FrictionOverPressure bent({{0, 0}, {2, 1.6}, {5, 2.8}, {9, 3.2}});

struct Point {
    ThetaStep step;
    PointLaw law;
    Multipliers at;
    Vec2 rate;

    PointResponse response(const Vec2& w) const { return respond(law, at, w.x(), w.y()); }
    Vec2 impulse(const PointResponse& r) const { return {r.normal(law), r.tangential}; }
    Vec2 impulse(const Vec2& w) const { return impulse(response(w)); }
    /// [m/s] At which the law holds these impulses, beyond what the springs of the multipliers give.
    Vec2 rate_of_law(const PointResponse& r) const {
        return rate + Vec2(law.contact.may_touch ? (r.held(law) - at.contact) / at.rho_N : 0,
                           (r.tangential - at.tangential) / at.rho_T);
    }
};

/// A damaged point anywhere near the corner of its law; `step` of the result belongs to it, so it must not be moved.
void make_random(Random& random, Point& point, bool over_pressure = false) {
    point.step = {.h = 0.3, .theta = random.uniform(0.5, 1), .implicit_beta = true};
    const double cohesion = random.uniform(0.2, 1), s = (1 - cohesion) * material.delta_c();
    const double u_T = random.uniform(-1, 1) * s / material.gamma;
    point.law = {.u_N = random.uniform(0, 1) * (s - material.gamma * std::abs(u_T)),
                 .u_T = u_T,
                 .strength = point.step.kick() * material.sigma_c,
                 .cohesion = cohesion,
                 .material = &material,
                 .friction = random.uniform(0, 1) < 0.3 ? 0 : material.friction,
                 .contact = {.may_touch = random.uniform(0, 1) < 0.9, .rate = random.uniform(-1, 0)},
                 .step = &point.step};
    if (over_pressure) point.law.pressed = {&bent, 0.1}, point.law.friction = 0.8;
    point.law.set_staircase();
    point.at = {.contact = random.uniform(0, 1),
                .tangential = random.uniform(-1, 1),
                .rho_N = random.uniform(0.5, 2),
                .rho_T = random.uniform(0.5, 2),
                .friction_follows = random.uniform(0, 1) < 0.7,
                .pressed = random.uniform(0, 1)};
    point.rate = Vec2(random.uniform(-2, 2), random.uniform(-4, 4));
}

/// Likewise, with secant unloading; kappa is that of beta, or down to a millionth of it.
void make_random_on_ramp(Random& random, Point& point) {
    make_random(random, point);
    point.law.ramp = (1 - point.law.cohesion) * material.delta_c() * std::pow(10, -random.uniform(0, 6));
    const double s = random.uniform(0, 1) < 0.3 ? 1 : random.uniform(0, 1);
    point.law.u_T = random.uniform(-1, 1) * s * point.law.ramp / material.gamma;
    point.law.u_N = s * point.law.ramp - material.gamma * std::abs(point.law.u_T);
    point.law.contact.rate = -point.law.u_N / point.step.h;
    if (random.uniform(0, 1) < 0.5) {  // it lands too fast to be stopped, or overlaps
        point.law.u_N -= random.uniform(0, 1) * point.law.ramp;
        point.law.contact.rate = -(std::abs(point.law.u_N) + random.uniform(0, 2) * point.law.ramp) / point.step.kick();
    }
    point.at.contact = random.uniform(0, 1) * point.law.strength * point.law.cohesion;
    point.law.set_staircase();
}

/// Likewise, with vertical unloading; half of them at their largest opening.
void make_random_below(Random& random, Point& point) {
    make_random_on_ramp(random, point);
    PointLaw& law = point.law;
    law.drops = true;
    const double s = material.equivalent_opening(law.u_N, law.u_T);
    if (random.uniform(0, 1) < 0.5) law.ramp = s;
    law.below = std::min(0.0, s - law.ramp);
    law.set_staircase();
}

}  // namespace

TEST_CASE("the tangent of a point is the derivative of its law and that of friction over pressure") {
    Random random(5, "point law");
    const double e = 1e-6;  // of rates of order one: the law is linear in each of its pieces
    int n_coupled = 0, n_left_out = 0, n_stick = 0, n_open = 0;
    for (int count = 0; count < 6000; ++count) {
        Point point;
        make_random(random, point, count >= 4000);
        const PointResponse here = point.response(point.rate);
        Eigen::Matrix2d differences;
        bool one_piece = true;
        for (int k = 0; k < 2; ++k) {
            const Vec2 d = k == 0 ? Vec2(e, 0) : Vec2(0, e);
            for (const double sign : {-1.0, 1.0})
                one_piece = one_piece && point.response(point.rate + sign * d).state == here.state;
            differences.col(k) = (point.impulse(point.rate - d) - point.impulse(point.rate + d)) / (2 * e);
        }
        // the augmented rate decides the sign of the force, the rate itself the way: at a solution both agree
        const double u_T = point.law.u_T + point.step.h * point.rate.y();
        const double pressed = point.at.friction_follows ? here.contact : point.at.pressed,
                     bound = point.law.rubbing(pressed) * here.friction_sign +
                             material.gamma * point.law.strength * here.cohesion_theta * here.cohesion_sign;
        // a point that would stick with the cohesion of one place and slides with that of another is between two pieces
        const bool slides = here.cohesion_sign * u_T >= 0 && std::abs(here.tangential + bound) <= 1e-12;
        if (!one_piece || !(here.sticks || slides)) continue;
        const Eigen::Matrix2d D = tangent(point.law, point.at, here, Softening::now);
        const bool slides_and_softens = here.softens && !here.sticks && (here.closed || !here.opens),
                   rubs = here.closed && point.law.friction > 0 && point.at.friction_follows;
        CAPTURE(count);
        if (slides_and_softens && !rubs) {
            // tension is lost without opening, so the law has no potential; without friction the matrix stays symmetric
            CHECK(std::abs(differences(0, 1)) > 0.01 * material.gamma);
            CHECK(D(0, 1) == 0);
            differences(0, 1) = 0;
            ++n_left_out;
        }
        CHECK((D - differences).cwiseAbs().maxCoeff() <= 1e-8);  // rounding of the law over e is 1e-10
        n_coupled += slides_and_softens && rubs;
        n_stick += here.sticks;
        n_open += here.softens && !here.closed;
    }
    for (const int n : {n_coupled, n_left_out, n_stick, n_open}) CHECK(n > 50);
}

TEST_CASE("without friction the tangent of the norm is symmetric to the bit so that it is no friction to iterate for") {
    CohesiveLaw norm = material;
    norm.coupling = Coupling::norm;
    Random random(7, "norm");
    int n_coupled = 0, n_soften = 0;
    for (int count = 0; count < 2000; ++count) {
        Point point;
        make_random(random, point);
        point.law.material = &norm, point.law.friction = 0;
        const PointResponse here = point.response(point.rate);
        const Eigen::Matrix2d D = tangent(point.law, point.at, here, Softening::now);
        CHECK(D(0, 1) == D(1, 0));
        n_coupled += D(0, 1) != 0;
        n_soften += D(0, 1) != 0 && here.softens;
    }
    for (const int n : {n_coupled, n_soften}) CHECK(n > 200);
}

TEST_CASE("a point of the norm that floats between overlap and contact bears no pressure and holds its slip") {
    CohesiveLaw norm = material;
    norm.coupling = Coupling::norm;
    Random random(8, "floating");
    for (int count = 0; count < 100; ++count) {
        Point point;
        make_random(random, point);
        point.law.material = &norm, point.law.u_N = point.law.u_T = 0;
        point.law.contact = {.may_touch = true, .rate = -1};
        const double full = point.law.strength * point.law.cohesion;
        point.at = {
            .contact = full, .tangential = 0.5 * full * norm.gamma * random.uniform(-1, 1), .rho_N = 1, .rho_T = 1};
        point.rate = {random.uniform(-0.9, -0.1), 0.4 * full * norm.gamma * random.uniform(-1, 1)};
        const PointResponse here = point.response(point.rate);
        CHECK(!here.closed);
        CHECK(here.sticks);
        CHECK(here.normal(point.law) == 0);
        CHECK(here.tangential == relative(point.at.tangential - point.rate.y()));
        const Eigen::Matrix2d D = tangent(point.law, point.at, here, Softening::now);
        CHECK((D - Eigen::Matrix2d(Vec2(0, 1).asDiagonal())).isZero(0));
    }
}

TEST_CASE("the tangent of a ramp is the derivative of its law") {
    Random random(6, "ramps");
    int n_on_ramp = 0, n_stick = 0, n_closed = 0, n_land = 0, n_soften = 0, n_rub = 0;
    for (int count = 0; count < 4000; ++count) {
        Point point;
        make_random_on_ramp(random, point);
        const double e = 1e-3 * point.law.ramp;
        const PointResponse here = point.response(point.rate);
        Eigen::Matrix2d differences;
        bool one_piece = true;
        for (int k = 0; k < 2; ++k) {
            const Vec2 d = e * Vec2::Unit(k);
            const PointResponse before = point.response(point.rate - d), after = point.response(point.rate + d);
            one_piece = one_piece && before.state == here.state && after.state == here.state;
            differences.col(k) = (point.impulse(before) - point.impulse(after)) / (2 * e);
        }
        if (!one_piece) continue;
        const Eigen::Matrix2d D = tangent(point.law, point.at, here, Softening::now);
        CAPTURE(count);
        // of a softening ramp the law is a product, whose curvature the differences miss by their length
        CHECK((D - differences).cwiseAbs().maxCoeff() <= (here.softens ? 2e-3 : 1e-13 / e + 1e-8));
        const bool rubs = here.closed && !here.sticks && point.law.friction > 0 && point.at.friction_follows;
        // openings of the end and of the middle of the step, which decide how beta falls and where it acts
        const bool one_sign =
            !here.softens || (here.end_sign == here.cohesion_sign && here.opens == here.opens_on_ramp);
        if (!rubs && one_sign) CHECK(D(0, 1) == D(1, 0));
        n_on_ramp += here.on_ramp, n_stick += here.sticks, n_closed += here.closed, n_soften += here.softens;
        n_rub += rubs, n_land += here.lands;
    }
    for (const int n : {n_on_ramp, n_stick, n_closed, n_land, n_soften, n_rub}) CHECK(n > 50);
}

TEST_CASE("a ramp is no stiffer than the springs of its multipliers and obeys its law at the rates they leave") {
    Random random(7, "ramps");
    int n_on_ramp = 0, n_reversed = 0;
    for (int count = 0; count < 4000; ++count) {
        Point point;
        make_random_on_ramp(random, point);
        point.step.implicit_beta = false;
        const PointLaw& law = point.law;
        const Multipliers& at = point.at;
        const PointResponse r = point.response(point.rate);
        const Vec2 q = point.impulse(r), omega = point.rate_of_law(r);
        CAPTURE(count);
        // beta min(s/kappa, 1) in the middle of the step
        const double kick = point.step.kick(),
                     s = material.equivalent_opening(law.u_N + kick * omega.x(), law.u_T + kick * omega.y());
        CHECK(std::abs(r.cohesion_theta * law.ramp - law.cohesion * std::min(s, law.ramp)) <= 1e-12);
        CHECK(r.contact >= 0);
        if (law.u_N + kick * omega.x() < -1e-9) CHECK(r.normal(law) == r.contact);  // no cohesion pulls an overlap
        if (law.contact.may_touch) CHECK(omega.x() >= law.contact.rate - 1e-12);
        // a fixed point on springs of any stiffness
        Multipliers there = at;
        there.contact = r.held(law), there.tangential = q.y();
        for (const double rho : {1e-3, 1.0, 1e3}) {
            there.rho_N = there.rho_T = rho;
            const PointResponse again = respond(law, there, omega.x(), omega.y());
            CHECK((point.impulse(again) - q).norm() <= 1e-9);
        }
        // no jump, over a way that is a hundred times the ramp, too
        const Vec2 d =
            law.ramp * std::pow(10, random.uniform(-2, 2)) / kick * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
        const PointResponse moved = point.response(point.rate + d);
        if (law.contact.may_touch && (law.friction == 0 || !at.friction_follows))
            CHECK((point.impulse(moved) - q).norm() <= 1.01 * std::max(at.rho_N, at.rho_T) * d.norm() + 1e-12);
        n_on_ramp += r.on_ramp, n_reversed += r.cohesion_sign * moved.cohesion_sign < 0;
    }
    CHECK(n_on_ramp > 50);
    CHECK(n_reversed > 20);
}

TEST_CASE("a point at its largest opening bears what its rates ask for up to its cohesion") {
    Random random(8, "drops");
    int n_held = 0, n_beyond = 0, n_below = 0, n_differences = 0;
    for (int count = 0; count < 4000; ++count) {
        Point point;
        make_random_below(random, point);
        point.step.implicit_beta = count % 2;
        const PointLaw& law = point.law;
        const Multipliers& at = point.at;
        const PointResponse r = point.response(point.rate);
        const Vec2 q = point.impulse(r), omega = point.rate_of_law(r);
        CAPTURE(count);
        const double h = point.step.h, full = law.strength * r.full_cohesion, c = law.strength * r.cohesion_theta,
                     beyond = material.equivalent_opening(law.u_N + h * omega.x(), law.u_T + h * omega.y()) - law.ramp;
        CHECK(c >= 0);
        CHECK(c <= full * (1 + 1e-12));
        if (beyond > 1e-9) CHECK(c == relative(full, 1e-9));
        if (beyond < -1e-9) CHECK(c == 0);
        if (r.on_ramp) CHECK(std::abs(beyond) <= 1e-9);
        Multipliers there = at;  // a fixed point on springs of any stiffness
        there.contact = r.held(law), there.tangential = q.y();
        for (const double rho : {1e-3, 1.0, 1e3}) {
            if (point.step.implicit_beta && rho < 1) continue;  // softer than its softening
            there.rho_N = there.rho_T = rho;
            CHECK((point.impulse(respond(law, there, omega.x(), omega.y())) - q).norm() <= 1e-9);
        }
        n_held += r.on_ramp, n_beyond += beyond > 1e-9, n_below += beyond < -1e-9;
        const double e = 1e-6;
        Eigen::Matrix2d differences;
        bool one_piece = !point.step.implicit_beta;
        for (int k = 0; k < 2; ++k) {
            const Vec2 d = e * Vec2::Unit(k);
            const PointResponse before = point.response(point.rate - d), after = point.response(point.rate + d);
            one_piece = one_piece && before.state == r.state && after.state == r.state;
            differences.col(k) = (point.impulse(before) - point.impulse(after)) / (2 * e);
        }
        if (!one_piece) continue;
        const Eigen::Matrix2d D = tangent(law, at, r, Softening::now);
        CAPTURE(D);
        CAPTURE(differences);
        CAPTURE(r.state);
        CHECK((D - differences).cwiseAbs().maxCoeff() <= 1e-8);
        n_differences += r.on_ramp;
    }
    for (const int n : {n_held, n_beyond, n_below, n_differences}) CHECK(n > 50);
}

}  // namespace point_law_test
