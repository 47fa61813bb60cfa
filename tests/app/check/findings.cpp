// What a mesh says of a scenario before it runs: loads that contradict each other, jumps, what lies outside, what makes
// a run endless.
#include "app/check/findings.hpp"
#include "app/check/cost.hpp"
#include "app/program.hpp"
#include "app/setup/setup.hpp"
#include "base/stopwatch.hpp"
#include "output/history_csv.hpp"
#include "scenario/read_scenario.hpp"
#include "support/relative.hpp"

#include <cmath>

namespace findings_test {

using namespace program;
using namespace knap;
using knap::tests::relative;

namespace {

/// A plate of 100 mm x 40 mm; `more` comes behind its first tables.
std::string plate(const Folder& folder, const std::string& more, const std::string& domain = "") {
    std::ofstream(folder.path / "plate.toml")
        << rectangle("0.1, 0.04", "0.004", domain) +
               "[material.rock]\ndensity = 2650\nE = \"40 GPa\"\nnu = 0.2\n"
               "[interface.default]\nsigma_c = \"5 MPa\"\nG_c = 50\n[time]\nend = \"20 us\"\n" +
               more;
    return "check " + folder.in_shell("plate.toml") + " ";
}

const std::string top = "[[load]]\non = \"top\"\ndisplacement = [0, \"1 mm\"]\nramp = \"1 ms\"\n",
                  left = "[[load]]\non = \"left\"\nvelocity = [\"-1 m/s\", \"free\"]\n";

}  // namespace

TEST_CASE("a support between bodies that touch is a warning") {
    const Folder folder("support_between");
    const auto wall = [&](const std::string& place) {
        std::ofstream(folder.path / "wall.toml")
            << "knap = 1\n[[bodies]]\nname = \"wall\"\npattern = \"wall\"\ncolumns = 2\nrows = 2\n"
               "block = [0.02, 0.01]\n[mesh]\nsize = 0.01\n[material.rock]\ndensity = 2650\nE = \"40 GPa\"\nnu = 0.2\n"
               "[interface.default]\nbreakable = false\n[time]\nend = \"20 us\"\n[[support]]\non = " +
                   place + "\n";
        return command("check " + folder.in_shell("wall.toml"));
    };
    const Answer all = wall("{ body = \"wall\" }"), bottoms = wall("{ body = \"wall\", boundary = \"bottom\" }"),
                 ground = wall("{ body = \"wall\", boundary = \"bottom\", box = [-1, -1e-6, 1, 1e-6] }");
    CAPTURE(all.text);
    CHECK(all.has("warning[support-between]: `support[0].on` takes"));
    CHECK(bottoms.has("warning[support-between]: `support[0].on` takes"));  // the upper row stands on the lower one
    CHECK_FALSE(ground.has("support-between"));
    CHECK(ground.code == 0);
}

TEST_CASE("loads that contradict each other are refused with both lines") {
    const Folder folder("contradictions");
    const Answer corner = command(plate(folder, top + left));
    CAPTURE(corner.text);
    CHECK(corner.code == 2);
    CHECK(
        corner.has("error[contradiction]: `load[0]` (line 16) and `load[1]` (line 20) prescribe different motions in x "
                   "of their common nodes at (0, 0.04) m: "
                   "displacement 0 m on `top`, velocity -1 m/s on `left`"));
    CHECK(corner.has("plate.toml:20:1"));
    CHECK(corner.has("make x of one of them \"free\""));
    CHECK(command("run " + folder.in_shell("plate.toml") + " -q -o " + folder.in_shell("run")).code == 2);
    CHECK_FALSE(fs::exists(folder.path / "run"));
    CHECK(command("check " + folder.in_shell("plate.toml") + " -s 'load[0].displacement=[\"free\", \"1 mm\"]'").code ==
          0);
    const Answer traction =
        command(plate(folder, top + "[[load]]\nname = \"lid\"\non = \"top\"\ntraction = [0, \"1 MPa\"]\n"));
    CHECK(traction.code == 2);
    CHECK(traction.has(
        "`load[0]` (line 16) and `load[1]` `lid` (line 20) apply a traction and a motion in y to the same edges"));
    CHECK(command(plate(folder, top + "[[load]]\non = \"left\"\ntraction = [0, \"1 MPa\"]\n")).code == 0);
}

TEST_CASE("a load that rises within the passage of five edges by a third of the strength is a warning") {
    const Folder folder("steep");  // a wave passes five edges in 5 us
    const auto warns = [&](const std::string& more, const std::string& options = "") {
        const Answer answer = command(plate(folder, more) + options);
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        return answer.has("warning[steep-wave]: `load[0]` sends a wave");
    };
    const std::string pull = "[[load]]\non = \"top\"\ntraction = [0, \"3 MPa\"]\n";
    CHECK(warns(pull));
    CHECK(warns(pull, "-s load[0].ramp='5 us'"));
    CHECK_FALSE(warns(pull, "-s load[0].ramp='20 us'"));
    CHECK_FALSE(warns(pull, "-s 'load[0].traction=[0, \"1 MPa\"]'"));
    CHECK_FALSE(warns(pull, "-s 'material.rock.bulk_viscosity=[0.06, 1.2]'"));
    CHECK_FALSE(warns(pull, "-s interface.default='{ breakable = false }'"));
    CHECK_FALSE(warns(pull, "-s time.bulk=implicit"));
    CHECK(warns(left));  // rho c v = 11 MPa
    CHECK(warns(top));   // and so does the constant speed of the displacement
    CHECK_FALSE(warns(left, "-s 'initial=[{ velocity = [-1, 0] }]'"));
}

TEST_CASE("a displacement without a ramp is reported as a jump") {
    const Folder folder("jump");
    const Answer jump = command(plate(folder, top) + "-s load[0].ramp=");
    CAPTURE(jump.text);
    CHECK(jump.code == 0);
    CHECK(
        jump.has("warning[jump]: `load[0].displacement` jumps by 1 mm at t = 0 s: in a step of 400 ns this "
                 "is a velocity of 2500 m/s, 0.61 times the wave speed"));
    CHECK(jump.has("plate.toml:18:16"));
    CHECK(jump.has("ramp = \"1 ms\""));
    CHECK_FALSE(command(plate(folder, top)).has("warning[jump]"));
    const auto with_table = [&](const std::string& table, const std::string& more = "") {
        return command(plate(folder, top) + "-s load[0].ramp= -s 'load[0].table=" + table + "' " + more);
    };
    CHECK(with_table("[[0, 0], [1e-5, 0], [1e-5, 1]]")
              .has("jumps by 1 mm at t = 10 µs: in a step of 400 ns this is a velocity of 2500 m/s"));
    CHECK(with_table("[[0, 0], [0, 1]]").has("jumps by 1 mm"));
    CHECK(with_table("[[0, 0.5], [1e-5, 1]]").has("jumps by 500 µm at t = 0 s"));
    CHECK(with_table("[[0, 0], [1e-5, 0], [1.01e-5, 1]]").has("jumps by 1 mm at t = 10 µs"));  // within a step
    CHECK_FALSE(with_table("[[0, 0], [1e-5, 0], [1.01e-5, 1e-4]]").has("warning[jump]"));      // so it moves at 1 m/s
    CHECK_FALSE(with_table("[[0, 0], [5e-5, 0], [5e-5, 1]]").has("warning[jump]"));            // after the end
    CHECK(with_table("[[0, 1], [1e-5, 1], [1e-5, 2]]", "-s time.start=equilibrium").has("jumps by 1 mm at t = 10 µs"));
    CHECK_FALSE(command(plate(folder, top) + "-s load[0].ramp= -s time.start=equilibrium").has("warning[jump]"));
}

TEST_CASE("places outside the body are reported with their coordinates") {
    const Folder folder("outside");
    const std::string domain =
        "[[domain.region]]\nbox = [1, 1, 2, 2]\nmaterial = \"rock\"\n[[domain.hole]]\ncentre = [\"50 mm\", \"20 "
        "mm\"]\nradius = \"8 mm\"\n";
    const Answer check = command(
        plate(folder,
              "[[probe]]\nat = [\"50 mm\", \"20 mm\"]\nname = \"in the hole\"\n[[probe]]\nat = [\"58 mm\", \"20 mm\"]\n"
              "[[figure]]\nfile = \"a.png\"\nbox = [50, 0, 60, 20]\n",
              domain) +
        "-s 'mesh.refine=[{ inside = [1, 1, 2, 2], size = 0.001 }, { along = [[0, 0.05], [0.1, 0.05]], width = 0.01, "
        "size "
        "= 0.001 }, { along = [[0, 0.043], [0.1, 0.043]], width = 0.01, size = 0.001 }]'");
    CAPTURE(check.text);
    CHECK(check.code == 0);
    CHECK(check.has("probe `in the hole` at (0.05, 0.02) m lies outside the body, 7.7"));
    CHECK_FALSE(check.has("probe `probe2` at"));  // on the curve of the hole
    CHECK(check.has("`domain.region[0]` covers no triangle of the body: it extends from (1, 1) m to (2, 2) m"));
    CHECK(check.has("`mesh.refine[0].inside` lies outside the body"));
    CHECK(check.has("`mesh.refine[1].along` lies outside the body: from (-0.005, 0.045) m to (0.105, 0.055) m"));
    CHECK_FALSE(check.has("`mesh.refine[2].along`"));
    CHECK(check.has("`figure[0].box` lies outside the body: from (50, 0) m to (60, 20) m"));
    CHECK(check.has("the body extends from (0, 0) m to (0.1, 0.04) m"));
}

TEST_CASE("a run that nobody can mean is reported") {
    const Folder folder("endless");
    const Answer check =
        command(plate(folder, "[output]\nevery = \"1 us\"\nhistory_every = \"1 us\"\n") + "-s 'time.end=10 h'");
    CAPTURE(check.text);
    CHECK(check.has("warning[too-long]: `time.end` = 10 h is "));
    // both from one estimate
    const auto number_after = [&](const std::string& words) {
        return std::stod(check.text.substr(check.text.find(words) + words.size()));
    };
    CHECK(number_after("s: about ") == relative(number_after("  about "), 0.06));
    CHECK(check.has(" year of one core"));
    CHECK(check.has("warning[too-many]: `output.every` = 1 µs in a run of 10 h makes 3.6e+10 frames"));
    CHECK(check.has("warning[too-many]: `output.history_every` = 1 µs"));
    const Answer damped = command(plate(folder, "") + "-s 'time.damping=1000 GHz'");
    CAPTURE(damped.text);
    CHECK(damped.has("warning[too-large]: `time.damping` = 1e+12 Hz takes "));
    CHECK(damped.has("reverses in every step"));
}

// A scenario without [[load]]: its only history is that of the fluid.
TEST_CASE("a crack under pressure alone: check and run") {
    const Folder folder("pressure_alone");
    const std::string crack = "[[domain.crack]]\npoints = [[0, 0.02], [0.05, 0.02]]\n",
                      from_left = "[[pressure]]\nfrom = { boundary = \"left\" }\n",
                      ice = "[heat]\ntemperature = \"-1 C\"\n" + from_left +
                            "pressure_table = [[-2, \"1 MPa\"], [0, 0]]\n";
    for (const std::string& pressure : {from_left + "pressure = \"1 MPa\"\n", ice}) {
        const Answer check = command(plate(folder, pressure, crack));
        CAPTURE(check.text);
        CHECK(check.code == 0);
        CHECK(check.has("in cracks from its source; 50 mm of them at t = 0"));
        CHECK_FALSE(check.has("pressure-enters-nothing"));
        CHECK_FALSE(check.has("no-expansion"));
        const Answer run = command("run " + folder.in_shell("plate.toml") + " -q --force -o " + folder.in_shell("run"));
        CAPTURE(run.text);
        CHECK(run.code == 0);
        const History energy = knap::read_csv(folder.path / "run" / "energy.csv");
        CHECK(energy.column("external_work").back() > 0);
    }
}

TEST_CASE("a pressure that reaches nothing or draws is a warning") {
    const Folder folder("pressure_nowhere");
    const std::string crack = "[[domain.crack]]\npoints = [[0, 0.02], [0.05, 0.02]]\n",
                      joints = "[[joints]]\ndirection = 0\nspacing = 0.01\ninterface = \"default\"\n";
    const auto check = [&](const std::string& source, const std::string& domain, const std::string& value = "1e6") {
        return command(plate(folder, "[[pressure]]\npressure = " + value + "\n" + source, domain));
    };
    const std::string right = "from = { boundary = \"right\" }\n";
    const Answer away = check(right, crack);
    CAPTURE(away.text);
    CHECK(away.code == 0);
    CHECK(away.has("; 0 m of them at t = 0"));
    CHECK(away.has("warning[pressure-enters-nothing]: `pressure[0]` presses on nothing at t = 0"));
    CHECK(away.has("plate.toml:1"));
    CHECK(check("from = { box = [0.06, 0.01, 0.08, 0.03] }\n", crack).has("pressure-enters-nothing"));
    CHECK_FALSE(check("", "").has("pressure-enters-nothing"));     // cracks may form later, everywhere
    CHECK_FALSE(check(right, "").has("pressure-enters-nothing"));  // or there
    CHECK(command(plate(folder, "[[pressure]]\npressure = 1e6\n" + right) +
                  "-s 'interface.default={ breakable = false }'")
              .has("and nothing there can break"));
    CHECK_FALSE(check("", crack).has("pressure-enters-nothing"));
    CHECK_FALSE(check(right + joints, crack).has("pressure-enters-nothing"));  // the joint may open
    CHECK_FALSE(check("", crack).has("warning[implausible]"));
    CHECK(check("", crack, "\"-2*x MPa\"").has("pressure[0] -2*x MPa, in all cracks; 50 mm of them"));
    const std::string injected = "[[pressure]]\nrate = 1e-3\nstorage = 1e-12\n";
    CHECK(command(plate(folder, injected, crack)).has("warning[coarse-crack]: the cracks that this fluid fills"));
    CHECK_FALSE(command(plate(folder, injected, crack) + "-s mesh.order=2").has("coarse-crack"));
    CHECK(check("", crack, "-1e6").has("warning[implausible]: `pressure[0]` is negative at times"));
    CHECK(check("table = [[0, 1], [1e-5, -0.1]]\n", crack)
              .has("warning[implausible]: `pressure[0]` is negative at times"));
}

TEST_CASE("two lines that cut the stable step are named with their place") {
    const Folder folder("detail");
    const std::string near =
        "[[domain.crack]]\npoints = [[\"20 mm\", \"10 mm\"], [\"44 mm\", \"10 mm\"]]\n"
        "[[domain.crack]]\npoints = [[\"20 mm\", \"10.22 mm\"], [\"44 mm\", \"10.22 mm\"]]\n";
    const Answer check = command(plate(folder, "", near));
    CAPTURE(check.text);
    CHECK(check.has("warning[small-step]: a triangle at (0.0"));
    CHECK(check.has("Next to it: `domain.crack[0]` and `domain.crack[1]`"));
    CHECK(check.has("domain.snap = \"800 µm\" joins them"));  // a fifth of the mesh size
    // each detail by itself, in a mesh of 1 mm: a pair a tenth of an edge apart, a small hole
    const Answer both =
        command(plate(folder, "",
                      "[[domain.crack]]\npoints = [[\"20 mm\", \"10 mm\"], [\"44 mm\", \"10 mm\"]]\n"
                      "[[domain.crack]]\npoints = [[\"20 mm\", \"10.101 mm\"], [\"44 mm\", \"10.101 mm\"]]\n"
                      "[[domain.hole]]\ncentre = [\"80 mm\", \"30 mm\"]\nradius = \"0.1 mm\"\n") +
                "-s 'mesh.size=1 mm'");
    CAPTURE(both.text);
    CHECK(both.has("Next to it: a detail of `domain.hole[0]`"));
    CHECK((both.has("Next to it: `domain.crack[0]` and `domain.crack[1]`") ||
           both.has("Next to it: `domain.crack[1]` and `domain.crack[0]`")));
    CHECK_FALSE(
        command(plate(folder, "", "[[domain.crack]]\npoints = [[\"20 mm\", \"10 mm\"], [\"44 mm\", \"10 mm\"]]\n"))
            .has("small-step"));
}

TEST_CASE("check and mesh and the log of a run say what was placed") {
    const Folder folder("placed");
    const std::string set = "[[inclusions]]\nsize = \"8 mm\"\nnumber = 5\n";
    for (const std::string verb : {"check ", "mesh "}) {
        plate(folder, set);
        CHECK(command(verb + folder.in_shell("plate.toml")).has("inclusions[0]  5 placed, 6.28"));  // 5 pi 16/4000 %
    }
    CHECK(
        command("run " + folder.in_shell("plate.toml") + " -q -s 'time.end=1 us' -o " + folder.in_shell("run")).code ==
        0);
    CHECK(text_of(folder.path / "run/log.txt").find("inclusions[0]  5 placed, 6.28") != std::string::npos);
    for (const std::string verb : {"check ", "mesh "}) {
        plate(folder, "[[grains]]\nsize = \"8 mm\"\n");
        const Answer grains = command(verb + folder.in_shell("plate.toml"));
        CAPTURE(grains.text);
        CHECK(grains.has("  grains         "));
        CHECK(grains.has(" of rock (100 %)"));
    }
    const Answer full = command(plate(folder, set) + "-s inclusions[0].number=500");
    CHECK(full.code == 2);
    CHECK(full.has("500 are requested"));
    CHECK(full.has("a smaller number"));
}

TEST_CASE("a snap that leaves out much of a map is a warning with its length and an error where nothing is left") {
    const Folder folder("snap_of_map");
    std::ofstream(folder.path / "map.csv") << "trace, x [mm], y [mm]\na, 10, 10\na, 16, 10\nb, 30, 20\nb, 36, 20\n"
                                              "c, 60, 20\nc, 60, 34\n";
    const auto answer = [&](const std::string& verb, const std::string& snap) {
        plate(folder, "[[traces]]\nfile = \"map.csv\"\n", "snap = \"" + snap + "\"\n");
        return command(verb + folder.in_shell("plate.toml"));
    };
    for (const std::string verb : {"check ", "mesh "}) {
        const Answer some = answer(verb, "10 mm");
        CAPTURE(some.text);
        CHECK(some.code == 0);
        CHECK(
            some.has("warning[lost-cracks]: `domain.snap` = 10 mm leaves out 2 of 3 cracks, and 12 mm of their 26 mm"));
        CHECK(some.has("half of which are shorter than 6 mm"));
        const Answer all = answer(verb, "15 mm");
        CAPTURE(all.text);
        CHECK(all.code == 2);
        CHECK(all.has("error[lost-cracks]: `domain.snap` = 15 mm leaves out 3 of 3 cracks, and 26 mm of their 26 mm"));
        CHECK(all.has("map.csv:2"));  // most likely the unit of the file
        CHECK(all.has("the right unit of the file"));
        CHECK_FALSE(answer(verb, "1 mm").has("lost-cracks"));
    }
}

TEST_CASE("the outline of an excavation has the name of its table and takes cracks within snap") {
    const Folder folder("snap_of_excavation");
    const std::string excavation =
        "[[excavation]]\nbox = [\"40 mm\", \"10 mm\", \"60 mm\", \"30 mm\"]\nat = \"10 us\"\n"
        "[[domain.crack]]\npoints = [[\"20 mm\", \"20 mm\"], [\"39.9 mm\", \"20 mm\"]]\n";
    const Answer apart = command(plate(folder, excavation, "snap = \"10 um\"\n"));
    CAPTURE(apart.text);
    CHECK(apart.code == 2);
    CHECK(apart.has("`domain.crack[0]` comes within 100 µm of `excavation[0]` at"));
    CHECK(apart.has("its snap of 10 µm is below that"));
    CHECK_FALSE(apart.has("domain.region"));
    const Answer joined = command(plate(folder, excavation, "snap = \"200 um\"\n"));
    CAPTURE(joined.text);
    CHECK(joined.code == 0);
    CHECK(joined.has("domain.snap    within 200 µm: 1 ends joined"));
}

TEST_CASE("what the mesh finds wrong in a data file has the place of the data") {
    const Folder folder("place_of_data");
    std::ofstream(folder.path / "map.csv")
        << "trace, x [mm], y [mm]\na, 10, 10\na, 60, 10\nb, 10, 10.001\nb, 60, 10.02\n";
    const Answer map = command(plate(folder, "[[traces]]\nfile = \"map.csv\"\n"));
    CAPTURE(map.text);
    CHECK(map.code == 2);
    CHECK(map.has("map.csv:4:1"));
    CHECK(map.has("4 | b, 10, 10.001"));
    std::ofstream(folder.path / "points.csv") << "x [mm], y [mm], xx [MPa], yy [MPa], xy [MPa]\n0, 0, -1, -1, 0\n"
                                                 "100, 0, -1, -1, 0\n50, 40, -1, -1, 0\n";
    const Answer points = command(plate(folder, "[[initial]]\nstress = \"points.csv\"\n"));
    CAPTURE(points.text);
    CHECK(points.code == 2);
    CHECK(points.has("error[no-value]: `initial[0].stress`: the points of points.csv do not reach ("));
    CHECK(points.has("points.csv\n"));
    CHECK_FALSE(points.has("plate.toml:"));
}

TEST_CASE("points over exactly the box of an initial stress are enough") {
    const Folder folder("points_of_box");
    std::ofstream(folder.path / "points.csv")
        << "x [mm], y [mm], xx [MPa], yy [MPa], xy [MPa]\n20.1, 10.3, -1, -1, 0\n70.7, 10.3, -1, -1, 0\n"
           "70.7, 30.1, -1, -1, 0\n20.1, 30.1, -1, -1, 0\n";
    for (const std::string order : {"1", "2"}) {
        const Answer answer = command(plate(folder,
                                            "[[initial]]\nbox = [\"20.1 mm\", \"10.3 mm\", \"70.7 mm\", \"30.1 mm\"]\n"
                                            "stress = \"points.csv\"\n") +
                                      " -s mesh.order=" + order);
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        CHECK(answer.has("initial stress up to 1 MPa"));
    }
}

TEST_CASE("mistakes of a map name both parts as the file does and each place once") {
    const Folder folder("names_of_parts");
    std::ofstream(folder.path / "map.toml")
        << "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [1, 1]\n"
           "[[domain.crack]]\npoints = [[0.2, 0.5], [0.5, 0.5], [0.8, 0.5]]\n"
           "[[domain.crack]]\npoints = [[0.5, 0.501], [0.5, 0.8]]\n"
           "[[domain.hole]]\ncentre = [0.2, 0.2]\nradius = 0.05\n[[domain.hole]]\ncentre = [0.2, 0.25]\nradius = 0.05\n"
           "[mesh]\nsize = 0.1\n[material.a]\ndensity = 2500\nE = 1e10\nnu = 0.2\n"
           "[interface.default]\nsigma_c = 1e6\nG_c = 10\n[time]\nend = 1e-4\n";
    const Answer holes = command("check " + folder.in_shell("map.toml"));
    CAPTURE(holes.text);
    CHECK(holes.has("`domain.hole[1]` crosses or touches `domain.hole[0]` near "));
    const Answer cracks = command("check " + folder.in_shell("map.toml") + " -s domain.hole=[]");
    CAPTURE(cracks.text);
    CHECK(cracks.has("`domain.crack[1]` comes within 1 mm of `domain.crack[0]` at (0.5, 0.5) m without"));
    CHECK(cracks.has("`domain.crack[0]` comes within 1 mm of `domain.crack[1]` at (0.5, 0.501) m without"));
}

TEST_CASE("a step that is not solved while it is measured is given up and said") {
    const Folder folder("given_up");
    std::ofstream(folder.path / "pulled.toml")
        << "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.05]\n[mesh]\nsize = 0.005\n"
           "[material.a]\ndensity = 2500\nE = 30e9\nnu = 0.2\n"
           "[interface.default]\nsigma_c = 3e6\nG_c = 100\ngamma = 1\nfriction = 0.7\n"
           "[[load]]\non = \"left\"\ndisplacement = [0, 0]\n"
           "[[load]]\non = \"right\"\ndisplacement = [1e-3, 0]\nramp = \"1 day\"\n"
           "[time]\nend = \"1 day\"\nbulk = \"implicit\"\nstep = \"1 day\"\n";
    ReadResult read = read_scenario(folder.path / "pulled.toml");
    const Model model = model_of(read);
    const StepPlan plan = plan_of(read, model, read.scenario.time.end);
    const double start = Stopwatch::seconds(CLOCK_PROCESS_CPUTIME_ID);
    const Cost cost = estimate_cost(read.scenario, model, plan, 0, 1e-3);
    CHECK(Stopwatch::seconds(CLOCK_PROCESS_CPUTIME_ID) - start < 2);  // 0.2 and what one look at the time takes
    CHECK(cost.given_up_after == relative(0.2));
    CHECK(std::isnan(cost.total()));
    CHECK(cost.memory > 50);
    CHECK(unknown_text(cost, 43200).find("the first step, of 12 h, was not solved in 200 ms of one core") !=
          std::string::npos);
}

// slow_crush takes 180 s with 17 stages of explicit steps, 100 times what it takes while nothing breaks.
TEST_CASE("check gives a range for the time of implicit steps and one number for explicit ones") {
    const auto cost = [](const char* name) {
        ReadResult read = read_scenario(fs::path(KNAP_SOURCE_DIR) / "scenarios" / name);
        const Model model = model_of(read);
        return estimate_cost(read.scenario, model, plan_of(read, model, read.scenario.time.end), 0, 1e-3);
    };
    const Cost slow = cost("slow_crush.toml"), fast = cost("crushed_specimen.toml");
    CHECK(slow.steps > 30 * slow.least_steps);
    CHECK(slow.least() == relative(slow.total() - slow.steps + slow.least_steps));
    CHECK(slow.stage > 0);
    CHECK(fast.least_steps == fast.steps);
    const Answer text = command("check slow_crush");
    CHECK(
        text.has("while nothing breaks and no contact changes, the first number; a stage of explicit steps at least"));
}

// L^2/kappa_T = 2.82 s (kappa_T = 8.85e-6 m2/s, L = 5 mm), k/transfer = 0.31 mm, 2 kappa_T/l = 0.11 m/s of an edge l = 0.16 mm.
TEST_CASE("check judges the conduction of heat") {
    const std::string slab = "check alumina_quench -s mesh.size='0.3 mm' ", undamped = slab + "-s time.damping=0 ";
    const Answer good = command(slab);
    CAPTURE(good.text);
    CHECK(good.has("kappa_T 8.85e-06 m2/s; heat crosses the body in 2.8"));  // 2.82, or 2.83 by the way in the mesh
    CHECK(good.has("s; the run is 200 ms of heat (time_factor 1000)"));
    CHECK(good.has("k over transfer 310 µm"));
    CHECK_FALSE(good.has("warning[heat]"));
    CHECK(command(slab + "-s heat.time_factor=20000").has("of the Rayleigh speed, and radiate that part"));
    // 0.02 c_R/(2 kappa_T/l) with damping, 0.003 without, where nothing takes the waves out of the slab
    CHECK(good.has("keeps it below 0.02\n"));
    CHECK(command(undamped).has(" without time.damping; the summary's kinetic_part"));
    CHECK(command(slab + "-s time.end='5 us'").has("its temperature depends on the mesh"));
    CHECK_FALSE(command(slab + "-s time.end='5 us' -s heat.exchange=[]").has("heat enters"));
    CHECK(command(slab + "-s heat.exchange[0].transfer=1e6").has("within a depth k/transfer of 31 µm"));
    CHECK(command(slab + "-s heat.every=100000").has("fewer than 20 times until `time.end`"));
    CHECK(command(undamped + "-s time.bulk=implicit -s time.step='200 us'")
              .has("of the time in which heat crosses `alumina`"));
    // quartz: e(400) - e(20) = .0063, E e/(1 - 2 nu) = 70 GPa x .0063 x 2
    CHECK(command("check granite_heating -s mesh.size='1 mm'")
              .has("temperature  20 C at t = 0, 400 C at the end; reference 20 C: strains up to 0.0063, as "
                   "stresses, where prevented, 882 MPa, 73.5 times the smallest strength"));
}

// A concrete plate (E = 30 GPa, nu = .2, 1e-5/K) at 20 C whose strains count from 0 C: E a dT/(1 - 2 nu) = 10 MPa.
TEST_CASE("a body that is hot at the start is a blow unless it is free of stress then") {
    const Folder folder("hot");
    const auto plate_at = [&](const std::string& heat, const std::string& time = "") {
        std::ofstream(folder.path / "hot.toml")
            << "knap = 1\nname = \"hot\"\n[domain]\nshape = \"rectangle\"\nsize = [\"40 mm\", \"20 mm\"]\n[mesh]\nsize "
               "= \"4 "
               "mm\"\n[material.concrete]\ndensity = \"2400 kg/m3\"\nE = \"30 GPa\"\nnu = 0.2\nexpansion = "
               "1e-5\n[interface.default]\nsigma_c = \"3 MPa\"\nG_c = \"80 J/m2\"\n[heat]\n"
            << heat << "\n[time]\nend = \"20 us\"\n"
            << time;
        return command("check " + folder.in_shell("hot.toml"));
    };
    const Answer blow = plate_at("temperature = \"20 C\"");
    CAPTURE(blow.text);
    CHECK(
        blow.has("warning[hot-start]: at t = 0 the body is undeformed at 20 C, and without thermal strain at a "
                 "`heat.reference` of 0 C: stresses up to 10 MPa at once, 3.3 times the smallest strength"));
    CHECK(blow.has("reference = \"20 C\" if it is free of stress then"));
    CHECK_FALSE(plate_at("temperature = \"20 C\"\nreference = \"20 C\"").has("hot-start"));
    CHECK_FALSE(plate_at("temperature = \"20 C\"\nramp = \"10 us\"").has("hot-start"));
    CHECK_FALSE(plate_at("temperature = \"1 C\"").has("hot-start"));
    CHECK(plate_at("temperature = \"20 C\"\ntable = [[1, 0], [2, 1]]")
              .has("`heat.table` begins at 1 s, and the run ends at 20 µs"));
}

TEST_CASE("an initial stress that the loads do not balance is a warning and the text says what balances it") {
    const Folder folder("initial_stress");
    const std::string stress = "[[initial]]\nstress = [\"-2 MPa\", 0, 0]\n";
    const Answer alone = command(plate(folder, stress));
    CAPTURE(alone.text);
    CHECK(alone.code == 0);
    CHECK(alone.has("warning[unbalanced-stress]: at t = 0 neither loads nor supports balance 100 % of the forces"));
    CHECK(alone.has("initial stress up to 2 MPa; nothing balances 100 %"));
    const std::string around = "[[load]]\non = { box = [-1, -1, 1, 1] }\nstress = [\"-2 + 0*x MPa\", 0, 0]\n";
    CHECK(command(plate(folder, stress + around)).has("which loads and supports balance\n"));
    const Answer relaxed = command(plate(folder, stress + "[[load]]\non = \"left\"\ndisplacement = [0, 0]\n") +
                                   " -s time.start=equilibrium");
    CAPTURE(relaxed.text);
    CHECK_FALSE(relaxed.has("unbalanced-stress"));
    CHECK(relaxed.has("before the start the body strains for 100 % of the forces"));
    const Answer outside = command(plate(folder, "[[initial]]\nstress = [\"1/(x - 0.05)*0/0\", 0, 0]\n"));
    CHECK(outside.code == 2);
    CHECK(outside.has("error[no-value]: `initial[0].stress` is no finite number at ("));
    CHECK(command(plate(folder, stress + "box = [8, 8, 9, 9]\n")).has("an initial stress on a box selects nothing"));
}

TEST_CASE("slender parts of first order that something bends are named with their edges across") {
    const Folder folder("bending");
    const auto check = [&](const std::string& size, const std::string& mesh, const std::string& load,
                           const std::string& more = "") {
        return accepted(
            folder, rectangle(size, mesh, more) +
                        "[material.rock]\ndensity = 2650\nE = \"40 GPa\"\nnu = 0.2\n"
                        "[interface.default]\nsigma_c = \"5 MPa\"\nG_c = 50\n[time]\nend = \"20 us\"\n[[load]]\non = "
                        "\"left\"\ndisplacement = [0, 0]\n[[load]]\non = \"right\"\n" +
                        load);
    };
    const std::string across = "traction = [0, 1e5]\n", along = "traction = [1e5, 0]\n";
    for (const auto& [mesh, edges] : {std::pair{"0.005", "has 0.9 edges across"},
                                      {"0.0025", "has 1.9 edges across"},
                                      {"0.00125", "has 3.9 edges across"}}) {
        const Answer beam = check("0.1, 0.005", mesh, across);
        CAPTURE(mesh);
        CAPTURE(beam.text);
        CHECK(beam.has("warning[bending]: a part of "));
        CHECK(beam.has(edges));
    }
    CHECK_FALSE(check("0.1, 0.005", "0.000625", across).has("[bending]"));
    CHECK_FALSE(check("0.1, 0.005", "0.0025", along).has("[bending]"));  // a bar that is pulled
    CHECK_FALSE(check("0.1, 0.05", "0.02", across).has("[bending]"));    // compact
    CHECK_FALSE(check("0.1, 0.005", "0.0025\norder = 2", across).has("[bending]"));
    // the arms beside a crack
    CHECK(check("0.1, 0.02", "0.004", across, "[[domain.crack]]\npoints = [[0.02, 0.01], [0.1, 0.01]]\n")
              .has("[bending]"));
}

TEST_CASE("the time of heat through a body is that of its way and not of an insulated side") {
    const Folder folder("way_of_heat");
    const auto check = [&](const std::string& exchange) {
        return accepted(
            folder, rectangle("0.04, 0.01", "0.002") +
                        "[material.a]\ndensity = 2500\nE = 30e9\nnu = 0.2\nconductivity = 3\nheat_capacity = 800\n"
                        "[interface.default]\nbreakable = false\n[time]\nend = 1000\nbulk = \"implicit\"\nstep = 10\n" +
                        exchange);
    };
    const std::string heat = "[heat]\nconduction = true\ntemperature = ";
    const auto heated = [&](const std::string& on) {
        return check(heat + "\"0\"\n[[heat.exchange]]\non = \"" + on + "\"\ntemperature = 100\n");
    };
    CHECK_FALSE(heated("left").has("of the time in which heat crosses"));  // 40 mm: 1067 s
    CHECK(heated("top").has("a step of 10 s is 0.15 of the time in which heat crosses"));
    CHECK_FALSE(check(heat + "\"1000*x\"\n").has("of the time in which heat crosses"));
    CHECK(check(heat + "\"1000*y\"\n").has("of the time in which heat crosses"));
}

}  // namespace findings_test
