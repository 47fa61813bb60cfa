// The lines of the energy figure add up to the work of the loads, in every line of energy.csv, whatever the numbers
// took.
#include "app/program.hpp"

#include "figures/curve_figures.hpp"
#include "output/history_csv.hpp"

#include <algorithm>
#include <cmath>

namespace energy_balance_test {

using namespace program;

namespace {

struct Balance {
    std::size_t lines = 0;
    double largest = 0, missed = 0, figure_missed = 0;  // [J]
    knap::History energy;
    double end_of(const char* column) const { return energy.column(column).back(); }
};

Balance balance_of(const Folder& folder, const std::string& arguments) {
    const Answer run = command("run " + arguments + " -q -j 1 -s output.fields=false -s 'expect={}' " + undrawn +
                               "-o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    Balance found{.energy = knap::read_csv(folder.path / "run/energy.csv")};
    const auto column = [&](const char* name) { return found.energy.column(name); };
    const std::vector<double> external = column("external_work");
    std::vector<double> sum(external.size(), 0.0);
    for (const char* name : {"kinetic", "strain", "dissipated", "recoverable", "law_lag_energy", "crossing_loss_energy",
                             "scheme_dissipation", "excavated_energy", "excavated_recoverable"})
        for (std::size_t i = 0; i < sum.size() && found.energy.has(name); ++i) sum[i] += column(name)[i];
    for (const char* name : {"friction_work", "impact_work", "step_change_work", "rotation_work", "damping_work",
                             "radiated_work", "excavation_work"})  // the last four where the scene has them
        for (std::size_t i = 0; i < sum.size() && found.energy.has(name); ++i) sum[i] -= column(name)[i];
    found.lines = sum.size();
    for (std::size_t i = 0; i < sum.size(); ++i) {
        found.largest = std::max({found.largest, std::abs(external[i]), sum[i]});
        CHECK(std::abs(column("surface")[i] - column("dissipated")[i] - column("recoverable")[i]) <=
              1e-15 * found.largest);
        found.missed = std::max(found.missed, std::abs(sum[i] - sum[0] - external[i]));
    }
    const knap::Chart chart = knap::energy_chart(found.energy);
    REQUIRE(chart.curves[0].label == "sum of all");
    for (std::size_t i = 0; i < sum.size(); ++i)
        found.figure_missed = std::max(found.figure_missed, std::abs(chart.curves[0].y[i] - chart.curves[1].y[i]));
    return found;
}

void check_closes(const Balance& balance) {
    CHECK(balance.lines > 50);
    CHECK(balance.missed <= 1e-12 * balance.largest);
    CHECK(balance.figure_missed <= 1e-12 * balance.largest);
}

}  // namespace

TEST_CASE("energy balance: a cracked block with friction") {
    const Balance balance =
        balance_of(Folder("energy block"),
                   "edge_cracked_block -s 'mesh.size=2 mm' -s 'time.end=60 us' -s interface.default.friction=0.3");
    check_closes(balance);
    for (const char* name : {"dissipated", "recoverable", "crossing_loss_energy"})
        CHECK_MESSAGE(balance.end_of(name) > 0, name);
    CHECK(balance.end_of("law_lag_energy") != 0);
    CHECK(balance.end_of("friction_work") < 0);
}

TEST_CASE("energy balance: a damped implicit bar in steps that change") {
    const Balance balance = balance_of(
        Folder("energy bar"),
        "bar_pulled_apart -s time.bulk=implicit -s time.cohesion=implicit -s time.theta=0.7 -s 'time.step=20 CFL' "
        "-s 'time.step_cracking=2 CFL' -s 'output.history_every=1 us'");
    check_closes(balance);
    CHECK(balance.end_of("scheme_dissipation") > 0);
}

TEST_CASE("energy balance: explicit steps that change at the first softening") {
    const Balance balance = balance_of(
        Folder("energy steps"), "bar_pulled_apart -s time.step_cracking='0.3 CFL' -s 'output.history_every=1 us'");
    check_closes(balance);
    CHECK(balance.end_of("step_change_work") != 0);
}

TEST_CASE("energy balance: a block that turns and breaks") {
    const Balance balance =
        balance_of(Folder("energy rotation"),
                   "edge_cracked_block -s 'mesh.size=2 mm' -s 'time.end=60 us' -s domain.rotation=large "
                   "-s 'initial=[{ velocity = [0, 20], box = [0.05, -1, 1, 1] }]'");
    check_closes(balance);
    CHECK(balance.end_of("rotation_work") != 0);
    CHECK(balance.end_of("dissipated") > 0);
}

TEST_CASE("energy balance: water that drives a crack") {
    const Balance balance =
        balance_of(Folder("energy water"), "hydraulic_fracture -s 'mesh.size=10 mm' -s 'output.history_every=1 us'");
    check_closes(balance);
    CHECK(balance.end_of("dissipated") > 0);
}

TEST_CASE("energy balance: a gallery that is excavated while the rock breaks") {
    const Balance balance = balance_of(Folder("energy gallery"),
                                       "excavated_gallery -s 'mesh.refine=[]' -s 'mesh.size=0.6 m' -s 'time.end=15 ms' "
                                       "-s 'excavation[0].ramp=5 ms' -s 'interface.default.sigma_c=5 MPa' "
                                       "-s 'output.history_every=0.1 ms'");
    check_closes(balance);
    for (const char* name : {"excavated_energy", "dissipated"}) CHECK_MESSAGE(balance.end_of(name) > 0, name);
    CHECK(balance.end_of("excavation_work") < 0);
}

}  // namespace energy_balance_test
