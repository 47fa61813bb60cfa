// The norm law of a point: its projection obeys it whatever the weight, its slope is the derivative, its domain at rest
// is the half ellipse with Coulomb's lines.
#include "law/norm_law.hpp"

#include "base/random.hpp"
#include "law/self_stress.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace norm_law_test {

using namespace knap;
using knap::tests::relative;

namespace {

NormLaw random_norm_law(Random& random, bool friction) {
    NormLaw law;
    const auto some = [&](double most) { return random.uniform(0, most); };
    law.cohesive = random.uniform() < 0.8 ? some(2) : 0;
    law.gamma = 0.3 + some(2);
    law.contact = {random.uniform() < 0.8, random.uniform(-0.5, 0.1)};
    if (friction) add_friction_explicit(some(1), random.uniform(-1, 1), 0, law.sliding);
    if (random.uniform() < 0.7) law.shift = {random.uniform(-0.1, 1), random.uniform(-1, 1)};
    if (random.uniform() < 0.4) law.ramp = 0.1 + some(1), law.start = some(law.ramp);
    return law;
}

}  // namespace

TEST_CASE("the norm law holds for what its projection gives with any weight") {
    Random random(1, "norm law");
    int n_stuck = 0, n_closed = 0, n_open = 0;
    for (int k = 0; k < 20000; ++k) {
        CAPTURE(k);
        const NormLaw law = random_norm_law(random, true);
        const double r = std::pow(10, random.uniform(-2, 2));
        const Vec2 Q(random.uniform(-3, 3), random.uniform(-3, 3));
        const NormLaw::Response found = law.respond(Q, r);
        const Vec2 P = found.at.impulse, V = (P - Q) / r, W = V + law.shift;
        const double unit = 1e-11 * (1 + r + Q.norm());
        // with another weight the same rate has the same impulse
        for (const double other : {0.1 * r, 30 * r})
            CHECK((law.project(P - other * V, other).impulse - P).norm() < unit * (1 + other / r));
        const double S = law.size(W), pull = -found.cohesion.x(), p = P.x() + pull;
        if (law.contact.may_touch) {
            CHECK(V.x() > law.contact.rate - 1e-11 * (1 + 1 / r) * (1 + Q.norm()));
            if (V.x() > law.contact.rate + 1e-9 * (1 + 1 / r)) CHECK(std::abs(p) < unit);
        }
        CHECK(p > -unit);
        if (found.sticks && !found.closed) {
            ++n_stuck;
            CHECK(P.x() <= 0);
            CHECK(std::hypot(P.x(), P.y() / law.gamma) <= law.cohesive + unit);
        }
        n_closed += found.closed;
        if (found.closed || S < 1e-3 || law.ramp > 0) continue;
        ++n_open;
        const Vec2 expected = -law.cohesive / S * Vec2(std::max(W.x(), 0.0), law.gamma * law.gamma * W.y());
        CHECK((P - expected).norm() < unit * (1 + 1 / r));
    }
    CHECK(n_stuck > 300);
    CHECK(n_closed > 1000);
    CHECK(n_open > 1000);
}

TEST_CASE("the slope of the norm law is the derivative of its projection") {
    Random random(2, "norm law");
    int n_checked = 0;
    for (int k = 0; k < 5000; ++k) {
        CAPTURE(k);
        const NormLaw law = random_norm_law(random, true);
        const double r = std::pow(10, random.uniform(-1, 1)), d = 1e-6;
        const Vec2 Q(random.uniform(-3, 3), random.uniform(-3, 3));
        Eigen::Matrix2d one, other;
        for (int c = 0; c < 2; ++c) {
            const Vec2 step = d * Vec2::Unit(c), P = law.project(Q, r).impulse;
            one.col(c) = (law.project(Q + step, r).impulse - P) / d;
            other.col(c) = (P - law.project(Q - step, r).impulse) / d;
        }
        if ((one - other).norm() > 1e-4) continue;  // at a kink, or near zero opening
        ++n_checked;
        CHECK((law.project(Q, r).slope - 0.5 * (one + other)).norm() < 1e-4);
    }
    CHECK(n_checked > 4000);
}

TEST_CASE("on a ramp the norm law does the work of the change of its energy along one direction and never less") {
    Random random(3, "norm law");
    for (int k = 0; k < 2000; ++k) {
        NormLaw law;
        const bool straight = k % 2 == 0;
        law.cohesive = 1, law.gamma = straight ? 1 : 0.5 + random.uniform(), law.ramp = 1;
        const Vec2 from = random.uniform() * Vec2(1, 0.3), to = straight
                                                                    ? Vec2(random.uniform(0, 2) * Vec2(1, 0.3))
                                                                    : Vec2(random.uniform(0, 2), random.uniform(-1, 1));
        if (law.size(from) > 1) continue;
        law.start = law.size(from);
        const Vec2 P = law.project(-1e3 * to, 1e3).impulse,  // a weight so large that W is nearly `to`
            W = to + P / 1e3;
        const double work = -P.dot(W - from), stored = CohesiveLaw::stored_opening(1, law.size(W)) -
                                                       CohesiveLaw::stored_opening(1, law.size(from));
        if (straight) CHECK(work == relative(stored, 1e-9));
        else CHECK(work > stored - 1e-12);
    }
}

TEST_CASE("the strength of an intact point of the norm is a half ellipse and Coulomb's lines") {
    const CohesiveLaw law{.sigma_c = 2, .G_c = 1, .gamma = 1.5, .friction = 0.7, .coupling = Coupling::norm};
    const Vec2 N = Vec2(1, 2).normalized(), T = turned_left(N);
    const StrengthPolygon domain = StrengthPolygon::at_rest(law, N, 2, 1);
    const auto slack = [&](double along_N, double along_T) { return domain.smallest_slack(along_N * N + along_T * T); };
    for (const double angle : {0.0, 0.4, 1.0, 1.5}) {
        const double n = -2 * std::cos(angle), t = 3 * std::sin(angle);
        CHECK(std::abs(slack(n, t)) < 1e-12);
        CHECK(slack(0.99 * n, -0.99 * t) > 0);
        // its chords lie inside it and no farther than half of a percent
        for (const double scale : {0.99, 1.001}) {
            std::vector<HalfPlane> planes;
            StrengthPolygon free_of_friction = domain;
            free_of_friction.contact_jump = 0;
            free_of_friction.add_half_planes(0, scale * (n * N + t * T), Vec2::Ones(), planes);
            double least = infinity;
            for (const HalfPlane& plane : planes) least = std::min(least, plane.value);
            CHECK((least >= 0) == (scale < 1));
        }
    }
    CHECK(std::abs(slack(1, 3 + 0.7)) < 1e-12);
    CHECK(slack(1, 3.8) < 0);
    CHECK(CohesiveLaw(law).shear_strength() == 1.5);
}

}  // namespace norm_law_test
