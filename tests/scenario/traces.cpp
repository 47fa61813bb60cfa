// [[traces]]: maps of traces as csv and GeoJSON, and cracks with a law of their own.
#include "base/random.hpp"
#include "base/stopwatch.hpp"
#include "mesh/triangulate.hpp"
#include "scenario/samples.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

using namespace knap;
using knap::tests::relative;

namespace traces_test {

const std::string weak = "[interface.weak]\nsigma_c = 1e6\nG_c = 1\n";

/// A folder with a map, removed at the end.
struct Map {
    explicit Map(const std::string& content, const std::string& name = "map.csv") : file(name) {
        std::filesystem::create_directories(directory);
        std::ofstream(directory / file) << content;
    }
    ~Map() { std::filesystem::remove_all(directory); }
    Map(const Map&) = delete;
    Map& operator=(const Map&) = delete;

    ReadResult read(const std::string& keys = "", const std::string& more = "") const {
        std::ofstream(directory / "s.toml") << samples::least + "[[traces]]\nfile = \"" + file + "\"\n" + keys + more;
        return read_scenario(directory / "s.toml");
    }
    /// The first error, or an empty one.
    Diagnostic error(const std::string& keys = "", const std::string& more = "") const {
        try {
            read(keys, more);
        } catch (const UserError& error) {
            return error.diagnostics.at(0);
        }
        return {};
    }

    // tests run side by side, each in a process of its own
    std::filesystem::path directory =
        std::filesystem::path(KNAP_BINARY_DIR) / ("test_scenario_traces_" + std::to_string(getpid()));
    std::string file;
};

const char* const two =
    "trace, x [mm], y [mm], class\n1, 10, 5, fault\n1, 40, 12, fault\n2, 60, 30, joint\n2, 70, 10, joint\n";

TEST_CASE("traces: each is a crack of the body with the law of its class") {
    // a file of a spreadsheet begins with a byte-order mark
    CHECK(Map("\xEF\xBB\xBF" + std::string(two)).read().scenario.bodies[0].shape.cracks.size() == 2);
    const Map map(two);
    const Scenario all = map.read().scenario;
    REQUIRE(all.bodies[0].shape.cracks.size() == 2);
    CHECK(all.bodies[0].shape.cracks[0].points == std::vector<Vec2>{{0.01, 0.005}, {0.04, 0.012}});
    CHECK(all.bodies[0].shape.cracks[1].joint == -1);

    const ReadResult result = map.read("class = \"joint\"\ninterface = \"weak\"\n",
                                       weak + "[[traces]]\nfile = \"map.csv\"\nclass = \"fault\"\n");
    const std::vector<Crack>& cracks = result.scenario.bodies[0].shape.cracks;
    REQUIRE(cracks.size() == 2);
    CHECK(cracks[0].points.front() == Vec2(0.06, 0.03));
    REQUIRE(cracks[0].joint == 0);
    CHECK(result.scenario.laws[result.scenario.law_of_joint[0]].name == "weak");
    CHECK(cracks[1].joint == -1);
    CHECK(result.scenario.placed_sets.at(0).n == 1);
    CHECK(result.scenario.placed_sets.at(1).n == 1);
    CHECK(result.scenario.table_of_part(0, PlacedSet::Part::cracks, 0, "domain.crack") == "traces[0] (line 4)");
    CHECK(result.scenario.files.at(0).name == "traces1.csv");
    CHECK(result.scenario.files.at(1).name == "traces1.csv");
}

TEST_CASE("traces: one mistake of a unit is one error") {
    const Diagnostic unit =
        Map("trace, x [m], y [m]\n1, 10, 10\n1, 20, 20\n2, 20, 10\n2, 30, 10\n3, 10, 10\n3, 20, 30\n").error();
    CHECK(unit.message == "3 of 3 traces leave the body, as trace `1` at (10, 10) m");
}

TEST_CASE("traces: what lies beyond the body is an error or cut off") {
    const Map map("trace, x [mm], y [mm]\n1, 90, 20\n1, 110, 20\n2, 200, 0\n2, 200, 10\n3, 10, 10\n3, 20, 20\n");
    const Diagnostic beyond = map.error();
    CHECK(beyond.code == "bad-file");
    CHECK(beyond.line == 2);
    CHECK(beyond.message == "trace `1` leaves the body at (0.11, 0.02) m");
    const Scenario cut = map.read("crop = true\n").scenario;
    CHECK(cut.bodies[0].shape.cracks.size() == 2);
    CHECK(cut.placed_sets.at(0).n_cropped == 1);
    const Mesh mesh = triangulate(cut.bodies[0].shape, cut.bodies[0].mesh);
    double length = 0;
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.cracked) {
            const auto [a, b] = mesh.side_vertices(edge.triangle[0], edge.side[0]);
            length += (mesh.vertices[a] - mesh.vertices[b]).norm();
        }
    CHECK(length == relative(0.01 + 0.01 * std::sqrt(2), 1e-9));
    CHECK(map.error("crop = true\norigin = [\"1 m\", 0]\n").message.find("has no trace that lies in the body") !=
          std::string::npos);
    const Scenario moved = map.read("origin = [\"105 mm\", 0]\ncrop = true\n").scenario;
    CHECK(moved.bodies[0].shape.cracks.at(1).points.front().x() == relative(0.095));
}

TEST_CASE("traces: GeoJSON gives lines and classes") {
    const std::string json = R"({"type": "FeatureCollection", "features": [
 {"type": "Feature", "properties": {"set": 1}, "geometry": {"type": "LineString", "coordinates": [[10, 5], [40, 12, 3]]}},
 {"type": "Feature", "properties": null, "geometry": null},
 {"type": "Feature", "properties": {"set": "b"},
  "geometry": {"type": "MultiLineString",
   "coordinates": [[[60, 30], [70, 10]], [[12, 30], [30, 33]]]}}]})";
    const Map map(json, "map.geojson");
    CHECK(map.error().code == "missing-key");
    const Scenario all = map.read("unit = \"1 mm\"\n").scenario;
    REQUIRE(all.bodies[0].shape.cracks.size() == 3);
    CHECK(all.bodies[0].shape.cracks[0].points[1].y() == relative(0.012));
    CHECK(all.placed_sets.at(0).file_lines == std::vector<int>{2, 6, 6});
    const Scenario one = map.read("unit = \"1 mm\"\nproperty = \"set\"\nclass = \"1\"\n",
                                  "[[traces]]\nfile = \"map.geojson\"\nunit = \"1 mm\"\nproperty = \"set\"\nclass = "
                                  "\"b\"\n")
                             .scenario;
    CHECK(one.placed_sets.at(0).n == 1);
    CHECK(one.placed_sets.at(1).n == 2);
    CHECK(map.error("unit = \"1 mm\"\nclass = \"b\"\n").note == "known: set");  // without property: class
    CHECK(map.error("unit = \"1 mm\"\nproperty = \"sets\"\n").hint == "did you mean `set`?");
    for (const auto& [content, line, text] :
         {std::tuple{"{\n\"features\": [", 2, "no JSON"},
          {"{\"features\": [\n{\"geometry\": {\"type\": \"Point\", \"coordinates\": [1, 2]}}]}", 2, "is a Point"},
          {"{\"features\": [\n\n{\"geometry\": {\"type\": \"LineString\", \"coordinates\": [[1, \"a\"]]}}]}", 3,
           "no type and coordinates"},
          {"{\"features\": [{\"geometry\": {\"type\": \"LineString\", \"coordinates\": [[1, 2]]}}]}", 1, "one point"},
          {"{\"features\": []}", 1, "no trace"},
          {"[]", 1, "no trace"}}) {
        CAPTURE(content);
        const Diagnostic error = Map(content, "map.geojson").error("unit = \"1 mm\"\n");
        CHECK(error.line == line);
        CHECK_MESSAGE(error.message.find(text) != std::string::npos, error.message);
    }
}

TEST_CASE("traces: a law whose name they misspell is no second error") {
    const Map map(two);
    try {
        map.read("interface = \"falt\"\n", "[interface.fault]\nsigma_c = 0\nfriction = 0.5\n");
        FAIL("read");
    } catch (const UserError& error) {
        REQUIRE(error.diagnostics.size() == 1);
        CHECK(error.diagnostics[0].message == "there is no interface law `falt`");
    }
}

TEST_CASE("traces: mistakes of a map have their line") {
    for (const auto& [content, keys, line, text] :
         {std::tuple{"x, y\n1, 2\n", "", 1, "does not name the columns"},
          {"trace, x, y\n1, 2, 3\n", "", 1, "has no unit"},
          {"trace, x [s], y [m]\n", "", 1, "the unit `s` of x is no length"},
          {"trace, x [mm], y [mm]\n1, 10, 10\n", "", 2, "trace `1` has one point"},
          {"trace, x [mm], y [mm]\n1, 10, 10\n1, ten, 10\n", "", 3, "is not a number"},
          {"trace, x [mm], y [mm]\n1, 10, 10\n1, 20\n", "", 3, "has 2 values for 3 names"},
          {"trace, x [mm], y [mm]\n1, 10, 10\n1, 20, 10\n2, 5, 5\n2, 6, 9\n1, 8, 8\n", "", 6, "goes on after another"},
          {"trace, x [mm], y [mm], class\n1, 10, 10, a\n1, 20, 10, b\n", "", 3, "has the class `b` here"},
          {"trace, x [mm], y [mm], class\n1, 10, 10, a\n1, 20, 10, a\n2, 5, 5, b\n2, 6, 9, b\n", "class = \"a\"\n", 4,
           "class `b`, which no [[traces]] takes"},
          {"trace, x [mm], y [mm]\n", "", 1, "no trace"}}) {
        CAPTURE(content);
        const Diagnostic error = Map(content).error(keys);
        CHECK(error.file.ends_with("map.csv"));
        CHECK(error.line == line);
        CHECK_MESSAGE(error.message.find(text) != std::string::npos, error.message);
    }
    CHECK(Map(two).error("class = \"dyke\"\n").code == "unknown-name");
    const Diagnostic property = Map(two).error("property = \"clas\"\n");
    CHECK(property.message == "`traces[0].property` = \"clas\" is no column or property of the traces in the file");
    CHECK(property.note == "known: class");
    CHECK(property.hint == "did you mean `class`?");
    CHECK(Map("trace, x, y\n1, 10, 5\n1, 40, 12\n").read("unit = \"1 mm\"\n").scenario.bodies[0].shape.cracks.size() ==
          1);
}

TEST_CASE("traces: a fault that the mesh cannot resolve names its line of the map") {
    const Map map("trace, x [mm], y [mm]\n1, 10, 10\n1, 60, 10\n2, 10, 10.001\n2, 60, 10.02\n");
    const ReadResult result = map.read();
    try {
        triangulate(result.scenario.bodies[0].shape, result.scenario.bodies[0].mesh);
        FAIL("meshed");
    } catch (const ShapeError& error) {
        const std::vector<Diagnostic> found = result.at_shapes(error);
        CHECK_MESSAGE(found.at(0).message.starts_with("`traces[0]` (line "), found.at(0).message);
        CHECK(found.at(0).file.ends_with("map.csv"));
        CHECK((found.at(0).line == 2 || found.at(0).line == 4));
    }
}

TEST_CASE("traces: a map of 2000 meshes in one round within 30 s") {
    Random random(3, "traces");
    std::string text = "trace, x [mm], y [mm]\n";
    for (int n = 0; n < 2000;) {  // three sets
        const double angle = (30 + 60 * (n % 3) + random.uniform(-10, 10)) * std::numbers::pi / 180;
        const Vec2 a(random.uniform(0, 100), random.uniform(0, 40)),
            b = a + random.uniform(1, 4) * Vec2(std::cos(angle), std::sin(angle));
        if (b.x() < 0 || b.x() > 100 || b.y() > 40) continue;
        ++n;
        for (const Vec2& x : {a, b})
            text += std::to_string(n) + ", " + std::to_string(x.x()) + ", " + std::to_string(x.y()) + "\n";
    }
    const Map map(text);
    std::ofstream(map.directory / "s.toml")
        << samples::changed(
               "size = 0.001", "size = 0.0007",
               samples::changed("size = [0.1, 0.04]", "size = [0.1, 0.04]\nsnap = \"0.15 mm\"", samples::least)) +
               "[[traces]]\nfile = \"map.csv\"\ninterface = \"weak\"\n" + weak;
    const Stopwatch watch;
    const ReadResult read = read_scenario(map.directory / "s.toml");
    const Mesh mesh = triangulate(read.scenario.bodies[0].shape, read.scenario.bodies[0].mesh);
    CHECK(watch.cpu() < 30);  // 1.5 s where this was written
    CHECK(read.scenario.placed_sets.at(0).n == 2000);
    double length = 0;  // [m] of the faults
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.joint >= 0) length += mesh.side_vector(edge.triangle[0], edge.side[0]).norm();
    CHECK(length > 4.5);  // 2000 of 2.5 mm, less what snap and crossings leave out
    CHECK(length < 5.2);
}

TEST_CASE("cracks: one with an interface is a joint with that law") {
    const std::string crack = "[[domain.crack]]\npoints = [[0.02, 0.02], [0.06, 0.02]]\n";
    const ReadResult result = samples::read(samples::least + crack + "interface = \"weak\"\n" + weak);
    CHECK(result.scenario.bodies[0].shape.cracks.at(0).joint == 0);
    CHECK(result.scenario.laws[result.scenario.law_of_joint.at(0)].name == "weak");
    CHECK(samples::read(samples::least + crack).scenario.bodies[0].shape.cracks.at(0).joint == -1);
    try {
        samples::read(samples::least + crack + "interface = \"feeble\"\n" + weak);
        FAIL("read");
    } catch (const UserError& error) {
        CHECK(error.diagnostics[0].code == "unknown-name");
    }
}

}  // namespace traces_test
