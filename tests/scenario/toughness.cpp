// The surplus of a mesh: tables of it, and G_c as measured.
#include "scenario/toughness.hpp"
#include "samples.hpp"

#include "base/error.hpp"
#include "scenario/built_in.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>

namespace toughness_test {

using namespace knap;

namespace {

const std::string head = "softening,unloading,order,gamma,edges,load,through,seeds,speed_over_cR,surplus,deviation\n";

/// Two gammas, each on two meshes.
ToughnessTable four_meshes() {
    return ToughnessTable(head +
                          "linear,constant,1,1,4,1.4,1,5,0.4,1.2,0.02\n"
                          "linear,constant,1,1,16,1.4,1,5,0.4,1.1,0.04\n"
                          "linear,constant,1,3,4,1.4,1,5,0.4,1.4,0.02\n"
                          "linear,constant,1,3,16,1.4,1,5,0.4,1.3,0.02\n");
}

MeshedLaw law_with(double gamma, double edges) { return {"linear", "constant", 1, gamma, edges}; }

}  // namespace

TEST_CASE("toughness: the surplus is linear in the logarithm of the edges and in gamma") {
    const ToughnessTable table = four_meshes();
    CHECK(table.find(law_with(1, 4))->mean == 1.2);
    CHECK(table.find(law_with(1, 8))->mean == tests::relative(1.15, 1e-14));
    CHECK(table.find(law_with(1, 8))->deviation == tests::relative(0.03, 1e-14));
    CHECK(table.find(law_with(2, 8))->mean == tests::relative(1.25, 1e-14));
    // a little beyond the meshes of the table the surplus is that of the last one
    CHECK(table.find(law_with(1, 31.9))->mean == 1.1);
    CHECK_FALSE(table.find(law_with(1, 32.1)));
    CHECK_FALSE(table.find(law_with(1, 1.9)));
    CHECK_FALSE(table.find(law_with(3.1, 8)));
    CHECK_FALSE(table.find({"linear", "constant", 2, 1, 8}));
    CHECK_FALSE(table.find({"linear", "secant", 1, 1, 8}));
    CHECK(table.nearest_text(law_with(1, 64)) ==
          "nearest row: 16 edges, 1.10 +- 0.04; all rows of its coupling: 1.10 to 1.40");
}

TEST_CASE("toughness: the surplus of a measured energy is that of the process zone which its interfaces have") {
    const ToughnessTable table = four_meshes();
    for (const double edges : {5., 8., 15.}) {
        const double surplus = table.of_measured(law_with(1, edges))->mean;
        CHECK(surplus == tests::relative(table.find(law_with(1, edges / surplus))->mean, 1e-11));
    }
    CHECK(table.of_measured(law_with(1, 16 * 1.2))->mean == 1.1);
    CHECK_FALSE(table.of_measured(law_with(1, 100)));
}

TEST_CASE("toughness: of several loads the smallest one counts under which four of five cracks run through") {
    const ToughnessTable table(head +
                               "linear,constant,1,1,6,2,1,5,0.6,1.4,0.02\n"
                               "linear,constant,1,1,6,1.2,0.6,5,0.2,1.05,0.02  # two cracks stopped\n"
                               "linear,constant,1,1,6,1.4,0.8,5,0.4,1.1,0.02\n");
    CHECK(table.find(law_with(1, 6))->mean == 1.1);
    CHECK(table.at_speed(law_with(1, 6), 0.5)->mean == tests::relative(1.25));  // between loads
    CHECK_FALSE(table.at_speed(law_with(1, 6), 0.7));
}

TEST_CASE("toughness: a crack costs less with the norm up to 0.6 of the Rayleigh speed") {
    const ToughnessTable table(std::ranges::find(built_in_files(), "mesh_toughness.csv", &BuiltIn::name)->text);
    const auto costs = [&](Coupling coupling, double speed) {
        return table.at_speed(law_with(1, 6).with(coupling), speed)->mean;
    };
    for (const double speed : {0.52, 0.56, 0.6}) CHECK(costs(Coupling::norm, speed) < costs(Coupling::sum, speed));
    for (const double speed : {0.63, 0.66}) CHECK(costs(Coupling::norm, speed) > costs(Coupling::sum, speed));
}

TEST_CASE("toughness: a table is what it writes") {
    const ToughnessRow row{law_with(0.5, 6.25), 1.4, 0.8, 5, 0.45, 1.125, 0.0625};
    const ToughnessTable table(toughness_csv({row}));
    CHECK(table.find(law_with(0.5, 6.25))->mean == 1.125);
    CHECK(table.find(law_with(0.5, 6.25))->deviation == 0.0625);
    for (const char* wrong : {"linear,constant,1,1,6", "linear,constant,1,1,x,2,1,5,0.6,1.4,0.02",
                              "linear,constant,1,1,0,2,1,5,0.6,1.4,0.02", "linear,constant,1,1,6,2,1,5,0.6,0,0.02"})
        CHECK_THROWS_AS(ToughnessTable(head + wrong), UserError);
    CHECK_THROWS_AS(ToughnessTable(""), UserError);
}

namespace {

/// A plate of 3 J/m2; `more`: at the top of the scenario.
std::string plate(const std::string& more) {
    return "knap = 1\n" + more + R"(
[domain]
shape = "rectangle"
size = ["60 mm", "20 mm"]
[mesh]
size = "0.25 mm"
[material.glass]
density = "2450 kg/m3"
E = "32 GPa"
nu = 0.2
[material.steel]
density = "7800 kg/m3"
E = "210 GPa"
nu = 0.3
[interface.default]
breakable = false
[interface.glass-glass]
sigma_c = "7.67 MPa"
G_c = "3 J/m2"
[interface.glass-steel]
sigma_c = "7.67 MPa"
G_c = "2 J/m2"
[time]
end = "1 us"
)";
}

}  // namespace

TEST_CASE("toughness: interfaces within a material get the measured energy over the surplus") {
    const Scenario as_given = read_scenario_text(plate(""), "plate.toml").scenario;
    CHECK(as_given.laws[1].law.G_c == 3);
    CHECK(as_given.laws[1].measured_G_c == 0);
    const Scenario measured = read_scenario_text(plate("toughness = \"as measured\""), "plate.toml").scenario;
    const NamedLaw& glass = measured.laws[1];
    CHECK(glass.measured_G_c == 3);
    CHECK(glass.surplus.mean > 1.05);
    CHECK(glass.surplus.mean < 1.25);
    CHECK(glass.law.G_c == 3 / glass.surplus.mean);
    // a crack between two materials runs along a given line
    CHECK(measured.laws[2].law.G_c == 2);
    CHECK(measured.laws[2].measured_G_c == 0);
}

TEST_CASE("toughness: the coupling is part of the law of a table") {
    const MeshedLaw sum = law_with(1, 6), norm = sum.with(Coupling::norm);
    CHECK(norm.softening == "linear norm");
    CHECK(norm.with(Coupling::norm).softening == "linear norm");
    CHECK(norm.with(Coupling::sum).softening == "linear");
    const Scenario measured =
        read_scenario_text(plate("toughness = \"as measured\""), "plate.toml",
                           {"interface.glass-glass.coupling=norm", "interface.glass-steel.coupling=norm"})
            .scenario;
    CHECK(measured.laws[1].surplus.mean > 1.10);
    CHECK(measured.laws[1].surplus.mean < 1.13);
}

TEST_CASE("toughness: a mesh without calibration is an error with its cure") {
    const auto codes = [](const std::string& more, const std::vector<std::string>& set) {
        try {
            read_scenario_text(plate(more), "plate.toml", set);
        } catch (const UserError& error) {
            CHECK(error.diagnostics.size() == 1);
            CHECK(error.diagnostics.front().note.find("knap calibrate") != std::string::npos);
            return error.diagnostics.front().code;
        }
        return std::string();
    };
    const std::string measured = "toughness = \"as measured\"";
    CHECK(codes(measured, {"mesh.size=2 um"}) == "no-calibration");
    CHECK(codes(measured, {"interface.glass-glass.gamma=50"}) == "no-calibration");
    CHECK(codes(measured, {"interface.glass-glass.unloading=vertical"}) == "no-calibration");
    CHECK(codes("", {"mesh.size=2 um"}).empty());
    // rows without these keys would be 5 to 8 % too low (G_II of 2 and 4 G_c); friction changes less than 1 %
    CHECK(codes(measured, {"interface.glass-glass.G_II=6"}) == "no-calibration");
    CHECK(codes(measured, {"interface.glass-glass.relaxation_time=1 us"}) == "no-calibration");
    CHECK(codes(measured, {"interface.glass-glass.friction=0.7"}).empty());
    const auto warned = [&](const char* friction) {
        return std::ranges::count(read_scenario_text(plate(measured), "plate.toml", {friction}).warnings, "calibration",
                                  &Diagnostic::code);
    };
    CHECK(warned("interface.glass-glass.friction=0.7") == 0);
    CHECK(warned("interface.glass-glass.friction=0.9") == 1);
}

}  // namespace toughness_test
