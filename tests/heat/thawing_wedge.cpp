// A wedge of rock on a joint whose ice is warmed, against the limit equilibrium of one block (H26).
#include "heat_bodies.hpp"
#include "mesh/triangulate.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace thawing_wedge_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double height = 20, density = 2600, g = 9.81, friction = 0.5, sigma_c = 80e3, delta_c = 10e-3;  // SI
constexpr double warming = 0.1;                                                                           // [K/s]

// Cohesion of ice in rock joints, exp(-0.13 (T + 10)): the table of the scenario thawing_joint.
const TemperatureTable phi{.temperature = {-10, -8, -6, -5, -4, -3, -2, -1.5, -1, -0.5},
                           .value = {1, 0.7711, 0.5945, 0.5220, 0.4584, 0.4025, 0.3535, 0.3312, 0.3104, 0.2908}};

struct Slope {
    double face, joint;  // [degrees] dip
    double p() const { return joint * M_PI / 180; }
    double length() const { return height / std::sin(p()); }
    /// [N/m] 1/2 rho g H^2 (cot p - cot f).
    double weight() const {
        return 0.5 * density * g * height * height * (1 / std::tan(p()) - 1 / std::tan(face * M_PI / 180));
    }
    /// [N/m] What the cohesion must bear: W (sin p - friction cos p).
    double drive() const { return weight() * (std::sin(p()) - friction * std::cos(p())); }
    /// Limit equilibrium: c = phi (gamma + friction) sigma_c over the whole joint, gamma = 1.
    double needed_phi() const { return drive() / ((1 + friction) * sigma_c * length()); }
    /// [C] At which phi has fallen to it.
    double failure() const {
        double cold = -10, warm = -0.5;
        for (int i = 0; i < 60; ++i) (phi(0.5 * (cold + warm)) > needed_phi() ? cold : warm) = 0.5 * (cold + warm);
        return cold;
    }
};

/// The wedge alone on a rigid joint, ten times as stiff as rock (elastic slips of rock make phi larger by 0.0006). It is
/// warmed from `start` degrees on, and its weight grows during the first second.
ModelInput wedge(const Slope& slope, double start) {
    Shape shape;
    const double along = height / std::tan(slope.p());
    shape.outer = {.points = {{0, 0}, {along, height}, {height / std::tan(slope.face * M_PI / 180), height}},
                   .boundary = {0, 1, 1}};
    shape.boundary_names = {"joint", "free"};
    Heat heat = field(digits(start, 12) + " + 0.1*t", {0});
    heat.every = 1;
    ModelInput input = heated(triangulate(shape, {.size = 6}), heat, {.density = density, .E = 5e11, .nu = 0.25},
                              CohesiveLaw::unbreakable(), PlaneModel::strain);
    CohesiveLaw ice{.sigma_c = sigma_c, .G_c = 0.5 * sigma_c * delta_c, .gamma = 1, .friction = friction};
    ice.of_temperature = std::make_shared<StrengthOfTemperature>(StrengthOfTemperature{phi, {}});
    input.laws.push_back(ice);
    input.supports = {{.on = {.boundary = "joint", .box = {}}, .law = 1, .glued = true}};
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -g, {.time = {0, 1}, .value = {0, 1}})};
    return input;
}

}  // namespace

// Slip along the joint: it is that of a rigid block, m s'' = W (sin p - friction cos p) - c(T) L (1 - s/delta_c), which
// rests until c(T) L has fallen to the drive.
TEST_CASE("H26 a wedge on a joint that thaws slides at its limit equilibrium") {
    describe(
        "A wedge of E = 500 GPa, 20 m high, on a joint of ice (80 kPa, gamma = 1, friction 0.5, delta_c = 10 mm) whose "
        "strength falls as exp(-0.13 (T + 10)), warmed by 0.1 K/s, implicit steps of 10 ms: phi at which its slip "
        "begins (at a thousandth of delta_c, less the time that a rigid block takes to it) against the limit "
        "equilibrium W (sin p - friction cos p) = phi (gamma + friction) sigma_c L, and the time from there until the "
        "joint is broken against the motion of a rigid block. Dips of face and joint in degrees.");
    on_path(both_implicit);
    for (const Slope& slope : {Slope{70, 45}, {70, 50}, {67, 45}, {68, 50}}) {
        const double needed = slope.needed_phi(), start = slope.failure() - 0.3, h = 0.01;
        // the rigid block, from the equilibrium on
        const double mass = slope.weight() / g;
        double s = 0, v = 0, t = 0, slips = 0;
        const auto force = [&](double at, double time) {
            return (slope.drive() - phi(slope.failure() + warming * time) * (1 + friction) * sigma_c * slope.length() *
                                        std::max(0.0, 1 - at / delta_c)) /
                   mass;
        };
        for (constexpr double dt = 1e-4; s < delta_c; t += dt) {
            const double middle = v + 0.5 * dt * force(s, t);
            v += dt * force(s + 0.5 * dt * v, t + 0.5 * dt), s += dt * middle;
            if (slips == 0 && s > 1e-3 * delta_c) slips = t;
        }
        Run run(wedge(slope, start), both_implicit);
        const auto slip = [&] {  // least of all points
            double least = infinity;
            for (Index p = 0; p < run.model.n_points(); ++p)
                if (run.model.laws[run.model.fan_points[run.model.fan_point_of[p]].law].breakable())
                    least = std::min(least, std::abs(opening(run.model, run.now, p).y()));
            return least;
        };
        double begins = 0;
        while (slip() < delta_c) {
            for (double part = h; !run.step_if_taken(part); part *= 0.5) REQUIRE(part > 1e-3);  // some while it slides
            REQUIRE(run.now.time < 5);
            if (begins == 0 && slip() > 1e-3 * delta_c) begins = run.now.time;
        }
        const std::string of = ", " + digits(slope.face) + " and " + digits(slope.joint);
        verify("phi at which it slides" + of, phi(start + warming * (begins - slips)), needed, {3e-4, 1e-4});
        verify_near("time from a thousandth of delta_c to the break [s]" + of, run.now.time - begins, t - slips,
                    {h, 0.5 * h});
        CHECK(run.ledger.largest_residual() < 1e-11 * run.ledger.largest_energy());
    }
}

TEST_CASE("H26 a wedge that its joint holds at every temperature stands") {
    const Slope slope{65, 50};
    REQUIRE(slope.needed_phi() < phi(-0.5));
    Run run(wedge(slope, -1), both_implicit);
    while (run.now.time < 8) REQUIRE(run.step(0.02).rejection == Rejection::none);  // to -0.2 C: phi stays
    double largest = 0;
    for (Index p = 0; p < run.model.n_points(); ++p) largest = std::max(largest, opening(run.model, run.now, p).norm());
    CHECK(largest < 3e-4 * delta_c);  // elastic; a slide begins at 1e-3 in the case above
}

}  // namespace thawing_wedge_test
