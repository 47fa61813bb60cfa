// knap study --safety: the factor by which c and tan phi of laws may be divided.
#include "app/program.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <regex>

namespace safety_test {

using namespace program;

namespace {

/// A block of 1 x 0.2 m on a plane with the slope 0.8, glued with c = (1 + 0.4) sigma_c and tan phi = 0.4:
/// F = (c L + W cos a tan phi)/(W sin a) = (1990.4 + 1600)/3200 = 1.122.
const std::string block =
    "# Does it stand?\nknap = 1\nname = \"block\"\n[domain]\nshape = \"rectangle\"\nsize = [1, 0.2]\n[mesh]\n"
    "size = 0.1\n[material.rock]\ndensity = 2000\nE = 1e10\nnu = 0.2\n[interface.default]\nbreakable = false\n"
    "[interface.joint]\nsigma_c = 1421.7142857142858\ndelta_c = 0.02\ngamma = 1\nfriction = 0.4\n[[support]]\n"
    "on = \"bottom\"\ninterface = \"joint\"\nglued = true\n[[load]]\nacceleration = [8, -10]\n[time]\nend = 0.1\n"
    "start = \"equilibrium\"\n";

Answer study(const Folder& folder, const std::string& options) {
    return command("study " + folder.in_shell("scene.toml") + " --safety -q -o " + folder.in_shell("study") + " " +
                   options);
}

struct Bracket {
    double low = 0, high = 0;
};
Bracket bracket_of(const std::string& text) {
    static const std::regex form("factor of safety [0-9.]+: stands at ([0-9.]+), not at ([0-9.]+)");
    std::smatch found;
    if (!std::regex_search(text, found, form)) return {};
    return {std::stod(found[1]), std::stod(found[2])};
}

}  // namespace

TEST_CASE("study --safety: a block on a slope has the factor of its limit equilibrium in all schemes") {
    for (const std::string bulk : {"implicit", "explicit", "auto"}) {
        const Folder folder("safety_" + bulk);
        write_scene(folder,
                    block + "bulk = \"" + bulk + "\"\n" + (bulk == "implicit" ? "cohesion = \"implicit\"\n" : ""));
        const Answer answer = study(folder, "--laws joint");
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        const auto [low, high] = bracket_of(answer.text);
        CHECK(low < 1.122 * 1.005);
        CHECK(high > 1.122 * 0.995);
        CHECK(high - low <= 0.005 * low);
        CHECK(fs::exists(folder.path / "study/figures/mechanism.png"));
        CHECK(fs::exists(folder.path / "study/report.html"));
        CHECK(text_of(folder.path / "study/safety.md").find("factor of safety 1.1") != std::string::npos);
        CHECK(text_of(folder.path / "study/safety.csv").starts_with("run,factor,verdict,status,"));
    }
}

// thawing_joint without ice: c = (gamma + mu) sigma_c = 50.455 kPa on 28.284 m, mu = 0.5, W = 3.2445 MN/m at
// 45 degrees, F = mu/tan 45 + c L/(W sin 45) = 1.122; the elastic wedge slips unevenly, which costs less than a half per cent
TEST_CASE("study --safety: a wedge on a joint has the factor of planar sliding within one per cent") {
    for (const std::string bulk : {"implicit -s time.cohesion=implicit", "auto -s time.cohesion= -s time.step="}) {
        const Folder folder("safety_wedge");
        const Answer answer = command(
            "study thawing_joint --safety --laws rock-wedge -q -o " + folder.in_shell("study") +
            " -s heat= -s interface.rock-wedge.strength_table= -s interface.rock-wedge.sigma_c=\"33.637 kPa\" -s "
            "load[0].ramp= -s figure= -s expect= -s time.start=equilibrium -s time.end=\"3 s\" -s mesh.size=\"5 m\" "
            "-s time.bulk=" +
            bulk);
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        const auto [low, high] = bracket_of(answer.text);
        CHECK(low > 1.122 * 0.99);
        CHECK(high < 1.122 * 1.01);
        CHECK(fs::exists(folder.path / "study/figures/mechanism.png"));
    }
}

TEST_CASE("study --safety: the same command is done at once and more runs at a time find the same factor") {
    const Folder folder("safety_again");
    write_scene(folder, block + "bulk = \"implicit\"\ncohesion = \"implicit\"\n");
    const Answer first = study(folder, "");
    CAPTURE(first.text);
    REQUIRE(first.code == 0);
    const auto time = fs::last_write_time(folder.path / "study/runs/F1/run.json");
    const Answer again = study(folder, "");
    CHECK(again.code == 0);
    CHECK(bracket_of(again.text).low == bracket_of(first.text).low);
    CHECK(fs::last_write_time(folder.path / "study/runs/F1/run.json") == time);
    CHECK(bracket_of(first.text).low < 1.122 * 1.005);
    CHECK(bracket_of(first.text).high > 1.122 * 0.995);
    for (const std::string at_once : {"2", "3"}) {
        const Answer faster = study(folder, "--force -j " + at_once);
        CHECK(faster.code == 0);
        CHECK(bracket_of(faster.text).low == bracket_of(first.text).low);
        CHECK(bracket_of(faster.text).high == bracket_of(first.text).high);
    }
}

// Without [contact] what slides off its ground falls through it: the picture shows the beginning.
TEST_CASE("study --safety: the mechanism is drawn where it begins with displacements that can be seen") {
    const Folder folder("safety_mechanism");
    write_scene(folder, block + "bulk = \"explicit\"\n");
    const Answer answer = study(folder, "-s time.end=2 -s study.safety.factors=[1,3] -s study.safety.tolerance=0.5");
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    const std::string report = text_of(folder.path / "study/report.html");
    static const std::regex caption(
        "The mechanism of F[0-9.a-z_]+, which has moved by ([0-9.]+) (mm|m) at [^;]*; "
        "displacements × ([0-9.]+)");
    std::smatch found;
    REQUIRE(std::regex_search(report, found, caption));
    const double moved = std::stod(found[1]) * (found[2] == "mm" ? 1e-3 : 1), shown = moved * std::stod(found[3]);
    const double diagonal = std::hypot(1, 0.2);
    CHECK(moved > 0.01 * diagonal);
    CHECK(moved < 0.2);  // over 2 s it would fall by metres
    CHECK(shown > 0.02 * diagonal);
    CHECK(shown <= 0.0501 * diagonal);
}

TEST_CASE("study --safety: what has no factor says why") {
    const Folder folder("safety_none");
    write_scene(folder, block + "bulk = \"implicit\"\ncohesion = \"implicit\"\n");
    const auto says = [&](const std::string& options, int code, const std::string& words) {
        const Answer answer = study(folder, "--force " + options);
        CAPTURE(options);
        CAPTURE(answer.text);
        CHECK(answer.code == code);
        CHECK(answer.has(words));
    };
    says("-s study.safety.factors=[1.2,3]", 3, "the body does not stand at factor 1.2: no equilibrium");
    says("-s study.safety.factors=[1,1.05]", 3, "the body stands at factor 1.05, the largest one");
    says("-s support[0].glued=false", 3, "`support[0]` is not glued: of the law `joint` it has the friction alone");
    says("--laws seam", 2, "there is no interface law `seam`");
    says("--laws default", 2, "the law `default` has neither strength nor friction to divide");
    says("-s study.safety.factors=[2,1]", 2, "does not ascend");
    says("--print-commands", 2, "cannot be listed before");
}

}  // namespace safety_test
