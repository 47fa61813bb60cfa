#pragma once
// A mesh from a Gmsh file, with the names of its physical groups; their meaning is decided by the scenario.
#include "mesh/mesh.hpp"

namespace knap {

/// A physical group of triangles or lines.
struct GmshGroup {
    std::string name;    // its number where the file gives no name; empty: no group
    bool named = false;  // in $PhysicalNames
    Index n = 0;         // triangles, or edges inside the body
};

struct InnerLine {
    Index edge;   // of interior_edges
    Index group;  // into inner_groups
};

struct GmshMesh {
    Mesh mesh;  // vertices in the unit of the file; region: into surface_groups; no edge is cracked
                // boundary_names: groups of lines; the last one is "" when there are edges without a group
    std::vector<GmshGroup> surface_groups;
    std::vector<GmshGroup> inner_groups;  // groups of lines with edges inside the body
    std::vector<InnerLine> inner_lines;
    std::vector<Index> surface;  // per triangle: number of its elementary surface and group, in the order of triangles
    std::vector<std::string> warnings;
};

/// `bytes` of a file of format 2.2 or 4.1, ASCII or binary; `name` is the file in messages. Clockwise triangles are
/// reversed, nodes without triangles dropped. Throws UserError for a file that cannot be read or is no mesh of
/// triangles in a plane.
GmshMesh read_gmsh(const std::string& bytes, const std::string& name);

}  // namespace knap
