// The law of one link as a staircase, against the formula it stands for.
#include "base/random.hpp"
#include "interfaces/link_law.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace knap;

namespace {

FanLink link_with(double u_N, double u_T, double restitution = 0) {
    return {.before = 0, .after = 1, .normal = Vec2(1, 0), .u_N = u_N, .u_T = u_T, .cohesive = 2, .gamma = 0.5, .friction = 0.3,
            .restitution = restitution, .unbreakable = false};
}

double sign(double x) { return x > 0 ? 1 : -1; }

}  // namespace

TEST_CASE("the staircase of a link is its formula") {
    Random random(1, "link law");
    const double h = 0.1, p = 3;
    for (int count = 0; count < 200; ++count) {
        const FanLink link = link_with(0, random.uniform(-1, 1));
        const Vec2 before(random.uniform(-1, 1), random.uniform(-10, 10));
        const LinkLaw law(link, before, h, 1e-12);
        CHECK(law.n_states(true) == 7);
        CHECK(law.n_states(false) == 3);
        double last = -INFINITY;
        for (double v = -20.03; v < 20; v += 0.37) {  // -P_T grows with V_T
            const double cohesive = link.gamma * link.cohesive * sign(link.u_T + h * v);
            const double friction = link.friction * p * 0.5 * (sign(v) + sign(v + before.y()));
            const TangentialLaw closed = law.tangential(true, law.state_of(true, v, 1e-12));
            const TangentialLaw open = law.tangential(false, law.state_of(false, v, 1e-12));
            CHECK(!closed.stick);
            CHECK((closed.low < v && v < closed.high));
            CHECK(closed.at + closed.contact * p == doctest::Approx(cohesive + friction).scale(1));
            CHECK(open.at == doctest::Approx(cohesive).scale(1));
            CHECK(open.contact == 0);
            CHECK(closed.at + closed.contact * p >= last - 1e-12);
            last = closed.at + closed.contact * p;
        }
        // a kink joins the steps beside it
        for (int state = 1; state < 7; state += 2) {
            const TangentialLaw below = law.tangential(true, state - 1), kink = law.tangential(true, state), above = law.tangential(true, state + 1);
            CHECK(kink.stick);
            CHECK(kink.velocity == below.high);
            CHECK(kink.velocity == above.low);
            CHECK(kink.at - kink.play == doctest::Approx(below.at).scale(1));
            CHECK(kink.at + kink.play == doctest::Approx(above.at).scale(1));
            CHECK(kink.contact - kink.contact_play == doctest::Approx(below.contact).scale(1));
            CHECK(kink.contact + kink.contact_play == doctest::Approx(above.contact).scale(1));
            CHECK(law.state_of(true, kink.velocity, 1e-12) == state);
        }
    }
}

TEST_CASE("kinks that coincide are one and exact rest wins") {
    const double h = 0.1, near = 1e-9;
    const LinkLaw at_rest(link_with(0, 0), Vec2(0, 0), h, near);
    CHECK(at_rest.n_states(true) == 3);
    CHECK(at_rest.tangential(true, 1).play == doctest::Approx(1));              // gamma C
    CHECK(at_rest.tangential(true, 1).contact_play == doctest::Approx(0.3));    // mu
    const LinkLaw nearly(link_with(0, 0.5 * h * near), Vec2(0, 0.5 * near), h, near);
    CHECK(nearly.n_states(true) == 3);
    CHECK(nearly.tangential(true, 1).velocity == 0);
    const LinkLaw sliding(link_with(0, 0), Vec2(0, 4), h, near);
    CHECK(sliding.n_states(true) == 5);
    CHECK(sliding.tangential(true, 1).velocity == -4);  // the slip that would turn the motion round
    FanLink bare = link_with(0, 1);
    bare.cohesive = 0, bare.friction = 0;
    CHECK(LinkLaw(bare, Vec2(1, 1), h, near).n_states(true) == 1);
}

TEST_CASE("the bound on the normal velocity never lets a contact give energy") {
    const double h = 0.1;
    const auto bound = [&](double u_N, double v_N, double e) { return LinkLaw(link_with(u_N, 0, e), Vec2(v_N, 0), h, 1e-12).bound(); };
    CHECK(bound(0, -2, 0.5) == doctest::Approx(1));
    CHECK(bound(-1, -2, 0) == 0);
    CHECK(bound(0.1, -2, 0) == doctest::Approx(-1));  // the gap closes exactly
    CHECK(bound(0.1, 3, 0) == doctest::Approx(-3));   // what separated is at most thrown back at its own speed
    CHECK(!LinkLaw(link_with(0.1, 0, 0.5), Vec2(-2, 0), h, 1e-12).may_touch());
    Random random(1, "bound");
    for (int i = 0; i < 1000; ++i) {
        const double v = random.uniform(-1, 1), b = bound(random.uniform(-0.1, 0.1), v, random.uniform() < 0.5 ? 0 : random.uniform());
        CHECK(0.5 * (v + b) <= 0);  // p >= 0 works on the mean velocity
    }
}
