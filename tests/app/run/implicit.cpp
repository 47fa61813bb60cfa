// knap run on the implicit path: cut steps, runs that cannot go on, stored complementarity problems.
#include "app/program.hpp"

#include "app/run/dump_lcp.hpp"
#include "app/run/run_text.hpp"
#include "base/error.hpp"
#include "output/history_csv.hpp"

#include "support/relative.hpp"

#include <algorithm>
#include <cmath>

namespace run_implicit_test {

using namespace program;
using knap::tests::relative;

namespace {

/// The bar that is pulled apart in the middle, until shortly before the line is broken.
const std::string bar =
    "bar_pulled_apart -q -j 1 -s time.bulk=implicit -s time.cohesion=implicit -s 'time.end=95 us' -s 'expect={}' "
    "-s output.report=false -s 'figure=[{file=\"energy.png\", show=\"energy\"}]' ";

/// One triangle of point masses without stiffness, glued at two of them; pulled by 1.1 of the strength. With h theta
/// kappa = 1.5 the step has several solutions.
void write_point_masses(const fs::path& folder) {
    std::ofstream(folder / "triangle.msh")
        << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"base\"\n1 2 \"free\"\n2 3 \"dust\"\n"
           "$EndPhysicalNames\n$Nodes\n3\n1 0 0 0\n2 2 0 0\n3 1 1 0\n$EndNodes\n$Elements\n4\n1 1 2 1 1 1 2\n"
           "2 1 2 2 2 2 3\n3 1 2 2 2 3 1\n4 2 2 3 3 1 2 3\n$EndElements\n";
    std::ofstream(folder / "masses.toml")
        << "knap = 1\nname = \"masses\"\n[mesh]\nfile = \"triangle.msh\"\n[material.dust]\ndensity = 3\nE = 1e-9\nnu = "
           "0\n"
           "[interface.default]\nbreakable = false\n[interface.glue]\nsigma_c = 1\nG_c = 0.5\n[[support]]\non = "
           "\"base\"\n"
           "interface = \"glue\"\nglued = true\n[[load]]\nbody_force = [0, 3.3]\n[time]\nend = 9\nbulk = \"implicit\"\n"
           "cohesion = \"implicit\"\nstep = 3\n[limits]\nlaw_lag = \"none\"\narea_change = \"none\"\n"
           "[output]\nfields = false\n[[figure]]\nfile = \"energy.png\"\nshow = \"energy\"\n";
}

void check_complete(const fs::path& run) {
    for (const char* file : {"scenario.toml", "resolved.toml", "run.json", "log.txt", "energy.csv", "cracks.csv",
                             "fragments.csv", "figures/energy.png"})
        CHECK_MESSAGE((fs::exists(run / file) && fs::file_size(run / file) > 0), file);
}

/// The run ended where no smaller step was possible, says why, and its outputs are complete.
void check_stuck(const Answer& answer, const std::vector<std::string>& reasons, const fs::path& run) {
    CAPTURE(answer.text);
    CHECK(answer.code == 3);
    CHECK(answer.has("cannot continue from t = 0 s"));
    for (const std::string& reason : reasons) CHECK(answer.has(reason));
    check_complete(run);
}

}  // namespace

TEST_CASE("an implicit run says what it did") {
    const Folder folder("implicit");
    const Answer run = command("run " + bar + "-o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    CHECK(run.has("linear solves"));
    check_complete(folder.path / "run");
    const std::string json = text_of(folder.path / "run/run.json");
    for (const char* words :
         {"\"bulk\": \"implicit\"", "\"cohesion\": \"implicit\"", "\"theta\": 0.5", "\"mass\": \"lumped\"",
          "\"linear_solves\": ", "\"factor\": {", "\"factorisations\": ", "\"softening\": 0", "\"assumption_1\": 0",
          "\"smallest_step_s\": ", "\"scheme_dissipation\": 0.0,"})
        CHECK_MESSAGE(json.find(words) != std::string::npos, words);
    CHECK(json.find("\n  \"linear_solves\": 0,") == std::string::npos);  // not those of the fans
    const std::string energy = text_of(folder.path / "run/energy.csv");
    CHECK(
        energy.starts_with("time [s],kinetic [J],strain [J],surface [J],dissipated [J],recoverable [J],external_work "
                           "[J],cohesive_work [J],friction_work [J],impact_work [J],residual [J],law_lag_energy [J],"
                           "crossing_loss_energy [J],scheme_dissipation [J],step_change_work [J],step [s]\n"));

    SUBCASE("theta above a half damps and the energy balance closes") {
        const Answer damped =
            command("run " + bar + "-s time.theta=0.7 -s time.mass=consistent -o " + folder.in_shell("damped"));
        CHECK(damped.code == 0);
        const std::string found = text_of(folder.path / "damped/run.json");
        CHECK(found.find("\"mass\": \"consistent\"") != std::string::npos);
        CHECK(found.find("\"scheme_dissipation\": 0.0,") == std::string::npos);
    }
    SUBCASE("a shorter run is the begin of the longer one") {
        CHECK(command("run " + bar + "--until 90us -o " + folder.in_shell("short")).code == 0);
        const std::string part = text_of(folder.path / "short/energy.csv");
        const std::string head = part.substr(0, part.rfind('\n', part.size() - 2));
        CHECK(head.size() > 1000);
        CHECK(energy.starts_with(head));
    }
}

TEST_CASE("a run cuts its steps where cohesion begins to fall and says so") {
    const Folder folder("cuts");
    const Answer run =
        command("run " + bar + "-s 'time.step=100 CFL' -s 'time.step_cracking=10 CFL' -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    const std::string log = text_of(folder.path / "run/log.txt"), json = text_of(folder.path / "run/run.json");
    CHECK(log.find("cutback: t = ") != std::string::npos);
    CHECK(log.find("at (0.008, ") != std::string::npos);  // the line in the middle
    CHECK(log.find("m: cohesion begins to fall") != std::string::npos);
    CHECK(json.find("\"softening\": 1,") != std::string::npos);
    CHECK(run.has("cutbacks 1: cohesion begins to fall"));
    CHECK(run.has(" to 7.917 µs;"));
    const std::string resolved = text_of(folder.path / "run/resolved.toml");
    CHECK(resolved.find("step = \"100 CFL\"") != std::string::npos);
    CHECK(resolved.find("step_cracking = \"10 CFL\"") != std::string::npos);

    // what is cut is cut at the same times in a shorter run
    CHECK(command("run " + bar + "-s 'time.step=100 CFL' -s 'time.step_cracking=10 CFL' --until 88us -o " +
                  folder.in_shell("short"))
              .code == 0);
    const std::string part = text_of(folder.path / "short/energy.csv"), whole = text_of(folder.path / "run/energy.csv");
    const std::string head = part.substr(0, part.rfind('\n', part.size() - 2));
    CHECK(head.size() > 200);
    CHECK(whole.starts_with(head));
}

TEST_CASE("a run that cannot go on ends with 3 and its outputs are complete") {
    const Folder folder("stuck");
    write_point_masses(folder.path);
    const std::string masses = "run " + folder.in_shell("masses.toml") + " -q -j 1 ";
    // a motion that is no number
    const Answer infinite =
        command(masses + "-s 'load[0].body_force=[0, 1e200]' -s time.bulk=explicit -o " + folder.in_shell("run"));
    CAPTURE(infinite.text);
    CHECK(infinite.code == 3);
    CHECK(infinite.has("reason: the motion is no longer finite"));
    check_complete(folder.path / "run");
    CHECK(text_of(folder.path / "run/run.json").find("\"status\": \"failed\"") != std::string::npos);
}

TEST_CASE("a body that is driven against its support ends the run and the reason says so") {
    const Folder folder("driven");
    write_point_masses(folder.path);
    std::ofstream(folder.path / "masses.toml", std::ios::app) << "[[load]]\non = \"base\"\nvelocity = [\"free\", -1]\n";
    const Answer run =
        command("run " + folder.in_shell("masses.toml") +
                " -q -j 1 -s time.bulk=explicit -s 'support[0].glued=false' -o " + folder.in_shell("run"));
    check_stuck(run, {"contacts are driven against each other", "Look at the prescribed motions"}, folder.path / "run");
}

TEST_CASE("a body that is only shifted comes to rest in whole steps") {
    const Folder folder("shifted");
    std::ofstream(folder.path / "blocks.toml") << R"(knap = 1
name = "blocks"
[domain]
shape = "rectangle"
size = [0.04, 0.01]
[[domain.crack]]
points = [[0.02, 0], [0.02, 0.01]]
[mesh]
size = 0.002
[material.a]
density = 2500
E = 30e9
nu = 0.2
[interface.default]
breakable = false
[[load]]
on = { box = [-1, -1, 0.019999, 1] }
displacement = [0, 0]
[[load]]
on = { box = [0.020001, -1, 1, 1] }
displacement = [0.0002, 0]
ramp = 600
[time]
end = 6000
bulk = "implicit"
step = 30
theta = 1
[output]
fields = false
)";
    const Answer run = command("run " + folder.in_shell("blocks.toml") + " -q -j 1 -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    CHECK(run.code == 0);
    CHECK(run.has("after 200 steps of 30 s"));
    CHECK_FALSE(run.has("cutback"));
}

TEST_CASE("a step beyond Assumption 1 ends the run or is cut or is taken as the scenario says") {
    const Folder folder("assumption");
    write_point_masses(folder.path);
    const std::string masses = "run " + folder.in_shell("masses.toml") + " -q -j 1 ";

    const Answer stuck = command(masses + "-s time.step_min=2 -o " + folder.in_shell("run"));
    check_stuck(stuck, {"Assumption 1", "time.assumption_1 = \"ignore\""}, folder.path / "run");
    const std::string json = text_of(folder.path / "run/run.json");
    CHECK(json.find("\"status\": \"failed\"") != std::string::npos);
    CHECK(json.find("\"reason\": \"the run cannot continue") != std::string::npos);
    CHECK(json.find("\"assumption_1\": 1,") != std::string::npos);

    // smaller steps are allowed: cut once and done
    const Answer cut = command(masses + "-o " + folder.in_shell("cut"));
    CAPTURE(cut.text);
    CHECK(cut.code == 0);
    CHECK(cut.has("cutbacks 1: Assumption 1"));
    // or one of the solutions is good enough
    const Answer ignored = command(masses + "-s time.assumption_1=ignore -o " + folder.in_shell("ignored"));
    CHECK(ignored.code == 0);
    CHECK(ignored.has("3 steps of 3 s"));
}

TEST_CASE("a body that is torn apart with friction is solved in every step of the size of the stable one") {
    const Folder folder("violent");
    std::ofstream(folder.path / "violent.toml")
        << "knap = 1\nname = \"violent\"\nseed = 2\n[domain]\nshape = \"rectangle\"\nsize = [\"14 mm\", \"8 "
           "mm\"]\nmodel = \"plane strain\"\n[[domain.crack]]\n"
           "points = [[0, \"4 mm\"], [\"4 mm\", \"4 mm\"]]\n[mesh]\nsize = \"1 mm\"\n[material.glass]\ndensity = "
           "2450\nE = \"32 GPa\"\nnu = 0.2\n"
           "[interface.default]\nsigma_c = \"5 MPa\"\nG_c = 3\ngamma = 1\nfriction = 0.3\n[[load]]\non = "
           "\"top\"\nvelocity = [0, 3]\nramp = \"3 us\"\n"
           "[[load]]\non = \"bottom\"\nvelocity = [0, -3]\nramp = \"3 us\"\n[time]\nend = \"16 us\"\nbulk = "
           "\"implicit\"\ncohesion = \"implicit\"\ntheta = 0.7\n"
           "step = \"1 CFL\"\n[output]\nfields = false\nevery = \"1 ms\"\n";
    const Answer run =
        command("run " + folder.in_shell("violent.toml") + " -q -j 1 --until 3.8us -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    CHECK(run.code == 0);
    const std::string json = text_of(folder.path / "run/run.json");
    CHECK(
        json.find("\"not_converged\": 0") !=
        std::string::npos);  // the states of a few fans go round in a circle in two of these steps, at one augmentation
}

TEST_CASE("why a run stopped names place and time and what to change") {
    const knap::Cutback cut{.reason = knap::CutbackReason::not_converged, .time = 3e-5, .from = 2e-9, .to = 1e-9};
    const std::string text = knap::stuck_text(cut, {0.25, -0.5}, 1.5e-9);
    for (const char* words : {"t = 30 µs", "(0.25, -0.5) m", "of 2 ns", "1.5 ns", "time.theta = 0.7",
                              "time.bulk = \"explicit\"", "time.step_min = \"1.5 ps\""})
        CHECK_MESSAGE(text.find(words) != std::string::npos, words);
    CHECK(knap::cutback_text(cut, {0.25, -0.5}, 1).find("2 ns -> 1 ns at (0.25, -0.5) m: the interface problem") !=
          std::string::npos);

    const knap::Cutback jump{.reason = knap::CutbackReason::assumption_1,
                             .time = 1,
                             .from = 2e-4,
                             .to = 1e-6,
                             .changes_to_explicit = true,
                             .explicit_until = 1.0004995};
    CHECK(knap::stuck_text(jump, {}, 1e-9).find("time.bulk = \"auto\"") != std::string::npos);
    CHECK(knap::cutback_text(jump, {}, 2).find("at least 500 steps of 1 µs, 1e+06 if the body is not quiet") !=
          std::string::npos);
}

TEST_CASE("complementarity problems of chosen steps are stored and can be solved") {
    const Folder folder("dump");
    const Answer run = command("run " + bar + "--dump-lcp 1,10:20:40 -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    std::vector<std::string> files;
    for (const auto& file : fs::directory_iterator(folder.path / "run/lcp"))
        files.push_back(file.path().filename().string());
    std::sort(files.begin(), files.end());
    CHECK(files == std::vector<std::string>{"step_000001.L.mtx", "step_000001.q.mtx", "step_000010.L.mtx",
                                            "step_000010.q.mtx", "step_000030.L.mtx", "step_000030.q.mtx"});
    CHECK(text_of(folder.path / "run/log.txt").find("lcp: step_000010: ") != std::string::npos);
    const Answer solved = command("lcp " + folder.in_shell("run/lcp/step_000030"));
    CHECK(solved.code == 0);
    CHECK(solved.has("solved"));
    // the half ellipse of the norm is stored as a polygon
    const Answer norm =
        command("run " + bar + "-s interface.left-right.coupling=norm --dump-lcp 10 -o " + folder.in_shell("norm"));
    CHECK_MESSAGE(norm.code == 0, norm.text);
    CHECK(text_of(folder.path / "norm/log.txt").find("polygon of 8 sides round it") != std::string::npos);
    CHECK(command("lcp " + folder.in_shell("norm/lcp/step_000010")).code == 0);
    CHECK(command("run " + bar +
                  "-s interface.left-right.coupling=norm -s interface.left-right.unloading=secant --dump-lcp 1 -o " +
                  folder.in_shell("ramps"))
              .has("ramps of unloading"));
    // what lies beyond the end of a run, or behind the command that goes on with it, is reported
    CHECK_FALSE(run.has("dump-lcp"));
    const Answer beyond = command("run " + bar + "--until 2us --dump-lcp 1,3:5:100000 -o " + folder.in_shell("early"));
    CAPTURE(beyond.text);
    CHECK(beyond.has("warning[dump-lcp]: --dump-lcp did not store "));
    CHECK(beyond.has(":5:99998; this command took steps 1 to "));
    CHECK(command("run " + bar + "--until 6us --dump-lcp 1 -o " + folder.in_shell("early"))
              .has("did not store 1; this command took steps "));
    CHECK(knap::StepSelection::parse("1:4,5,9:3:20").outside(3, 12) == "1:2,15:3:18");
    CHECK(knap::StepSelection::parse("1:4,5,9:3:20").outside(1, 20) == "");
    CHECK(knap::StepSelection::parse("7,10:9223372036854775807:9223372036854775807").outside(8, 9) == "7,10");
    CHECK(
        command("run bar_pulled_apart --dump-lcp 1 -o " + folder.in_shell("explicit")).has("time.bulk = \"implicit\""));
    const Answer large = command(
        "run edge_cracked_block -s 'domain.crack=[]' -s 'interface.default.breakable=true' -s time.bulk=implicit "
        "-s 'mesh.size=0.25 mm' -s time.cohesion=implicit --dump-lcp 1 -o " +
        folder.in_shell("large"));
    CHECK(large.code == 2);
    CHECK(large.has("too-large"));
    CHECK_FALSE(fs::exists(folder.path / "large"));
}

TEST_CASE("steps to store are chosen by number or by range") {
    const auto chosen = [](const std::string& text) {
        std::vector<int> numbers;
        const knap::StepSelection selection = knap::StepSelection::parse(text);
        for (int i = 0; i < 100; ++i)
            if (selection.contains(i)) numbers.push_back(i);
        return numbers;
    };
    CHECK(chosen("10") == std::vector<int>{10});
    CHECK(chosen("20,10") == std::vector<int>{10, 20});
    CHECK(chosen("3:6") == std::vector<int>{3, 4, 5, 6});
    CHECK(chosen("10,20:5:40") == std::vector<int>{10, 20, 25, 30, 35, 40});
    for (const char* text : {",", "0", "-3", "a", "1:", "1:2:3:4", "5:1:4", "1,,2", "1.5", "1:0:3", " "}) {
        CAPTURE(text);
        CHECK_THROWS_AS(knap::StepSelection::parse(text), knap::UserError);
    }
}

TEST_CASE("a run reports the steps of the Lemke fallback") {
    knap::RunRecord record;
    record.status = "done";
    record.steps = 10;
    record.counts.linear_solves = 40;
    CHECK(knap::end_of_run(record, "somewhere").find("Lemke") == std::string::npos);
    record.counts.fan_fallbacks = 3;
    CHECK(knap::end_of_run(record, "somewhere").find("Lemke   solved 3 steps on which this solver failed") !=
          std::string::npos);
}

TEST_CASE("a notched beam that is loaded again and again with secant unloading needs no smaller steps") {
    // Ramps of 1e-6 to 0.1 delta_c lie side by side round every vertex, and their slips reverse.
    const Folder folder("secant");
    write_scene(folder, R"(knap = 1
name = "beam"
[domain]
shape = "polygon"
points = [["0 mm", "0 mm"], ["240 mm", "0 mm"], ["240 mm", "40 mm"], ["260 mm", "40 mm"], ["260 mm", "0 mm"],
          ["500 mm", "0 mm"], ["500 mm", "100 mm"], ["0 mm", "100 mm"]]
sides = ["left half", "notch", "notch", "notch", "right half", "right", "top", "left"]
model = "plane stress"
[mesh]
size = "30 mm"
refine = [{ inside = ["200 mm", "0 mm", "300 mm", "100 mm"], size = "10 mm" }]
[material.concrete]
density = "2400 kg/m3"
E = "25.85 GPa"
nu = 0.18
[interface.default]
sigma_c = "2.7 MPa"
G_c = "90 J/m2"
unloading = "secant"
[[load]]
on = { box = ["-1 mm", "-1 mm", "10 mm", "1 mm"] }
displacement = ["0 mm", "0 mm"]
[[load]]
on = { box = ["488 mm", "-1 mm", "501 mm", "1 mm"] }
displacement = ["free", "0 mm"]
[[load]]
on = { box = ["240 mm", "99 mm", "260 mm", "101 mm"] }
displacement = ["free", "-1 mm"]
table = [["0 s", 0], ["0.15 s", 0.06], ["0.3 s", 0.01], ["0.45 s", 0.1], ["0.6 s", 0.01], ["0.8 s", 0.2], ["1 s", 0]]
[time]
bulk = "implicit"
end = "1 s"
step = "5 ms"
theta = 0.55
[output]
fields = false
)");
    const Answer run = run_scene(folder, "-j 1 -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    CHECK(run.code == 0);
    CHECK(text_of(folder.path / "run/log.txt").find("cutback") == std::string::npos);
}

// Friction 0.3 of 10 kN on 10 mm/s: 30 W. An explicit step is 0.13 ms long.
TEST_CASE("a block that is pushed at a steady speed takes implicit steps of auto and friction takes mu N v") {
    const Folder folder("steady slide");
    std::ofstream(folder.path / "s.toml")
        << "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.25\n[material.rock]\ndensity = 2000\nE = 1e9\n"
           "nu = 0.2\n[interface.default]\nbreakable = false\n[contact]\nfriction = 0.3\n[[body]]\nname = \"block\"\n"
           "shape = \"rectangle\"\nsize = [1, 0.5]\norigin = [0, 0]\nvelocity = [0.01, 0]\n[[obstacle]]\nshape = "
           "\"half plane\"\nat = [0, 0]\nnormal = [0, 1]\nfriction = 0.3\n[[load]]\non = \"block.left\"\nvelocity = "
           "[0.01, \"free\"]\n[[load]]\nacceleration = [0, -10]\n[time]\nend = 10\nbulk = \"auto\"\nstep = 0.1\n"
           "start = \"equilibrium\"\n[output]\nreport = false\nfields = false\nhistory_every = 1\n[expect]\n"
           "energy_residual = { below = 1e-10 }\nfriction_work = { value = -300, within = \"0.01 %\" }\n";
    const Answer answer = command("run " + folder.in_shell("s.toml") + " -q -j 1 -o " + folder.in_shell("run"));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    CHECK(std::stoi(answer.text.substr(answer.text.find(" after ") + 7)) < 5000);  // 79 418 explicit ones
}

// A bar of 1 m on its two ends, friction mu, on a rigid slope of angle i. What the strain e of its temperature adds to its
// length, sqrt(1 + 2 e) - 1 with Green's strain, moves its lower end when it warms and its upper one when it cools, but for
// the shortening by the friction that this takes.
TEST_CASE("T6 a stiff bar creeps down with every cycle of its temperature as the closed form says") {
    constexpr double e = 3e-4, mu = 0.5, E = 1e12, section = 0.1, g = 9.81, i = 10 * 3.14159265358979323846 / 180;
    const Folder folder("ratchet");
    std::ofstream(folder.path / "s.toml")
        << "knap = 1\n[domain]\nrotation = \"large\"\nmodel = \"plane stress\"\n[mesh]\nsize = 0.1\n[material.rock]\n"
           "density = 2500\nE = 1e12\nnu = 0\nexpansion = 3e-6\n[interface.default]\nbreakable = false\n[contact]\n"
           "friction = 0.5\n[[body]]\nname = \"bar\"\nshape = \"polygon\"\npoints = [[0, 0], [0.125, 0.001], [0.875, "
           "0.001], [1, 0], [1, 0.1], [0, 0.1]]\n[heat]\ntemperature = \"100\"\ntable = [[0, 0], [20, 1], [40, 0], "
           "[60, "
           "1], [80, 0], [100, 1], [120, 0]]\n[[obstacle]]\nshape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]\n"
           "friction = 0.5\n[[load]]\nacceleration = ["
        << -g * std::sin(i) << ", " << -g * std::cos(i)
        << "]\n[[probe]]\nname = \"low\"\nat = [0, 0.1]\n[time]\nend = 120\nbulk = \"auto\"\nstep = 0.4\ntheta = 1\n"
           "start = \"equilibrium\"\n[output]\nreport = false\nfields = false\nhistory_every = 40\n";
    const Answer answer = command("run " + folder.in_shell("s.toml") + " -q -j 1 -o " + folder.in_shell("run"));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    const std::vector<double> place = knap::read_csv(folder.path / "run/probes.csv").column("low_u_x");
    REQUIRE(place.size() == 4);
    const double weight = 2500 * section * g,
                 shortening = (mu * weight * std::cos(i) - weight * std::sin(i)) / (E * section),
                 creep = std::sqrt(1 + 2 * e) - 1 - shortening, last = place[2] - place[3];
    CHECK(last == relative(creep, 1e-4));
    CHECK(last == relative(place[1] - place[2], 1e-7));
}

}  // namespace run_implicit_test
