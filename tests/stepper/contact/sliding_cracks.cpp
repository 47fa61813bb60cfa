// Closed cracks that slide: general contact leaves them alone until their points retire, and takes them over smoothly.
#include "stepper/contact/retirement.hpp"
#include "support/several_bodies.hpp"
#include "support/sheared_joint.hpp"

#include <doctest/doctest.h>

namespace sliding_cracks_test {

using namespace knap;
using namespace knap::tests;

namespace {

ModelInput sheared(double from, double to, bool rough, double shear, bool contact) {
    return sheared_joint({.from = from, .to = to, .rough = rough, .shear = shear, .contact = contact});
}

/// [-] Of the broken points, over their edge: the largest.
double largest_slip(const Run& run) {
    double most = 0;
    for (const FanPoint& point : run.model.fan_points) {
        if (!point.cracked) continue;
        const Vec2 jump = run.now.displacement_of(point.after) - run.now.displacement_of(point.before);
        most = std::max(most, jump.norm() / (2 * point.area));
    }
    return most;
}

/// [m] Largest distance of the same corner in two runs.
double apart(const Run& a, const Run& b) {
    double most = 0;
    for (Index c = 0; c < a.model.mesh.n_corners(); ++c)
        most = std::max(most, (a.now.displacement_of(c) - b.now.displacement_of(c)).norm());
    return most;
}

}  // namespace

// Afterwards vertices press on faces at places that have moved by the slip, of 0.03 edges at the end: the same forces,
// spread over other nodes. Found: 0.3 % of the slip, and 1.4 % (straight) and 2 % (rough) where the joint goes through.
TEST_CASE("a crack that slides inside a body moves to the bit as without contact until its points retire") {
    // the shear beyond friction, 1.9e-3 E, makes a crack of length 6 slip by some 4 x 3 x 1.9e-3 = 0.02 edges
    for (const bool rough : {false, true}) {
        CAPTURE(rough);
        Run with(sheared(3, 9, rough, 2.5e-3 * joint_E, true)), without(sheared(3, 9, rough, 2.5e-3 * joint_E, false));
        const double h = 0.8 * with.stepper.stable_step();
        double slip = 0, off = 0;
        int n_sliding = 0;
        while (with.now.time < 3) {
            const double before = slip;
            REQUIRE(with.step(h).rejection == Rejection::none);
            without.step(h);
            slip = std::max(slip, largest_slip(with));
            n_sliding += slip > before;
            if (slip < inner_retirement_slip) REQUIRE(same_bits(with.now, without.now));
            off = std::max(off, apart(with, without));
        }
        CAPTURE(slip);
        CHECK(std::ranges::count(with.now.retired, Retirement::retired) == 10);  // all but the ends
        CHECK(off < 0.01 * slip);
        CHECK(slip > 3 * retirement_slip);  // on the surface such points had retired long ago
        CHECK(n_sliding > 100);
    }
}

TEST_CASE("a joint through a body slides with contact as without while it is handed over") {
    for (const bool rough : {false, true}) {
        CAPTURE(rough);
        Run with(sheared(0, 12, rough, 0.7e-3 * joint_E, true)),
            without(sheared(0, 12, rough, 0.7e-3 * joint_E, false));
        const double h = 0.8 * with.stepper.stable_step();
        double slip = 0, off = 0;
        while (with.now.time < 6 && slip < 0.1) {
            REQUIRE(with.step(h).rejection == Rejection::none);
            without.step(h);
            slip = largest_slip(without);
            off = std::max(off, apart(with, without));
        }
        CAPTURE(slip);
        CHECK(slip > 3 * inner_retirement_slip);
        CHECK(std::ranges::count(with.now.retired, Retirement::retired) == 24);
        CHECK(off < 0.04 * slip);
        CHECK(with.ledger.worst().contact_depth < 1e-3);
    }
}

}  // namespace sliding_cracks_test
