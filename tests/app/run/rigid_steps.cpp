// Steps of rigid pieces ([rigid]): how far what meets may move in one.
#include "app/rigid_scene.hpp"

namespace rigid_steps_test {

using namespace program;

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
        CHECK(std::abs(y[1] - y[0]) == doctest::Approx(1).epsilon(1e-12));  // they touch, however far they moved
        for (const double each : v) CHECK(each == doctest::Approx(-500 * path).epsilon(1e-12));
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
    CHECK(way("0.01") == doctest::Approx(way("0")).epsilon(1e-4));
}

}  // namespace rigid_steps_test
