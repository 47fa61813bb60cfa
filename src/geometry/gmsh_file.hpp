#pragma once
// What a Gmsh file says: nodes, lines, triangles and the names of physical groups, as they stand there.
// Source: Gmsh reference manual, "MSH file format" (version 4.1) and "Legacy formats" (version 2.2).
#include "geometry/gmsh_source.hpp"

#include <array>
#include <map>
#include <vector>

namespace knap {

/// What most often explains an empty file.
inline const char* const saved_in_groups = "where there are physical groups, Gmsh saves only what is in one: give surfaces one, too";

struct GmshNode {
    std::int64_t tag;
    std::array<double, 3> position;  // in the file's own unit
};

/// A line (2 nodes) or a triangle (3 nodes). One that is in several physical groups comes several times.
template <std::size_t n_nodes>
struct GmshElement {
    std::array<std::int64_t, n_nodes> nodes;  // tags
    std::int32_t group;                       // tag of the physical group, 0 for none
    std::size_t where;                        // in the file, for messages
};

struct GmshFile {
    std::map<std::pair<int, std::int32_t>, std::string> group_names;  // by dimension and tag
    std::vector<GmshNode> nodes;
    std::vector<GmshElement<2>> lines;
    std::vector<GmshElement<3>> triangles;

    /// The tag where the file gives no name, empty for tag 0 (no group).
    std::string group_name(int dimension, std::int32_t tag) const;
};

/// Reads formats 2.2 and 4.1, ASCII and binary. Throws UserError.
GmshFile read_gmsh_file(GmshSource& source);

}  // namespace knap
