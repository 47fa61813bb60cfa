// A run that leaves what knap computes says so, goes on, and ends where its results would mislead; [limits] moves that
// end.
#include "app/program.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace limits_test {

using namespace program;
using knap::tests::relative;

namespace {

using Json = nlohmann::json;

Json record_of(const Folder& folder) { return Json::parse(text_of(folder.path / "run/run.json")); }

Json gate_of(const Json& record, const std::string& name) {
    for (const Json& gate : record["gates"])
        if (gate["name"] == name) return gate;
    return {};
}

std::size_t count(const std::string& text, const std::string& words) {
    std::size_t n = 0;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++n;
    return n;
}

const std::string rock = "[material.rock]\ndensity = 2600\nE = 20e9\nnu = 0.2\n";
const std::string unbreakable = "[interface.default]\nbreakable = false\n";

/// A free bar that turns by some 54 degrees in 4 ms.
const std::string spin = rectangle("0.04, 0.01", "0.005", "origin = [-0.02, -0.005]\n") + rock + unbreakable +
                         "[[initial]]\nvelocity = [0, 5]\nbox = [0, -0.005, 0.02, 0.005]\n[[initial]]\nvelocity = [0, "
                         "-5]\nbox = [-0.02, -0.005, 0, 0.005]\n"
                         "[time]\nend = \"4 ms\"\n[output]\nfields = false\n";

/// A soft block with a slot that is squeezed shut.
const std::string slot =
    rectangle("0.04, 0.02", "0.0014",
              "[[domain.hole]]\npoints = [[0.005, 0.0095], [0.035, 0.0095], [0.035, 0.0105], [0.005, 0.0105]]\n") +
    "[material.gel]\ndensity = 1000\nE = 1e6\nnu = 0.3\n" + unbreakable +
    "[[load]]\non = \"bottom\"\ndisplacement = [0, 0]\n[[load]]\non = \"top\"\nvelocity = [0, -0.5]\nramp = \"1 "
    "ms\"\n[time]\nend = \"6 ms\"\n"
    "[output]\nfields = false\n";

/// The upper half of a cracked block slides over the lower one, pressed.
const std::string slide = rectangle("0.04, 0.02", "0.0025", "[[domain.crack]]\npoints = [[0, 0.01], [0.04, 0.01]]\n") +
                          rock +
                          "[interface.default]\nsigma_c = 1e8\nG_c = 100\n[[load]]\non = \"bottom\"\ndisplacement = "
                          "[0, 0]\n[[load]]\non = \"top\"\ntraction = [0, -1e6]\n"
                          "[[initial]]\nvelocity = [60, 0]\nbox = [0, 0.01, 0.04, 0.02]\n[time]\nend = \"0.1 "
                          "ms\"\n[output]\nfields = false\n";

Answer run(const Folder& folder, const std::string& scenario, const std::string& more = "") {
    std::ofstream(folder.path / "scene.toml") << scenario;
    return command("run " + folder.in_shell("scene.toml") + " -q -j 1 --force -s output.report=false -o " +
                   folder.in_shell("run") + " " + more);
}

}  // namespace

TEST_CASE("limits: a bar that turns is warned of from 5 degrees and ends its run at 30") {
    const Folder folder("spin");
    const Answer turned = run(folder, spin, "-s 'expect.fragments={ at_least = 1 }'");
    CHECK(turned.code == 3);
    CHECK(turned.has("expect: 1 number not judged, because the run failed"));
    CHECK(turned.has("\n          Set domain.rotation = \"large\""));
    CHECK(count(turned.text, "warning[rotation]") == 1);
    CHECK(turned.has("gate rotation violated"));
    const Json record = record_of(folder);
    CHECK(record["status"] == "failed");
    const Json gate = gate_of(record, "rotation");
    CHECK(gate["level"] == "violated");
    CHECK(gate["pass"] == false);
    CHECK(gate["value"].get<double>() > 30);
    CHECK(gate["value"].get<double>() < 31);  // it is looked at often enough
    CHECK(gate["place_m"].size() == 2);
    CHECK(record["summary"]["largest_rotation"] == gate["value"]);
    CHECK(fs::exists(folder.path / "run/energy.csv"));
    CHECK(count(text_of(folder.path / "run/log.txt"), "warning[rotation]") == 1);

    SUBCASE("a shorter run is warned of and done") {
        const Answer part = run(folder, spin, "-s 'time.end=1 ms'");
        CHECK(part.code == 0);
        CHECK(count(part.text, "warning[rotation]") == 1);
        const Json warned = record_of(folder);
        CHECK(warned["status"] == "done");
        CHECK(gate_of(warned, "rotation")["level"] == "warning");
        CHECK(gate_of(warned, "rotation")["pass"] == true);
        const auto& warnings = warned["warnings"];
        CHECK(std::count_if(warnings.begin(), warnings.end(), [](const Json& one) {
                  return one.get<std::string>().find("largest rotation") != std::string::npos;
              }) == 1);
    }
    SUBCASE("and of one that would be a hundred times longer") {
        const Answer whole = run(folder, spin, "-s 'time.end=400 ms'");
        CHECK(whole.code == 3);
        CHECK(count(whole.text, "warning[rotation]") == 1);
        CHECK(gate_of(record_of(folder), "rotation")["value"].get<double>() < 31);
    }
    SUBCASE("a very short one is not") {
        const Answer part = run(folder, spin, "-s 'time.end=0.1 ms'");
        CHECK(part.code == 0);
        CHECK_FALSE(part.has("warning["));
        CHECK(gate_of(record_of(folder), "rotation")["level"] == "ok");
    }
    SUBCASE("the scenario may allow it") {
        const Answer allowed = run(folder, spin, "-s limits.rotation=none -s limits.area_change=none");
        CHECK(allowed.code == 0);
        CHECK(count(allowed.text, "warning[rotation]") == 1);
        CHECK(gate_of(record_of(folder), "rotation")["value"].get<double>() > 50);
        CHECK(gate_of(record_of(folder), "rotation")["limit"].is_null());
        CHECK(run(folder, spin, "-s 'limits.rotation=40 deg' -s limits.area_change=none").code == 3);
        CHECK(gate_of(record_of(folder), "rotation")["value"].get<double>() > 40);
        CHECK(gate_of(record_of(folder), "rotation")["value"].get<double>() < 41);
    }
}

TEST_CASE("limits: a run that ends before the time of its only figure draws its end") {
    const Folder folder("early_figure");
    const Answer ended = run(folder, spin + "[[figure]]\nfile = \"late.png\"\nshow = \"cracks\"\nat = \"4 ms\"\n");
    CAPTURE(ended.text);
    CHECK(ended.code == 3);
    CHECK(ended.has("gate rotation violated"));
    CHECK(record_of(folder)["status"] == "failed");
}

TEST_CASE("limits: with large rotations the bar turns as far as it likes") {
    const Folder folder("spin large");
    const std::string large =
        spin.substr(0, spin.find("[mesh]")) + "rotation = \"large\"\n" + spin.substr(spin.find("[mesh]"));
    const Answer turned = run(folder, large, "-s 'time.end=40 ms'");
    CHECK(turned.code == 0);
    CHECK_FALSE(turned.has("warning["));
    const Json record = record_of(folder);
    CHECK(gate_of(record, "rotation")["value"].is_null());
    CHECK(gate_of(record, "strain")["value"].get<double>() > 0);
    CHECK(gate_of(record, "strain")["value"].get<double>() < 0.01);
    CHECK(gate_of(record, "rotation_work_part")["value"].get<double>() < 1e-3);
    CHECK(record["summary"]["largest_rotation"].get<double>() > 90);
    CHECK(text_of(folder.path / "run/energy.csv").find(",rotation_work [J],") != std::string::npos);
    CHECK(text_of(folder.path / "run/fragments.csv").find(",rotation [deg]") != std::string::npos);

    SUBCASE("but not to strains that are not small") {
        const Answer fast =
            run(folder, large,
                "-s 'initial=[{velocity = [4000, 0], box = [-0.02, -0.005, 0, 0.005]}]' -s 'time.end=0.1 ms'");
        CHECK(fast.code == 3);
        const Json violated = record_of(folder);
        CHECK(gate_of(violated, "area_change")["level"] == "violated");
        CHECK(gate_of(violated, "strain")["level"] == "warning");
    }
    SUBCASE("which the check of the small ones foresees") {
        std::ofstream(folder.path / "scene.toml") << spin;
        const Answer checked = command("check " + folder.in_shell("scene.toml"));
        CHECK(checked.code == 0);
        CHECK(checked.has("warning[spin]"));
        CHECK(checked.has("domain.rotation"));
    }
    SUBCASE("where probes and the table of fragments see the present state") {
        // at 400 rad/s it has turned by 90 degrees after 3.927 ms; mean axial stress: density spin^2 length^2/12
        const Answer spun =
            run(folder, large,
                "-s 'time.end=4.127 ms' -s 'initial=[{ spin = \"400 rad/s\" }]' "
                "-s 'probe=[{ name = \"end\", at = [0.02, 0] }, { name = \"mean\", watch = \"stress\" }]'");
        REQUIRE(spun.code == 0);
        std::istringstream probes(text_of(folder.path / "run/probes.csv"));
        std::string line;
        std::getline(probes, line);
        CHECK(line ==
              "time [s],end_u_x [m],end_u_y [m],end_v_x [m/s],end_v_y [m/s],mean_stress_xx [Pa],"
              "mean_stress_yy [Pa],mean_stress_xy [Pa]");
        double across = 0, along = 0;
        int n = 0;
        while (std::getline(probes, line)) {
            std::array<double, 8> row{};
            std::istringstream cells(line);
            for (double& value : row) {
                std::getline(cells, line, ',');
                value = std::atof(line.c_str());
            }
            if (row[0] < 3.727e-3) continue;  // means over some periods of its vibration
            across += row[5], along += row[6], ++n;
            const double angle = 400 * row[0];
            CHECK(std::abs(row[1] - 0.02 * (std::cos(angle) - 1)) < 2e-4);
            CHECK(std::abs(row[2] - 0.02 * std::sin(angle)) < 2e-4);
        }
        REQUIRE(n > 20);
        CHECK(along / n == relative(2600 * 400. * 400 * 0.04 * 0.04 / 12, 0.05));
        CHECK(across / n < 0.2 * along / n);
        const std::string table = text_of(folder.path / "run/fragments.csv");
        const double rotation = std::atof(table.c_str() + table.rfind(',') + 1);
        CHECK(rotation == relative(400 * 4.127e-3 * 180 / M_PI, 1e-4));
    }
    SUBCASE("nor where sides of second order cannot turn, but in implicit steps") {
        CHECK(run(folder, large, "-s mesh.order=2").code == 2);
        CHECK(run(folder, large, "-s time.bulk=implicit").code == 0);
    }
}

TEST_CASE("limits: the two sides of a slot that go through each other are found") {
    const Folder folder("slot");
    const Answer shut = run(folder, slot, "-s limits.area_change=none");
    CHECK(shut.code == 3);
    CHECK(shut.has("gate overlap violated"));
    const Json summary = record_of(folder)["summary"];
    CHECK(summary["overlap_area"].get<double>() > 1e-6);
    CHECK(summary["overlap_x"].get<double>() > 0.01);
    CHECK(summary["overlap_x"].get<double>() < 0.03);
    CHECK(summary["overlap_y"].get<double>() > 0.005);
    CHECK(summary["overlap_y"].get<double>() < 0.01);
    CHECK(run(folder, slot, "-s limits.area_change=none -s limits.overlap=none").code == 0);
    CHECK(record_of(folder)["summary"]["overlap_area"].get<double>() > summary["overlap_area"].get<double>());
}

TEST_CASE("limits: faces that slid by more than an edge under pressure end the run") {
    const Folder folder("slide");
    const Answer slid = run(folder, slide);
    CHECK(slid.code == 3);
    CHECK(count(slid.text, "warning[slip]") == 1);
    CHECK(slid.has("gate slip violated"));
    CHECK(record_of(folder)["time_s"].get<double>() > 25e-6);  // an edge of some 2 mm at 60 m/s
    CHECK(record_of(folder)["time_s"].get<double>() < 50e-6);
    CHECK(run(folder, slide, "-s limits.slip=none -s limits.overlap=none").code == 0);
    CHECK(record_of(folder)["summary"]["largest_slip"].get<double>() > 1.5);
}

TEST_CASE("limits: free faces that meet too fast or lie too deep end the run with place and value and cure") {
    // a square that spins falls onto another one
    const std::string squares =
        "knap = 1\nname = \"squares\"\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.005\n" + rock + unbreakable +
        "[contact]\nfriction = 0.5\n[[body]]\nname = \"lower\"\nshape = \"rectangle\"\nsize = [0.04, 0.02]\n"
        "[[body]]\nname = \"upper\"\nshape = \"rectangle\"\norigin = [0.01, 0.021]\nsize = [0.02, 0.02]\n"
        "velocity = [0, -10]\nspin = 200\n[time]\nend = \"0.3 ms\"\n[output]\nevery = \"0.1 ms\"\n";
    const Folder folder("squares");
    const Answer meets = run(folder, squares);
    CHECK(meets.code == 0);
    const double depth = gate_of(record_of(folder), "contact_depth")["value"].get<double>();
    REQUIRE(depth > 0);
    CHECK(depth < 0.01);
    CHECK(gate_of(record_of(folder), "contact_residual")["value"].get<double>() < 1e-8);

    const auto refused = [&](const std::string& settings, const std::string& reason, const std::string& cure) {
        CAPTURE(settings);
        const Answer stuck = run(folder, squares, settings + " -s output.report=true");
        CHECK(stuck.code == 3);
        CHECK(stuck.has("the run cannot continue from t = "));
        CHECK(stuck.has(" at (0.0"));
        CHECK(stuck.has(cure));
        CHECK(stuck.has(" of an edge)"));
        const Json record = record_of(folder);
        CHECK(record["status"] == "failed");
        CHECK(record["cuts"][reason] == 11);
        const std::string log = text_of(folder.path / "run/log.txt");
        CHECK(count(log, "cutback:") == 11);
        for (const char* file : {"energy.csv", "fragments.csv", "report.html", "run.pvd"})
            CHECK(fs::exists(folder.path / "run" / file));
    };
    std::ostringstream unreachable;  // the depth falls with the square of the step
    unreachable << 1e-7 * depth;
    refused("-s limits.contact_depth=" + unreachable.str(), "contact_depth", "[limits] contact_depth sets another");
    refused("-s 'time.end=1 us' -s 'body[1].velocity=[0, -3e7]'", "contact_speed", "units of velocities");
    CHECK(run(folder, squares, "-s limits.contact_depth=none").code == 0);
}

TEST_CASE("limits: loads on few light parts stop no run") {
    const Folder folder("light");
    // a point load, whose vertex has all the energy of the first step
    const std::string block = rectangle("0.1, 0.04", "0.002") + rock + unbreakable;
    const std::string point =
        "[[load]]\non = { box = [0.0487, 0.0399, 0.0513, 0.0401] }\nforce = [0, -100]\nramp = \"5 us\"\n[time]\nend = "
        "\"10 us\"\n[output]\nfields = false\n";
    CHECK(run(folder, block + point).code == 0);
    CHECK(gate_of(record_of(folder), "largest_speed")["pass"] == true);
}

TEST_CASE("limits: an obstacle that begins a few nanometres in the body is beside it") {
    const Folder folder("touching");
    const auto block = [](const std::string& height) {
        return rectangle("0.04, 0.02", "0.002") + rock + unbreakable +
               "[[obstacle]]\nshape = \"half plane\"\nat = [0, \"" + height +
               "\"]\nnormal = [0, 1]\n[[load]]\nacceleration = [0, -9.81]\n"
               "[time]\nend = \"20 us\"\n[output]\nfields = false\n";
    };
    CHECK(run(folder, block("5 nm")).code == 0);
    const Json summary = record_of(folder)["summary"];
    CHECK(summary["largest_penetration"].get<double>() <= 6e-9);
    CHECK(summary["largest_speed"].get<double>() <=
          1e-3);  // 9.81 m/s2 for 20 us, and waves; it is not thrown out, 5 nm in a step
    const Answer deep = run(folder, block("5 um"));
    CHECK(deep.code == 2);
    CHECK(deep.has("lies in the body at the start, by 5 µm"));
}

TEST_CASE("limits: a crack that did not grow has no mean speed and one whose growth is in few lines has the same") {
    const Folder folder("no_speed");
    REQUIRE(run(folder, spin, "-s 'time.end=0.1 ms'").code == 0);
    CHECK(record_of(folder)["summary"]["mean_tip_speed"].is_null());
    REQUIRE(
        command("run " + small_block() + "-s 'output.history_every=10 us' --force -o " + folder.in_shell("run")).code ==
        0);
    const double in_few_lines = record_of(folder)["summary"]["mean_tip_speed"].get<double>();
    REQUIRE(command("run " + small_block() + "--force -o " + folder.in_shell("run")).code == 0);
    CHECK(record_of(folder)["summary"]["mean_tip_speed"].get<double>() == in_few_lines);
    CHECK(in_few_lines > 100);
    CHECK(record_of(folder)["summary"]["mean_tip_speed"].get<double>() < 3000);
}

}  // namespace limits_test
