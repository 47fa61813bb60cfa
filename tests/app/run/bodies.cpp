// A run of three bodies: frames, tables and a figure know them apart.
#include "app/program.hpp"

#include "output/history_csv.hpp"
#include "output/vtk_series.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

namespace bodies_test {

using namespace knap;
using namespace program;

namespace {

const std::string scene = R"(knap = 1
[[body]]
name = "plate"
shape = "rectangle"
size = ["100 mm", "20 mm"]
[[body]]
name = "boulder"
shape = "disc"
centre = ["30 mm", "41 mm"]
radius = "20 mm"
velocity = ["1 m/s", "-10 m/s"]
spin = "1000 deg/s"
[[body]]
name = "block"
shape = "rectangle"
origin = ["60 mm", "20 mm"]
size = ["30 mm", "20 mm"]
[mesh]
size = "5 mm"
[material.rock]
density = 2400
E = "30 GPa"
nu = 0.2
[interface.default]
sigma_c = "3 MPa"
G_c = 50
[time]
end = "2 us"
[output]
every = "1 us"
[[figure]]
file = "a.png"
show = "speed"
)";

}  // namespace

TEST_CASE("bodies: the warning that bodies pass through each other is printed with -q") {
    const Folder folder("no_contact");
    std::ofstream(folder.path / "three.toml") << scene;
    const Answer run = command("run -q -j 1 " + folder.in_shell("three.toml") + " -o " + folder.in_shell("run"));
    CHECK(run.text.find("warning[no-contact]") != std::string::npos);
    CHECK(run.text.find("warning[resolution]") == std::string::npos);
}

TEST_CASE("bodies: check lists no interface between materials of separate bodies") {
    const Folder folder("pairs");
    std::string two = scene + "[material.ice]\ndensity = 900\nE = \"9 GPa\"\nnu = 0.3\n";
    for (const std::string name : {"plate", "boulder", "block"}) {
        const std::string line = "name = \"" + name + "\"\n";
        const std::string material = name == "boulder" ? "ice" : "rock";
        two.replace(two.find(line), line.size(), line + "material = \"" + material + "\"\n");
    }
    std::ofstream(folder.path / "two.toml") << two;
    const Answer check = command("check " + folder.in_shell("two.toml"));
    CHECK(check.code == 0);
    CHECK(check.text.find("  ice          law default") != std::string::npos);
    CHECK(check.text.find("  rock         law default") != std::string::npos);
    CHECK(check.text.find("ice-rock") == std::string::npos);
    CHECK(check.text.find("rock-ice") == std::string::npos);
}

TEST_CASE("bodies: three in one run") {
    const Folder folder("bodies");
    std::ofstream(folder.path / "three.toml") << scene;
    const Answer run = command("run -q -j 1 " + folder.in_shell("three.toml") + " -o " + folder.in_shell("run"));
    CAPTURE(run.text);
    REQUIRE(run.code == 0);
    const fs::path out = folder.path / "run";
    CHECK(fs::file_size(out / "figures" / "a.png") > 1000);
    const History last = read_csv(out / "fragments.csv");
    REQUIRE(last.rows.size() == 3);
    CHECK(last.column("area")[0] == tests::relative(2e-3, 1e-12));
    CHECK(last.column("velocity_y")[1] == tests::relative(-10, 1e-9));
    CHECK(last.column("spin")[1] == tests::relative(1000 * std::numbers::pi / 180, 1e-4));
    CHECK(last.column("area")[2] == tests::relative(6e-4, 1e-12));
    const History history = read_csv(out / "fragment_history.csv"), paths = read_csv(out / "fragment_paths.csv");
    CHECK(history.column("fragments") == std::vector<double>{3, 3, 3});
    CHECK(history.column("time")[1] == tests::relative(1e-6, 1e-9));
    CHECK(history.column("to_x")[0] == tests::relative(0.075, 1e-12));
    REQUIRE(paths.rows.size() == 9);
    const std::vector<double> label = paths.column("label");
    CHECK(std::set<double>(label.begin(), label.end()).size() == 3);
    CHECK(paths.column("centre_x")[7] > paths.column("centre_x")[1]);  // the boulder moves
    // the last lines are those of fragments.csv
    CHECK(std::vector<double>(paths.rows[8].begin() + 2, paths.rows[8].end()) == last.rows[2]);
    const Frame frame = read_frame(out, frame_times(out).size() - 1);
    REQUIRE(frame.fragment.size() == frame.region.size());
    for (const int fragment : {0, 1, 2})
        CHECK(std::ranges::count(frame.fragment, fragment) == last.column("triangles")[fragment]);
}

TEST_CASE("bodies: mesh and check") {
    const Folder folder("bodies_check");
    std::ofstream(folder.path / "three.toml") << scene;
    const Answer mesh = command("mesh " + folder.in_shell("three.toml") + " -o " + folder.in_shell("m.svg"));
    CHECK(mesh.code == 0);
    CHECK(mesh.has("bodies                       3"));
    const Answer check = command("check " + folder.in_shell("three.toml"));
    CHECK(check.has("bodies 3"));
    CHECK(check.has("without [contact] bodies pass through each other"));
    std::ofstream(folder.path / "thin.toml") << scene +
                                                    "[[body]]\nname = \"thin\"\nshape = \"rectangle\"\norigin = "
                                                    "[1, 1]\nsize = [\"10 mm\", \"0.01 mm\"]\n";
    const Answer thin = command("check " + folder.in_shell("thin.toml"));
    CHECK(thin.code == 2);
    CHECK(thin.has("(body `thin`)"));
}

TEST_CASE("bodies: with contact one block throws the other") {
    const Folder folder("bodies_contact");
    std::ofstream(folder.path / "two.toml") << R"(knap = 1
[domain]
rotation = "large"
[[body]]
name = "hammer"
shape = "rectangle"
size = ["20 mm", "20 mm"]
velocity = ["10 m/s", 0]
[[body]]
name = "anvil"
shape = "rectangle"
origin = ["20.05 mm", "2 mm"]
size = ["20 mm", "20 mm"]
[mesh]
size = "4 mm"
[material.rock]
density = 2400
E = "30 GPa"
nu = 0.2
[interface.default]
breakable = false
[contact]
friction = 0.5
[time]
end = "40 us"
)";
    const auto momenta = [&](const std::string& options) {
        const Answer run = command("run -q -j 1 --force " + options + " " + folder.in_shell("two.toml") + " -o " +
                                   folder.in_shell("run"));
        CAPTURE(run.text);
        REQUIRE((run.code == 0 || run.code == 3));  // 3: without contact they overlap
        const History last = read_csv(folder.path / "run" / "fragment_paths.csv");
        std::array<double, 2> found{};
        const std::size_t n = last.rows.size();
        for (std::size_t i = n - 2; i < n; ++i)
            found[last.column("label")[i] > 0] = last.column("mass")[i] * last.column("velocity_x")[i];
        return found;
    };
    const double start = 2400 * 4e-4 * 10;
    const auto [hammer, anvil] = momenta("");
    CHECK(anvil > 0.3 * start);
    CHECK(hammer + anvil == tests::relative(start, 1e-12));
    const auto [ghost, other] = momenta("-s contact=");
    CHECK(ghost == tests::relative(start, 1e-9));
    CHECK(std::abs(other) < 1e-9 * start);
}

}  // namespace bodies_test
