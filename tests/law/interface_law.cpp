// The law of one link as a staircase, against the formula it stands for.
#include "base/random.hpp"
#include "nonsmooth/link_state.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace interface_law_test {

using namespace knap;
using knap::tests::relative;
using knap::tests::within;

namespace {

FanLink link_with(double u_N, double u_T, double restitution = 0) {
    return {.before = 0,
            .after = 1,
            .normal = Vec2(1, 0),
            .u_N = u_N,
            .u_T = u_T,
            .cohesive = 2,
            .gamma = 0.5,
            .friction = 0.3,
            .restitution = restitution,
            .unbreakable = false};
}

double sign(double x) { return x > 0 ? 1 : -1; }

}  // namespace

TEST_CASE("the staircase of a link is its formula") {
    Random random(1, "link law");
    const double h = 0.1, p = 3;
    for (int count = 0; count < 200; ++count) {
        const FanLink link = link_with(0, random.uniform(-1, 1));
        const Vec2 before(random.uniform(-1, 1), random.uniform(-10, 10));
        const InterfaceLaw law = link_law(link, before, h, 1e-12);
        CHECK(law.staircase(true).n_states() == 7);
        CHECK(law.staircase(false).n_states() == 3);
        double last = -INFINITY;
        for (double v = -20.03; v < 20; v += 0.37) {  // -P_T grows with V_T
            const double cohesive = link.gamma * link.cohesive * sign(link.u_T + h * v);
            const double friction = link.friction * p * 0.5 * (sign(v) + sign(v + before.y()));
            const StaircasePiece closed = law.staircase(true).piece(law.staircase(true).state_of(v, 1e-12));
            const StaircasePiece open = law.staircase(false).piece(law.staircase(false).state_of(v, 1e-12));
            CHECK(!closed.stick);
            CHECK((closed.low < v && v < closed.high));
            CHECK(closed.offset + closed.contact_offset * p == within(cohesive + friction, 1e-12));
            CHECK(open.offset == within(cohesive, 1e-12));
            CHECK(open.contact_offset == 0);
            CHECK(closed.offset + closed.contact_offset * p >= last - 1e-12);
            last = closed.offset + closed.contact_offset * p;
        }
        // a kink joins the two adjacent steps
        for (int state = 1; state < 7; state += 2) {
            const StaircasePiece below = law.staircase(true).piece(state - 1), kink = law.staircase(true).piece(state),
                                 above = law.staircase(true).piece(state + 1);
            CHECK(kink.stick);
            CHECK(kink.kink == below.high);
            CHECK(kink.kink == above.low);
            CHECK(kink.offset - kink.jump == within(below.offset, 1e-12));
            CHECK(kink.offset + kink.jump == within(above.offset, 1e-12));
            CHECK(kink.contact_offset - kink.contact_jump == within(below.contact_offset, 1e-12));
            CHECK(kink.contact_offset + kink.contact_jump == within(above.contact_offset, 1e-12));
            CHECK(law.staircase(true).state_of(kink.kink, 1e-12) == state);
        }
    }
}

TEST_CASE("kinks that coincide are one and exact rest wins") {
    const double h = 0.1, near = 1e-9;
    const InterfaceLaw at_rest = link_law(link_with(0, 0), Vec2(0, 0), h, near);
    CHECK(at_rest.staircase(true).n_states() == 3);
    CHECK(at_rest.staircase(true).piece(1).jump == relative(1));            // gamma C
    CHECK(at_rest.staircase(true).piece(1).contact_jump == relative(0.3));  // mu
    const InterfaceLaw nearly = link_law(link_with(0, 0.5 * h * near), Vec2(0, 0.5 * near), h, near);
    CHECK(nearly.staircase(true).n_states() == 3);
    CHECK(nearly.staircase(true).piece(1).kink == 0);
    const InterfaceLaw sliding = link_law(link_with(0, 0), Vec2(0, 4), h, near);
    CHECK(sliding.staircase(true).n_states() == 5);
    CHECK(sliding.staircase(true).piece(1).kink == -4);  // the slip that would turn the motion round
    FanLink bare = link_with(0, 1);
    bare.cohesive = 0, bare.friction = 0;
    CHECK(link_law(bare, Vec2(1, 1), h, near).staircase(true).n_states() == 1);
}

TEST_CASE("the bound on the normal velocity never lets a contact add energy") {
    const double h = 0.1;
    const auto bound = [&](double u_N, double v_N, double e) {
        return link_law(link_with(u_N, 0, e), Vec2(v_N, 0), h, 1e-12).contact.rate;
    };
    CHECK(bound(0, -2, 0.5) == relative(1));
    CHECK(bound(-1, -2, 0) == 0);
    CHECK(bound(0.1, -2, 0) == relative(-1));  // the gap closes exactly
    CHECK(bound(0.1, 3, 0) == relative(-3));   // what separated is at most thrown back at its own speed
    CHECK(!link_law(link_with(0.1, 0, 0.5), Vec2(-2, 0), h, 1e-12).contact.may_touch);
    Random random(1, "bound");
    for (int i = 0; i < 1000; ++i) {
        const double v = random.uniform(-1, 1),
                     b = bound(random.uniform(-0.1, 0.1), v, random.uniform() < 0.5 ? 0 : random.uniform());
        CHECK(0.5 * (v + b) <= 0);  // p >= 0 works on the mean velocity
    }
}

}  // namespace interface_law_test
