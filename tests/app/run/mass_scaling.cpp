// time.mass_scaling: check proposes it and says what moves, a run books it, another body does not go on from it.
#include "app/program.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace mass_scaling_app_test {

using namespace program;
using knap::tests::relative;
using nlohmann::json;

namespace {

/// A plate with two joints that cross at 1.6 degrees, pulled; the time table is open at its end.
const std::string joints =
    rectangle("0.2, 0.1", "0.01",
              "crack = [{ points = [[0.02, 0.05], [0.18, 0.05]], interface = \"joint\" },\n"
              "         { points = [[0.02, 0.0478], [0.18, 0.0522]], interface = \"joint\" }]\n") +
    "[material.rock]\ndensity = 2650\nE = \"40 GPa\"\nnu = 0.2\n[interface.default]\nsigma_c = \"5 MPa\"\nG_c = 50\n"
    "[interface.joint]\nsigma_c = \"1 MPa\"\nG_c = 5\nfriction = 0.5\n"
    "[[load]]\non = \"top\"\ntraction = [0, \"2 MPa\"]\n[[load]]\non = \"bottom\"\ntraction = [0, \"-2 MPa\"]\n"
    "[output]\nstates = \"20 us\"\nfields = false\n[time]\nend = \"40 us\"\n";

}  // namespace

TEST_CASE("mass scaling: check proposes it where it pays and says what moves where") {
    const Folder folder("mass_scaling_check");
    const Answer without = accepted(folder, joints);
    CAPTURE(without.text);
    CHECK(without.has("times as long with time.mass_scaling = \"1 %\", which moves "));
    const Answer with = accepted(folder, joints + "mass_scaling = \"1 %\"\n");
    CAPTURE(with.text);
    CHECK(with.has("mass scaling: steps are "));
    CHECK(with.has(" others, of which that at (0."));
    CHECK_FALSE(with.has("times as long with time.mass_scaling"));
    for (const std::string other : {"bulk = \"implicit\"\n", "step = \"1 ns\"\n"})
        CHECK_FALSE(accepted(folder, joints + other).has("times as long with time.mass_scaling"));
    check_refused(folder, joints + "mass_scaling = \"1 %\"\nbulk = \"implicit\"\n", "exclusive-keys",
                  "its steps have any size");
    check_refused(folder, joints + "mass_scaling = \"6 %\"\n", "out-of-range", "scene.toml:");
    check_refused(folder, joints + "mass_scaling = \"1 kg\"\n", "wrong-unit", "mass_scaling");
}

TEST_CASE("mass scaling: a run takes the longer step and says what moved and closes its balance") {
    const Folder folder("mass_scaling_run");
    std::vector<json> runs;
    for (const std::string more : {"", "mass_scaling = \"1 %\"\n"}) {
        write_scene(folder, joints + more);
        const Answer run = run_scene(folder, "-j 1 -o " + folder.in_shell("run" + std::to_string(runs.size())));
        CAPTURE(run.text);
        REQUIRE(run.code == 0);
        runs.push_back(json::parse(text_of(folder.path / ("run" + std::to_string(runs.size())) / "run.json")));
    }
    CHECK_FALSE(runs[0].contains("mass_scaling"));
    CHECK_FALSE(runs[0]["summary"].contains("moved_kinetic_energy"));
    const json moved = runs[1]["mass_scaling"], found = runs[1]["summary"];
    CHECK(moved["gain"] > 1.2);
    CHECK(moved["moved"] <= 0.01);
    CHECK(moved["heavier"] > 0);
    CHECK(moved["heaviest"].size() <= 10);
    CHECK(std::abs(moved["heaviest"][0]["y"].get<double>() - 0.05) < 0.005);  // at the joints
    CHECK(runs[0]["steps"].get<double>() / runs[1]["steps"].get<double>() ==
          relative(moved["gain"].get<double>(), 0.02));
    CHECK(found["energy_residual"] < 1e-12);
    CHECK(std::abs(found["moved_kinetic_energy"].get<double>()) < 0.02 * found["kinetic_energy"].get<double>());
    CHECK(found["dissipated"].get<double>() == relative(runs[0]["summary"]["dissipated"].get<double>(), 0.1));
    // the other body has other momenta
    const std::string start = "start = \"run:run1@20us\"\n";
    check_refused(folder, joints + start, "another-body", "`time.mass_scaling` is 0.01 there");
    accepted(folder, joints + start + "mass_scaling = \"1 %\"\n");
}

}  // namespace mass_scaling_app_test
