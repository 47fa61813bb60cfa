// The surplus of specimens: tables of it, and sigma_c as measured.
#include "scenario/specimen_strength.hpp"
#include "samples.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "scenario/built_in.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace specimen_strength_test {

using namespace knap;

namespace {

const std::string head = "test,softening,unloading,order,gamma,friction,zones,edges,through,seeds,surplus,deviation\n";

TestedLaw tested(double gamma, double friction, double zones, double edges) {
    return {"compression", "linear", "constant", 1, gamma, friction, zones, edges};
}

/// Two sizes with one law, and one with more friction.
StrengthTable three_specimens() {
    return StrengthTable(head +
                         "compression,linear,constant,1,1,0.5,4,20,1,5,1.2,0.02\n"
                         "compression,linear,constant,1,1,0.5,16,20,0.8,5,1.1,0.04\n"
                         "compression,linear,constant,1,1,0.5,64,20,0.6,5,1.01,0.04  # two had no peak\n"
                         "compression,linear,constant,1,1,0.7,4,20,1,5,1.3,0.02\n");
}

}  // namespace

TEST_CASE("strength: the surplus is linear in friction and in the logarithm of the process zones") {
    const StrengthTable table = three_specimens();
    CHECK(table.find(tested(1, 0.5, 4, 20))->mean == 1.2);
    CHECK(table.find(tested(1, 0.5, 8, 20))->mean == tests::relative(1.15, 1e-14));
    CHECK(table.find(tested(1, 0.5, 8, 20))->deviation == tests::relative(0.03, 1e-14));
    CHECK(table.find(tested(1, 0.6, 4, 20))->mean == tests::relative(1.25, 1e-14));
    // a little beyond the table the last value, farther out none
    CHECK(table.find(tested(1, 0.5, 23.9, 59.9))->mean == 1.1);
    CHECK_FALSE(table.find(tested(1, 0.5, 24.1, 20)));
    CHECK_FALSE(table.find(tested(1, 0.5, 2.6, 20)));
    CHECK_FALSE(table.find(tested(1, 0.5, 4, 60.1)));
    CHECK_FALSE(table.find(tested(1, 0.4, 4, 20)));
    CHECK_FALSE(table.find(tested(1.1, 0.5, 4, 20)));
    CHECK_FALSE(table.find({"brazilian", "linear", "constant", 1, 1, 0.5, 4, 20}));
    CHECK_FALSE(table.find({"compression", "linear", "secant", 1, 1, 0.5, 4, 20}));
    CHECK(table.nearest_text(tested(1, 0.9, 4, 20)) ==
          "nearest row: friction 0.7, 1.30 +- 0.02; all rows of its coupling: 1.10 to 1.30");
}

TEST_CASE("strength: the surplus of a measured strength is that of the process zone which its interfaces have") {
    const StrengthTable table = three_specimens();
    for (const double zones : {7., 10., 18.}) {
        const double surplus = table.of_measured(tested(1, 0.5, zones, 20))->mean;
        CHECK(surplus == tests::relative(table.find(tested(1, 0.5, zones / (surplus * surplus), 20))->mean, 1e-11));
    }
    CHECK_FALSE(table.of_measured(tested(1, 0.5, 100, 20)));
}

TEST_CASE("strength: a table is what it writes") {
    const StrengthTable table(strength_csv({{tested(0.5, 0.3, 8, 12.5), 0.8, 5, 1.0625, 0.0125}}));
    CHECK(table.find(tested(0.5, 0.3, 8, 12.5))->mean == 1.0625);
    CHECK(table.find(tested(0.5, 0.3, 8, 12.5))->deviation == 0.0125);
    for (const char* wrong :
         {"compression,linear,constant,1,1,0.5,4,20,1,5,1.2", "compression,linear,constant,1,1,0.5,4,x,1,5,1.2,0.02",
          "compression,linear,constant,1,1,0.5,0,20,1,5,1.2,0.02", "compression,linear,constant,1,1,0.5,4,20,1,5,0,0"})
        CHECK_THROWS_AS(StrengthTable(head + wrong), UserError);
    CHECK_THROWS_AS(StrengthTable(""), UserError);
}

namespace {

/// A plate of 5 MPa whose interfaces have the surplus of tests/scenario/data/strength.csv; `more`: keys of [strength].
std::string tested_plate(const std::string& more) {
    return R"(knap = 1
[strength]
meaning = "as measured"
table = ")" KNAP_SOURCE_DIR
           R"(/tests/scenario/data/strength.csv"
)" + more + R"([domain]
shape = "rectangle"
size = ["50 mm", "50 mm"]
model = "plane stress"
[mesh]
size = "0.5 mm"
order = 2
[material.rock]
density = "2400 kg/m3"
E = "20 GPa"
nu = 0.2
[interface.default]
sigma_c = "5 MPa"
G_c = "20 J/m2"
[time]
end = "1 us"
)";
}

Diagnostic mistake_in(const std::string& text, const std::vector<std::string>& set = {}) {
    try {
        read_scenario_text(text, "plate.toml", set);
    } catch (const UserError& error) {
        CHECK(error.diagnostics.size() == 1);
        return error.diagnostics.front();
    }
    return {};
}

}  // namespace

TEST_CASE("strength: what structures bear is what the bench measured") {
    std::ifstream bench(KNAP_SOURCE_DIR "/scenarios/results/coupling_surplus.csv");
    std::set<std::string> measured;
    for (std::string line; std::getline(bench, line);) {
        const std::size_t coupling = line.find("sum,") == line.npos ? line.find("norm,") : line.find("sum,");
        std::istringstream fields(coupling == line.npos ? "" : line.substr(coupling));
        std::string field, words;
        for (int i = 0; i < 5 && std::getline(fields, field, ','); ++i) words += field + " ";
        measured.insert(words);  // coupling, gamma, seeds, load, deviation
    }
    const StrengthTable table(
        std::ranges::find(built_in_files(), std::string("mesh_strength.csv"), &BuiltIn::name)->text);
    int n = 0;
    for (const StrengthRow& row : table.rows()) {
        if (row.law.test == "compression" || row.law.test == "brazilian") continue;
        const std::string words =
            formatted("%s %g %d %.3f %.3f ", row.law.softening.ends_with(" norm") ? "norm" : "sum", row.law.gamma,
                      row.seeds, row.surplus, row.deviation);
        CHECK_MESSAGE(measured.contains(words), words);
        ++n;
    }
    CHECK(n >= 50);
}

TEST_CASE("strength: means of the bench are those of its single seeds") {
    // specimen, coupling and gamma, and the fields behind them
    const auto rows = [](const std::string& file) {
        std::ifstream table(KNAP_SOURCE_DIR "/scenarios/results/" + file);
        std::map<std::string, std::vector<std::string>> found;
        for (std::string line; std::getline(table, line);) {
            std::size_t end = line.starts_with('"') ? line.find('"', 1) + 1 : line.find(',');
            if (line.starts_with('#') || line.starts_with("specimen")) continue;
            for (int i = 0; i < 2; ++i) end = line.find(',', end + 1);
            std::istringstream fields(line.substr(end + 1));
            for (std::string field; std::getline(fields, field, ',');) found[line.substr(0, end)].push_back(field);
        }
        return found;
    };
    const auto mean = [](const std::string& numbers) {
        std::istringstream in(numbers);
        double sum = 0, n = 0;
        for (double number; in >> number; ++n) sum += number;
        return sum / n;
    };
    const auto means = rows("coupling_surplus.csv");
    int n = 0;
    for (const auto& [name, row] : rows("coupling_runs.csv")) {
        if (row[0].empty() || name.find("spall") != name.npos) continue;  // over sigma_c or another specimen
        const auto& of_means = means.at(name);
        for (const int column : {0, 1})
            if (const std::string& given = of_means[1 + 2 * column]; !given.empty()) {
                CAPTURE(name);
                CHECK(std::abs(mean(row[3 + column]) / std::stod(row[column]) - std::stod(given)) < 0.00051);
                ++n;
            }
    }
    CHECK(n > 120);
}

TEST_CASE("strength: interfaces within a material get the measured strength over the surplus") {
    const std::string disc = tested_plate("test = \"brazilian\"\nsize = \"80 mm\"\n");
    const Scenario measured = read_scenario_text(disc, "plate.toml").scenario;
    CHECK(measured.laws[0].measured_sigma_c == 5e6);
    CHECK(measured.laws[0].law.sigma_c == 4e6);
    CHECK(measured.laws[0].law.G_c == 20);
    const Scenario as_given =
        read_scenario_text(disc, "plate.toml", {"strength.table=", "strength.meaning=of interfaces"}).scenario;
    CHECK(as_given.laws[0].measured_sigma_c == 0);
    CHECK(as_given.laws[0].law.sigma_c == 5e6);
}

TEST_CASE("strength: what has no calibration is an error with its place and cure") {
    const std::string disc = tested_plate("test = \"brazilian\"\nsize = \"80 mm\"\n");
    const Diagnostic coarse = mistake_in(disc, {"mesh.size=3 mm"});
    CHECK(coarse.code == "no-calibration");
    CHECK(coarse.line == 2);
    CHECK(coarse.note.find("knap calibrate --of strength") != std::string::npos);
    CHECK(mistake_in(disc, {"strength.test=compression"}).code == "no-calibration");
    const Diagnostic rubs = mistake_in(disc, {"interface.default.friction=0.7"});
    CHECK(rubs.code == "no-calibration");
    CHECK_MESSAGE(rubs.message.find("order 2, friction 0.7, brazilian") != std::string::npos, rubs.message);
    CHECK(rubs.message.ends_with("; by default softening linear, unloading constant, gamma 1"));
    const Diagnostic random = mistake_in(disc, {"interface.default.scatter={ kind = \"weibull\", modulus = 6 }"});
    CHECK(random.message.find("its strength is random") != std::string::npos);
    const Diagnostic sizeless = mistake_in(tested_plate(""));
    CHECK(sizeless.code == "missing-key");
    CHECK(sizeless.message.find("strength.size") != std::string::npos);
    CHECK(mistake_in(disc, {"strength.size=-1 mm"}).code == "out-of-range");
}

}  // namespace specimen_strength_test
