// Stresses and tractions by formulas and by csv files of points.
#include "scenario/samples.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace place_fields_test {

using namespace knap;

namespace {

/// A folder with a file of points, removed at the end.
struct Points {
    explicit Points(const std::string& content) {
        std::filesystem::create_directories(directory);
        std::ofstream(directory / "points.csv") << content;
    }
    ~Points() { std::filesystem::remove_all(directory); }
    Points(const Points&) = delete;
    Points& operator=(const Points&) = delete;

    ReadResult read(const std::string& more) const {
        std::ofstream(directory / "s.toml") << samples::least + more;
        return read_scenario(directory / "s.toml");
    }
    Diagnostic error(const std::string& more = "[[initial]]\nstress = \"points.csv\"\n") const {
        try {
            read(more);
        } catch (const UserError& error) {
            return error.diagnostics.at(0);
        }
        return {};
    }

    std::filesystem::path directory =
        std::filesystem::path(KNAP_BINARY_DIR) / ("test_scenario_points_" + std::to_string(getpid()));
};

const std::string header = "x [mm], y [mm], xx [MPa], yy [MPa], xy [kPa]\n";

std::vector<Diagnostic> mistakes(const std::string& more) { return samples::mistakes(samples::least + more); }

}  // namespace

TEST_CASE("place fields: formulas are in Pa or in the unit behind them beside numbers with units") {
    const Scenario s =
        samples::read(samples::least +
                      "[[initial]]\nstress = [\"-0.5*0.027*(1 - y) MPa\", \"-27e3*(1 - y)\", \"2 kPa\"]\n"
                      "box = [0, 0, 1, 1]\n[[initial]]\nstress = [1, 2, 3]\nvelocity = [4, 5]\n"
                      "[[load]]\non = \"top\"\ntraction = [0, \"-5*t*x kPa\"]\nramp = \"1 us\"\n"
                      "[[load]]\non = \"left\"\nstress = [\"x\", 0, \"-1 MPa\"]\n")
            .scenario;
    REQUIRE(s.initial_stresses.size() == 2);
    const std::array<double, 3> first = s.initial_stresses[0].field.at({0.3, 0.2}, 0);
    CHECK(first[0] == tests::relative(-0.5 * 27e3 * 0.8, 1e-14));
    CHECK(first[1] == tests::relative(-27e3 * 0.8, 1e-14));
    CHECK(first[2] == 2e3);
    CHECK(s.initial_stresses[0].on.box.has_value());
    CHECK(s.initial_stresses[1].field.at({0, 0}, 0) == std::array<double, 3>{1, 2, 3});
    REQUIRE(s.initial_velocities.size() == 1);  // of the second entry
    CHECK(s.initial_velocities[0].value == Vec2(4, 5));
    REQUIRE(s.loads.size() == 2);
    REQUIRE(s.loads[0].field);
    CHECK(s.loads[0].field->depends_on_time());
    CHECK(s.loads[0].traction_on({0, 2}, {0.1, 0}, 3) == Vec2(0, 2 * -5e3 * 0.3));
    CHECK(s.loads[1].traction_on({1, 0}, {0.1, 0}, 0) == Vec2(0.1, -1e6));
}

TEST_CASE("place fields: the points of a csv file count in their units and are kept with the run") {
    const Points points("# measured\n" + header +
                        "0, 0, -1, -2, 3\n100, 0, -3, -2, 3\n0, 40, -1, 6, 3\n100, 40, -3, 6, 3\n");
    const Scenario s = points.read("[[initial]]\nstress = \"points.csv\"\n").scenario;
    const std::array<double, 3> middle = s.initial_stresses.at(0).field.at({0.05, 0.01}, 0);
    CHECK(middle[0] == tests::relative(-2e6, 1e-14));
    CHECK(std::abs(middle[1]) < 1e-8);
    CHECK(middle[2] == tests::relative(3e3, 1e-14));
    REQUIRE(s.files.size() == 1);
    CHECK(s.files[0].name == "initial_0_stress.csv");
    CHECK_THROWS_AS(s.initial_stresses[0].field.at({0.2, 0}, 0), BadPlace);
    const Points traction("tx [Pa], ty [Pa], x [m], y [m]\n1, 2, 0, 0\n1, 2, 1, 0\n1, 2, 0, 1\n");
    CHECK(traction.read("[[load]]\non = \"top\"\ntraction = \"points.csv\"\n")
              .scenario.loads.at(0)
              .traction_on({0, 1}, {0.1, 0.04}, 0) == Vec2(1, 2));
}

TEST_CASE("place fields: points on one line have values between them alone") {
    const Points points("x [mm], y [mm], p [MPa]\n100, 0, 3\n0, 0, 1\n20, 0, 5\n");
    const PlaceField field =
        *points.read("[[load]]\non = \"bottom\"\npressure = \"points.csv\"\n").scenario.loads.at(0).field;
    CHECK(field.at({0.01, 0}, 0)[0] == tests::relative(3e6, 1e-14));
    CHECK(field.at({0.06, 0}, 0)[0] == tests::relative(4e6, 1e-14));
    CHECK(field.at({0.1, 1e-9}, 0)[0] == tests::relative(3e6, 1e-14));
    CHECK_THROWS_AS(field.at({0.06, 0.001}, 0), BadPlace);
    CHECK_THROWS_AS(field.at({0.101, 0}, 0), BadPlace);
}

TEST_CASE("place fields: a pressure by a number or a formula pushes on its face") {
    const Scenario s = samples::read(samples::least +
                                     "[[load]]\non = \"top\"\npressure = \"2*x*t MPa\"\n[[load]]\non = \"left\"\n"
                                     "pressure = \"2 MPa\"\n[[pressure]]\npressure = \"3*y kPa\"\n")
                           .scenario;
    CHECK(s.loads[0].traction_on({0, 1}, {0.1, 0}, 2) == Vec2(0, -0.4e6));
    CHECK(!s.loads[1].field);
    CHECK(s.loads[1].traction_on({-1, 0}, {0, 0}, 0) == Vec2(2e6, 0));
    REQUIRE(s.crack_pressures.at(0).field);
    CHECK(s.crack_pressures[0].field->at({0, 0.5}, 0)[0] == 1.5e3);
}

TEST_CASE("place fields: points with a time are linear between the moments and constant beyond them") {
    const Points points(
        "t [ms], x [m], y [m], p [kPa]\n2, 0, 0, 5\n2, 1, 0, 7\n0, 0, 0, 1\n0, 1, 0, 3\n3, 0, 0, 5\n3, 1, 0, 9\n");
    const Scenario s = points.read("[[load]]\non = \"bottom\"\npressure = \"points.csv\"\n").scenario;
    const PlaceField& field = *s.loads.at(0).field;
    CHECK(field.depends_on_time());
    CHECK(field.at({0.5, 0}, -1)[0] == tests::relative(2e3, 1e-14));
    CHECK(field.at({0.5, 0}, 1e-3)[0] == tests::relative(4e3, 1e-14));
    CHECK(field.at({0.5, 0}, 2.5e-3)[0] == tests::relative(6.5e3, 1e-14));
    CHECK(field.at({0.5, 0}, 1)[0] == tests::relative(7e3, 1e-14));
}

TEST_CASE("place fields: mistakes of a csv file are reported at their lines") {
    struct Wrong {
        const char *text, *code, *words;
        int line;
    };
    const std::string good = header + "0, 0, 1, 1, 1\n1, 0, 1, 1, 1\n";
    const auto check = [](const std::string& text, int line, const std::string& words) {
        const Diagnostic found = Points(text).error();
        CAPTURE(words);
        CAPTURE(found.message);
        CHECK(found.code == "bad-csv");
        CHECK(found.line == line);
        CHECK(found.message.find(words) != std::string::npos);
        CHECK(found.file.ends_with("points.csv"));
    };
    check(good + "0, 1, 1, x, 1\n", 4, "yy of this line is not a number");
    check(good + "0, 1, 1, 1\n", 4, "xy of this line is not a number");
    check(good + "0, 1, 1, 1 MPa, 1\n", 4, "yy of this line is not a number");
    check(good + "0, 0, 1, 1, 1\n", 4, "the point of line 2 again");
    check(header + "0, 0, 1, 1, 1\n", 0, "no two points");
    check("x [mm]; y [mm]; xx [MPa]; yy [MPa]; xy [MPa]\n0; 0; 1,5; 1; 1\n", 2, "1,5 is 1.5");
    const std::string timed = "t [ms], x [m], y [m], xx [Pa], yy [Pa], xy [Pa]\n0, 0, 0, 1, 1, 1\n0, 1, 0, 1, 1, 1\n";
    check(timed + "0, 0, 0, 1, 1, 1\n", 4, "the point of line 2 again");
    check(timed + "1, 0, 0, 1, 1, 1\n", 0, "one point alone at t = 0.001 s");
    check("x [mm], y [mm], xx [MPa], yy [MPa]\n0, 0, 1, 1\n", 1, "names no column `xy`");
    check("x [mm], y, xx [MPa], yy [MPa], xy [MPa]\n0, 0, 1, 1, 1\n", 1, "`y` has no unit");
    check("x [mm], y [mm], xx [mm], yy [MPa], xy [MPa]\n0, 0, 1, 1, 1\n", 1,
          "the unit `mm` of xx is not one of a pressure");
    check("x [mm], y [mm], t [mm], xx [MPa], yy [MPa], xy [MPa]\n0, 0, 0, 1, 1, 1\n", 1,
          "the unit `mm` of t is not one of a time");
    check("x [mm], y [mm], z [mm], xx [MPa], yy [MPa], xy [MPa]\n0, 0, 0, 1, 1, 1\n", 1,
          "a column `z` that nothing reads");
    check("", 0, "no two points");
}

TEST_CASE("place fields: layers have angles by formula or by a file and keep them") {
    const auto bedded = [](const std::string& angle) {
        return samples::changed("nu = 0.2", "nu = 0.2\nbedding = { E = 1e9, nu = 0.1, angle = " + angle + " }");
    };
    const auto at = [&](const std::string& angle, const Vec2& place) {
        const Scenario s = samples::read(bedded(angle)).scenario;
        REQUIRE(s.materials[0].layer_angle);
        return s.materials[0].layer_angle->at_start(place)[0];
    };
    CHECK(at("\"10 + 20*x\"", {0.5, 0}) == tests::relative(20, 1e-15));
    CHECK(at("\"atan(x) rad\"", {1, 0}) == tests::relative(45, 1e-14));
    CHECK(samples::read(bedded("\"30 deg\"")).scenario.materials[0].layer_angle == nullptr);
    CHECK(samples::mistakes(bedded("\"90*t\"")).at(0).message.find("layers do not turn") < std::string::npos);
    CHECK(samples::mistakes(bedded("\"20*x MPa\"")).at(0).message.find("not of an angle") < std::string::npos);
    const Points file("x [m], y [m], angle [rad]\n0, 0, 0\n1, 0, 1\n0, 1, 2\n1, 1, 3\n");
    const Scenario s = file.read("[material.glass.bedding]\nE = 1e9\nnu = 0.1\nangle = \"points.csv\"\n").scenario;
    CHECK(s.materials[0].layer_angle->at_start({0.5, 0.25})[0] == tests::relative(180 / std::numbers::pi, 1e-12));
    const Points wrong("x [m], y [m], angle [mm]\n0, 0, 0\n1, 0, 1\n");
    CHECK(wrong.error("[material.glass.bedding]\nE = 1e9\nnu = 0.1\nangle = \"points.csv\"\n")
              .message.find("the unit `mm` of angle is not one of an angle") < std::string::npos);
}

TEST_CASE("place fields: what is no formula is reported at its key") {
    const auto first = [](const std::string& more) {
        const std::vector<Diagnostic> found = mistakes(more);
        REQUIRE(!found.empty());
        return found.front();
    };
    CHECK(first("[[initial]]\nstress = [\"2*z\", 0, 0]\n").code == "bad-formula");
    CHECK(first("[[initial]]\nstress = [\"-(1 - y) mm\", 0, 0]\n").code == "bad-formula");
    CHECK(first("[[initial]]\nstress = [\"5 mm\", 0, 0]\n").code == "wrong-unit");
    CHECK(first("[[initial]]\nstress = [\"5 MPx\", 0, 0]\n").code == "bad-formula");
    CHECK(first("[[initial]]\nstress = [\"t\", 0, 0]\n").code == "bad-formula");  // it does not change with time
    CHECK(
        first("[[initial]]\nstress = [\"-(1 - y) mm\", 0, 0]\n").message.find("`mm` behind it is a unit of a length") <
        std::string::npos);
    CHECK(first("[[load]]\non = \"top\"\npressure = \"2*x MPA\"\n").message.find("did you mean `MPa`?") <
          std::string::npos);
    CHECK(first("[[initial]]\nstress = [1, 2]\n").code == "wrong-type");
    CHECK(first("[[initial]]\nbox = [0, 0, 1, 1]\n").code == "missing-key");
    CHECK(first("[[initial]]\nstress = \"none.csv\"\n").code == "missing-file");
    CHECK(first("[[load]]\nacceleration = [0, \"2*x\"]\n").code == "wrong-unit");
    CHECK(first("[[load]]\non = \"top\"\ntraction = [0, \"2*\"]\n").line == 18);
}

}  // namespace place_fields_test
