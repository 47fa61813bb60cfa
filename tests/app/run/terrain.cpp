// Bodies on an obstacle that is a terrain: they slide and rest on it as on planes, in both schemes, and what starts in
// its ground is refused.
#include "app/program.hpp"
#include "base/random.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace terrain_run_test {

using namespace program;
using knap::tests::relative;

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
        CHECK(path("terrain", sides(angle, 60)) == relative(path("plane", plane), 1e-9));
    }
}

TEST_CASE("terrain: a square slides over the seams of flush slabs as on one plane") {
    const Folder folder("seams");
    const std::string slabs = [] {
        std::string text;
        for (int k = -4; k < 6; ++k) {  // seams at 0, 0.37, 0.74 ...
            if (k > -4) text += "[[obstacle]]\nname = \"slab" + std::to_string(k) + "\"\n";
            const double x = 0.37 * k;
            text += "shape = \"polygon\"\npoints = [" + point(x, -1) + ", " + point(x + 0.37, -1) + ", " +
                    point(x + 0.37, 0) + ", " + point(x, 0) + "]\nfriction = 0.3\n";
        }
        return text;
    }();
    const std::string time = "[time]\nend = 0.2\n[[initial]]\nvelocity = [4, 0]\n";
    for (const char* more : {"", "[contact]\n[rigid]\nstep = 1e-3\nrestitution = 0\n"}) {
        CAPTURE(more);
        const auto path = [&](const std::string& name, const std::string& ground) {
            return run_column(folder, name + (*more ? "rigid" : ""),
                              with_rotation("large", on_slope(0, ground, time + more)), "fragment_paths.csv",
                              "centre_x")
                .back();
        };
        const double on_slabs = path("slabs", slabs),
                     on_plane = path("plane", "shape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]\nfriction = 0.3\n");
        CHECK(on_plane > 0.7);  // over two seams by all of its nodes
        CHECK(on_slabs == relative(on_plane, 1e-9));
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
    CHECK(force("explicit", "[time]\nend = 0.02\nstart = \"equilibrium\"\n") == relative(weight, 1e-6));
    CHECK(force("implicit", "[time]\nend = 0.02\nbulk = \"implicit\"\nstep = 1e-3\nstart = \"equilibrium\"\n") ==
          relative(weight, 1e-6));
}

TEST_CASE("terrain: a body loses mu g L on every range of a terrain that it slides over") {
    const Folder folder("ranges");
    const std::string ground =
        "shape = \"polyline\"\npoints = [[9, 0], [-9, 0]]\nfriction = 0\n"
        "[[obstacle.range]]\nfrom = 0.5\nto = 0.8\nfriction = 0.2\n"
        "[[obstacle.range]]\nfrom = 1\nto = 1.1\nfriction = 0.5\n";
    const std::string text = on_slope(0, ground, "[time]\nend = 0.15\n[[initial]]\nvelocity = [10, 0]\n");
    const double v = run_column(folder, "slides", text, "fragment_paths.csv", "velocity_x").back();
    // its nodes pass both ranges one after the other; while it is braked those in front bear more than those behind
    CHECK(10 * 10 - v * v == relative(2 * 9.81 * (0.2 * 0.3 + 0.5 * 0.1), 0.04));
}

TEST_CASE(
    "terrain: fast and spinning boulders and triangles stay above a rough terrain of corners finer than an edge") {
    const Folder folder("rough");
    knap::Random random(45, "boulders");
    std::string text = "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.5\n[contact]\n" + rock +
                       "[[obstacle]]\nname = \"ground\"\nshape = \"polyline\"\npoints = [[80, -40], [-5, 2.5]]\n"
                       "friction = 0.6\nroughness = 0.02\nroughness_kind = \"normal\"\nspacing = 0.05\n"
                       "[time]\nend = 0.012\n[output]\nevery = 1\nfields = false\nhistory_every = 0.012\n";
    const int n = 50;
    for (int k = 0; k < n; ++k) {
        const bool is_disc = k % 3 == 0, is_triangle = k % 3 == 1;
        const double radius = random.uniform(0.15, is_triangle ? 0.25 : 0.5), x = 1.5 * k,
                     y = -0.5 * x + 1.2 * radius + 0.2, turn = random.uniform(0, 6);
        text += "[[body]]\nmesh_size = " + std::to_string(radius) +
                "\nvelocity = " + point(random.uniform(-20, 40), -random.uniform(20, 40)) + "\nspin = \"" +
                std::to_string(random.uniform(-3000, 3000)) + " deg/s\"\n";
        if (is_disc) {
            text += "shape = \"disc\"\ncentre = " + point(x, y) + "\nradius = " + std::to_string(radius) + "\n";
            continue;
        }
        const int corners = is_triangle ? 3 : 4 + k % 5;
        text += "shape = \"polygon\"\npoints = [";
        for (int i = 0; i < corners; ++i) {
            const double angle = turn + 2 * M_PI * (i + random.uniform(-0.2, 0.2)) / corners;
            text += (i > 0 ? ", " : "") + point(x + radius * std::cos(angle), y + radius * std::sin(angle));
        }
        text += "]\n";
    }
    write_scene(folder, text);
    const Answer answer = run_scene(folder, "-j 1 -s 'figure=[]' -o " + folder.in_shell("drop"));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    const auto record = nlohmann::json::parse(text_of(folder.path / "drop/run.json"));
    for (const auto& gate : record["gates"])
        if (gate["name"] == "obstacle_depth") CHECK(gate["value"].get<double>() < 0.03);
    const auto paths = knap::read_csv(folder.path / "drop/fragment_paths.csv");
    const std::vector<double> x = paths.column("centre_x"), y = paths.column("centre_y");
    REQUIRE(x.size() >= n);
    for (std::size_t i = x.size() - n; i < x.size(); ++i) CHECK(y[i] + 0.5 * x[i] > -0.05);
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
