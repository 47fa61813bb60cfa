// The energy ledger at its start, and the energy figure, which must close.
#include "analysis/gates.hpp"
#include "figures/curve_figures.hpp"
#include "model/make_model.hpp"
#include "stepper/adapt/excavation.hpp"

#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace energy_ledger_test {

using namespace knap;
using namespace knap::tests;

namespace {

const CohesiveLaw glue{.sigma_c = 1, .G_c = 0.5};

}  // namespace

TEST_CASE("ledger: the kinetic energy at the start is that of the mass matrix") {
    const Model model = make_model(point_masses(glue, true));  // one triangle of mass 3
    State start = initial_state(model);
    start.velocity[start.node_of_corner[0]] = {1, 0};
    CHECK(EnergyLedger(model, start).row().kinetic == relative(0.5, 1e-15));                           // 1/2 m/3 v^2
    CHECK(EnergyLedger(model, start, MassMatrix::consistent).row().kinetic == relative(0.25, 1e-15));  // 1/2 m/6 v^2
    CHECK(EnergyLedger(model, start, MassMatrix::one_point).row().kinetic ==
          relative(1.0 / 6, 1e-15));  // 1/2 m (v/3)^2
    for (Vec2& v : start.velocity) v = {1, 2};
    CHECK(EnergyLedger(model, start).row().kinetic == relative(7.5, 1e-15));
    CHECK(EnergyLedger(model, start, MassMatrix::consistent).row().kinetic ==
          relative(7.5, 1e-15));  // moved as a whole: the same
    CHECK(EnergyLedger(model, start, MassMatrix::one_point).row().kinetic == relative(7.5, 1e-15));
}

TEST_CASE("ledger: NaN violates the gate and stays NaN") {
    const Model model = make_model(point_masses(glue, true));
    const State start = initial_state(model);
    EnergyLedger ledger(model, start);
    StepReport report;
    ledger.add(start, report);
    Gates gates;
    judge({ledger, 1, 1}, {}, gates);
    CHECK(gates[0].pass());
    report.external_work = std::numeric_limits<double>::quiet_NaN();
    ledger.add(start, report);
    judge({ledger, 1, 1}, {}, gates);
    CHECK_FALSE(gates[0].pass());
    CHECK(std::isnan(gates[0].value));
}

TEST_CASE("ledger: the law lag is judged once the surface has an energy of a point") {
    const Model model = make_model(point_masses(glue, true));
    const State state = initial_state(model);
    const double point = 1e-3;  // [J] what the weakest point dissipates
    EnergyLedger first(model, state, MassMatrix::lumped, point);
    StepReport report{.recoverable = 1e-3 * point, .cohesive_work = 0.75e-3 * point};
    first.add(state, report);
    CHECK(first.law_lag() == relative(0.25e-3, 1e-12));
    CHECK(first.largest_law_lag() == relative(0.25e-3, 1e-12));
    EnergyLedger more(model, state, MassMatrix::lumped, point);
    report.cohesive_work *= 1e4, report.recoverable *= 1e4;
    more.add(state, report);
    CHECK(more.largest_law_lag() == relative(0.25, 1e-12));
    // a step of rigid pieces in whose micro steps it came and went
    EnergyLedger within(model, state, MassMatrix::lumped, point);
    within.add(state, {.micro_lag = 0.3 * point});
    CHECK(within.law_lag() == 0);
    CHECK(within.largest_law_lag() == relative(0.3, 1e-12));
    within.add(state, {.micro_lead = 0.4 * point});
    CHECK(within.largest_law_lag() == relative(-0.4, 1e-12));
}

TEST_CASE("ledger: what rests has the scale of its loads and no rounding is an error") {
    const Model model = make_model(point_masses(glue, true));
    const State state = initial_state(model);
    EnergyLedger ledger(model, state);
    ledger.add(state, {.kinetic = 1e-31, .external_work = 0.6e-31, .kick_energy = 1e-3});  // a rigid piece on a slope
    Gates gates;
    judge({ledger, 1, 1}, {}, gates);
    CHECK(gates[0].name == std::string_view("energy_residual"));
    CHECK(gates[0].value == relative(0.4e-28, 1e-9));
    CHECK(gates[0].pass());
}

TEST_CASE("ledger: a preload is energy of the start and no work") {
    ModelInput input = point_masses(glue, true);
    input.materials = {{.density = 3, .E = 8, .nu = 0}};
    const Model model = make_model(input);
    State start = initial_state(model);
    start.displacement[start.node_of_corner[2]] = {0, 0.25};  // eps_yy = 1/4 over the area 1
    EnergyLedger ledger(model, start);
    CHECK(ledger.row().strain == relative(0.25, 1e-14));  // 1/2 E eps^2
    CHECK(ledger.row().external_work == 0);
    StepReport held;
    held.strain = ledger.row().strain;
    ledger.add(start, held);
    CHECK(std::abs(ledger.row().residual) <= 1e-15);
}

TEST_CASE("ledger: what interfaces stored before the start is energy that they may give") {
    const Model model = make_model(point_masses(glue, true));
    State start = initial_state(model);
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f)
        if (start.split_rank[f] < 0 && model.fans[f].n_points > 0) split(model, f, start);
    for (PointState& point : start.points) point.cohesion = 0.75;  // at s = delta_c/4
    for (Vec2& u : start.displacement) u = {0, 0.25};
    EnergyLedger ledger(model, start);
    const double stored = ledger.row().recoverable;
    REQUIRE(stored > 0);
    CHECK(ledger.supplied() == ledger.row().kinetic + ledger.row().strain + stored);
    ledger.add(start, {.kinetic = stored, .dissipated = ledger.row().dissipated, .cohesive_work = -stored});
    CHECK(ledger.dissipation_scale() == stored);  // not what was dissipated, which is less
}

TEST_CASE("ledger: the energy damped by the scheme closes the balance") {
    const Model model = make_model(point_masses(glue, true));
    State now = initial_state(model);
    EnergyLedger ledger(model, now);
    ledger.add(now, {.kinetic = 3, .strain = 1, .external_work = 5, .scheme_dissipation = 1});
    CHECK(ledger.row().residual == 0);
    ledger.add(now, {.kinetic = 2, .strain = 1.5, .scheme_dissipation = 0.5});
    CHECK(ledger.row().scheme_dissipation == 1.5);
    CHECK(ledger.row().residual == 0);
}

TEST_CASE("energy ledger: what leaves with an excavation has its lines and what it had dissipated remains") {
    const Model model = make_model(point_masses(glue, true));
    State now = initial_state(model);
    EnergyLedger ledger(model, now);
    ledger.add(now, {.kinetic = 3,
                     .strain = 1,
                     .dissipated = 0.5,
                     .recoverable = 0.25,
                     .external_work = 4.75,
                     .cohesive_work = 0.75});
    CHECK(ledger.row().residual == 0);
    ledger.excavate({.kinetic = 2, .strain = 0.5, .dissipated = 0.125, .recoverable = 0.0625});
    CHECK(ledger.row().excavated_energy == 1.5);
    CHECK(ledger.row().excavated_recoverable == 0.0625);
    CHECK(ledger.row().recoverable == 0.1875);
    ledger.add(now,
               {.kinetic = 2.25, .strain = 0.5, .dissipated = 0.375, .recoverable = 0.1875, .excavation_work = 0.25});
    CHECK(ledger.row().residual == 0);
    CHECK(ledger.row().dissipated == 0.5);
    CHECK(ledger.row().law_lag == 0);
    CHECK(ledger.row().excavation_work == 0.25);
}

TEST_CASE("figures: the energy figure closes with the energy of the start and all numerical terms") {
    History energy;
    energy.columns = {"time",
                      "kinetic",
                      "strain",
                      "surface",
                      "dissipated",
                      "recoverable",
                      "external_work",
                      "friction_work",
                      "impact_work",
                      "law_lag_energy",
                      "crossing_loss_energy",
                      "scheme_dissipation",
                      "step_change_work",
                      "rotation_work",
                      "damping_work",
                      "radiated_work",
                      "excavated_energy",
                      "excavated_recoverable",
                      "excavation_work"};
    energy.rows = {
        {0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
        {1, 2, 2, 1, 0.75, 0.25, 4, -0.5, -0.25, -0.5, 0.125, 0.75, -0.375, 0.25, -0.5, -0.25, 0.5, 0.125, 0.625}};
    const Chart chart = energy_chart(energy);
    const auto curve = [](const Chart& drawn, const std::string& label) -> const Curve* {
        for (const Curve& c : drawn.curves)
            if (c.label == label) return &c;
        return nullptr;
    };
    REQUIRE(curve(chart, "sum of all"));
    REQUIRE(curve(chart, "start + external work"));
    CHECK(curve(chart, "sum of all")->y == std::vector<double>{3, 7});
    CHECK(curve(chart, "start + external work")->y == std::vector<double>{3, 7});
    double drawn = 0;
    for (std::size_t i = 2; i < chart.curves.size(); ++i) drawn += chart.curves[i].y[1];
    CHECK(drawn == 7);
    for (const char* label : {"dissipated", "recoverable", "law lag", "crossing loss", "damped by the scheme",
                              "lost in changes of step", "defect of rotation", "damped", "radiated", "excavated",
                              "excavated, recoverable", "taken by released forces"})
        CHECK_MESSAGE(curve(chart, label), label);

    energy.rows = {{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                   {1, 2, 2, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
    const Chart plain = energy_chart(energy);
    CHECK(plain.curves.size() == 5);
    for (const char* label :
         {"recoverable", "law lag", "crossing loss", "damped by the scheme", "lost in changes of step"})
        CHECK_MESSAGE(!curve(plain, label), label);
    CHECK(plain.curves[1].label == "external work");

    energy.columns = {"time", "kinetic", "strain", "surface", "external_work"};  // of an older run
    energy.rows = {{0, 0, 0, 0, 0}, {1, 2, 1, 1, 4}};
    const Chart older = energy_chart(energy);
    REQUIRE(curve(older, "surface"));
    CHECK(curve(older, "sum of all")->y == std::vector<double>{0, 4});
}

TEST_CASE("figures: the energy figure draws every term of the ledger") {
    RareWorks all;
    for (const auto work : RareWorks::all()) all.*work = true;
    EnergyRow row;
    double next = 1, work = 0;
    for (const EnergyTerm& term : energy_terms()) {
        if (term.value == nullptr) continue;
        row.*term.value = next = std::fmod(7 * next, 11);
        work += term.use.work * row.*term.value;
    }
    row.kinetic = work - row.strain;  // nothing at the start
    row.law_lag = row.cohesive_work + row.law_change - row.crossing_loss - row.viscous_dissipation -
                  row.mixed_dissipation - row.surface() - row.excavated_recoverable;
    History energy;
    energy.rows.resize(2);
    for (const Measure<EnergyRow>& column : energy_columns(all)) {
        energy.columns.emplace_back(column.name);
        energy.rows[0].push_back(0);
        energy.rows[1].push_back(column.of(row));
    }
    const Chart chart = energy_chart(energy);
    CHECK(chart.curves[0].y.back() == relative(row.external_work + row.thermal_work, 1e-14));
    CHECK(chart.curves[1].y.back() == relative(row.external_work + row.thermal_work, 1e-14));
}

}  // namespace energy_ledger_test
