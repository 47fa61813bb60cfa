// Obstacles and the edges of bodies between nodes; what no contact stops is found by `check` or ends the run, with its
// place.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <numeric>

namespace obstacle_edges_test {

using namespace program;
using knap::tests::relative;

namespace {

using Json = nlohmann::json;

const std::string rock =
    "[material.rock]\ndensity = 2600\nE = \"10 GPa\"\nnu = 0.25\n[interface.default]\nbreakable = "
    "false\nfriction = 0.3\nrestitution = 0\n";
const std::string weight = "[[load]]\nacceleration = [0, -9.81]\n";
const std::string tables = "[output]\nevery = 0.02\nfields = false\nhistory_every = 0.005\n";

std::string obstacle(const std::string& name, const std::string& shape, const std::string& more = "") {
    return "[[obstacle]]\nname = \"" + name + "\"\nfriction = 0.9\n" + shape + "\n" + more;
}
std::string disc(const std::string& centre, const std::string& radius) {
    return "shape = \"disc\"\ncentre = [" + centre + "]\nradius = " + radius;
}
std::string polygon(const std::string& points) { return "shape = \"polygon\"\npoints = [" + points + "]"; }

/// A block of large triangles with [contact] and large rotations.
std::string block(const std::string& origin, const std::string& size, const std::string& mesh_size,
                  const std::string& more, const std::string& end) {
    return "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = " + mesh_size +
           "\n[[body]]\nshape = \"rectangle\"\norigin = [" + origin + "]\nsize = [" + size + "]\n" + rock +
           "[contact]\n" + more + weight + "[time]\nend = " + end + "\n" + tables;
}

/// A beam of 15.3 kN on two rollers, each in the middle of an edge.
const std::string rollers =
    block("-1, 0", "2, 0.3", "0.3",
          obstacle("rl", disc("-0.571, -0.06", "0.06")) + obstacle("rr", disc("0.571, -0.06", "0.06")), "0.5");
/// A block of which 47 % lie beyond a bench, whose corner is below the edge.
const std::string overhang =
    block("-0.53, 0", "1, 0.3", "0.2", obstacle("bench", polygon("[-3, -2], [0, -2], [0, 0], [-3, 0]")), "0.5");
/// A disc that is driven into the side of a block which stands before a wall.
const std::string driven_disc = block("0, 0", "0.6, 0.6", "0.2",
                                      obstacle("floor", "shape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]") +
                                          obstacle("wall", "shape = \"half plane\"\nat = [0.6, 0]\nnormal = [-1, 0]") +
                                          obstacle("ram", disc("-0.05, 0.3", "0.05"), "velocity = [0.5, 0]\n"),
                                      "0.2");
/// A disc that falls on a slab between its nodes.
const std::string free_disc = block("0, 0", "1.2, 0.2", "0.2",
                                    obstacle("floor", "shape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]") +
                                        obstacle("ball", disc("0.5, 0.231", "0.03"), "density = 7800\n"),
                                    "0.3");
/// A ball above a body that is held everywhere.
const std::string held = rectangle("1, 0.05", "0.01") +
                         "[material.a]\ndensity = 2500\nE = 1e8\nnu = 0.2\n[interface.default]\nbreakable = false\n" +
                         "[[load]]\non = { box = [-1, -1, 2, 1] }\ndisplacement = [0, 0]\n" + weight +
                         obstacle("ball", disc("0.5, 0.1501", "0.1"), "mass = 3\nrestitution = 0.37\nturns = false\n") +
                         "[time]\nend = 0.012\nbulk = \"implicit\"\nstep = 2e-4\ntheta = 0.5\n" +
                         "[output]\nfields = false\nhistory_every = 5e-4\n";

Answer run_to_end(const Folder& folder, const std::string& text) {
    write_scene(folder, text);
    return run_scene(folder, "-j 1 -s 'figure=[]' -o " + folder.in_shell("run"));
}

/// A column of reactions.csv, or its mean over the second half of the run.
std::vector<double> reaction(const Folder& folder, const char* column) {
    return knap::read_csv(folder.path / "run/reactions.csv").column(column);
}
double late_mean(const std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    return std::accumulate(middle, values.end(), 0.0) / static_cast<double>(values.end() - middle);
}

Json gate(const Folder& folder) {
    const Json record = Json::parse(text_of(folder.path / "run/run.json"));
    for (const Json& one : record["gates"])
        if (one["name"] == "obstacle_depth") return one;
    return {};
}

/// The run ends with the gate, at a place within 0.1 of `x`, `y` [m].
void check_ends(const std::string& name, const std::string& text, double x, double y) {
    const Folder folder("obstacle gate " + name);
    const Answer answer = run_to_end(folder, text);
    CAPTURE(answer.text);
    CHECK(answer.code == 3);
    CHECK(answer.has("obstacle_depth"));
    const Json found = gate(folder);
    CHECK(found["pass"] == false);
    CHECK(found["value"].get<double>() > 0.1);
    CHECK(found["value"].get<double>() < 0.2);
    CHECK(std::hypot(found["place_m"][0].get<double>() - x, found["place_m"][1].get<double>() - y) < 0.1);
}

}  // namespace

TEST_CASE("obstacle edges: a beam rests on two rollers between its nodes") {
    const Folder folder("rollers");
    REQUIRE(run_to_end(folder, rollers).code == 0);
    for (const char* column : {"rl_force_y", "rr_force_y"})
        CHECK(late_mean(reaction(folder, column)) == relative(7652, 0.02));
}

TEST_CASE("obstacle edges: a block with less than half beyond a bench stays") {
    const Folder folder("overhang");
    REQUIRE(run_to_end(folder, overhang).code == 0);
    const knap::History paths = knap::read_csv(folder.path / "run/fragment_paths.csv");
    CHECK(std::abs(paths.column("rotation").back()) < 0.01);
    CHECK(late_mean(reaction(folder, "bench_force_y")) == relative(7652, 0.02));
}

TEST_CASE("obstacle edges: a free ball stays on a body that is held everywhere in implicit steps") {
    const Folder folder("held");
    REQUIRE(run_to_end(folder, held).code == 0);
    const std::vector<double> u = reaction(folder, "ball_u_y");
    for (const double each : u) REQUIRE(each > -1.09e-4);  // what is thrown back covers 8.9 um in a step
    CHECK(u.back() == relative(-1e-4, 1e-2));
    CHECK(reaction(folder, "ball_force_y").back() == relative(-3 * 9.81, 1e-3));
    CHECK(reaction(folder, "load0_force_y").back() == relative(3 * 9.81 + 0.05 * 2500 * 9.81, 1e-3));
}

TEST_CASE("obstacle edges: a light block lands on a heavy body on a support in implicit steps with theta one half") {
    const Folder folder("light");
    const Answer answer = run_to_end(
        folder,
        "knap = 1\n[domain]\nshape = \"rectangle\"\norigin = [-1, -0.5]\nsize = [2, 0.5]\n[mesh]\nsize = 0.25\n"
        "[material.a]\ndensity = 2600\nE = 1e9\nnu = 0.25\n[interface.default]\nbreakable = false\n"
        "friction = 0.5\n[time]\nend = 0.1\nbulk = \"implicit\"\nstep = 1e-3\n[output]\nfields = false\n" +
            weight + "[[support]]\non = \"bottom\"\n[[obstacle]]\nname = \"a\"\nfriction = 0.5\nmass = 10\n" +
            polygon("[-0.2, 0.001], [0.2, 0.001], [0.2, 0.4], [-0.2, 0.4]"));
    CAPTURE(answer.text);
    CHECK(answer.code == 0);  // its impulses are as exact as those of the body, a thousand times heavier
}

TEST_CASE("obstacle edges: a block in implicit steps stays on corners and arcs between its nodes") {
    for (const std::string& scene : {rollers, overhang}) {
        const Folder folder(scene == rollers ? "rollers implicit" : "overhang implicit");
        std::string text = scene;
        const auto replace = [&](const std::string& what, const std::string& by) {
            text.replace(text.find(what), what.size(), by);
        };
        replace("rotation = \"large\"\n", ""), replace("[contact]\n", "");
        replace("end = 0.5\n", "end = 0.1\nbulk = \"implicit\"\nstep = 1e-3\nstart = \"equilibrium\"\n");
        REQUIRE(run_to_end(folder, text).code == 0);
        CHECK(gate(folder)["value"].get<double>() < 1e-9);
        if (scene == rollers)
            for (const char* column : {"rl_force_y", "rr_force_y"})
                CHECK(reaction(folder, column).back() == relative(7652, 1e-3));
        else CHECK(reaction(folder, "bench_force_y").back() == relative(7651.8, 1e-6));
    }
}

TEST_CASE("obstacle edges: a disc that is driven into a block between its nodes presses on it") {
    const Folder folder("driven");
    run_to_end(folder, driven_disc);
    CHECK(reaction(folder, "ram_force_x").back() > 1e3);
}

TEST_CASE("obstacle edges: a disc that falls on a slab between its nodes stays on it") {
    const Folder folder("free disc");
    REQUIRE(run_to_end(folder, free_disc).code == 0);
    for (const double u : reaction(folder, "ball_u_y")) REQUIRE(u > -1.1e-3);
}

TEST_CASE("obstacle edges: a free ball stays on a body that is held everywhere in explicit steps") {
    const Folder folder("held explicit");
    const std::string implicit = "bulk = \"implicit\"\nstep = 2e-4\ntheta = 0.5\n";
    std::string text = held;
    text.erase(text.find(implicit), implicit.size());
    REQUIRE(run_to_end(folder, text).code == 0);
    const std::vector<double> u = reaction(folder, "ball_u_y");
    for (const double each : u) REQUIRE(each > -1.01e-4);  // what is thrown back covers 0.9 um in a step
    CHECK(u.back() == relative(-1e-4, 1e-3));
    CHECK(reaction(folder, "ball_force_y").back() == relative(-3 * 9.81, 1e-9));
}

// ---- What cannot give way.

/// A disc that is driven into the side of a block that is held everywhere.
const std::string against_held = driven_disc + "[[load]]\non = { box = [-1, -1, 2, 2] }\ndisplacement = [0, 0]\n" +
                                 "[limits]\npenetration = \"none\"\n";

TEST_CASE("obstacle edges: what no contact stops ends the run at its place") {
    check_ends("driven", against_held, 0, 0.3);
    std::string text = against_held;
    const auto replace = [&](const std::string& what, const std::string& by) {
        text.replace(text.find(what), what.size(), by);
    };
    replace("rotation = \"large\"\n", ""), replace("[contact]\n", "");
    replace("end = 0.2\n", "end = 0.2\nbulk = \"implicit\"\nstep = 1e-3\n");
    check_ends("driven implicit", text, 0, 0.3);
}

TEST_CASE("obstacle edges: a spike that its corner stops and the limit of a scenario") {
    // a spike of 4 mm half width that is driven into the face of a block: its corner touches the edge and stops there
    const auto spike = [](const std::string& x, const std::string& more) {
        return block("0, 0", "0.6, 0.6", "0.2",
                     obstacle("wall", "shape = \"half plane\"\nat = [0.6, 0]\nnormal = [-1, 0]") +
                         obstacle("spike", polygon("[" + x + ", 0.32], [-0.2, 0.328], [-0.2, 0.312]"),
                                  "velocity = [0.5, 0]\n"),
                     "0.01") +
               more;
    };
    const Folder folder("spike");
    CHECK(run_to_end(folder, spike("-0.001", "")).code == 0);
    CHECK(gate(folder)["value"].get<double>() < 0.05);
    const Folder limited("limited depth");
    const Answer answer = run_to_end(limited, against_held + "obstacle_depth = \"none\"\n");
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    CHECK(answer.has("warning[obstacle_depth]"));
}

TEST_CASE("obstacle edges: check refuses what overlaps at the start also between nodes and inside") {
    const Folder folder("overlaps");
    const auto disc_at = [](const std::string& centre, const std::string& radius) {
        return block("0, 0", "1, 0.3", "0.3", obstacle("disc", disc(centre, radius)), "0.1");
    };
    check_refused(folder, disc_at("0.45, 0.348", "0.05"), "overlap", "by 2 mm at (0.45, 0.3) m");
    check_refused(folder, disc_at("0.4, 0.15", "0.05"), "overlap", "lies in the body at the start, by 200 mm");
    check_refused(folder, disc_at("0.4, 0.15", "3"), "overlap", "lies in the body");
    check_refused(
        folder,
        block("0, 0", "1, 0.3", "0.3", obstacle("spike", polygon("[0.4, 0.29], [0.5, 0.6], [0.3, 0.6]")), "0.1"),
        "overlap", "by 10 mm at (0.4, 0.29) m");
    write_scene(folder, disc_at("0.45, 0.35", "0.05"));  // it touches
    CHECK(command("check " + folder.in_shell("scene.toml")).code == 0);
    // a disc in a hole of its radius touches it at its nodes
    const auto pin = [](const std::string& radius) {
        return rectangle("1, 1", "0.1", "[[domain.hole]]\ncentre = [0.5, 0.5]\nradius = 0.2\n") + rock +
               obstacle("pin", disc("0.5, 0.5", radius)) + "[time]\nend = 1e-4\n";
    };
    write_scene(folder, pin("0.2"));
    const Answer fits = command("check " + folder.in_shell("scene.toml"));
    CAPTURE(fits.text);
    CHECK(fits.code == 0);
    check_refused(folder, pin("0.21"), "overlap", "lies in the body at the start, by ");
}

TEST_CASE("obstacle edges: check refuses free obstacles whose friction on a held edge is not solved") {
    const Folder folder("held pairs");
    const auto slab = [](const std::string& motion, const std::string& centre, const std::string& more) {
        return rectangle("1, 0.05", "0.05") + rock + "[[load]]\non = \"top\"\ndisplacement = " + motion + "\n" +
               weight + obstacle("ball", disc(centre, "0.1"), "mass = 3\n" + more) +
               "[time]\nend = 0.2\nbulk = \"implicit\"\nstep = 1e-3\n";
    };
    const std::string along_normal = "[\"free\", 0]";
    check_refused(folder, slab(along_normal, "0.5, 0.16", ""), "held-against-obstacle",
                  "comes first to an edge, at (0.5, 0.05) m: it is held along its normal and may slip");
    for (const std::string& lawful : {slab("[0, 0]", "0.5, 0.16", ""),                       // nothing slips
                                      slab(along_normal, "0.5, 0.5", ""),                    // it does not arrive
                                      slab(along_normal, "1.2, 0.1", "turns = false\n")}) {  // it falls past it
        write_scene(folder, lawful);
        const Answer answer = command("check " + folder.in_shell("scene.toml"));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
    }
}

TEST_CASE("obstacle edges: a free obstacle falls on the ground of a support and one that starts in it is refused") {
    const Folder folder("on support");
    const auto slab = [](const std::string& centre, const std::string& more) {
        return rectangle("1, 0.1", "0.1", "rotation = \"large\"\n") + rock +
               "[contact]\n[[support]]\non = \"bottom\"\nbeyond = 1\n" + weight +
               obstacle("ball", disc(centre, "0.1"), "density = 7800\n") + more;
    };
    const std::string time = "[time]\nend = 0.15\n" + tables;
    const Answer answer = run_to_end(folder, slab("1.5, 0.12", time));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    CHECK(reaction(folder, "ball_u_y").back() == relative(-0.02, 0.05));
    CHECK(-reaction(folder, "ball_force_y").back() == relative(7800 * 0.01 * 3.14159 * 9.81, 1e-4));
    check_refused(folder, slab("1.5, 0.05", time), "obstacles-overlap",
                  "and the ground of a support overlap by 50 mm at (1.5, -0.05) m");
    check_refused(folder, slab("1.5, 0.12", "[rigid]\nstep = 1e-3\n" + time), "held-against-obstacle",
                  "with [rigid] a support meets bodies alone");
}

}  // namespace obstacle_edges_test
