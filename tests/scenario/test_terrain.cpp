// Obstacles that are open polylines: their points by key and by csv, and mistakes in both.
#include "samples.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <tuple>

namespace terrain_test {

using namespace knap;

namespace {

const std::string polyline = "[[obstacle]]\nshape = \"polyline\"\n";

const Obstacle& only_obstacle(const ReadResult& read) { return read.scenario.obstacles.at(0); }

/// In their places.
std::vector<Vec2> points_of(const Obstacle& obstacle) {
    std::vector<Vec2> points;
    for (const Vec2& p : obstacle.outline.points) points.emplace_back(p + obstacle.start.position);
    return points;
}

}  // namespace

TEST_CASE("scenario: the points of a terrain keep their order and are part of the resolved scenario") {
    const std::filesystem::path directory = std::filesystem::path(KNAP_BINARY_DIR) / "test_scenario_terrain";
    std::filesystem::create_directories(directory);
    const ReadResult by_key = samples::read(samples::least + polyline + "points = [[2, 0], [1, 0.5], [0, 0]]\n");
    CHECK(only_obstacle(by_key).outline.kind == Outline::Kind::polyline);
    CHECK(points_of(only_obstacle(by_key)) == std::vector<Vec2>{{2, 0}, {1, 0.5}, {0, 0}});
    std::ofstream(directory / "s.toml") << samples::least + polyline + "csv = \"terrain.csv\"\n";
    for (const char* lines : {"x [m], y [mm]\n2, 0\n1, 500\n0, 0\n", "2 m, 0 m\n1000 mm, 50 cm\n0 m, 0 m\n",
                              "x [m]; y [m]\n2; 0\n1; 0.5\n0; 0 mm\n"}) {
        CAPTURE(lines);
        std::ofstream(directory / "terrain.csv") << lines;
        const ReadResult read = read_scenario(directory / "s.toml");
        CHECK(points_of(only_obstacle(read)) == points_of(only_obstacle(by_key)));
        CHECK(points_of(only_obstacle(samples::read(resolved_toml(read)))) == points_of(only_obstacle(by_key)));
    }
    for (const auto& [lines, line, message] : {std::tuple{"x, y\n0, 0\n1, 0\n", 2, "has no unit"},
                                               {"0, 0\n1, 0\n", 1, "has no unit"},
                                               {"x [m], y\n1, 0\n0, 0\n", 2, "has no unit"},
                                               {"x [s], y [m]\n1, 0\n0, 0\n", 2, "is not `x, y`"},
                                               {"x [m], y [m]\n0, 0\n1, 0\n0.5, 0\n", 4, "out of order"},
                                               {"x [m], y [m]\n2, 0\n1, 0\n1.5, 0\n", 4, "out of order"},
                                               {"x [m], y [m]\n2, 0\n1, zero\n", 3, "is not `x, y`"},
                                               {"x [m], y [m]\n", 0, "has no line `x, y`"},
                                               {"x [m], y [m]\n1, 1\n", 0, "has one point"}}) {
        CAPTURE(lines);
        std::ofstream(directory / "terrain.csv") << lines;
        try {
            read_scenario(directory / "s.toml");
            FAIL("read");
        } catch (const UserError& error) {
            CHECK_MESSAGE(error.diagnostics[0].message.find(message) != std::string::npos,
                          error.diagnostics[0].message);
            if (line > 0) CHECK(error.diagnostics[0].line == line);
        }
    }
    std::filesystem::remove_all(directory);
}

TEST_CASE("scenario: mistakes in the points of a terrain are told with the place") {
    const auto points = [](const std::string& list) { return polyline + "points = [" + list + "]\n"; };
    for (const auto& [text, code, message] :
         {std::tuple{points("[0, 0]"), "out-of-range", "has one point"},
          {points("[2, 0], [2, 0], [0, 0]"), "out-of-range", "has two points in a row at (2, 0) m"},
          {points("[0, 0], [2, 0], [2, 1], [1, -1]"), "out-of-range", "crosses or touches itself near (0, 0) m"},
          {points("[0, 0], [2, 0], [2, 1], [1, 0]"), "out-of-range", "crosses or touches itself"},
          {points("[0, 0], [2, 0], [1, 0]"), "out-of-range", "turns back on itself at (2, 0) m"},
          {points("[2, 0], [0, 0]") + "mass = 1\n", "exclusive-keys", "an open polyline is fixed or driven"},
          {points("[2, 0], [0, 0]") + "density = 1\n", "exclusive-keys", "an open polyline is fixed or driven"},
          {points("[2, 0], [0, 0]") + "velocity = [0, \"free\"]\n", "missing-key", "is free in y"},
          {points("[2, 0], [0, 0]") + "turns = true\n", "missing-key", "needs inertia"},
          {points("[2, 0], [0, 0]") + "csv = \"a.csv\"\n", "exclusive-keys", "of which only one is allowed"},
          {polyline, "missing-key", "has none of points, csv"},
          {std::string("[[obstacle]]\nshape = \"polygon\"\n"), "missing-key", "is missing"}}) {
        CAPTURE(text);
        try {
            samples::read(samples::least + text);
            FAIL("read");
        } catch (const UserError& error) {
            CHECK(error.diagnostics[0].code == code);
            CHECK_MESSAGE(error.diagnostics[0].message.find(message) != std::string::npos,
                          error.diagnostics[0].message);
        }
    }
}

}  // namespace terrain_test
