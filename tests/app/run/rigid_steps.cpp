// Steps of rigid pieces ([rigid]): how far what meets may move in one.
#include "app/rigid_scene.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace rigid_steps_test {

using namespace program;
using knap::tests::relative;
using knap::tests::within;

TEST_CASE("rigid pieces: a step is divided where faces that meet move by more than a fifth of an edge") {
    const Folder folder("rigid steps");
    for (const double path : {0.18, 0.22}) {  // [-] of an edge of 1 m in 1 ms
        CAPTURE(path);
        const std::string velocity = "velocity = [0, " + std::to_string(-1000 * path) + "]\n";
        REQUIRE(run_to_end(folder, scene(block("a", "0, 0", "1, 1") + block("b", "0, 1.001", "1, 1", velocity),
                                         "step = \"1 ms\"\nrestitution = 0\n", "0.003", whole, "1"))
                    .code == 0);
        CHECK(record(folder)["cuts"]["contact_speed"] == (path < 0.2 ? 0 : 1));
        const knap::History pieces = table(folder, "fragments.csv");
        const std::vector<double> y = pieces.column("centre_y"), v = pieces.column("velocity_y");
        CHECK(std::abs(y[1] - y[0]) == relative(1, 1e-12));  // they touch, however far they moved
        for (const double each : v) CHECK(each == relative(-500 * path, 1e-12));
    }
}

TEST_CASE("rigid pieces: what a blow hands on meets the next one in the same step") {
    const Folder folder("rigid handed on");
    // in 1 ms the first block covers 0.1 m; the second one, 0.01 m from the third, has no speed before
    REQUIRE(run_to_end(folder, scene(block("a", "0, 0", "1, 1", "velocity = [100, 0]\n") +
                                         block("b", "1.001, 0", "1, 1") + block("c", "2.011, 0", "1, 1"),
                                     "step = \"1 ms\"\nrestitution = 0\n", "0.001", whole, "1"))
                .code == 0);
    const std::vector<double> x = table(folder, "fragments.csv").column("centre_x");
    CHECK(x[1] - x[0] == within(1, 2e-12));  // [m] of a path of 0.04, what is left of the rounds over contacts
    CHECK(x[2] - x[1] == relative(1, 1e-12));
    CHECK(balance(table(folder, "energy.csv")) < 1e-12);
}

TEST_CASE("rigid pieces: 230 of a broken boulder overlap by less than a hundredth of an edge") {
    const Folder folder("rigid heap of 230");
    std::ifstream file(fs::path(KNAP_SOURCE_DIR) / "tools/bench/box2d/pieces.txt");
    std::string bodies, line;
    while (std::getline(file, line)) {
        std::istringstream values(line);
        double vx = 0, vy = 0, spin = 0;
        int n = 0;
        values >> vx >> vy >> spin >> n;
        std::ostringstream points;
        double low_x = 1e9, low_y = 1e9, high_x = -1e9, high_y = -1e9;
        for (double x = 0, y = 0; n > 0 && values >> x >> y; --n) {
            points << std::setprecision(9) << "[" << x << ", " << y << "], ";
            low_x = std::min(low_x, x), low_y = std::min(low_y, y);
            high_x = std::max(high_x, x), high_y = std::max(high_y, y);
        }
        std::ostringstream body;  // an edge nearly as long as the piece keeps its corners alone
        body << "[[body]]\nshape = \"polygon\"\nvelocity = [" << vx << ", " << vy << "]\nspin = \"" << spin
             << " rad/s\"\nmesh_size = " << 0.95 * std::min(high_x - low_x, high_y - low_y) << "\npoints = ["
             << points.str();
        bodies += body.str() + "]\n";
    }
    bodies +=
        "[[obstacle]]\nname = \"slope\"\nshape = \"polyline\"\nfriction = 0.6\npoints = [[75, 50], [60, 55], "
        "[20, 88], [-5, 103]]\n";
    for (const char* step : {"0.98e-3", "1e-3"}) {
        REQUIRE(
            run_to_end(folder, scene(bodies + weight, std::string("step = ") + step + "\nrestitution = 0\n", "0.15"))
                .code == 0);
        const Json json = record(folder);
        CHECK(json["pieces"]["rigid"] == 230);
        for (const Json& gate : json["gates"])
            if (gate["name"] == "contact_depth") CHECK(gate["value"] < 0.01);
    }
}

TEST_CASE("rigid pieces: friction that follows the slip does so in each step of an island") {
    const Folder folder("rigid weakening");
    const auto way = [&](const std::string& thaw) {
        const std::string text = scene(
            block("b", "0, 1e-4", "0.4, 0.4", "crack = [{ points = [[0, 0.2], [0.4, 0.2]] }]\n") +
                ground("friction = 2\n") + "[[load]]\nacceleration = [5.5, -8]\n",
            "hold = 1e6\nthaw = " + thaw + "\n", "0.05", weak + "kinetic_friction = 0.1\nslip_distance = 0.003\n");
        REQUIRE(run_to_end(folder, text).code == 0);
        const knap::History pieces = table(folder, "fragments.csv");
        return pieces.column("centre_x")[0] - pieces.column("centre_x")[1];
    };
    CHECK(way("0.01") == relative(way("0"), 1e-4));
}

}  // namespace rigid_steps_test
