// mesh.file: what the names of a Gmsh mesh become in a scenario.
#include "samples.hpp"

#include "scenario/write_scenario.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace mesh_file_test {

using namespace knap;
using knap::tests::relative;

namespace {

const std::filesystem::path data = KNAP_SOURCE_DIR "/tests/mesh/data";

const std::string mesh_of_block = R"([mesh]
file = "block_41_binary.msh"
unit = "1 mm"
cracks = ["crack"]
)";

const std::string one_material =
    samples::changed("[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n[mesh]\nsize = 0.001\n", mesh_of_block);
const std::string steel = "[material.steel]\ndensity = 8000\nE = 190e9\nnu = 0.3\n";
const std::string two_materials = samples::changed("[interface.default]", steel + "[interface.default]", one_material);

/// Two triangles in format 2.2; `groups` are the physical groups of the two, 0 for none.
std::string square(const std::string& groups, const std::string& names = "") {
    return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + names +
           "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n$EndNodes\n$Elements\n2\n1 2 1 " + groups.substr(0, 1) +
           " 1 2 3\n2 2 1 " + groups.substr(2) + " 1 3 4\n$EndElements\n";
}

std::filesystem::path folder() {
    const std::filesystem::path path = std::filesystem::path(KNAP_BINARY_DIR) / "test_mesh_file";
    std::filesystem::create_directories(path);
    return path;
}

/// A scenario with this mesh in its directory.
ReadResult with_mesh(const std::string& mesh, const std::string& text) {
    std::ofstream(folder() / "m.msh", std::ios::binary) << mesh;
    return read_scenario_text(samples::changed(mesh_of_block, "[mesh]\nfile = \"m.msh\"\n", text), "s.toml", {},
                              folder());
}

std::vector<Diagnostic> mistakes(const std::string& text) {
    try {
        read_scenario_text(text, "s.toml", {}, data);
    } catch (const UserError& error) {
        return error.diagnostics;
    }
    return {};
}

std::vector<Diagnostic> mistakes_with_mesh(const std::string& mesh, const std::string& text) {
    try {
        with_mesh(mesh, text);
    } catch (const UserError& error) {
        return error.diagnostics;
    }
    return {};
}

}  // namespace

TEST_CASE("mesh file: surfaces are materials and curves boundaries and cracks in metres") {
    const Scenario s = read_scenario_text(two_materials, "s.toml", {}, data).scenario;
    REQUIRE(s.given);
    const Mesh& mesh = s.given->mesh;
    double area[2] = {0, 0};
    for (Index t = 0; t < mesh.n_triangles(); ++t) area[mesh.region[t]] += mesh.area(t);
    CHECK(area[1] == relative(1e-4, 1e-9));  // steel, the second material of the scenario, is the left half
    CHECK(area[0] > 0.85e-4);
    CHECK(area[0] < 1e-4);
    double cracked = 0;
    for (const InteriorEdge& edge : mesh.interior_edges)
        if (edge.cracked)
            cracked +=
                (mesh.corner(edge.triangle[0], edge.side[0]) - mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3))
                    .norm();
    CHECK(cracked == relative(5e-3, 1e-9));
    CHECK(s.boundary_names() == std::vector<std::string>{"left side", "Rand unten ü", "right", "hole"});
    CHECK(s.plane == PlaneModel::strain);
    CHECK(s.files.front().bytes.size() == std::filesystem::file_size(data / "block_41_binary.msh"));

    const Scenario other = read_scenario_text(samples::changed("unit = \"1 mm\"\n", "", two_materials) +
                                                  "[domain]\nmodel = \"plane stress\"\n",
                                              "s.toml", {}, data)
                               .scenario;
    CHECK(other.plane == PlaneModel::stress);
    CHECK(other.given->mesh.vertices[0].norm() == relative(1e3 * mesh.vertices[0].norm()));
}

TEST_CASE("mesh file: the resolved scenario names it and has no keys of meshing") {
    const ReadResult once = read_scenario_text(two_materials, "s.toml", {}, data);
    const std::string text = resolved_toml(once);
    CHECK(text.find("file = \"block_41_binary.msh\"") != std::string::npos);
    for (const char* key : {"min_angle", "grading", "size"}) CHECK(text.find(key) == std::string::npos);
    CHECK(resolved_toml(read_scenario_text(text, "again.toml", {}, data)) == text);
}

TEST_CASE("mesh file: boundaries are known by name wherever one is selected") {
    const auto with_load = [](const std::string& on) {
        return two_materials + "[[load]]\non = \"" + on + "\"\ntraction = [0, 1]\n";
    };
    CHECK(mistakes(with_load("Rand unten ü")).empty());
    const auto found = mistakes(with_load("left sid"));
    REQUIRE(found.size() == 1);
    CHECK(found[0].code == "unknown-name");
    CHECK(found[0].hint == "did you mean `left side`?");
    CHECK(found[0].line > 0);
    CHECK(mistakes(two_materials + "[[support]]\non = \"hole\"\n").empty());
    CHECK(mistakes(two_materials + "[[support]]\non = \"top\"\n").size() == 1);
}

TEST_CASE("mesh file: names that the scenario does not have are refused") {
    const auto material = mistakes(samples::changed("material.steel", "material.steal", two_materials));
    REQUIRE(material.size() == 1);
    CHECK(material[0].message == "`mesh.file` has the physical surface `steel`, which is no material");
    CHECK(material[0].hint == "did you mean `steal`?");
    CHECK(material[0].note == "materials: glass, steal; mesh.material is that of all without such a name");
    const auto crack = [](const std::string& name) {
        return mistakes(samples::changed("\"crack\"", "\"" + name + "\"", two_materials));
    };
    CHECK(crack("joint").empty());
    REQUIRE(crack("crak").size() == 1);
    CHECK(crack("crak")[0].note == "known: crack, joint");
    REQUIRE(crack("hole").size() == 1);
    CHECK(crack("hole")[0].note == "it lies on the boundary");
    const auto twice = mistakes(two_materials + "[[mesh.joint]]\ncurve = \"crack\"\ninterface = \"default\"\n");
    REQUIRE(twice.size() == 1);
    CHECK(twice[0].message == "`mesh.joint[0].curve` = \"crack\" is in mesh.cracks or another [[mesh.joint]], too");
}

TEST_CASE("mesh file: triangles without a name have the only material") {
    const std::string names = "$PhysicalNames\n1\n2 5 \"glass\"\n$EndPhysicalNames\n";
    for (const char* groups : {"0 0", "0 7", "7 8"})
        CHECK(with_mesh(square(groups), one_material).scenario.given->mesh.region == std::vector<Index>{0, 0});
    CHECK(with_mesh(square("5 0", names), one_material).scenario.given->mesh.n_triangles() == 2);
    const auto without = mistakes_with_mesh(square("5 0", names), two_materials);
    REQUIRE(without.size() == 1);
    CHECK(without[0].message ==
          "`mesh.file` has 1 triangles in no physical surface, so that their material is unknown");
    CHECK(mistakes_with_mesh(square("5 7", names), two_materials).size() == 1);
    const std::string numbered =
        samples::changed("material.steel", "material.7", two_materials);  // a number may be a name
    CHECK(with_mesh(square("5 7", names), numbered).scenario.given->mesh.region.size() == 2);
}

TEST_CASE("mesh file: one material for surfaces without a name of one and grains") {
    const auto named = [](const std::string& keys) {
        return samples::changed("[mesh]\nfile = \"m.msh\"\n", "[mesh]\nfile = \"m.msh\"\n" + keys,
                                samples::changed(mesh_of_block, "[mesh]\nfile = \"m.msh\"\n", two_materials));
    };
    std::ofstream(folder() / "m.msh", std::ios::binary) << square("7 8");
    const auto read = [&](const std::string& keys) { return read_scenario_text(named(keys), "s.toml", {}, folder()); };
    const ReadResult grains = read("unit = 1\nmaterial = \"steel\"\ngrains = true\n");
    CHECK(grains.warnings.empty());
    CHECK(grains.scenario.given->mesh.region == std::vector<Index>{1, 1});
    CHECK(grains.scenario.given->mesh.grain == std::vector<Index>{0, 1});
    CHECK(grains.scenario.given->others == std::vector<std::string>{"7", "8"});
    const ReadResult pad = read(
        "unit = 1\nmaterial = \"steel\"\ngrains = true\n[[domain.region]]\nbox = [-9, -9, 9, 9]\nmaterial = "
        "\"glass\"\n");
    CHECK(pad.scenario.given->mesh.grain == std::vector<Index>{-1, -1});  // no longer tied by the law within a grain
    try {
        read("unit = 1\nmaterial = \"stel\"\n");
        FAIL("an unknown material");
    } catch (const UserError& error) {
        REQUIRE(error.diagnostics.size() == 1);
        CHECK(error.diagnostics[0].hint == "did you mean `steel`?");
    }
}

TEST_CASE("mesh file: regions lie over its triangles") {
    const auto with_region = [](const std::string& keys) {
        return two_materials + "[[domain.region]]\n" + keys + "material = \"steel\"\n";
    };
    const Scenario s =
        read_scenario_text(with_region("box = [\"15 mm\", \"-1 mm\", \"25 mm\", \"11 mm\"]\n"), "s.toml", {}, data)
            .scenario;
    double area = 0;
    for (Index t = 0; t < s.given->mesh.n_triangles(); ++t)
        if (s.given->mesh.region[t] == 1) area += s.given->mesh.area(t);
    CHECK(area > 1.2e-4);  // the left half, and what lies beyond 15 mm
    CHECK(area < 1.7e-4);
    const auto none = mistakes(with_region("centre = [1, 1]\nradius = 0.001\n"));
    REQUIRE(none.size() == 1);
    CHECK(none[0].code == "empty-region");
}

TEST_CASE("mesh file: keys that define the body are excluded") {
    const auto with = [](const std::string& more) { return mistakes(two_materials + more); };
    for (const char* more :
         {"[domain]\nsize = [1, 1]\n", "[domain]\nsides = [\"a\"]\n", "[[domain.hole]]\ncentre = [0, 0]\nradius = 1\n",
          "[[domain.crack]]\npoints = [[0, 0], [1, 1]]\n", "[[mesh.refine]]\ninside = [0, 0, 1, 1]\nsize = 1\n"}) {
        CAPTURE(more);
        const auto found = with(more);
        REQUIRE(found.size() == 1);
        CHECK(found[0].code == "exclusive-keys");
        CHECK(found[0].message.find("has no meaning with mesh.file") != std::string::npos);
    }
    for (const char* more : {"size = 1\n", "min_angle = 20\n"})
        CHECK(mistakes(samples::changed("[mesh]\n", std::string("[mesh]\n") + more, two_materials)).size() == 1);
    const std::string shape = samples::changed("size = 0.001\n", "size = 0.001\nunit = 1\ncracks = [\"a\"]\n");
    CHECK(samples::mistakes(shape).size() == 2);
}

TEST_CASE("mesh file: without it the shape and the size are needed") {
    const auto message = [](const std::string& from, const std::string& to) {
        const auto found = samples::mistakes(samples::changed(from, to));
        REQUIRE(found.size() == 1);
        return found[0].message;
    };
    CHECK(message("[domain]\nshape = \"rectangle\"\nsize = [0.1, 0.04]\n", "") == "`domain` is missing");
    CHECK(message("shape = \"rectangle\"\nsize = [0.1, 0.04]\n", "") == "`domain.shape` is missing");
    CHECK(message("size = 0.001\n", "") == "`mesh` has none of size, file");
    CHECK(message("[mesh]\nsize = 0.001\n", "") == "`mesh` is missing");
}

TEST_CASE("mesh file: mistakes in it have a place in the mesh file") {
    const auto bad = mistakes_with_mesh("$MeshFormat\n4.0 0 8\n", one_material);
    REQUIRE(bad.size() == 1);
    CHECK(bad[0].code == "bad-mesh");
    CHECK(std::filesystem::path(bad[0].file).filename() == "m.msh");
    CHECK(bad[0].line == 2);
    const auto missing = mistakes(samples::changed("block_41_binary.msh", "no-such.msh", two_materials));
    REQUIRE(missing.size() == 1);
    CHECK(missing[0].code == "missing-file");
    CHECK(missing[0].line == 3);
}

TEST_CASE("mesh file: surfaces without a name that become one material are said to") {
    const auto said = [](const std::string& groups) {
        const std::vector<Diagnostic> warnings = with_mesh(square(groups), one_material).warnings;
        return std::ranges::count_if(warnings, [](const Diagnostic& d) {
            return d.code == "merged-surfaces" &&
                   d.message.find("2 physical surfaces without a name (1, 2): all are the one material `glass`") !=
                       std::string::npos;
        });
    };
    CHECK(said("1 2") == 1);
    CHECK(said("1 1") == 0);
}

TEST_CASE("mesh file: curves inside the body that nothing names are said") {
    const auto said = [](const std::string& keys) -> std::string {
        const std::vector<Diagnostic> warnings =
            read_scenario_text(samples::changed("cracks = [\"crack\"]\n", keys, two_materials), "s.toml", {}, data)
                .warnings;
        const auto found = std::ranges::find(warnings, "unused-curve", &Diagnostic::code);
        return found == warnings.end() ? "" : found->message.substr(found->message.find("joints: "));
    };
    const std::string joint = "joint = [{ curve = \"joint\", interface = \"default\" }]\n";
    CHECK(said("") == "joints: crack, joint");
    CHECK(said("cracks = [\"crack\"]\n") == "joints: joint");
    CHECK(said(joint) == "joints: crack");
    CHECK(said("cracks = [\"crack\"]\n" + joint).empty());
}

TEST_CASE("mesh file: a built-in scenario has its mesh in the binary") {
    const ReadResult built_in = open_scenario("hopkinson_time_piece");
    const ReadResult on_disk = read_scenario(KNAP_SOURCE_DIR "/scenarios/hopkinson_time_piece.toml");
    REQUIRE(built_in.scenario.given);
    CHECK(built_in.scenario.files.at(0).bytes == on_disk.scenario.files.at(0).bytes);
    CHECK(built_in.scenario.given->mesh.n_triangles() == 616);
    CHECK(std::count_if(built_in.scenario.given->mesh.interior_edges.begin(),
                        built_in.scenario.given->mesh.interior_edges.end(),
                        [](const InteriorEdge& edge) { return edge.cracked; }) == 3);
}

}  // namespace mesh_file_test
