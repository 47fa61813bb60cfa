// Friction over pressure from a file: the same as its table, which takes its place in the resolved scenario.
#include "samples.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

namespace friction_over_pressure_test {

using namespace knap;

TEST_CASE("friction over pressure from a csv file is part of the resolved scenario and its mistakes are named") {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_scenario_friction";
    std::filesystem::create_directories(directory);
    const auto write = [&](const char* content) { std::ofstream(directory / "shear.csv") << content; };
    std::ofstream(directory / "s.toml") << samples::changed("G_c = 3\n", "G_c = 3\nfriction_csv = \"shear.csv\"\n");
    const auto read = [&] { return read_scenario(directory / "s.toml"); };
    write("pressure [MPa], shear [kPa]\n0, 0\n1, 1500\n4, 3000  # last\n");
    const ReadResult found = read();
    const CohesiveLaw& law = found.scenario.laws[0].law;
    REQUIRE(law.over_pressure);
    CHECK((*law.over_pressure)(2e6) == tests::relative(2e6, 1e-12));
    CHECK(law.friction == tests::relative((*law.over_pressure)(law.sigma_c) / law.sigma_c, 1e-12));
    CHECK(found.values.find("interface.default.friction_csv") == nullptr);
    const ReadResult again = samples::read(resolved_toml(found));
    CHECK((*again.scenario.laws[0].law.over_pressure)(2e6) == (*law.over_pressure)(2e6));
    for (const auto& [content, code] :
         {std::pair{"pressure [MPa], shear [kPa]\n0, 0\n1, 1500\n4, 9000\n", "out-of-range"},
          {"pressure [MPa], shear [m]\n0, 0\n1, 1500\n", "bad-csv"},
          {"shear [MPa], pressure [MPa]\n0, 0\n1, 1500\n", "bad-csv"},
          {"pressure, shear\n0, 0\n1, 1500\n", "bad-csv"},
          {"pressure [MPa], shear [kPa]\n0, 0\n1, one\n", "bad-csv"}}) {
        write(content);
        CAPTURE(content);
        const std::vector<Diagnostic> mistakes = samples::mistakes_of(read);
        REQUIRE(!mistakes.empty());
        CHECK(mistakes[0].code == code);
    }
    std::filesystem::remove_all(directory);
}

}  // namespace friction_over_pressure_test
