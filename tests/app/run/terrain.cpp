// Bodies on an obstacle that is a terrain: they slide and rest on it as on planes, in both schemes, and what starts in
// its ground is refused.
#include "app/program.hpp"
#include "output/history_csv.hpp"

#include <cmath>

namespace terrain_run_test {

using namespace program;

namespace {

const std::string rock =
    "[material.rock]\ndensity = 2600\nE = \"10 GPa\"\nnu = 0.25\n[interface.default]\nbreakable = "
    "false\nfriction = 0\nrestitution = 0\n";

std::string point(double x, double y) {
    char text[80];
    snprintf(text, sizeof text, "[%.17g, %.17g]", x, y);
    return text;
}

/// A square of 0.4 m, which turns by -`angle` about the origin and lies there on `ground`.
std::string on_slope(double angle, const std::string& ground, const std::string& more) {
    const auto at = [&](double x, double y) {
        return point(x * std::cos(angle) + y * std::sin(angle), -x * std::sin(angle) + y * std::cos(angle));
    };
    return "knap = 1\n[domain]\nshape = \"polygon\"\npoints = [" + at(-0.2, 0) + ", " + at(0.2, 0) + ", " +
           at(0.2, 0.4) + ", " + at(-0.2, 0.4) + "]\n[mesh]\nsize = 0.2\n" + rock +
           "[[load]]\nacceleration = [0, -9.81]\n[[obstacle]]\nname = \"ground\"\n" + ground +
           "[output]\nevery = 0.005\nfields = false\nhistory_every = 0.005\n" + more;
}

/// A straight slope with the ground on its left, of n sides.
std::string sides(double angle, int n) {
    std::string text = "shape = \"polyline\"\npoints = [";
    for (int i = 0; i <= n; ++i) {
        const double s = 2 - 4. * i / n;
        text += (i > 0 ? ", " : "") + point(s * std::cos(angle), -s * std::sin(angle));
    }
    return text + "]\n";
}

std::string with_rotation(const std::string& rotation, std::string text) {
    return text.replace(text.find("[domain]\n"), 9, "[domain]\nrotation = \"" + rotation + "\"\n");
}

std::vector<double> run_column(const Folder& folder, const std::string& name, const std::string& text,
                               const char* table, const char* column) {
    write_scene(folder, text);
    const Answer answer = run_scene(folder, "-j 1 -s 'figure=[]' -o " + folder.in_shell(name));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    return knap::read_csv(folder.path / name / table).column(column);
}

}  // namespace

TEST_CASE("terrain: a body slides on a straight terrain of many sides as on a plane") {
    const Folder folder("slides");
    const double angle = 20 * M_PI / 180;
    const std::string plane =
        "shape = \"half plane\"\nat = [0, 0]\nnormal = " + point(std::sin(angle), std::cos(angle)) + "\n";
    for (const char* rotation : {"small", "large"}) {
        CAPTURE(rotation);
        const auto path = [&](const std::string& name, const std::string& ground) {
            const std::string text = with_rotation(rotation, on_slope(angle, ground, "[time]\nend = 0.05\n"));
            return run_column(folder, rotation + name, text, "fragment_paths.csv", "centre_x").back();
        };
        CHECK(path("terrain", sides(angle, 60)) == doctest::Approx(path("plane", plane)).epsilon(1e-9));
    }
}

TEST_CASE("terrain: a body rests in a valley of a terrain with its weight in both schemes") {
    const Folder folder("rests");
    const double weight = 2600 * 0.16 * 9.81;
    // a corner of 90 degrees whose sides the square touches with two of its own
    const std::string valley = "shape = \"polyline\"\npoints = [[2, 2], [0, 0], [-2, 2]]\n";
    const auto force = [&](const std::string& name, const std::string& time) {
        const std::string square = on_slope(-M_PI / 4, valley, time);
        const std::size_t from = square.find("points = ["), to = square.find("]\n", from);
        const std::string moved = square.substr(0, from) + "points = [[0, 0], " +
                                  point(0.4 * std::sqrt(0.5), 0.4 * std::sqrt(0.5)) + ", " +
                                  point(0, 0.8 * std::sqrt(0.5)) + ", " +
                                  point(-0.4 * std::sqrt(0.5), 0.4 * std::sqrt(0.5)) + square.substr(to);
        return run_column(folder, name, moved, "reactions.csv", "ground_force_y").back();
    };
    CHECK(force("explicit", "[time]\nend = 0.02\nstart = \"equilibrium\"\n") == doctest::Approx(weight).epsilon(1e-6));
    CHECK(force("implicit", "[time]\nend = 0.02\nbulk = \"implicit\"\nstep = 1e-3\nstart = \"equilibrium\"\n") ==
          doctest::Approx(weight).epsilon(1e-6));
}

TEST_CASE("terrain: a body that starts in the ground is refused with the cure") {
    const Folder folder("below");
    for (const char* points : {"[-1, -0.1], [2, -0.1]", "[2, 0.02], [-1, 0.02]", "[2, 5], [-1, 5]"}) {
        CAPTURE(points);
        const std::string hill =
            std::string("[[obstacle]]\nname = \"hill\"\nshape = \"polyline\"\npoints = [") + points + "]\n";
        const std::string text = rectangle("1, 0.05", "0.02") + rock + hill + "[time]\nend = 1e-4\n";
        check_refused(folder, text, "overlap", "starts in the ground of obstacle `hill`");
    }
}

TEST_CASE("terrain: a resumed run on a terrain has the same bits") {
    // over a summit and a valley with large rotations; and figures of it
    const std::string ground =
        "friction = 0.3\nshape = \"polyline\"\npoints = [[3, -0.5], [0.6, -0.6], [0.25, -0.1], [-2, 0.73]]\n";
    const std::string text = with_rotation("large", on_slope(20 * M_PI / 180, ground, "[time]\nend = 0.02\n"));
    const Folder folder("resumed terrain");
    write_scene(folder, text + "[[figure]]\nfile = \"speed.png\"\nshow = \"speed\"\n");
    REQUIRE(run_scene(folder, "-j 1 -o " + folder.in_shell("whole")).code == 0);
    REQUIRE(run_scene(folder, "-j 2 --until 8ms -o " + folder.in_shell("parts")).code == 0);
    REQUIRE(run_scene(folder, "-j 2 -o " + folder.in_shell("parts")).code == 0);
    check_same(folder.path / "whole", folder.path / "parts", 3);
    CHECK(fs::file_size(folder.path / "whole/figures/speed.png") > 1000);
}

}  // namespace terrain_run_test
