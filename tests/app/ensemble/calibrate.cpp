// knap calibrate, and toughness = "as measured" with its table.
#include "app/program.hpp"

#include "base/vec.hpp"
#include "scenario/toughness.hpp"
#include "support/relative.hpp"

#include <cmath>
#include <sstream>
#include <vector>

namespace calibrate_test {

using namespace program;
using namespace knap;

namespace {

const std::string coarse = "mesh_toughness -s 'mesh.refine[0].size=0.5 mm' ";  // three edges in the process zone

/// A column of sweep.csv.
std::vector<double> column_of_sweep(const fs::path& csv, const std::string& name) {
    std::ifstream file(csv);
    std::vector<double> values;
    std::ptrdiff_t column = -1;
    for (std::string line; std::getline(file, line);) {
        std::istringstream in(line);
        std::vector<std::string> cells;
        for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
        if (column >= 0) values.push_back(std::stod(cells.at(column)));
        for (std::size_t i = 0; column < 0 && i < cells.size(); ++i)
            if (cells[i] == name) column = static_cast<std::ptrdiff_t>(i);
    }
    return values;
}

}  // namespace

TEST_CASE("calibrate: it replaces no table unasked and check gives both energies") {
    const Folder folder("calibrate");
    std::ofstream(folder.path / "t.csv") << "mine\n";
    const Answer refused = command("calibrate " + coarse + "--table " + folder.in_shell("t.csv"));
    CHECK(refused.code == 2);
    CHECK(refused.has("exists already"));
    CHECK(text_of(folder.path / "t.csv") == "mine\n");
    const Answer none = command("calibrate bar_pulled_apart --table " + folder.in_shell("none.csv"));
    CHECK(none.code == 2);
    CHECK(none.has("nothing-to-calibrate"));
    const Answer both = command("check " + coarse + "-s toughness='as measured'");
    CHECK(both.code == 0);
    CHECK(both.has("(3 as measured)"));
    CHECK(both.has("costs 3 J/m2 as measured"));
}

TEST_CASE("calibrate: other strips than those of the table dissipate the measured energy within its scatter" *
          doctest::test_suite("slow")) {
    const Folder folder("calibrated");
    const Answer measured = command("calibrate " + coarse + "--loads 1.4 --seeds 5 -j 2 -q -o " +
                                    folder.in_shell("strips") + " --table " + folder.in_shell("t.csv"));
    CAPTURE(measured.text);
    REQUIRE(measured.code == 0);
    const ToughnessTable table(text_of(folder.path / "t.csv"));
    const Surplus surplus = table.find({"linear", "constant", 1, 1, 3}).value();
    CHECK(surplus.mean > 1.05);
    // the same load over G_c of the interfaces
    const double half = 1.08683e-6 / std::sqrt(surplus.mean);
    const std::string pull = "-s 'load[0].displacement=[0, " + std::to_string(1e6 * half) +
                             "e-6]' -s 'load[1].displacement=[0, -" + std::to_string(1e6 * half) + "e-6]' ";
    const Answer strips =
        command("sweep " + coarse + pull +
                "-s 'sweep={ quantities = [\"steady_work_per_advance\"] }' --seeds 11..15 -j 2 -q -o " +
                folder.in_shell("sweep") + " -s 'toughness={ meaning = \"as measured\", table = \"" +
                (folder.path / "t.csv").string() + "\" }'");
    CAPTURE(strips.text);
    REQUIRE(strips.code == 0);
    const std::vector<double> work =
        column_of_sweep(folder.path / "sweep" / "sweep.csv", "steady_work_per_advance [J/m2]");
    REQUIRE(work.size() == 5);
    double mean = 0;
    for (const double w : work) mean += w / 5;
    // two means of five: three times the standard error of their difference
    CHECK(std::abs(mean / 3 - 1) < 3 * surplus.deviation / surplus.mean * std::sqrt(2. / 5));
}

TEST_CASE("calibrate: strength needs a size and a law whose strength is one number") {
    const Folder folder("strength_mistakes");
    const std::string table = " --of strength --table " + folder.in_shell("t.csv");
    const Answer sizeless = command("calibrate " + coarse + table);
    CHECK(sizeless.code == 2);
    CHECK(sizeless.has("`strength.size` is missing"));
    const Answer large = command("calibrate " + coarse + "-s 'strength.size=3 mm'" + table);
    CHECK(large.code == 2);
    CHECK(large.has("covered by 6 edges"));
    const Answer random = command("calibrate weibull_plate -s 'strength.size=20 mm'" + table);
    CHECK(random.code == 2);
    CHECK(random.has("its strength is random"));
    CHECK_FALSE(fs::exists(folder.path / "t.csv"));
}

TEST_CASE("calibrate: other plates than those of the table have the measured strength within its scatter" *
          doctest::test_suite("slow")) {
    const Folder folder("calibrated_plate");
    const std::string plate =
        "uniaxial_compression -s 'mesh.size=2 mm' -s interface.default.gamma=0.5 -s interface.default.friction=0.3 ";
    const Answer measured = command("calibrate " + plate + "--of strength --seeds 5 -j 2 -q -o " +
                                    folder.in_shell("specimens") + " --table " + folder.in_shell("t.csv"));
    CAPTURE(measured.text);
    REQUIRE(measured.code == 0);
    // the speed and the end that the specimens of the calibration have
    const Answer others = command(
        "sweep " + plate +
        "-s 'obstacle[0].velocity=[0, -0.035]' -s figure= -s expect= -s output.fields=false -s output.report=false "
        "-s 'sweep={ quantities = [\"peak_stress\", \"measured_strength\", \"strength_ratio\"] }' --seeds 11..15 "
        "-j 2 -q -o " +
        folder.in_shell("sweep") + " -s 'strength={ meaning = \"as measured\", table = \"" +
        (folder.path / "t.csv").string() + "\" }'");
    CAPTURE(others.text);
    REQUIRE(others.code == 0);
    const fs::path csv = folder.path / "sweep" / "sweep.csv";
    const std::vector<double> peak = column_of_sweep(csv, "peak_stress [Pa]"),
                              given = column_of_sweep(csv, "measured_strength [Pa]"),
                              ratio = column_of_sweep(csv, "strength_ratio");
    REQUIRE(peak.size() == 5);
    double over_given = 0, over_law = 0;
    for (std::size_t i = 0; i < 5; ++i) over_given += peak[i] / given[i] / 5, over_law += ratio[i] / 5;
    CHECK(over_law > 1.03);
    CHECK(over_given == tests::relative(1, 0.02));  // standard error of a mean of five: 0.005
}

}  // namespace calibrate_test
