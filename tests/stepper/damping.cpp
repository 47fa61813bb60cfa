// Mass-proportional damping of the explicit bulk: its decay, its order, and its work in the energy balance.
#include "properties/wild_body.hpp"
#include "support/obstacles.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace damping_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double alpha = 0.2;  // [1/s]

/// A triangle on two fixed vertices. Its third one, of mass 1, moves in x against a stiffness of 1: omega = 1.
ModelInput oscillator() {
    ModelInput input = point_masses({}, false);
    input.supports.clear();
    input.materials = {{.density = 3, .E = 2, .nu = 0}};  // mu = 1; the shear angle is u
    input.loads = {load(Load::Kind::displacement, "base", 0.0, 0.0)};
    Load guide{.kind = Load::Kind::displacement, .on = {.boundary = "", .box = Box{{0.5, 0.5}, {1.5, 1.5}}}};
    guide.value[1] = 0.0;
    input.loads.push_back(guide);
    return input;
}

/// With absorbing boundaries, too: the largest error of the energy balance so far, over the largest energy or work.
class Balance {
public:
    void add(const StepReport& r) {
        const double energy = r.kinetic + r.strain;
        damping_ += r.damping_work, radiated_ += r.radiated_work;
        work_ += r.external_work - r.cohesive_work + r.impact_work + r.friction_work + r.step_change_work +
                 r.rotation_work + r.damping_work + r.radiated_work;
        largest_ = std::max({largest_, energy, std::abs(r.external_work), -damping_, std::abs(r.cohesive_work)});
        error_ = std::max(error_, std::abs(energy - start_ - work_));
        CHECK(r.damping_work <= 0);
        CHECK(r.radiated_work <= 0);
    }
    explicit Balance(double start) : start_(start), largest_(start) {}
    double error() const { return largest_ > 0 ? error_ / largest_ : 0; }
    double damping() const { return damping_; }

private:
    double start_, largest_, work_ = 0, damping_ = 0, radiated_ = 0, error_ = 0;
};

}  // namespace

TEST_CASE("damping: a free oscillation decays by half of it and to second order") {
    const auto error_at = [](double h) {
        Run run(oscillator(), {.damping = alpha});
        const Index apex = run.now.node_of_corner[2];
        run.now.velocity[apex].x() = 1;
        Balance balance(0.5);
        const double until = 10, omega = std::sqrt(1 - 0.25 * alpha * alpha);
        for (int i = 0; i < std::lround(until / h); ++i) balance.add(run.step(h));
        CHECK(balance.error() < 1e-13);
        CHECK(balance.damping() < -0.4);
        return run.now.displacement[apex].x() - std::exp(-0.5 * alpha * until) * std::sin(omega * until) / omega;
    };
    const double coarse = error_at(0.1), fine = error_at(0.05), finest = error_at(0.025);
    CHECK(coarse / fine == doctest::Approx(4).epsilon(0.02));
    CHECK(fine / finest == doctest::Approx(4).epsilon(0.005));
    CHECK(std::abs(finest) < 2e-4);
}

TEST_CASE("damping: a free disc falls as its discrete equation says and its energy is accounted for") {
    ModelInput input = free_block(1, {});
    input.obstacles = {boulder({5, 5}, 1, {0.5, 0})};
    input.obstacles[0].initial_velocity.z() = 2;
    input.loads = {load(Load::Kind::acceleration, "", 0.0, -10.0)};
    Run run(input, {.damping = alpha});
    const double h = 1e-3, start = 0.5 * 0.25 + 0.5 * 0.5 * 4;  // inertia m r^2/2
    Balance balance(start);
    for (int i = 0; i < 1000; ++i) balance.add(run.step(h));
    const double t = 999.5 * h, fall = std::exp(-alpha * t);  // velocities live at the middle of the steps
    const Vec3& v = run.now.obstacles[0].velocity;
    CHECK(v.x() == doctest::Approx(0.5 * fall).epsilon(1e-6));
    CHECK(v.y() == doctest::Approx(-10 / alpha * (1 - fall)).epsilon(1e-6));
    CHECK(v.z() == doctest::Approx(2 * fall).epsilon(1e-6));
    CHECK(run.mean_velocity([](Index) { return true; }).y() == doctest::Approx(v.y()).epsilon(1e-12));
    CHECK(balance.error() < 1e-13);
}

TEST_CASE("damping: random bodies with cracks and friction and obstacles close their energy balance") {
    int n = 0, n_broken = 0, n_absorbing = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        WildBody wild = WildBodies(seed).body();
        if (wild.body.scheme.bulk != BulkScheme::explicit_lumped || !wild.body.input.obstacles.empty() != (seed % 2))
            continue;
        const double h = wild.safety * Run(wild.body.input, wild.body.scheme).stepper.stable_step();
        wild.body.scheme.damping = 0.1 * static_cast<double>(1 + seed % 7) / h;  // up to a half of the motion in a step
        if (const auto& loads = wild.body.input.loads;
            wild.body.input.supports.empty() && seed % 3 != 0 && std::ranges::none_of(loads, &Load::drives))
            wild.body.scheme.absorbing = {{.boundary = "right"}}, ++n_absorbing;
        Run run(wild.body.input, wild.body.scheme);
        Balance balance(run.ledger.row().kinetic + run.ledger.row().strain);
        bool taken = true;
        for (int i = 0; i < wild.n_steps && taken; ++i) {
            taken = run.step_if_taken(i % 3 ? h : 0.6 * h);
            if (taken) balance.add(run.last);
        }
        INFO("seed " << seed);
        CHECK(balance.error() < 1e-12);
        for (const PointState& point : run.now.points) n_broken += point.cohesion == 0;
        ++n;
    }
    CHECK(n > 50);
    CHECK(n_absorbing > 5);
    CHECK(n_broken > 100);
}

}  // namespace damping_test
