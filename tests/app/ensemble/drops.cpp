// Random members of a sweep: what they draw, that they do not depend on each other, their figures and tables, and that
// one that fails or does not come to rest is named while the rest goes on.
#include "app/program.hpp"

#include "app/ensemble/ensemble.hpp"
#include "base/error.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

namespace drops_test {

using namespace program;
using namespace knap;
using tests::relative;

namespace {

/// A stone of four triangles and a free block above a slope with a step, a barrier line and a vertical.
const std::string drop = R"(knap = 1
name = "drop"
title = "Drops"
[domain]
rotation = "large"
[mesh]
size = 0.8
[[body]]
name = "stone"
shape = "polygon"
points = [[-0.4, 12.6], [0.5, 12.5], [0.4, 13.4], [-0.3, 13.3]]
velocity = [6, 1]
[material.rock]
density = 2600
E = "200 MPa"
nu = 0.25
[interface.default]
breakable = false
[contact]
friction = 0.5
[[load]]
acceleration = [0, -9.81]
[[obstacle]]
name = "terrain"
shape = "polyline"
points = [[60, 0], [14, 0], [9, 4], [6, 4], [-4, 11]]
friction = 0.5
[[obstacle]]
name = "block"
shape = "polygon"
points = [[-3, 13], [-2, 13], [-2, 14], [-3, 14]]
density = 2600
initial_velocity = [3, 0]
friction = 0.5
restitution = 0.2
[[collector]]
name = "net"
from = [12, 0]
to = [12, 12]
direction = "forward"
[[collector]]
name = "edge"
x = 9
[time]
end = 2.5
until = "rest"
damping = 20
[output]
every = 0.05
[sweep]
quantities = ["net_passages", "net_largest_energy", "edge_largest_height"]
[sweep.random]
members = 8
seed = 3
[[sweep.random.vary]]
key = "body.stone.shift.x"
uniform = ["-0.5 m", "0.5 m"]
[[sweep.random.vary]]
key = "body.stone.velocity.y"
normal = ["1 m/s", "0.5 m/s"]
within = [0, 2]
[[sweep.random.vary]]
key = "body.stone.spin"
uniform = ["-90 deg/s", "90 deg/s"]
[[sweep.random.vary]]
key = "obstacle.block.initial_velocity.x"
lognormal = ["3 m/s", "1 m/s"]
[[sweep.random.vary]]
key = "obstacle.terrain.friction"
choice = [0.4, "0.6"]
[[sweep.random.vary]]
key = "seed"
uniform = [1, 1000]
)";

std::string with(const std::string& what, const std::string& by) {
    std::string text = drop;
    return text.replace(text.find(what), what.size(), by);
}

}  // namespace

TEST_CASE("random members: each draws a whole line of a file") {
    const Folder folder("lines");
    write_scene(folder, drop);
    const std::string scene = (folder.path / "scene.toml").string(), file = (folder.path / "members.csv").string(),
                      set = "sweep.random.file=\"" + file + "\"";
    const auto write = [&](const std::string& text) { std::ofstream(file) << text; };
    write("material.rock.E [MPa], material.rock.nu # two keys\r\n100, 0.10\r\n200, 0.20\n300, 0.30\n");
    const Ensemble plan = plan_sweep(scene, {set, "sweep.random.members=60", "sweep.random.vary="});
    std::map<std::string, int> drawn;
    for (const EnsembleRun& run : plan.runs) {
        CHECK(run.refusal.empty());
        CHECK(std::stod(run.drawn[0]) == relative(1000 * std::stod(run.drawn[1]), 1e-12));
        ++drawn[run.drawn[1]];
    }
    REQUIRE(drawn.size() == 3);
    for (const auto& [value, n] : drawn) CHECK(n >= 8);       // of 60: four standard deviations below 20 are 5
    CHECK(plan_sweep(scene, {set}).random.keys.size() == 8);  // beside [[sweep.random.vary]]

    write("material.rock.E [MPa], material.rock.mu\n100, 0.1\n");
    CHECK_THROWS_WITH_AS(plan_sweep(scene, {set}), doctest::Contains("material.rock.mu"), UserError);
    write("material.rock.E [MPa], material.rock.nu\n100, 0.1\n200\n");
    CHECK_THROWS_WITH_AS(plan_sweep(scene, {set}), doctest::Contains("1 values for 2 keys"), UserError);
    write("material.rock.E [MPa], material.rock.nu\n100, much\n");
    CHECK_THROWS_WITH_AS(plan_sweep(scene, {set}), doctest::Contains("`much` of `material.rock.nu`"), UserError);
    write("material.rock.nu, body.stone.shift.x\n0.1, 0\n");
    CHECK_THROWS_WITH_AS(plan_sweep(scene, {set}), doctest::Contains("drawn twice"), UserError);
    write("material.rock.nu\n");
    CHECK_THROWS_WITH_AS(plan_sweep(scene, {set}), doctest::Contains("no line of values"), UserError);
}

TEST_CASE("random members: their values depend on seed and number and key alone") {
    const Folder folder("draws");
    write_scene(folder, drop);
    const std::string scene = (folder.path / "scene.toml").string();
    const Ensemble all = plan_sweep(scene, {}), more = plan_sweep(scene, {"sweep.random.members=20"});
    REQUIRE(all.runs.size() == 8);
    REQUIRE(more.runs.size() == 20);
    std::set<std::string> different;
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(all.runs[i].name == "m" + std::to_string(i + 1));
        CHECK(all.runs[i].drawn == more.runs[i].drawn);
        CHECK(all.runs[i].resolved == more.runs[i].resolved);
        different.insert(all.runs[i].drawn[0]);
        CHECK(std::abs(std::stod(all.runs[i].drawn[0])) <= 0.5);
        CHECK(std::stod(all.runs[i].drawn[1]) >= 0);
        CHECK(std::stod(all.runs[i].drawn[1]) <= 2);
        CHECK((all.runs[i].drawn[4] == "0.4" || all.runs[i].drawn[4] == "0.6"));
        CHECK(std::to_string(all.runs[i].seed) == all.runs[i].drawn[5]);
        const Scenario scenario = open_scenario(scene, all.runs[i].overrides).scenario;
        CHECK(scenario.bodies[0].shape.outer.points[0].x() == relative(-0.4 + std::stod(all.runs[i].drawn[0]), 1e-12));
        CHECK(scenario.initial_velocities[0].value.x() == 6);
        CHECK(scenario.initial_velocities[0].value.y() == std::stod(all.runs[i].drawn[1]));
        CHECK(scenario.initial_velocities[0].spin ==
              relative(std::stod(all.runs[i].drawn[2]) * M_PI / 180, 1e-12));  // a vector that the file has not
        CHECK(scenario.obstacles[1].initial_velocity.x() == std::stod(all.runs[i].drawn[3]));
        CHECK(scenario.output.trajectories);
        CHECK(scenario.sweep.random.n == 0);
    }
    CHECK(different.size() == 8);
    // another order of the keys, other keys, another seed
    CHECK(plan_sweep(scene,
                     {"sweep.random.vary=[{ key = \"seed\", uniform = [1, 1000] }, { key = \"body.stone.shift.x\", "
                      "uniform = [-0.5, 0.5] }]"})
              .runs[4]
              .drawn[1] == all.runs[4].drawn[0]);
    CHECK(plan_sweep(scene, {"sweep.random.seed=4"}).runs[4].drawn[0] != all.runs[4].drawn[0]);
    // with the combinations of other keys
    const Ensemble product = plan_sweep(scene, {"mesh.size=0.8,0.7"});
    CHECK(product.runs.size() == 16);
    CHECK(product.runs[9].name == "size_0.7_m2");
    CHECK(product.runs[9].drawn == all.runs[1].drawn);
}

TEST_CASE("random members: one that is no scenario is refused and the others are not") {
    const Folder folder("refused member");
    write_scene(folder, drop);
    const std::string scene = (folder.path / "scene.toml").string();
    const auto vary = [](const std::string& values) {
        return "sweep.random.vary=[{ key = \"material.rock.nu\", choice = [" + values + "] }]";
    };
    const Ensemble plan = plan_sweep(scene, {vary("0.25, 0.6")});
    REQUIRE(plan.runs.size() == 8);
    for (const EnsembleRun& run : plan.runs) {
        CHECK(run.refusal.empty() == (run.drawn[0] == "0.25"));
        if (!run.refusal.empty()) CHECK(run.refusal.find("material.rock.nu") != std::string::npos);
    }
    CHECK(std::ranges::count(plan.runs, "", &EnsembleRun::refusal) % 8 != 0);
    CHECK_THROWS_AS(plan_sweep(scene, {vary("0.6")}), UserError);
}

TEST_CASE("random members: distributions have their moments") {
    const auto moments = [](RandomKey key) {
        constexpr int n = 4000;
        double mean = 0, square = 0;
        for (int i = 1; i <= n; ++i) {
            const double x = std::stod(key.drawn(5, i));
            mean += x / n, square += x * x / n;
        }
        return std::pair(mean, std::sqrt(square - mean * mean));
    };
    using Distribution = RandomKey::Distribution;
    const auto check = [](const std::pair<double, double>& found, double mean, double deviation) {
        CHECK(std::abs(found.first - mean) < 4 * deviation / std::sqrt(4000));
        CHECK(found.second == relative(deviation, 0.08));
    };
    check(moments({.key = "a", .distribution = Distribution::uniform, .of = {2, 8}}), 5, 6 / std::sqrt(12.));
    check(moments({.key = "a", .distribution = Distribution::normal, .of = {3, 2}}), 3, 2);
    check(moments({.key = "a", .distribution = Distribution::lognormal, .of = {3, 1}}), 3, 1);
    check(moments({.key = "a", .distribution = Distribution::uniform, .of = {1, 6}, .whole = true}), 3.5,
          std::sqrt(35. / 12));
    check(moments({.key = "a", .distribution = Distribution::choice, .choices = {"1", "4", "4"}}), 3, std::sqrt(2.));
    // the half-normal distribution
    check(moments({.key = "a", .distribution = Distribution::normal, .of = {0, 1}, .within = {{0, 50}}}),
          std::sqrt(2 / M_PI), std::sqrt(1 - 2 / M_PI));
}

TEST_CASE("random members: eight drops with a barrier have tables and figures and one that fails is named") {
    const Folder folder("drops");
    write_scene(folder, drop);
    const std::string sweep = "sweep " + folder.in_shell("scene.toml") + " -o " + folder.in_shell("s") + " ";
    const Answer answer = command(sweep + "-q");
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    const fs::path out = folder.path / "s";
    for (const char* figure : {"trajectories", "heights", "energies", "run_out", "sizes"}) {
        CHECK(fs::file_size(out / "figures" / (std::string(figure) + ".png")) > 4000);
        CHECK(text_of(out / "report.html").find(std::string(figure) + ".png") != std::string::npos);
    }
    CHECK_FALSE(fs::exists(out / "sweep.png"));
    CHECK_FALSE(fs::exists(out / "runs/m1/fragment_paths.csv"));
    CHECK(answer.has("not at rest at time.end, 8 of 8 runs: m1, m2"));
    CHECK(answer.has("| collector | runs | passages | mass | median energy |"));
    CHECK(answer.has("\n| net | "));
    // the table of all passages is that of the runs, and the summary of each its quantiles
    const std::string passages = text_of(out / "passages.csv");
    CHECK(passages.starts_with("run,collector,time [s],direction,"));
    std::size_t n_lines = 0;
    for (int m = 1; m <= 8; ++m) {
        const fs::path run = out / "runs" / ("m" + std::to_string(m));
        const History table = read_csv(run / "passages.csv"), ways = read_csv(run / "trajectories.csv");
        n_lines += table.rows.size();
        for (const std::vector<double>& row : table.rows) {
            CHECK(row[table.place_of("mass")] > 0);
            CHECK(row[table.place_of("height")] > 0);
        }
        CHECK(text_of(run / "trajectories.csv")
                  .starts_with("time [s],label,obstacle,mass [kg],diameter [m],x [m],y [m],height [m],speed "
                               "[m/s],energy [J]\n"));
        CHECK(ways.rows.size() % 2 == 0);  // the stone and the block
        CHECK(ways.rows[0][ways.place_of("obstacle")] == 1);
    }
    CHECK(n_lines > 2);
    CHECK(static_cast<std::size_t>(std::ranges::count(passages, '\n')) == n_lines + 1);
    CHECK(text_of(out / "sweep.csv")
              .starts_with("run,body.stone.shift.x [m],body.stone.velocity.y [m/s],body.stone.spin [deg/s],"
                           "obstacle.block.initial_velocity.x [m/s],obstacle.terrain.friction,seed,seed,status"));
    // a member that starts in the ground is refused, the others go on
    const Answer failed =
        command("sweep " + folder.in_shell("scene.toml") + " -q -o " + folder.in_shell("f") +
                " -s time.end=0.05 -s sweep.random.seed=1 -s sweep.random.members=6 -s 'sweep.random.vary=[{ key = "
                "\"body.stone.shift.y\", choice = [0, \"-5 m\"] }]'");
    CAPTURE(failed.text);
    CHECK(failed.code == 3);
    const std::string table = text_of(folder.path / "f/sweep.csv");
    std::size_t n_done = 0, n_refused = 0;
    for (std::size_t at = 0; (at = table.find(",done,", at)) != std::string::npos; ++at) ++n_done;
    for (std::size_t at = 0; (at = table.find(",refused,", at)) != std::string::npos; ++at) ++n_refused;
    CHECK(n_done + n_refused == 6);
    CHECK(n_done > 0);
    CHECK(n_refused > 0);
    CHECK(failed.has("- m"));
    CHECK(failed.has(": refused: "));
    CHECK(text_of(folder.path / "f/sweep.md").find(std::to_string(n_done) + " of 6") != std::string::npos);
}

TEST_CASE("random members: check says how many there are and what they cost") {
    const Folder folder("members");
    const Answer answer = accepted(folder, drop);
    CHECK(answer.has("8 runs, 6 keys drawn at random: about"));
}

TEST_CASE("random members: mistakes name key and bounds") {
    const Folder folder("wrong draws");
    const auto refused = [&](const std::string& what, const std::string& by, const char* code, const char* words) {
        CAPTURE(by);
        check_refused(folder, with(what, by), code, words);
    };
    refused("members = 8", "members = 0", "out-of-range", "sweep.random.members");
    refused("members = 8\n", "", "missing-key", "sweep.random.members");
    refused("body.stone.shift.x", "body.stone.shfit.x", "unknown-key", "shfit");
    refused("body.stone.shift.x", "body.stone.shift.z", "unknown-key", "has the components x and y");
    refused("body.stone.shift.x", "body.stne.shift.x", "unknown-name", "did you mean `stone`?");
    refused("body.stone.shift.x", "sweep.random.members", "out-of-range", "not a key that can be drawn");
    refused("body.stone.shift.x", "body.stone.shape", "wrong-type", "needs a key of one number");
    refused("body.stone.shift.x", "body.stone.shift", "wrong-type", "body.stone.shift.x, its component");
    refused("uniform = [\"-0.5 m\", \"0.5 m\"]", "uniform = [\"-0.5\", \"0.5 m\"]", "wrong-unit", "has no unit");
    refused("uniform = [\"-0.5 m\", \"0.5 m\"]", "uniform = [\"-0.5 s\", \"0.5 s\"]", "wrong-unit", "must be a length");
    refused("uniform = [\"-0.5 m\", \"0.5 m\"]", "uniform = [1, -1]", "out-of-range", "does not ascend");
    refused("uniform = [\"-0.5 m\", \"0.5 m\"]", "", "missing-key", "uniform, normal, lognormal, choice");
    refused("normal = [\"1 m/s\", \"0.5 m/s\"]", "normal = [1, 0]", "out-of-range", "not positive");
    refused("within = [0, 2]", "within = [9, 12]", "out-of-range", "a thousandth");
    refused("key = \"obstacle.block.initial_velocity.x\"", "key = \"body.stone.velocity.y\"", "duplicate-name",
            "drawn twice");
    refused("key = \"obstacle.block.initial_velocity.x\"\nlognormal = [\"3 m/s\", \"1 m/s\"]",
            "key = \"obstacle.terrain.friction\"\nnormal = [0.5, 0.2]", "out-of-range", "within = [smallest, largest]");
    write_scene(folder, with("choice = [0.4, \"0.6\"]", "choice = [0.4, -0.5]"));  // other members are computed
    CHECK(command("check " + folder.in_shell("scene.toml")).has("which `obstacle.terrain.friction` cannot be"));
    refused("[sweep]", "[sweep]\nseeds = 3", "exclusive-keys", "draw the key `seed`");
    refused("[sweep]", "[sweep]\nset = [\"seed=1,2\"]", "exclusive-keys", "a key of sweep.set, too");
}

TEST_CASE("overrides: entries of a list by name and components of a pair") {
    const Folder folder("by name");
    write_scene(folder, drop);
    const std::string scene = (folder.path / "scene.toml").string();
    const auto read = [&](const std::vector<std::string>& set) { return open_scenario(scene, set).scenario; };
    const Scenario s = read({"body.stone.velocity.x=1 m/s", "obstacle.terrain.friction=0.1", "collector.edge.x=8",
                             "obstacle.block.shift.y=2", "obstacle.block.angle=30", "load[0].acceleration[1]=-5"});
    CHECK(s.initial_velocities[0].value == Vec2(1, 1));
    CHECK(s.obstacles[0].contact.friction == 0.1);
    CHECK(s.collectors[1].x == 8);
    CHECK(s.obstacles[1].start.position == Vec2(-2.5, 15.5));
    CHECK(s.obstacles[1].start.angle == relative(M_PI / 6, 1e-14));
    CHECK(s.loads[0].value[1] == -5);
    for (const char* wrong : {"body.rock.velocity.x=1", "body.stone.velocity.z=1", "body.stone.spin.x=1"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(read({wrong}), UserError);
    }
    CHECK_THROWS_WITH_AS(read({"body.rock.spin=1"}), doctest::Contains("named: stone"), UserError);
}

}  // namespace drops_test
