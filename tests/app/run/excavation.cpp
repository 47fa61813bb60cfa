// Excavations in whole runs: same bits for threads and resumed runs, files without what vanished, messages.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "output/vtk_series.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace excavation_test {

using namespace program;
using knap::tests::relative;

namespace {

/// Stressed rock that breaks round two excavations, one of them to the top of the body; `more` of the scenario.
std::string scene(const std::string& more = "", const std::string& time = "") {
    return rectangle("\"12 m\", \"12 m\"", "\"0.6 m\"") + R"([material.rock]
density = 2600
E = "30 GPa"
nu = 0.25
[interface.default]
sigma_c = "3 MPa"
G_c = "300 J/m2"
friction = 0.6
[[load]]
name = "in situ"
on = { box = [-1, -1, 13, 13] }
stress = ["-10 MPa", "-20 MPa", 0]
[[absorb]]
on = "left"
[[absorb]]
on = "bottom"
[[excavation]]
centre = [4, 4]
radius = 1.5
at = "3 ms"
ramp = "1 ms"
[[excavation]]
points = [[7, 8], [10, 8], [10, 13], [7, 13]]
at = "1 ms"
ramp = "2 ms"
[[probe]]
at = [5.5, 4]
[output]
every = "0.5 ms"
history_every = "0.1 ms"
breaks = true
)" + more + "[time]\nend = \"6 ms\"\nstart = \"equilibrium\"\n" +
           time;
}

}  // namespace

TEST_CASE(
    "excavation: the same bits for one and two and four threads and for runs that stop before and within and after") {
    const Folder folder("excavation bits");
    write_scene(folder, scene("", "damping = \"20 Hz\"\n"));
    check_threads_and_parts(folder, {"2", "4"}, {"0.8ms", "2ms", "3.5ms", "5ms"}, 30);
    const std::string log = text_of(folder.path / "parts/log.txt");
    for (const char* line : {"excavation[0]: ", "excavation[1]: "}) {
        CHECK(log.find(line) != std::string::npos);
        CHECK(log.find(line) == log.rfind(line));
    }
    CHECK(log.find("excavation[1]: ") < log.find("excavation[0]: "));
}

TEST_CASE("excavation: files show what remains and the record has what left") {
    const Folder folder("excavation files");
    write_scene(folder, scene());
    REQUIRE(run_scene(folder, "-j 1 -o " + folder.in_shell("run")).code == 0);
    const fs::path directory = folder.path / "run";
    const knap::History energy = knap::read_csv(directory / "energy.csv");
    const auto record = nlohmann::json::parse(text_of(directory / "run.json"));
    const auto number = [&](const char* name) { return record["summary"][name].get<double>(); };
    CHECK(number("energy_residual") < 1e-12);
    CHECK(number("excavation_work") < 0);
    CHECK(number("excavated_energy") > 0);
    CHECK(energy.column("excavated_energy").front() == 0);
    CHECK(energy.column("excavated_energy").back() == number("excavated_energy"));
    const std::vector<double> times = knap::frame_times(directory);
    const auto area = [&](double time) {
        const knap::Frame frame = knap::read_frame(directory, knap::nearest_frame(times, time));
        double sum = 0;
        for (std::size_t c = 0; c < frame.position.size(); c += 3)
            sum +=
                0.5 * knap::cross(frame.position[c + 1] - frame.position[c], frame.position[c + 2] - frame.position[c]);
        CHECK(frame.stress.size() * 3 == frame.position.size());
        CHECK(frame.fragment.size() * 3 == frame.position.size());
        for (const auto& side : {frame.side_a, frame.side_b})
            for (const auto& corners : side)
                for (const knap::Index c : corners) CHECK(c < 3 * frame.n_triangles());
        return sum;
    };
    CHECK(area(0.5e-3) == relative(144));
    CHECK(area(2e-3) == relative(144 - 12, 2e-3));
    CHECK(area(6e-3) < 144 - 12 - 0.95 * 3.14 * 2.25);
    double mass = 0;
    const knap::History fragments = knap::read_csv(directory / "fragments.csv");
    for (const double part : fragments.column("mass")) mass += part;
    CHECK(mass == relative(2600 * area(6e-3), 1e-5));
}

TEST_CASE("excavation: messages") {
    const Folder folder("excavation messages");
    const auto refused = [&](const std::string& text, const char* code, const char* words) {
        check_refused(folder, text, code, words);
    };
    const std::string box = "[[excavation]]\nat = \"4 ms\"\nbox = ";
    refused(scene(box + "[20, 20, 21, 21]\n"), "empty-selection", "`excavation[2]` covers no triangle");
    refused(scene(box + "[8, 9, 9, 10]\n"), "empty-selection",
            "`excavation[2]` covers no triangle");  // excavated already
    refused(scene(box + "[-1, -1, 13, 13]\n"), "empty-selection", "`excavation[2]` leaves nothing of the body");
    refused(scene("[[probe]]\nname = \"core\"\nat = [4, 4]\n"), "excavated", "`probe[1]` `core` watches a place");
    refused(scene("[[probe]]\nat = [4, 4]\nwatch = \"interface\"\n"), "excavated", "watches an interface");
    refused(scene("[[absorb]]\non = { boundary = \"top\", box = [7, 11, 10, 13] }\n"), "excavated",
            "`absorb[2]` loses all of its boundary");
    refused(scene(box + "[0, 0, 1, 1]\nradius = 1\n"), "exclusive-keys", "only one");
    refused(scene("[[excavation]]\nat = \"4 ms\"\n"), "missing-key", "has none of");
    refused(scene("[[excavation]]\nat = \"-1 ms\"\nbox = [0, 0, 1, 1]\n"), "out-of-range", "excavation[2].at");

    const auto warned = [&](const std::string& text, const char* words) {
        write_scene(folder, text);
        const Answer answer = command("check " + folder.in_shell("scene.toml"));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        CHECK(answer.has(words));
    };
    warned(scene(), "`load[0]` acts on a region that vanishes");
    warned(scene(), "excavation[1]: ");
    warned(scene("[[excavation]]\nat = \"7 ms\"\nbox = [0, 0, 1, 1]\n"), "does not vanish in this run");
}

TEST_CASE("excavation: a region whose rock has moved by more than an edge is warned of") {
    const Folder folder("excavation moved");
    const auto warnings = [&](const char* at) {
        write_scene(folder, rectangle("12, 12", "2") + R"([material.rock]
density = 2600
E = "30 GPa"
nu = 0.25
[interface.default]
breakable = false
[[initial]]
velocity = [60, 0]
[[excavation]]
box = [4, 4, 8, 8]
ramp = "1 ms"
at = ")" + at + "\"\n[time]\nend = \"60 ms\"\n[output]\nfields = false\n");
        const Answer answer = run_scene(folder, "-j 1 --force -o " + folder.in_shell("run"));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        return text_of(folder.path / "run/log.txt");
    };
    const std::string words = "`excavation[0]` removes what was in its region at the start";
    CHECK(warnings("10 ms").find(words) == std::string::npos);  // 0.6 m of edges of 2 m
    const std::string log = warnings("50 ms");
    const std::size_t found = log.find(words);
    REQUIRE(found != std::string::npos);
    CHECK(log.find("warning[excavated]: at t = 50") != std::string::npos);
    CHECK(log.find("moved by up to 3", found) < found + 120);
    CHECK(log.find(words, found + 1) == std::string::npos);
}

TEST_CASE("excavation: a roof that only touches an excavated pillar is released by the ramp") {
    // under the force R (1 - t/ramp) of its weight it reaches the speed g (T - ramp/2) in the time T; it still vibrates,
    // by some hundredths of its weight
    const auto velocity = [](const Folder& folder, const std::string& ramp, const std::string& law) {
        write_scene(folder, R"(knap = 1
[domain]
rotation = "large"
[[body]]
name = "pillar"
shape = "rectangle"
origin = [0, 0]
size = [0.5, 0.5]
[[body]]
name = "roof"
shape = "rectangle"
origin = [-0.1, 0.5]
size = [0.7, 0.4]
[mesh]
size = 0.3
[material.rock]
density = 2600
E = "5 GPa"
nu = 0.25
[interface.default]
breakable = false
friction = 0.5
)" + law + R"([contact]
[[obstacle]]
shape = "half plane"
at = [0, 0]
normal = [0, 1]
friction = 0.5
[[load]]
ramp = 0.02
acceleration = [0, -9.81]
[[excavation]]
box = [-0.01, -0.01, 0.51, 0.5]
at = 0.04
ramp = )" + ramp + "\n[time]\nend = 0.14\n[output]\nfields = false\nevery = 0.07\n");
        const Answer run = run_scene(folder, "-j 1 -s 'figure=[]' -o " + folder.in_shell("run"));
        CAPTURE(run.text);
        REQUIRE(run.code == 0);
        return knap::read_csv(folder.path / "run/fragment_paths.csv").column("velocity_y").back();
    };
    const Folder at_once("released roof at once");
    CHECK(velocity(at_once, "0", "restitution = 0\n") == relative(-9.81 * 0.1, 0.01));
    for (const char* restitution : {"0", "0.5"}) {
        CAPTURE(restitution);
        const Folder slowly("released roof");
        CHECK(velocity(slowly, "0.06", std::string("restitution = ") + restitution + "\n") ==
              relative(-9.81 * 0.07, 0.02));
        const knap::History energy = knap::read_csv(slowly.path / "run/energy.csv");
        // int R (1 - t/ramp) v dt with v = g t^2/(2 ramp): m g^2 ramp^2/24, upwards while it falls
        CHECK(energy.column("excavation_work").back() == relative(-0.28 * 2600 * std::pow(9.81 * 0.06, 2) / 24, 0.1));
    }
}

// Of a plate with few round holes of the area fraction f the compliance is 1 + 3 f times as large (plane stress):
// 0.0196 here, so that the stress between grips that stay falls by 5.6 %; the hole is a polygon, and the plate is no
// large one.
TEST_CASE("excavation: a hole that is bored into a specimen takes its part of the stress") {
    const Folder folder("excavation specimen");
    const auto bored = [&](const std::string& hole) {
        return rectangle("0.04, 0.08", "0.003", "model = \"plane stress\"\n") +
               "[material.rock]\ndensity = 2600\nE = 30e9\nnu = 0.25\n[interface.default]\nbreakable = false\n"
               "[[load]]\non = \"bottom\"\ndisplacement = [0, 0]\n[[load]]\nname = \"top\"\non = \"top\"\n"
               "displacement = [0, -1e-5]\nramp = 0.1\n[specimen]\ntest = \"compression\"\nforce = \"top\"\n"
               "[[excavation]]\nat = 0.2\nramp = 0.1\n" +
               hole +
               "[time]\nend = 0.5\nbulk = \"implicit\"\nstep = 0.01\ntheta = 1\n[output]\nfields = false\n"
               "history_every = 0.01\n";
    };
    check_refused(folder, bored("centre = [0.04, 0.04]\nradius = 0.004\n"), "error[empty-selection]",
                  "takes a place at which the stress or the strains of the specimen are measured");
    write_scene(folder, bored("centre = [0.02, 0.04]\nradius = 0.00447\n"));
    const Answer run = run_scene(folder, "-j 1 -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    const knap::History curve = knap::read_csv(folder.path / "run/stress_strain.csv");
    const std::vector<double> time = curve.column("time"), stress = curve.column("stress");
    double before = 0;
    for (std::size_t i = 0; i < time.size() && time[i] < 0.2; ++i) before = stress[i];
    CHECK(1 - stress.back() / before == relative(0.056, 0.15));
}

}  // namespace excavation_test
