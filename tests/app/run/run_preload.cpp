// knap run with time.start = "equilibrium": a body that rests under its loads, and those that cannot begin.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace run_preload_test {

using namespace program;

namespace {

/// A column of stone, glued to the support and pulled upwards; `load` on its top [MPa].
std::string column(const Folder& folder, const std::string& load, const std::string& more = "") {
    std::ofstream(folder.path / "column.toml")
        << "knap = 1\nname = \"column\"\n[domain]\nshape = \"rectangle\"\nsize = [\"100 mm\", \"300 mm\"]\n"
           "model = \"plane stress\"\n[mesh]\nsize = \"20 mm\"\n[material.stone]\ndensity = \"2000 kg/m3\"\n"
           "E = \"10 GPa\"\nnu = 0\n[interface.default]\nsigma_c = \"1 MPa\"\nG_c = \"10 J/m2\"\n"
           "[[support]]\non = \"bottom\"\ninterface = \"default\"\nglued = true\n[[load]]\non = \"top\"\n"
           "traction = [\"0 MPa\", \"0.9 MPa\"]\n[time]\nend = \"1 ms\"\nbulk = \"implicit\"\ncohesion = \"implicit\"\n"
           "start = \"equilibrium\"\n[output]\nfields = false\n"
        << more;
    return "run " + folder.in_shell("column.toml") + " -q -j 1 -s 'load[0].traction=[\"0 MPa\", \"" + load +
           " MPa\"]' -o " + folder.in_shell("run");
}

}  // namespace

TEST_CASE("a run from equilibrium begins with the strain of its preload and rests") {
    const Folder folder("preload");
    for (const char* bulk : {"implicit", "explicit"}) {
        const Answer rests = command(column(folder, "0.9") + " --force -s time.bulk=" + bulk +
                                     " -s 'expect={energy_residual={at_most=1e-12}, largest_speed={at_most=1e-9}, "
                                     "broken_length={at_most=0}, strain_energy={value=1.215, within=1e-9}}'");
        CAPTURE(rests.text);
        const auto record = nlohmann::json::parse(text_of(folder.path / "run/run.json"));
        double sum = 0;
        for (const auto& part : record["cpu_parts_s"]) sum += part.get<double>();
        CHECK(record["cpu_parts_s"]["preload"] > 0);
        CHECK(std::abs(sum - record["cpu_s"].get<double>()) <= 1e-9 * sum);
        CHECK(rests.code == 0);  // 1/2 sigma^2/E times the volume of .03 m3 is 1.215 J
    }
}

TEST_CASE("glue at an end whose motion is prescribed across it holds to its strength") {
    const Folder folder("preload_held");
    const Answer rests = command(
        column(folder, "0.9", "[[load]]\non = \"right\"\nvelocity = [\"0 m/s\", \"free\"]\n") +
        " -s 'expect={energy_residual={at_most=1e-12}, largest_speed={at_most=1e-9}, broken_length={at_most=0}}'");
    CAPTURE(rests.text);
    CHECK(rests.code == 0);
    CHECK_FALSE(rests.has("cohesion begins to fall"));
}

TEST_CASE("a run from equilibrium that its interfaces or supports do not hold fails and says where") {
    const Folder folder("overload");
    const Answer breaks = command(column(folder, "1.02"));
    CAPTURE(breaks.text);
    CHECK(breaks.code == 3);
    CHECK(
        breaks.has("no equilibrium under the loads at t = 0 s: the preload is more than the interfaces hold, what "
                   "breaks loose would move away with "));
    const Answer flies = command(column(folder, "0.5") + " --force -s 'support=[]'");
    CAPTURE(flies.text);
    CHECK(flies.code == 2);  // known before it runs
    CHECK(flies.has("nothing holds the body around (0.05, 0.15) m: a force of (0, 5e+04) N"));
    const Answer check = command("check " + folder.in_shell("column.toml") + " -s 'support=[]'");
    CHECK(check.code == 2);
    CHECK(check.has("error[not-held]"));
    CHECK(check.has("column.toml:"));
}

}  // namespace run_preload_test
