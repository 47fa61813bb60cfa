// The four formats of Gmsh give the same mesh, with the areas and lengths of its geometry.
#include "mesh/gmsh_files.hpp"

#include "mesh/mesh_file.hpp"
#include "mesh/shapes.hpp"
#include "mesh/triangulate.hpp"
#include "support/relative.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace gmsh_formats_test {

using namespace knap;
using namespace knap::testing;
using knap::tests::relative;

namespace {

double length(const Mesh& mesh, Index triangle, Index side) {
    return (mesh.corner(triangle, (side + 1) % 3) - mesh.corner(triangle, side)).norm();
}

std::map<std::string, double> boundary_lengths(const Mesh& mesh) {
    std::map<std::string, double> sums;
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        sums[mesh.boundary_names[edge.boundary]] += length(mesh, edge.triangle, edge.side);
    return sums;
}

std::map<std::string, double> areas(const GmshMesh& read) {
    std::map<std::string, double> sums;
    for (Index t = 0; t < read.mesh.n_triangles(); ++t)
        sums[read.surface_groups[read.mesh.region[t]].name] += read.mesh.area(t);
    return sums;
}

std::map<std::string, double> inner_lengths(const GmshMesh& read) {
    std::map<std::string, double> sums;
    for (const InnerLine& line : read.inner_lines) {
        const InteriorEdge& edge = read.mesh.interior_edges[line.edge];
        sums[read.inner_groups[line.group].name] += length(read.mesh, edge.triangle[0], edge.side[0]);
    }
    return sums;
}

/// Bit for bit, or with vertices up to the 16 digits of Gmsh's text.
void check_same(const Mesh& a, const Mesh& b, bool text = false) {
    REQUIRE(a.n_vertices() == b.n_vertices());
    for (Index v = 0; v < a.n_vertices(); ++v)
        CHECK((a.vertices[v] - b.vertices[v]).norm() <= (text ? 1e-15 * a.vertices[v].norm() : 0));
    CHECK(a.triangles == b.triangles);
    CHECK(a.region == b.region);
    CHECK(a.boundary_names == b.boundary_names);
    REQUIRE(a.interior_edges.size() == b.interior_edges.size());
    for (std::size_t i = 0; i < a.interior_edges.size(); ++i) {
        CHECK(a.interior_edges[i].triangle == b.interior_edges[i].triangle);
        CHECK(a.interior_edges[i].side == b.interior_edges[i].side);
    }
    REQUIRE(a.boundary_edges.size() == b.boundary_edges.size());
    for (std::size_t i = 0; i < a.boundary_edges.size(); ++i) {
        CHECK(a.boundary_edges[i].triangle == b.boundary_edges[i].triangle);
        CHECK(a.boundary_edges[i].side == b.boundary_edges[i].side);
        CHECK(a.boundary_edges[i].boundary == b.boundary_edges[i].boundary);
    }
}

}  // namespace

TEST_CASE("gmsh: a file of every format has the areas and lengths of its geometry") {
    for (const std::string& file : gmsh_files) {
        CAPTURE(file);
        const GmshMesh read = read_gmsh(gmsh_bytes(file), file);
        CHECK(read.warnings.empty());
        CHECK(read.mesh.n_triangles() == 65);
        const auto area = areas(read);
        REQUIRE(area.size() == 2);
        CHECK(area.at("steel") == relative(100, 1e-12));
        CHECK(area.at("glass") < 100);
        CHECK(area.at("glass") > 100 - 4 * std::numbers::pi);
        const auto boundary = boundary_lengths(read.mesh);
        CHECK(boundary.at("left side") == relative(10, 1e-12));
        CHECK(boundary.at("Rand unten ü") == relative(20, 1e-12));
        CHECK(boundary.at("right") == relative(10, 1e-12));
        CHECK(boundary.at("hole") < 4 * std::numbers::pi);
        CHECK(boundary.at("hole") > 0.85 * 4 * std::numbers::pi);  // a polygon of 6 sides or more
        CHECK(boundary.at("") == relative(20, 1e-12));             // the top has no name
        CHECK(boundary.size() == 5);
        CHECK(read.mesh.boundary_names.back().empty());
        const auto inner = inner_lengths(read);
        CHECK(inner.size() == 2);
        CHECK(inner.at("crack") == relative(5, 1e-12));
        CHECK(inner.at("joint") == relative(10, 1e-12));
        for (const GmshGroup& group : read.surface_groups) CHECK(group.named);
        for (Index t = 0; t < read.mesh.n_triangles(); ++t) CHECK(read.mesh.area(t) > 0);
    }
}

TEST_CASE("gmsh: text and binary of one version are the same mesh") {
    const auto mesh = [](int i) { return read_gmsh(gmsh_bytes(gmsh_files[i]), gmsh_files[i]).mesh; };
    check_same(mesh(0), mesh(1), true);
    check_same(mesh(2), mesh(3), true);
    check_same(mesh(0), mesh(2));
}

TEST_CASE("gmsh: a file that knap wrote is read back bit for bit") {
    Shape shape = block();
    add_hole(shape, circle({0.07, 0.02}, 0.01, 24));
    shape.cracks.push_back({{{0, 0.02}, {0.03, 0.021}}});
    shape.cracks.push_back({{{0.01, 0.03}, {0.03, 0.032}}, 1});
    shape.regions.push_back({{{0.05, 0}, {0.1, 0}, {0.1, 0.04}, {0.05, 0.04}}, 1});
    const Mesh mesh = triangulate(shape, {.size = 0.004});
    const GmshMesh read = read_gmsh(mesh_as_text(mesh, ".msh", {"steel", "glass"}), "m.msh");
    CHECK(read.warnings.empty());
    REQUIRE(read.surface_groups.size() == 2);
    Mesh again = read.mesh;
    for (Index& region : again.region) region = read.surface_groups[region].name == "glass";
    check_same(mesh, again);
    std::vector<std::string> of_edge(mesh.interior_edges.size());
    for (const InnerLine& line : read.inner_lines) of_edge[line.edge] = read.inner_groups[line.group].name;
    int n_joined = 0;
    for (std::size_t i = 0; i < of_edge.size(); ++i) {
        const InteriorEdge& edge = mesh.interior_edges[i];
        CHECK(of_edge[i] == (edge.cracked ? "crack" : edge.joint == 1 ? "joint1" : ""));
        n_joined += edge.joint == 1;
    }
    CHECK(n_joined >= 5);
}

TEST_CASE("gmsh: edges without a name are written and read back without one") {
    const Mesh mesh = read_gmsh(gmsh_bytes(gmsh_files[0]), "m.msh").mesh;
    check_same(mesh, read_gmsh(mesh_as_text(mesh, ".msh"), "again.msh").mesh);
}

TEST_CASE("gmsh: line ends of DOS and blank lines and a plus sign do not matter") {
    std::string text;
    for (const char c : gmsh_bytes(gmsh_files[2])) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    check_same(read_gmsh(text, "dos.msh").mesh, read_gmsh(gmsh_bytes(gmsh_files[2]), "m.msh").mesh);
    const std::string nodes = "4\n\n1 +0 0 0\n2 1 0 0\n  \n3 +1.0e0 1 0\n4 0 1 0\n\n";
    CHECK(read_gmsh(square_file("2\n1 2 0 1 2 3\n2 2 0 1 3 4\n", nodes), "m.msh").mesh.n_vertices() == 4);
}

TEST_CASE("gmsh: format 4.1 may have no entities and then nothing is in a group") {
    std::string text = gmsh_bytes("block_41_ascii.msh");
    const std::size_t begin = text.find("$Entities"), end = text.find("$Nodes");
    const GmshMesh read = read_gmsh(text.erase(begin, end - begin), "m.msh");
    CHECK(read.mesh.n_triangles() == 65);
    CHECK(read.mesh.boundary_names == std::vector<std::string>{""});
    CHECK(read.surface_groups.size() == 1);
    CHECK(read.inner_groups.empty());
}

TEST_CASE("gmsh: partitions of format 2.2 are more tags of an element") {
    const GmshMesh read =
        read_gmsh(square_file("3\n1 2 4 5 1 1 2 1 2 3\n2 2 5 5 1 2 1 -2 1 3 4\n3 1 4 6 1 1 1 1 2\n"), "m.msh");
    CHECK(read.mesh.n_triangles() == 2);
    CHECK(read.surface_groups.size() == 1);
    CHECK(read.mesh.boundary_names == std::vector<std::string>{"6", ""});
}

TEST_CASE("gmsh: sections that do not describe the mesh are skipped") {
    const std::string other = "$Comments\nby hand\n$EndComments\n$NodeData\n1\n\"a\"\n$EndNodeData\n";
    CHECK(read_gmsh(square_file("2\n1 2 0 1 2 3\n2 2 0 1 3 4\n", "4\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n", other),
                    "m.msh")
              .mesh.n_triangles() == 2);
    CHECK(mistake(square_file("0\n", "0\n", "$Comments\nno end\n")).message.find("has no end") != std::string::npos);
}

TEST_CASE("gmsh: elements of second order are read by their corners") {
    // the square with nodes in the middles of its sides, of which one is curved
    const std::string nodes =
        "9\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0.5 0 0\n6 1.1 0.5 0\n7 0.5 0.5 0\n8 0.5 1 0\n9 0 0.5 0\n";
    const GmshMesh read = read_gmsh(square_file("3\n1 9 2 4 4 1 2 3 5 6 7\n2 9 2 4 8 1 3 4 7 8 9\n3 8 2 5 5 1 2 5\n",
                                                nodes, "$PhysicalNames\n1\n1 5 \"base\"\n$EndPhysicalNames\n"),
                                    "m.msh");
    CHECK(read.mesh.n_vertices() == 4);
    CHECK(read.mesh.n_triangles() == 2);
    CHECK(read.mesh.area(0) + read.mesh.area(1) == relative(1));
    CHECK(read.mesh.boundary_names.front() == "base");
    REQUIRE(read.warnings.size() == 1);
    CHECK(read.warnings[0].find("2 triangles have 6 nodes") != std::string::npos);
    CHECK(read.surface.size() == 2);  // one group, two elementary surfaces
    CHECK(read.surface[0] != read.surface[1]);
}

}  // namespace gmsh_formats_test
