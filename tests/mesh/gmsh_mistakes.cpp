// Unusual and invalid Gmsh files: read correctly or rejected, with the place.
#include "mesh/gmsh_files.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cstring>

namespace gmsh_mistakes_test {

using namespace knap;
using namespace knap::testing;
using knap::tests::relative;

namespace {

struct Case {
    std::string what;
    std::string text;
    int line;
    const char* words;
};

const std::string square_nodes = "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n";

std::string elements(const std::string& lines) { return square_file(lines); }
std::string nodes(const std::string& lines) { return square_file("2\n1 2 0 1 2 3\n2 2 0 1 3 4\n", lines); }
std::string header(const std::string& line) { return with(square_file(), "2.2 0 8", line); }

const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {"nothing", "", 1, "is empty"},
        {"another file", "knap = 1\n", 1, "no Gmsh mesh"},
        {"version 1", "$NOD\n1\n1 0 0 0\n$ENDNOD\n", 1, "version 1 of"},
        {"version 2.1", header("2.1 0 8"), 2, "version 2.1"},
        {"version 4.0", header("4 0 8"), 2, "version 4.0"},
        {"file type", header("2.2 2 8"), 2, "file type is 2"},
        {"size of numbers", header("2.2 0 4"), 2, "4 bytes"},
        {"more in the header", header("2.2 0 8 1"), 2, "more on this line"},
        {"header without an end", "$MeshFormat\n2.2 0 8\n", 3, "ends before `$EndMeshFormat`"},
        {"no nodes", with(square_file(), "$Nodes\n" + square_nodes + "$EndNodes\n", ""), 9, "no section $Nodes"},
        {"no elements", with(square_file(), "$Elements\n2\n1 2 0 1 2 3\n2 2 0 1 3 4\n$EndElements\n", ""), 11,
         "no section $Elements"},
        {"two sections of nodes", square_file() + "$Nodes\n0\n$EndNodes\n", 16, "second section $Nodes"},
        {"fewer nodes than announced", nodes("5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"), 10,
         "`$EndNodes` is not the tag of a node"},
        {"more nodes than announced", nodes("3\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n"), 9,
         "`$EndNodes` should stand here"},
        {"far too many nodes", nodes("99999999999\n1 0 0 0\n"), 5, "99999999999 nodes are announced"},
        {"too many nodes for any number", nodes("99999999999999999999\n1 0 0 0\n"), 5, "is not the number of nodes"},
        {"negative number of nodes", nodes("-1\n"), 5, "-1 nodes are announced"},
        {"a coordinate is missing", nodes("4\n1 0 0 0\n2 1 0\n3 1 1 0\n4 0 1 0\n"), 7,
         "this line ends where a coordinate should be"},
        {"a coordinate too many", nodes("4\n1 0 0 0\n2 1 0 0 0\n3 1 1 0\n4 0 1 0\n"), 7, "more on this line"},
        {"a coordinate that is no number", nodes("4\n1 0 0 0\n2 1,5 0 0\n3 1 1 0\n4 0 1 0\n"), 7,
         "`1,5` is not a coordinate"},
        {"a coordinate that is not finite", nodes("4\n1 0 0 0\n2 nan 0 0\n3 1 1 0\n4 0 1 0\n"), 7, "not finite"},
        {"a node far away", nodes("4\n1 0 0 0\n2 1e200 0 0\n3 1 1 0\n4 0 1 0\n"), 13, "node 2 has a coordinate above"},
        {"a node twice", nodes("4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n3 0 1 0\n"), 16, "node 3 twice"},
        {"not in a plane", nodes("4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0.1\n"), 16, "plane z = const"},
        {"a node that is not there", elements("2\n1 2 0 1 2 3\n2 2 0 1 3 7\n"), 14, "no node 7"},
        {"a line to a node that is not there", elements("2\n1 2 0 1 2 3\n2 1 0 1 9\n"), 14, "no node 9"},
        {"ten nodes", elements("1\n1 21 0 1 2 3 4 1 2 3 4 1 2\n"), 13, "a triangle of 10 nodes"},
        {"five of six nodes", elements("1\n1 9 0 1 2 3 4 1\n"), 13, "the tag of a node should be"},
        {"quadrangle", elements("1\n1 3 0 1 2 3 4\n"), 13, "a quadrangle"},
        {"tetrahedron", elements("1\n1 4 0 1 2 3 4\n"), 13, "a tetrahedron"},
        {"unknown type", elements("1\n1 99 0 1 2 3 4\n"), 13, "element of type 99"},
        {"no triangles", elements("1\n1 1 0 1 2\n"), 15, "no triangles"},
        {"a triangle twice", elements("3\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 3 1 2\n"), 15, "in the file twice"},
        {"a triangle in two groups", elements("3\n1 2 1 5 1 2 3\n2 2 1 5 1 3 4\n3 2 1 6 1 2 3\n"), 15,
         "two physical groups, `5` and `6`"},
        {"no area", elements("2\n1 2 0 1 2 3\n2 2 0 1 3 3\n"), 14, "1, 3 and 3 has no area"},
        {"three triangles at an edge",
         square_file("3\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 1 3 5\n",
                     "5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.1 0.9 0\n"),
         16, "same side of the edge between the nodes 1 and 3"},
        {"a fold", square_file("2\n1 2 0 1 2 3\n2 2 0 1 3 4\n", "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 1 0.5 0\n"), 14,
         "overlap"},
        {"a triangle over the others",
         square_file("3\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 5 6 7\n",
                     "7\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.3 0.2 0\n6 0.7 0.3 0\n7 0.4 0.6 0\n"),
         20, "overlaps the one around"},
        {"an edge with two names", elements("4\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 1 1 7 1 2\n4 1 1 8 2 1\n"), 16,
         "two physical groups, `7` and `8`"},
        {"a name without quotes", square_file("0\n", "0\n", "$PhysicalNames\n1\n1 1 left\n$EndPhysicalNames\n"), 6,
         "dimension tag \"name\""},
        {"an empty name", square_file("0\n", "0\n", "$PhysicalNames\n1\n1 1 \"\"\n$EndPhysicalNames\n"), 6,
         "empty name"},
        {"a name of no dimension", square_file("0\n", "0\n", "$PhysicalNames\n1\n4 1 \"a\"\n$EndPhysicalNames\n"), 6,
         "dimension 4"},
        {"a group beyond all numbers", elements("1\n1 2 1 99999999999 1 2 3\n"), 13, "tag of a physical group"},
        {"partitions", header("4.1 0 8") + "$PartitionedEntities\n", 5, ""},
        {"text between sections", with(square_file(), "$Nodes", "nodes\n$Nodes"), 4,
         "a section `$Name` should begin here"},
    };
    return all;
}

}  // namespace

TEST_CASE("gmsh: each mistake is rejected with its line") {
    for (const Case& c : cases()) {
        CAPTURE(c.what);
        const Diagnostic found = mistake(c.text);
        CHECK(found.code == "bad-mesh");
        CHECK(found.line == c.line);
        CHECK_MESSAGE(found.message.find(c.words) != std::string::npos, found.message);
    }
}

TEST_CASE("gmsh: mistakes in the blocks of format 4.1 are reported") {
    const std::string good = gmsh_bytes("block_41_ascii.msh");
    const auto message = [&](const std::string& from, const std::string& to) {
        return mistake(with(good, from, to)).message;
    };
    CHECK(message("$Entities\n11 11 2 0\n", "$Entities\n11 10 3 0\n") != "");
    CHECK(message("$Entities", "$PartitionedEntities").find("partitions") != std::string::npos);
    CHECK(message("\n2 1 2 ", "\n2 9 2 ").find("$Entities has no entity 9 of dimension 2") != std::string::npos);
    CHECK(message("\n2 1 2 ", "\n1 1 2 ").find("cannot have the dimension 1") != std::string::npos);
    CHECK(message("\n2 1 2 ", "\n2 1 21 ").find("a triangle of 10 nodes") != std::string::npos);
}

TEST_CASE("gmsh: the byte order is tested and binary messages name the byte") {
    for (const char* file : {"block_22_binary.msh", "block_41_binary.msh"}) {
        CAPTURE(file);
        std::string bytes = gmsh_bytes(file);
        const std::size_t one = bytes.find('\n', bytes.find('\n') + 1) + 1;
        std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(one),
                     bytes.begin() + static_cast<std::ptrdiff_t>(one) + 4);
        const Diagnostic turned = mistake(bytes);
        CHECK(turned.message.find("other byte order") != std::string::npos);
        CHECK(turned.message.find("at byte " + std::to_string(one)) != std::string::npos);
        CHECK(turned.line == 0);
        bytes[one] = 7;
        CHECK(mistake(bytes).message.find("the number 1 that shows the byte order is") != std::string::npos);

        const std::string good = gmsh_bytes(file);
        const Diagnostic cut = mistake(good.substr(0, good.size() - 60));
        CHECK(cut.message.find("(at byte ") != std::string::npos);
    }
}

TEST_CASE("gmsh: clockwise triangles are reversed and nodes without triangles are dropped") {
    const std::string five = "5\n1 0 0 0\n99 5 5 5\n2 1 0 0\n3 1 1 0\n4 0 1 0\n";
    const GmshMesh read = read_gmsh(square_file("2\n1 2 0 1 3 2\n2 2 0 1 3 4\n", five), "m.msh");
    CHECK(read.mesh.n_vertices() == 4);
    CHECK(read.mesh.area(0) == relative(0.5));
    CHECK(read.mesh.area(1) == relative(0.5));
    CHECK(read.mesh.interior_edges.size() == 1);
    CHECK(read.mesh.boundary_edges.size() == 4);
    REQUIRE(read.surface_groups.size() == 1);
    CHECK(read.surface_groups[0].name.empty());
    CHECK(read.surface_groups[0].n == 2);
}

TEST_CASE("gmsh: tags need be neither ascending nor without gaps") {
    const std::string huge = "4\n9000000000000000000 0 0 0\n7 1 0 0\n-3 1 1 0\n12 0 1 0\n";
    const GmshMesh read =
        read_gmsh(square_file("2\n8 2 0 9000000000000000000 7 -3\n3 2 0 9000000000000000000 -3 12\n", huge), "m.msh");
    CHECK(read.mesh.n_vertices() == 4);
    CHECK(read.mesh.interior_edges.size() == 1);
}

TEST_CASE("gmsh: groups without a name have their number as name and a sign is an orientation") {
    const GmshMesh read =
        read_gmsh(square_file("4\n1 2 1 -5 1 2 3\n2 2 2 5 1 1 3 4\n3 1 2 -8 1 1 2\n4 1 2 8 1 3 1\n"), "m.msh");
    REQUIRE(read.surface_groups.size() == 1);
    CHECK(read.surface_groups[0].name == "5");
    CHECK_FALSE(read.surface_groups[0].named);
    CHECK(read.mesh.boundary_names == std::vector<std::string>{"8", ""});
    REQUIRE(read.inner_groups.size() == 1);
    CHECK(read.inner_groups[0].name == "8");
}

TEST_CASE("gmsh: probable mistakes give warnings") {
    const std::string eight = "8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1 0 0\n6 2 0 0\n7 1 1 0\n8 3 3 0\n";
    const GmshMesh read =
        read_gmsh(square_file("5\n1 2 0 1 2 3\n2 2 0 1 3 4\n3 2 0 5 6 7\n4 1 1 9 2 4\n5 1 1 9 1 8\n", eight), "m.msh");
    REQUIRE(read.warnings.size() == 3);
    CHECK(read.warnings[0].find("2 pieces") != std::string::npos);
    CHECK(read.warnings[1].find("2 nodes of the boundary coincide with others") != std::string::npos);
    CHECK(read.warnings[2].find("2 lines of the group `9`") != std::string::npos);
}

}  // namespace gmsh_mistakes_test
