// Obstacles that are open polylines: their points by key and by csv, and mistakes in both.
#include "samples.hpp"
#include "scenario/write_scenario.hpp"

#include <doctest/doctest.h>

#include <cmath>
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
                                               {"x [s], y [m]\n1, 0\n0, 0\n", 1, "`s` is not one of the kind of `m`"},
                                               {"# heights\ny [m], x [m]\n1, 0\n0, 0\n", 2, "the columns are `y, x`"},
                                               {"foo [m], y [m]\n1, 0\n0, 0\n", 1, "the columns are `foo, y`"},
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

TEST_CASE("scenario: ranges of a terrain have laws of their own between their ends") {
    const ReadResult read = samples::read(samples::least + polyline +
                                          "points = [[9, 0], [4, 3], [0, 1]]\nfriction = 0.5\nrestitution = 0.1\n"
                                          "[[obstacle.range]]\nfrom = \"500 cm\"\nto = 7\nfriction = 0.2\n"
                                          "[[obstacle.range]]\nto = 3\nrestitution = 0.6\n");
    const Obstacle& terrain = only_obstacle(read);
    const auto law_at = [&](double x, double angle = 0) -> const ContactLaw& {
        return terrain.law_at(Rotation::by(angle).turned(Vec2(x, 1.7) - terrain.start.position), angle);
    };
    for (const auto& [x, friction, restitution] : {std::tuple{0., 0.5, 0.6},
                                                   {2.9, 0.5, 0.6},
                                                   {3.1, 0.5, 0.1},
                                                   {5.1, 0.2, 0.1},
                                                   {6.9, 0.2, 0.1},
                                                   {7.1, 0.5, 0.1}}) {
        CAPTURE(x);
        CHECK(law_at(x).friction == friction);
        CHECK(law_at(x).restitution == restitution);
        CHECK(law_at(x, 0.7).friction == friction);  // the ranges turn with their terrain
    }
    CHECK(terrain.largest_restitution() == 0.6);
    const Obstacle moved = only_obstacle(samples::read(samples::least + polyline +
                                                       "shift = [10, 1]\npoints = [[9, 0], [0, 1]]\nfriction = 0.5\n" +
                                                       "[[obstacle.range]]\nfrom = 5\nfriction = 0.2\n"));
    CHECK(moved.law_at(Vec2(15.1, 0) - moved.start.position, 0).friction == 0.2);
    CHECK(moved.law_at(Vec2(14.9, 0) - moved.start.position, 0).friction == 0.5);
    CHECK(points_of(terrain).size() == 3);
}

TEST_CASE("scenario: a rough terrain is that of its seed") {
    const auto points = [](const std::string& more) {
        return points_of(
            only_obstacle(samples::read(samples::least + polyline + "points = [[9, 0], [0, 0]]\n" + more)));
    };
    const std::string rough = "roughness = 0.1\nspacing = 0.3\n";
    const std::vector<Vec2> one = points(rough);
    CHECK(one.size() == 31);
    for (const Vec2& p : one) CHECK(std::abs(p.y()) <= 0.1);
    CHECK(points(rough) == one);
    CHECK(points(rough + "seed = 1\n") == one);  // that of the scenario
    CHECK(points(rough + "seed = 2\n") != one);
    // 0.2 long from 3 to 6, and smooth there with its ends
    const std::vector<Vec2> part =
        points(rough + "[[obstacle.range]]\nfrom = 3\nto = 6\nroughness = 0\nspacing = 0.2\n");
    CHECK(part.size() == 36);
    for (const Vec2& p : part) CHECK((p.y() == 0) == (p.x() >= 3 && p.x() <= 6));
}

TEST_CASE("scenario: mistakes in the points of a terrain are told with the place") {
    const auto points = [](const std::string& list) { return polyline + "points = [" + list + "]\n"; };
    const auto range = [&](const std::string& keys) {
        return points("[2, 0], [0, 0]") + "[[obstacle.range]]\n" + keys + "\n";
    };
    for (const auto& [text, code, message] :
         {std::tuple{points("[0, 0]"), "out-of-range", "needs at least 2 points"},
          {points("[2, 0], [2, 0], [0, 0]"), "out-of-range", "has two points in a row at (2, 0) m"},
          {points("[0, 0], [2, 0], [2, 1], [1, -1]"), "out-of-range", "crosses or touches itself at (1.5, 0) m"},
          {points("[0, 0], [2, 0], [2, 1], [1, 0]"), "out-of-range", "crosses or touches itself at (1, 0) m"},
          {points("[0, 0], [2, 0], [1, 0]"), "out-of-range", "turns back on itself at (2, 0) m"},
          {points("[2, 0], [0, 0]") + "mass = 1\n", "exclusive-keys", "an open polyline is fixed or driven"},
          {points("[2, 0], [0, 0]") + "density = 1\n", "exclusive-keys", "an open polyline is fixed or driven"},
          {points("[2, 0], [0, 0]") + "velocity = [0, \"free\"]\n", "missing-key", "is free in y"},
          {points("[2, 0], [0, 0]") + "turns = true\n", "missing-key", "needs inertia"},
          {points("[2, 0], [0, 0]") + "csv = \"a.csv\"\n", "exclusive-keys", "of which only one is allowed"},
          {polyline, "missing-key", "has none of points, csv"},
          {range("from = 1\nto = 1"), "out-of-range", "`obstacle[0].range[0].from` is not less than `to`"},
          {range("from = -0.1"), "out-of-range", "`obstacle[0].range[0].from` lies beyond the terrain"},
          {range("to = 2.1"), "out-of-range", "`obstacle[0].range[0].to` lies beyond the terrain"},
          {range("from = 1") + "[[obstacle.range]]\nto = 1.1\n", "out-of-range", "begins within another range"},
          {range("friction = -1"), "out-of-range", "`obstacle[0].range[0].friction`"},
          {range("restitution = 1.1"), "out-of-range", "`obstacle[0].range[0].restitution`"},
          {range("roughness = -0.1"), "out-of-range", "`obstacle[0].range[0].roughness`"},
          {range("to = 1\nroughness = 1"), "out-of-range", "`obstacle[0].range[0].roughness` is as large as the segm"},
          {points("[2, 0], [0, 0]") + "roughness = 0.1\nspacing = 0.1\n", "out-of-range",
           "is as large as the segments"},
          {points("[2, 0], [0, 0], [2, 0.02]") + "roughness = 0.04\nspacing = 0.1\n", "out-of-range",
           "crosses or touches"},
          {std::string("[[obstacle]]\nshape = \"disc\"\ncentre = [5, 5]\nradius = 1\n[[obstacle.range]]\nto = 1\n"),
           "exclusive-keys", "range"},
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
