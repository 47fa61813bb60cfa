// Cracks that cost more or less than G_c since the steps are too large: a warning, the end of the run, and what the
// scenario allows.
#include "app/program.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace law_lag_test {

using namespace program;
using knap::tests::relative;

namespace {

/// A block that a crack runs through in steps of a few crossings of a triangle, damped.
const std::string coarse =
    "edge_cracked_block -q -j 1 -s 'mesh.size=4 mm' -s 'time={ end=\"40 us\", bulk=\"implicit\", "
    "cohesion=\"implicit\", theta=1, step=\"10 CFL\" }' "
    "-s output.fields=false -s 'expect={}' " +
    undrawn;

}  // namespace

TEST_CASE("law lag: a crack that is all but free ends the run and is told what to change") {
    const Folder folder("law lag");
    const Answer run = command("run " + coarse + "-o " + folder.in_shell("run"));
    CAPTURE(run.text);
    CHECK(run.code == 3);
    for (const char* words :
         {"law_lag", "does not cost G_c", "limit 0.2", "time.step_cracking", "limits.law_lag", "warning[law_lag]"})
        CHECK_MESSAGE(run.has(words), words);
    const std::string json = text_of(folder.path / "run/run.json");
    for (const char* words : {"\"largest_law_lag\": -", "\"recoverable\": "})
        CHECK_MESSAGE(json.find(words) != std::string::npos, words);

    const Answer allowed = command("run " + coarse + "-s limits.law_lag=2 -o " + folder.in_shell("allowed"));
    CAPTURE(allowed.text);
    CHECK(allowed.code == 0);
    CHECK(allowed.has("warning[law_lag]"));
    CHECK(allowed.has("warning[scheme_dissipation_part]"));  // at the end: theta = 1
    CHECK(allowed.has("a theta nearer to 0.5"));
    // a number of the summary that has the name of a gate is that of the gate
    const auto record = nlohmann::json::parse(text_of(folder.path / "allowed/run.json"));
    int n = 0;
    for (const auto& gate : record["gates"]) {
        const std::string name = gate["name"];
        if (!record["summary"].contains(name) || gate["value"].is_null()) continue;
        CAPTURE(name);
        CHECK(std::abs(record["summary"][name].get<double>()) == relative(gate["value"].get<double>(), 1e-12));
        ++n;
        if (name == "crossing_loss") CHECK(gate["value"].get<double>() > 0);
    }
    CHECK(n >= 3);  // energy_residual, crossing_loss, largest_speed

    const Answer small =
        command("run " + coarse + "-s time.theta=0.5 -s 'time.step=0.5 CFL' -o " + folder.in_shell("small"));
    CAPTURE(small.text);
    CHECK(small.code == 0);
    CHECK_FALSE(small.has("VIOLATED"));
    CHECK_FALSE(small.has("warning[scheme_dissipation_part]"));
}

TEST_CASE("law lag: a hard impact is met in small steps and check says what they cost") {
    // a disc of rock that hits the ground at 25 m/s, 12 critical openings a step; it ended the run after 21 steps
    const Folder folder("hard impact");
    const auto scene = [](const std::string& velocity) {
        return "knap = 1\n[domain]\nrotation = \"large\"\nshape = \"disc\"\ncentre = [0, 0.3443]\nradius = "
               "0.3433\n[mesh]\n"
               "size = 0.12\n[material.rock]\ndensity = 2700\nE = 10e9\nnu = 0.25\n[interface.default]\nsigma_c = "
               "8e6\nG_c = "
               "200\ngamma = 2\nfriction = 0.6\n[contact]\nfriction = 0.5\n[[obstacle]]\nname = \"ground\"\nshape = "
               "\"half "
               "plane\"\nat = [0, 0]\nnormal = [0, 1]\nfriction = 0.5\n[[initial]]\nvelocity = " +
               velocity + "\n[time]\nend = 2e-3\n[output]\nfields = false\nevery = 1e-3\n";
    };
    for (const char* seed : {"1", "2", "3"}) {
        CAPTURE(seed);
        write_scene(folder, scene("[6, -24]"));
        const Answer run = run_scene(
            folder, std::string("-j 1 -s 'figure=[]' --force -s seed=") + seed + " -o " + folder.in_shell("run"));
        CAPTURE(run.text);
        CHECK(run.code == 0);
        const auto record = nlohmann::json::parse(text_of(folder.path / "run/run.json"));
        CHECK(record["cuts"]["impact"].get<int>() > 0);
        CHECK(record["summary"]["dissipated"].get<double>() > 500);
        for (const auto& gate : record["gates"])
            if (gate["name"] == "law_lag") CHECK(gate["value"].get<double>() < 0.05);
    }
    const Answer hard = command("check " + folder.in_shell("scene.toml"));
    CAPTURE(hard.text);
    CHECK(hard.has("warning[hard-impact]"));
    CHECK(hard.has("meet at 24.7 m/s"));
    write_scene(folder, scene("[1, -4]"));  // two critical openings a step
    CHECK_FALSE(command("check " + folder.in_shell("scene.toml")).has("hard-impact"));
    const Answer soft = run_scene(folder, "-j 1 -s 'figure=[]' -o " + folder.in_shell("soft"));
    CHECK(soft.code == 0);
    CHECK(nlohmann::json::parse(text_of(folder.path / "soft/run.json"))["cuts"]["impact"] == 0);
}

}  // namespace law_lag_test
