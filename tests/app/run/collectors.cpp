// Collectors of a run: free flight against the parabola in both schemes, free obstacles, heights above a terrain, and
// the same lines in parts.
#include "app/program.hpp"
#include "output/history_csv.hpp"
#include "support/relative.hpp"

#include <nlohmann/json.hpp>

#include <cmath>

namespace collectors_run_test {

using namespace program;
using knap::History;
using knap::tests::relative;

namespace {

/// A stone that flies; `more`: what it meets.
std::string flight(const std::string& motion, const std::string& rotation, const std::string& more) {
    return "knap = 1\n[domain]\nrotation = \"" + rotation +
           "\"\n[mesh]\nsize = 0.5\n[[body]]\nname = \"stone\"\nshape = \"polygon\"\n"
           "points = [[-0.4, 9.7], [0.5, 9.6], [0.4, 10.4], [-0.3, 10.3]]\nvelocity = [8, 2]\n" +
           motion +
           "[material.rock]\ndensity = 2600\nE = \"1 GPa\"\nnu = 0.25\n[interface.default]\nbreakable = false\n"
           "[[load]]\nacceleration = [0, -9.81]\n" +
           more + "[output]\nfields = false\nevery = 0.1\n";
}

struct Parabola {
    double x, y;  // of the centre at the start
    double time(double at) const { return (at - x) / 8; }
    double height(double at) const { return y + 2 * time(at) - 9.81 / 2 * time(at) * time(at); }
    double fall(double at) const { return 2 - 9.81 * time(at); }
};

std::vector<double> line(const History& table, std::size_t i) { return table.rows.at(i); }

}  // namespace

TEST_CASE("collectors: the passage of a stone in free flight is exact in both schemes") {
    const Folder folder("parabola");
    for (const char* scheme : {"explicit", "implicit"}) {
        CAPTURE(scheme);
        write_scene(folder, flight("", "small",
                                   "[[collector]]\nname = \"gate\"\nx = 3\n[[collector]]\nname = \"net\"\nfrom = "
                                   "[5, 5]\nto = [5, 12]\n[time]\nend = 0.7\nbulk = \"" +
                                       std::string(scheme) + "\"\n" + (scheme[0] == 'i' ? "step = 1e-3\n" : "")));
        const Answer answer = run_scene(folder, "-j 1 -o " + folder.in_shell(scheme));
        CAPTURE(answer.text);
        REQUIRE(answer.code == 0);
        const fs::path run = folder.path / scheme;
        const History table = knap::read_csv(run / "passages.csv"), paths = knap::read_csv(run / "fragment_paths.csv");
        REQUIRE(table.rows.size() == 2);
        const Parabola exact{paths.column("centre_x")[0], paths.column("centre_y")[0]};
        for (const std::size_t i : {0, 1}) {
            const double x = i == 0 ? 3 : 5;
            const auto value = [&](const char* name) { return line(table, i)[table.place_of(name)]; };
            CHECK(value("time") == relative(exact.time(x), 1e-9));
            CHECK(value("y") == relative(exact.height(x), 1e-9));
            CHECK(value("velocity_y") == relative(exact.fall(x), 1e-9));
            CHECK(value("speed") == relative(std::hypot(8, exact.fall(x)), 1e-9));
            CHECK(value("mass") == relative(2600 * 0.56, 1e-12));
            CHECK(value("translation") == relative(0.5 * 2600 * 0.56 * (64 + exact.fall(x) * exact.fall(x)), 1e-9));
            CHECK(value("direction") == 1);
            if (i == 0) CHECK(std::isnan(value("height")));  // there is no ground
            else CHECK(value("height") == relative(exact.height(x) - 5, 1e-9));
        }
        const nlohmann::json record = nlohmann::json::parse(text_of(run / "run.json")), &summary = record["summary"];
        CHECK(record["collectors"][0] == nlohmann::json{{"name", "gate"}, {"x_m", 3}});
        CHECK(record["collectors"][1] == nlohmann::json{{"name", "net"}, {"from_m", {5, 5}}, {"to_m", {5, 12}}});
        CHECK(summary["net_passages"] == 1);
        CHECK(summary["net_mass"].get<double>() == relative(2600 * 0.56, 1e-12));
        CHECK(summary["net_largest_height"].get<double>() == relative(exact.height(5) - 5, 1e-9));
        CHECK(summary["gate_median_height"].is_null());
    }
}

TEST_CASE("collectors: a stone and a ball above a terrain have the same lines in parts and the stone its turns") {
    const Folder folder("gate of two");
    const double angle = std::atan(0.2);
    write_scene(folder,
                flight("spin = 720\n", "large",
                       "[contact]\n[[obstacle]]\nname = \"terrain\"\nshape = \"polyline\"\npoints = [[20, 0], [10, 0], "
                       "[-5, 3]]\n[[obstacle]]\nname = \"ball\"\nshape = \"disc\"\ncentre = [-3, 12]\nradius = 0.5\n"
                       "density = 2600\ninitial_velocity = [8, 2]\ninitial_spin = 90\n[[collector]]\nname = \"gate\"\n"
                       "x = 3\n[time]\nend = 0.9\n"));
    check_threads_and_parts(folder, {"2"}, {"0.3s", "0.3662s", "0.7501s"}, 4);
    const History table = knap::read_csv(folder.path / "whole" / "passages.csv"),
                  paths = knap::read_csv(folder.path / "whole" / "fragment_paths.csv");
    REQUIRE(table.rows.size() == 2);
    const auto value = [&](std::size_t i, const char* name) { return line(table, i)[table.place_of(name)]; };
    const Parabola ball{-3, 12};
    CHECK(std::isnan(value(1, "label")));
    CHECK(value(1, "obstacle") == 1);
    CHECK(value(1, "time") == relative(0.75, 1e-12));
    CHECK(value(1, "height") == relative(ball.height(3) - 7 * std::tan(angle), 1e-12));
    CHECK(value(1, "speed") == relative(std::hypot(8, ball.fall(3)), 1e-12));
    CHECK(value(1, "mass") == relative(2600 * M_PI / 4, 1e-12));
    CHECK(value(1, "rotation") == relative(0.5 * 2600 * M_PI / 4 * 0.125 * M_PI * M_PI / 4, 1e-12));
    CHECK(value(0, "label") >= 0);
    CHECK(std::isnan(value(0, "obstacle")));
    CHECK(paths.column("rotation").back() == relative(0.9 * 720, 1e-3));  // it stretches by its spin
}

TEST_CASE("collectors: check says where there is no ground below a vertical") {
    const Folder folder("no ground");
    const std::string end = "[time]\nend = 0.1\n", vertical = "[[collector]]\nx = 3\n";
    CHECK(accepted(folder, flight("", "large", vertical + end)).has("no-ground"));
    CHECK_FALSE(accepted(folder, flight("", "large",
                                        "[[obstacle]]\nshape = \"half plane\"\nat = [0, 0]\nnormal = [0, 1]\n" +
                                            vertical + end))
                    .has("no-ground"));
    CHECK_FALSE(
        accepted(folder, flight("", "large", "[[collector]]\nfrom = [3, 0]\nto = [3, 9]\n" + end)).has("no-ground"));
}

}  // namespace collectors_run_test
