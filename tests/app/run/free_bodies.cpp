// Bodies that nothing holds: damping leaves their flight alone, and bulk viscosity keeps those that rub from creeping.
#include "app/program.hpp"

#include "base/random.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace free_bodies_test {

using namespace program;
using knap::tests::relative;

namespace {

/// What follows the density of a body that does not break and meets a half plane.
const std::string on_a_plane = R"(E = "30 GPa"
nu = 0.25
[interface.default]
breakable = false
[contact]
[[obstacle]]
shape = "half plane"
at = [0, 0]
)";

/// A disc of 0.34 m that flies with 10 m/s above a ground, and weighs nothing.
const std::string flight = R"(knap = 1
[domain]
rotation = "large"
shape = "disc"
centre = ["0 m", "100 m"]
radius = "0.34 m"
[mesh]
size = "0.2 m"
[material.rock]
density = 2700
)" + on_a_plane + R"(normal = [0, 1]
friction = 0.3
[[initial]]
velocity = ["10 m/s", 0]
spin = "3 rad/s"
[time]
end = "20 ms"
damping = "20 Hz"
)";

/// A block of 1 m on a plane of 35 degrees, friction 0.75: its safety is 1.07.
const std::string block = R"(knap = 1
seed = 1
[domain]
rotation = "large"
[mesh]
size = "0.5 m"
[[body]]
shape = "rectangle"
size = ["1 m", "1 m"]
origin = ["16.38304 m", "-11.471528 m"]
angle = "-35 deg"
[material.limestone]
density = 2600
)" + on_a_plane + R"(normal = [0.573576436, 0.819152044]
friction = 0.75
[[load]]
acceleration = [0, -9.81]
[time]
end = "0.5 s"
[output]
fields = false
)";

double number(const fs::path& run, const char* name) {
    return nlohmann::json::parse(text_of(run / "run.json"))["summary"][name];
}

std::size_t count(const std::string& text, const std::string& words) {
    std::size_t n = 0;
    for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++n;
    return n;
}

}  // namespace

TEST_CASE("damping: a body flies on and the log says so once and also in parts") {
    const Folder folder("free flight");
    write_scene(folder, flight);
    check_threads_and_parts(folder, {"2"}, {"1ms", "12ms"}, 3);
    const fs::path whole = folder.path / "whole";
    const double mass = knap::read_csv(whole / "fragments.csv").column("mass").at(0);
    CHECK(std::abs(number(whole, "momentum_x") / mass - 10) < 1e-12);
    CHECK(knap::read_csv(whole / "fragments.csv").column("spin").at(0) == relative(3, 1e-6));
    CHECK(count(text_of(whole / "log.txt"), "damping: from t = 0 s on nothing holds 1 pieces") == 1);
    for (const auto& run : fs::directory_iterator(folder.path))
        if (run.is_directory()) CHECK(count(text_of(run.path() / "log.txt"), "damping: from") == 1);

    REQUIRE(run_scene(folder, "-s time.damping_of=motion -o " + folder.in_shell("braked")).code == 0);
    const fs::path braked = folder.path / "braked";
    CHECK(number(braked, "momentum_x") / mass == relative(10 * std::exp(-20 * 0.02), 1e-3));
    CHECK(count(text_of(braked / "log.txt"), "damping: from") == 0);
}

TEST_CASE("viscosity: a stable block stands still by default") {
    const Folder folder("stable block");
    write_scene(folder, block);
    const auto moved = [&](const std::string& options) {
        const Answer answer = run_scene(folder, "--force -j 1 " + options + " -o " + folder.in_shell("run"));
        CAPTURE(answer.text);
        REQUIRE(answer.code == 0);
        const fs::path run = folder.path / "run";
        CHECK(number(run, "energy_residual") < 1e-12);
        return 1e3 * std::hypot(number(run, "mean_displacement_x"), number(run, "mean_displacement_y"));  // [mm]
    };
    const double without = moved("-s 'material.limestone.bulk_viscosity=[0, 0]'");
    CHECK(without > 10);
    for (const char* seed : {"1", "2", "3"}) {
        CHECK(moved(std::string("-s seed=") + seed) < 0.3);
        const knap::History energy = knap::read_csv(folder.path / "run" / "energy.csv");
        const std::vector<double> work = energy.column("friction_work"), time = energy.column("time");
        for (std::size_t i = 0; i < work.size(); ++i)
            if (time[i] > 0.25) CHECK(work[i] == work.back());
    }
}

// N. M. Newmark, Geotechnique 15 (1965) 139: a pulse A of duration T against the yield acceleration a = mu g moves a
// rigid block by A T^2 (A - a)/(2 a).
TEST_CASE("viscosity: a block that a pulse shakes slips as far as Newmark's rigid one") {
    const Folder folder("newmark");
    std::string text = block;
    const auto replace = [&](const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
    };
    replace("angle = \"-35 deg\"\n", "");
    replace("origin = [\"16.38304 m\", \"-11.471528 m\"]", "origin = [0, 0]");
    replace("normal = [0.573576436, 0.819152044]\nfriction = 0.75", "normal = [0, 1]\nfriction = 0.5");
    replace("[time]",
            "[[load]]\nacceleration = [8, 0]\ntable = [[0.0499, 0], [0.0501, 1], [0.1999, 1], [0.2001, 0]]\n[time]");
    write_scene(folder, text);
    REQUIRE(run_scene(folder, "-j 1 -o " + folder.in_shell("run")).code == 0);
    const double A = 8, T = 0.15, a = 0.5 * 9.81;
    CHECK(number(folder.path / "run", "mean_displacement_x") == relative(A * T * T * (A - a) / (2 * a), 0.005));
}

TEST_CASE("T9 rubble of 24 blocks that falls in implicit steps of 40 ms comes to rest to rounding") {
    constexpr int n = 24, in_a_row = 4;
    const auto number_text = [](double value) { return std::to_string(value); };
    knap::Random random(1, "rubble");
    std::string text =
        "knap = 1\n[domain]\nrotation = \"large\"\n[mesh]\nsize = 0.3\n[material.rock]\n"
        "density = 2600\n" +
        on_a_plane + "normal = [0, 1]\nfriction = 0.5\n";
    text.replace(text.find("[contact]"), 9, "[contact]\nfriction = 0.5");
    for (const char* wall : {"at = [0, 0]\nnormal = [1, 0]\n", "at = [4.6, 0]\nnormal = [-1, 0]\n"})
        text += std::string("[[obstacle]]\nshape = \"half plane\"\n") + wall + "friction = 0.5\n";
    for (int i = 0; i < n; ++i) {
        const int row = i / in_a_row;
        text += "[[body]]\nname = \"b" + std::to_string(i) + "\"\nshape = \"rectangle\"\nsize = [" +
                number_text(random.uniform(0.4, 0.8)) + ", " + number_text(random.uniform(0.25, 0.45)) +
                "]\norigin = [" + number_text(0.4 + i % in_a_row + 0.3 * (row % 2)) + ", " +
                number_text(0.5 + 0.95 * row) + "]\nangle = \"" + number_text(random.uniform(-40, 40)) + " deg\"\n";
    }
    text +=
        "[[load]]\nacceleration = [0, -9.81]\n[time]\nend = 5\nbulk = \"implicit\"\nstep = 0.04\ntheta = 1\n"
        "[output]\nevery = 0.1\nfields = false\n";
    const Folder folder("rubble");
    write_scene(folder, text);
    const Answer answer = run_scene(folder, "-j 1 -o " + folder.in_shell("run"));
    CAPTURE(answer.text);
    REQUIRE(answer.code == 0);
    const fs::path run = folder.path / "run";
    CHECK(number(run, "kinetic_energy") < 1e-20);
    CHECK(number(run, "impact_work") < -1000);
    const nlohmann::json record = nlohmann::json::parse(text_of(run / "run.json"));
    for (const auto& gate : record["gates"]) {
        const std::string name = gate["name"];
        if (name == "energy_residual") CHECK(gate["value"] < 1e-13);
        if (name == "contact_depth") CHECK(gate["value"] < 2e-3);
        if (name == "contact_injection") CHECK(gate["value"] < 1e-10);
    }
    CHECK(record["steps"] < 500);
}

}  // namespace free_bodies_test
