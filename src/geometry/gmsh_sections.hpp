#pragma once
// The sections of a Gmsh file, one function each and version. Each stands behind the line `$Name` and reads up to `$EndName`.
#include "geometry/gmsh_file.hpp"

namespace knap {

void read_nodes_22(GmshSource& source, GmshFile& file);
void read_elements_22(GmshSource& source, GmshFile& file);

/// Physical groups of the entities of format 4.1, by dimension and tag.
struct GmshEntities {
    bool given = false;
    std::map<std::pair<int, std::int64_t>, std::vector<std::int32_t>> groups;
};
GmshEntities read_entities_41(GmshSource& source);
void read_nodes_41(GmshSource& source, GmshFile& file);
void read_elements_41(GmshSource& source, const GmshEntities& entities, GmshFile& file);

/// Nodes of an element type: 1 (point), 2 (line) or 3 (triangle). Any other type is refused.
int nodes_of_gmsh_type(const GmshSource& source, std::size_t where, std::int64_t type);

/// The tag of a physical group from the number in the file; its sign is an orientation, which does not matter here.
std::int32_t gmsh_group(const GmshSource& source, std::size_t where, std::int64_t number);

/// Reads the nodes' tags of one element with 1 to 3 nodes. `binary_long`: 8 bytes each in a binary file, else 4.
template <bool binary_long>
std::array<std::int64_t, 3> read_gmsh_corners(GmshSource& source, int n_nodes) {
    std::array<std::int64_t, 3> corners{};
    for (int k = 0; k < n_nodes; ++k)
        corners[k] = binary_long ? source.long_integer("the tag of a node") : source.integer("the tag of a node");
    return corners;
}

void add_gmsh_element(GmshFile& file, int n_nodes, const std::array<std::int64_t, 3>& corners, std::int32_t group, std::size_t where);

}  // namespace knap
