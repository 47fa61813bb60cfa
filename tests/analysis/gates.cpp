// Gates of a run: three levels, limits set by a scenario, warnings that come once.
#include "analysis/gates.hpp"
#include "analysis/deformation_watch.hpp"

#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

namespace gates_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double none = std::numeric_limits<double>::infinity();

const Gate& named(const Gates& gates, std::string_view name) {
    return *std::find_if(gates.begin(), gates.end(), [&](const Gate& gate) { return gate.name == name; });
}

}  // namespace

TEST_CASE("gates: every rule has a name of its own and a meaning and a cure") {
    std::set<std::string_view> names;
    for (const GateRule& rule : gate_rules()) {
        CAPTURE(rule.name);
        CHECK(names.insert(rule.name).second);
        CHECK_FALSE(rule.meaning.empty());
        CHECK_FALSE(rule.cure.empty());
    }
}

TEST_CASE("gates: a limit of the scenario replaces that of a gate which allows it") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    const State start = initial_state(model);
    EnergyLedger ledger(model, start);
    ledger.add(start, {.kinetic = 1, .external_work = 1, .residual = 2e-10, .penetration = 0.5});
    Gates gates;
    judge({ledger, 0.25, 1}, {}, gates);
    CHECK(named(gates, "penetration").limit == 0.25);
    CHECK(named(gates, "penetration").level == GateLevel::violated);
    CHECK(named(gates, "interface_residual").level == GateLevel::violated);

    const std::vector<AllowedLimit> more{{"penetration", 0.5}, {"interface_residual", none}};
    judge({ledger, 0.25, 1}, more, gates);
    CHECK(named(gates, "penetration").level == GateLevel::ok);  // at its limit
    CHECK(named(gates, "interface_residual").limit == 1e-10);   // the laws are kept in every scene
    judge({ledger, 0.25, 1}, std::vector<AllowedLimit>{{"penetration", none}}, gates);
    CHECK(named(gates, "penetration").pass());
}

TEST_CASE("gates: the law lag is a signed part of the dissipated energy without an alarm at the first softened point") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    State implicit = initial_state(model);
    implicit.rate.assign(implicit.velocity.size(), Vec2::Zero());
    const State of_explicit = initial_state(model);
    Gates gates;
    const auto level = [&](const EnergyLedger& ledger, std::span<const AllowedLimit> allowed = {}) {
        judge({ledger, 1, 1}, allowed, gates);
        return named(gates, "law_lag").level;
    };

    EnergyLedger first(
        model, of_explicit);  // explicit bulk: its work is that of half the step, so far, and nothing is dissipated
    first.add(of_explicit,
              {.kinetic = 1, .dissipated = 1e-6, .recoverable = 2e-3, .external_work = 1, .cohesive_work = 1.01e-3});
    CHECK(first.row().law_lag == relative(-0.991e-3, 1e-12));
    CHECK(std::abs(first.law_lag()) < 0.01);
    CHECK(level(first) == GateLevel::ok);

    EnergyLedger broken(model, implicit);
    broken.add(implicit, {.kinetic = 1,
                          .dissipated = 0.5,
                          .external_work = 1,
                          .cohesive_work = 0.45,
                          .largest_drop = 0.1,
                          .drop_corner = 1});
    CHECK(broken.law_lag() == relative(-0.1, 1e-12));
    CHECK(level(broken) == GateLevel::warning);
    CHECK(level(broken, std::vector<AllowedLimit>{{"law_lag", 0.05}}) == GateLevel::violated);
    broken.add(implicit, {.kinetic = 1, .dissipated = 0.5, .largest_drop = 0.05, .drop_corner = 2});
    const DeformationWatch watch(model);
    judge({broken, 1, 1, false, &watch}, {}, gates);
    CHECK(named(gates, "law_lag").place == model.mesh.corner(1));  // where a step missed most
    broken.add(implicit, {.kinetic = 1, .dissipated = 0.5, .cohesive_work = 0.15});
    CHECK(broken.law_lag() == relative(0.2, 1e-12));
    broken.add(implicit, {.kinetic = 1, .dissipated = 0.5, .cohesive_work = 0.05});
    CHECK(level(broken) == GateLevel::violated);
    broken.add(implicit, {.kinetic = 1, .dissipated = 0.5, .cohesive_work = -0.15});
    CHECK(broken.law_lag() == within(0, 1e-12));
    CHECK(broken.largest_law_lag() == relative(0.3, 1e-12));
    CHECK(level(broken) == GateLevel::violated);  // it was
    CHECK(level(broken, std::vector<AllowedLimit>{{"law_lag", none}}) == GateLevel::warning);
}

TEST_CASE("gates: numerical losses above 5 percent of the dissipated energy give a warning at the end") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    const State now = initial_state(model);
    EnergyLedger ledger(model, now), elastic(model, now);
    ledger.add(now, {.kinetic = 1,
                     .dissipated = 0.5,
                     .external_work = 2,
                     .cohesive_work = 0.54,
                     .crossing_loss = 0.04,
                     .thaw_dissipation = 0.01,
                     .scheme_dissipation = 0.02});
    elastic.add(now, {.kinetic = 1, .external_work = 2, .scheme_dissipation = 1});
    Gates gates;
    for (const bool ended : {false, true}) {
        judge({ledger, 1, 1, ended}, {}, gates);
        CHECK(named(gates, "crossing_loss").level == (ended ? GateLevel::warning : GateLevel::ok));
        CHECK(named(gates, "missed_blow").level == (ended ? GateLevel::warning : GateLevel::ok));
        CHECK(named(gates, "scheme_dissipation_part").level == GateLevel::ok);
        judge({elastic, 1, 1, ended}, {}, gates);
        CHECK(named(gates, "scheme_dissipation_part").level == GateLevel::ok);  // no crack to compare with
    }
    judge({ledger, 1, 1, true}, {}, gates);
    CHECK(named(gates, "crossing_loss").value == relative(0.08, 1e-12));
    CHECK(named(gates, "lost_part").value == relative(0.03, 1e-12));  // of the energy supplied
    CHECK(named(gates, "lost_part").level == GateLevel::ok);
    // together with what a change of the step took
    ledger.add(now, {.kinetic = 1, .dissipated = 0.5, .external_work = 0, .step_change_work = -0.05});
    for (const bool ended : {false, true}) {
        judge({ledger, 1, 1, ended}, {}, gates);
        CHECK(named(gates, "lost_part").level == (ended ? GateLevel::warning : GateLevel::ok));
    }
    CHECK(named(gates, "lost_part").value == relative(0.055, 1e-12));
}

TEST_CASE("gates: every step may round the energy a little more") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    const State start = initial_state(model);
    EnergyLedger ledger(model, start);
    const StepReport rest;
    for (int i = 0; i < 1 << 16; ++i) ledger.add(start, rest);
    Gates gates;
    judge({ledger, 1, 1}, {}, gates);
    CHECK(named(gates, "energy_residual").limit == relative(1e-10 + std::ldexp(1.0, 16 - 51), 1e-15));
}

// The free plate of alumina that warms by 1000 K in 1 ms: 5946 J if it were held against 0.28 J, a residual of 3.8e-11 J after 25 351 steps.
TEST_CASE("gates: free thermal strains round the energy by their own scale") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    State warm = initial_state(model);
    const auto temperatures = std::make_shared<Temperatures>();
    temperatures->free_energy = 5946;
    warm.temperature = temperatures;
    EnergyLedger ledger(model, initial_state(model)), cold(model, initial_state(model));
    ledger.add(warm, {.kinetic = 0.28, .thermal_work = 0.28 - 4e-11});
    cold.add(initial_state(model), {.kinetic = 0.28, .external_work = 0.28 - 4e-11});
    for (int i = 0; i < 1 << 14; ++i) {
        ledger.add(warm, {.kinetic = 0.28});
        cold.add(initial_state(model), {.kinetic = 0.28});
    }
    Gates gates;
    judge({ledger, 1, 1}, {}, gates);
    CHECK(named(gates, "energy_residual").limit ==
          relative(1e-10 + std::ldexp((1 << 14) + 1, -51) * (1 + 5946 / 0.28), 1e-12));
    CHECK(named(gates, "energy_residual").pass());
    judge({cold, 1, 1}, {}, gates);
    CHECK_FALSE(named(gates, "energy_residual").pass());
}

TEST_CASE("gates: inertia of heat that runs too fast warns at the end") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    const State now = initial_state(model);
    EnergyLedger warmed(model, now), pulled(model, now);
    warmed.add(now, {.kinetic = 0.1, .strain = 1, .external_work = 0.1, .thermal_work = 1});
    pulled.add(now, {.kinetic = 0.1, .strain = 1, .external_work = 1, .thermal_work = 0.1});
    Gates gates;
    const auto level = [&](const EnergyLedger& ledger, double part) {
        judge({ledger, 1, 1, true, nullptr, part}, {}, gates);
        return named(gates, "kinetic_part").level;
    };
    CHECK(level(warmed, 0.009) == GateLevel::ok);
    CHECK(level(warmed, 0.011) == GateLevel::warning);
    CHECK(level(warmed, std::nan("")) == GateLevel::ok);  // not the end, or no strain energy
    CHECK(level(pulled, 0.5) == GateLevel::ok);           // loads may be dynamic
}

TEST_CASE("gates: the speed limit is that of the lightest corner with ten times the supplied energy") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));  // three masses of 1
    const State start = initial_state(model);
    const auto level = [&](double speed, double work) {
        EnergyLedger ledger(model, start);
        ledger.add(start, {.kinetic = 0.5 * speed * speed,
                           .strain = work - 0.5 * speed * speed,
                           .external_work = work,
                           .largest_speed = speed});
        Gates gates;
        judge({ledger, 1, 1}, {}, gates);
        CHECK(named(gates, "energy_residual").pass());  // an unstable leapfrog keeps its identity: what grows is
                                                        // kinetic energy against negative strain energy
        return named(gates, "largest_speed").level;
    };
    CHECK(level(std::sqrt(2), 1) == GateLevel::ok);  // all of it in one mass, as after the first step of a point load
    CHECK(level(4.4, 1) == GateLevel::ok);
    CHECK(level(4.5, 1) == GateLevel::violated);  // sqrt 20
    CHECK(level(0, 0) == GateLevel::ok);
}

TEST_CASE("gates: the rounding of a body that only moves is no residual and a real one is") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    Model stiff = model;
    stiff.materials[0].E = 30e9;
    State moved = initial_state(stiff);
    for (Vec2& u : moved.displacement) u = {2e-4, 0};
    moved.last_step = 1;
    DeformationWatch watch(stiff);
    watch.look_at(moved);
    CHECK(watch.rounding_energy(2e-4) == relative(std::ldexp(30e9 * 16e-8, -50), 1e-12));
    EnergyLedger ledger(stiff, initial_state(stiff));
    ledger.add(moved, {.strain = 1.1e-13, .external_work = 1e-13, .worst_impact_work = 1e-15, .largest_speed = 2e-4});
    Gates gates;
    const auto level = [&](const char* gate) { return named(gates, gate).level; };
    judge({ledger, 1, 1, false, &watch}, {}, gates);
    CHECK(level("energy_residual") == GateLevel::ok);
    CHECK(level("impact_injection") == GateLevel::ok);
    ledger.add(moved, {.strain = 1e-9, .external_work = 0.9e-9, .worst_impact_work = 1e-11});  // far above rounding
    judge({ledger, 1, 1, false, &watch}, {}, gates);
    CHECK(level("energy_residual") == GateLevel::violated);
    CHECK(level("impact_injection") == GateLevel::violated);
}

TEST_CASE("gates: the defect of large rotations may grow with the turns of the body alone") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    State now = initial_state(model);
    now.last_step = 0.1;
    const auto level = [&](double speed, int n, double defect) {
        EnergyLedger ledger(model, now);
        for (int i = 0; i < n; ++i)
            ledger.add(
                now,
                {.kinetic = 1, .external_work = i == 0 ? 1. : 0., .rotation_work = defect, .largest_speed = speed});
        Gates gates;
        judge({ledger, 1, 1}, {}, gates);
        return named(gates, "rotation_work_part").level;
    };
    CHECK(level(0, 100, 0.9e-5) == GateLevel::ok);
    CHECK(level(0, 100, 1.1e-5) == GateLevel::violated);                  // at rest
    CHECK(level(0.1 * std::numbers::pi, 2000, 0.9e-5) == GateLevel::ok);  // 20 turns, 0.018 of the energy
    CHECK(level(0.1 * std::numbers::pi, 2000, 1.1e-5) == GateLevel::violated);
}

TEST_CASE("gates: a loss is no part of next to nothing that was dissipated and free warming has no inertia to judge") {
    const Model model = make_model(point_masses(CohesiveLaw{.sigma_c = 1, .G_c = 0.5}, true));
    const State now = initial_state(model);
    EnergyLedger first(model, now, MassMatrix::lumped, 0.5);  // the first point has lost a thousandth of its cohesion
    first.add(now, {.kinetic = 1e-3,
                    .dissipated = 5e-7,
                    .external_work = 1e-3,
                    .crossing_loss = 1e-5,
                    .scheme_dissipation = 1e-5});
    Gates gates;
    judge({first, 1, 1, true}, {}, gates);
    CHECK(named(gates, "crossing_loss").level == GateLevel::ok);
    CHECK(named(gates, "scheme_dissipation_part").value == relative(2e-5, 1e-12));
    State warm = now;
    const auto temperatures = std::make_shared<Temperatures>();
    temperatures->free_energy = 4e-4;
    warm.temperature = temperatures;
    EnergyLedger free(model, now);
    free.add(warm, {.kinetic = 1e-8, .strain = 1e-8, .thermal_work = 2e-8});
    judge({free, 1, 1, true, nullptr, 1.0}, {}, gates);
    CHECK(named(gates, "kinetic_part").level == GateLevel::ok);
    free.add(warm, {.kinetic = 1e-5, .strain = 1e-5, .thermal_work = 2e-5});
    judge({free, 1, 1, true, nullptr, 1.0}, {}, gates);
    CHECK(named(gates, "kinetic_part").level == GateLevel::warning);
}

}  // namespace gates_test
