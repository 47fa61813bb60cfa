// Header, list of sections, names of groups; what both versions share.
#include "geometry/gmsh_file.hpp"

#include "geometry/gmsh_sections.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace knap {
namespace {

enum class Version { v22, v41 };

const char* const how_to_convert = "Gmsh converts it: gmsh -0 old.msh -o new.msh -format msh41 (or msh22)";

void expect_line(GmshSource& source, const std::string& wanted) {
    const std::size_t where = source.at();
    const std::string_view line = source.next_line();
    if (line == wanted) return;
    if (line.empty()) source.fail(where, "the file ends before `" + wanted + "`");
    source.fail(where, "`" + wanted + "` should stand here", "is there more in this section than it announces?");
}

void check_byte_order(GmshSource& source) {
    const std::size_t where = source.at();
    const std::int64_t one = source.integer("the number 1 that shows the byte order");
    if (one == 1) return;
    if (one == 0x01000000)
        source.fail(where, "this file was written with the other byte order", "save it as text, or on this kind of machine");
    source.fail(where, "the number 1 that shows the byte order is " + std::to_string(one));
}

Version read_header(GmshSource& source) {
    const std::string_view first = source.next_line();
    if (first.empty()) source.fail(0, "this file is empty");
    if (first == "$NOD") source.fail(0, "this file has version 1 of Gmsh's format; 2.2 and 4.1 can be read", how_to_convert);
    if (first != "$MeshFormat") source.fail(0, "this is no Gmsh mesh: it does not begin with $MeshFormat");
    const std::size_t where = source.at();
    const double version = source.text_real("the version of the format");
    const std::int64_t binary = source.text_integer("the file type (0 ASCII, 1 binary)");
    const std::int64_t size = source.text_integer("the size of numbers");
    const bool is_22 = std::abs(version - 2.2) < 1e-6, is_41 = std::abs(version - 4.1) < 1e-6;
    if (!is_22 && !is_41) {
        char text[32];
        std::snprintf(text, sizeof text, "%d.%d", static_cast<int>(std::fmin(std::fabs(version), 1e6)),
                      static_cast<int>(std::lround(10 * std::fmod(std::fabs(version), 1))) % 10);
        source.fail(where, "this file has version " + std::string(text) + " of Gmsh's format; 2.2 and 4.1 can be read", how_to_convert);
    }
    if (binary != 0 && binary != 1) source.fail(where, "the file type is " + std::to_string(binary) + ", neither 0 (ASCII) nor 1 (binary)");
    if (size != 8) source.fail(where, "numbers have " + std::to_string(size) + " bytes in this file; 8 can be read");
    source.binary = binary == 1;
    source.end_of_line();
    if (source.binary) check_byte_order(source);
    expect_line(source, "$EndMeshFormat");
    return is_22 ? Version::v22 : Version::v41;
}

/// Text in any file: dimension, tag and "name" a line.
void read_group_names(GmshSource& source, GmshFile& file) {
    const std::size_t n = source.checked_count(source.text_integer("the number of physical names"), 7, "physical names");
    source.end_of_line();
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t where = source.at();
        const std::int64_t dimension = source.text_integer("the dimension of a group");
        const std::int32_t tag = gmsh_group(source, where, source.text_integer("the tag of a group"));
        const std::string_view rest = source.next_line();
        const std::size_t open = rest.find('"'), close = rest.rfind('"');
        if (open != 0 || close == 0 || close + 1 != rest.size()) source.fail(where, "a line here is: dimension tag \"name\"");
        if (dimension < 0 || dimension > 3) source.fail(where, "a group cannot have the dimension " + std::to_string(dimension));
        if (close == 1) source.fail(where, "this group has an empty name");
        file.group_names[{static_cast<int>(dimension), tag}] = std::string(rest.substr(1, close - 1));
    }
}

/// Reads a section, or passes over one that says nothing about the mesh. Stands behind `$Name`.
void read_section(const std::string& name, std::size_t where, Version version, GmshSource& source, GmshEntities& entities, GmshFile& file) {
    const bool is_22 = version == Version::v22;
    if (name == "PartitionedEntities" || name == "GhostElements")
        source.fail(where, "this mesh is cut into partitions", "save it whole: Mesh > Unpartition in Gmsh, or `UnpartitionMesh;`");
    if (name == "PhysicalNames") {
        read_group_names(source, file);
    } else if (name == "Entities" && !is_22) {
        entities = read_entities_41(source);
    } else if (name == "Nodes") {
        is_22 ? read_nodes_22(source, file) : read_nodes_41(source, file);
    } else if (name == "Elements") {
        is_22 ? read_elements_22(source, file) : read_elements_41(source, entities, file);
    } else {
        if (!source.skip_past("$End" + name)) source.fail(where, "the section $" + name + " has no end");
        return;
    }
    expect_line(source, "$End" + name);
}

}  // namespace

GmshFile read_gmsh_file(GmshSource& source) {
    const Version version = read_header(source);
    GmshFile file;
    GmshEntities entities;
    std::set<std::string> seen;
    while (true) {
        const std::size_t where = source.at();
        const std::string line(source.next_line().substr(0, 64));
        if (line.empty()) break;
        if (line.front() != '$' || line.starts_with("$End")) source.fail(where, "a section `$Name` should begin here");
        const std::string name = line.substr(1);
        if (!seen.insert(name).second && (name == "Nodes" || name == "Elements" || name == "Entities"))
            source.fail(where, "there is a second section $" + name);
        read_section(name, where, version, source, entities, file);
    }
    for (const char* needed : {"Nodes", "Elements"})
        if (!seen.contains(needed)) source.fail(source.at(), "this file has no section $" + std::string(needed), saved_in_groups);
    return file;
}

std::string GmshFile::group_name(int dimension, std::int32_t tag) const {
    if (tag == 0) return "";
    const auto found = group_names.find({dimension, tag});
    return found == group_names.end() ? std::to_string(tag) : found->second;
}

int nodes_of_gmsh_type(const GmshSource& source, std::size_t where, std::int64_t type) {
    if (type == 1 || type == 2) return static_cast<int>(type) + 1;
    if (type == 15) return 1;
    static const std::map<std::int64_t, const char*> names{{3, "a quadrangle"},
                                                           {4, "a tetrahedron"},
                                                           {5, "a hexahedron"},
                                                           {6, "a prism"},
                                                           {7, "a pyramid"},
                                                           {8, "a line of 3 nodes"},
                                                           {9, "a triangle of 6 nodes"},
                                                           {10, "a quadrangle of 9 nodes"},
                                                           {16, "a quadrangle of 8 nodes"}};
    const auto found = names.find(type);
    const std::string what = found == names.end() ? "an element of type " + std::to_string(type) : std::string(found->second);
    const char* note = "only triangles of 3 nodes (type 2), lines of 2 nodes (1) and points (15) can be read";
    if (type == 3 || type == 10 || type == 16) note = "only triangles can be read: mesh without `Recombine Surface`";
    if (type == 8 || type == 9) note = "only triangles of 3 nodes can be read: save the mesh with order 1 (Mesh.ElementOrder = 1)";
    if (type >= 4 && type <= 7) note = "only plane meshes can be read: mesh in two dimensions (gmsh -2)";
    source.fail(where, what + " is in this mesh", note);
}

std::int32_t gmsh_group(const GmshSource& source, std::size_t where, std::int64_t number) {
    const std::int64_t largest = std::numeric_limits<std::int32_t>::max();
    if (number > largest || number < -largest) source.fail(where, std::to_string(number) + " cannot be the tag of a physical group");
    return static_cast<std::int32_t>(number < 0 ? -number : number);
}

void add_gmsh_element(GmshFile& file, int n_nodes, const std::array<std::int64_t, 3>& corners, std::int32_t group, std::size_t where) {
    if (n_nodes == 2) file.lines.push_back({{corners[0], corners[1]}, group, where});
    if (n_nodes == 3) file.triangles.push_back({corners, group, where});
}

}  // namespace knap
