// Any bytes as a Gmsh file: the result is a valid mesh or an error.
#include "target.hpp"

#include "base/error.hpp"
#include "mesh/gmsh.hpp"

using namespace knap;
using tests::require;

namespace {

void check(const GmshMesh& read) {
    const Mesh& mesh = read.mesh;
    const auto is_triangle = [&](Index t) { return t >= 0 && t < mesh.n_triangles(); };
    require(mesh.n_triangles() > 0 && mesh.region.size() == mesh.triangles.size(), "every triangle has a region");
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        for (const Index v : mesh.triangles[t]) require(v >= 0 && v < mesh.n_vertices(), "corners are vertices");
        require(mesh.region[t] >= 0 && static_cast<std::size_t>(mesh.region[t]) < read.surface_groups.size(),
                "a region is a group");
        require(mesh.area(t) > 0, "triangles are counterclockwise");
    }
    for (const InteriorEdge& edge : mesh.interior_edges) {
        std::array<Index, 2> from, to;
        for (int s = 0; s < 2; ++s) {
            require(is_triangle(edge.triangle[s]) && edge.side[s] >= 0 && edge.side[s] < 3,
                    "an edge is a side of triangles");
            from[s] = mesh.triangles[edge.triangle[s]][edge.side[s]];
            to[s] = mesh.triangles[edge.triangle[s]][(edge.side[s] + 1) % 3];
        }
        require(from[0] == to[1] && to[0] == from[1], "both triangles of an edge have its vertices");
    }
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        require(is_triangle(edge.triangle) && edge.boundary >= 0 &&
                    static_cast<std::size_t>(edge.boundary) < mesh.boundary_names.size(),
                "a boundary has a name");
    require(2 * mesh.interior_edges.size() + mesh.boundary_edges.size() == 3 * mesh.triangles.size(),
            "every side is an edge");
    for (const InnerLine& line : read.inner_lines)
        require(line.edge >= 0 && static_cast<std::size_t>(line.edge) < mesh.interior_edges.size() && line.group >= 0 &&
                    static_cast<std::size_t>(line.group) < read.inner_groups.size(),
                "an inner line is an edge with a group");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        check(read_gmsh(tests::text_of(data, size), "input.msh"));
    } catch (const UserError& error) {
        require(!error.diagnostics.empty(), "an error says something");
    }
    return 0;
}
