// Nodes and elements of Gmsh's format 2.2.
#include "geometry/gmsh_sections.hpp"

namespace knap {

void read_nodes_22(GmshSource& source, GmshFile& file) {
    file.nodes.resize(source.checked_count(source.text_integer("the number of nodes"), source.binary ? 28 : 8, "nodes"));
    source.end_of_line();
    for (GmshNode& node : file.nodes) {
        node.tag = source.integer("the tag of a node");
        for (double& x : node.position) x = source.real("a coordinate");
        source.end_of_record();
    }
}

namespace {

/// Tags are physical group, entity, and what else there may be (partitions).
std::int32_t read_tags(GmshSource& source, std::size_t where, std::int64_t n_tags) {
    std::int32_t group = 0;
    for (std::int64_t i = 0; i < n_tags; ++i) {
        const std::int64_t tag = source.integer("a tag of an element");
        if (i == 0) group = gmsh_group(source, where, tag);
    }
    return group;
}

/// ASCII: number, type, number of tags, tags, nodes.
void read_element_line(GmshSource& source, GmshFile& file) {
    const std::size_t where = source.at();
    source.text_integer("the number of an element");
    const int n_nodes = nodes_of_gmsh_type(source, where, source.text_integer("the type of an element"));
    const std::int32_t group = read_tags(source, where, source.text_integer("the number of tags"));
    add_gmsh_element(file, n_nodes, read_gmsh_corners<false>(source, n_nodes), group, where);
    source.end_of_line();
}

/// Binary: type, how many of it, number of tags; then each: number, tags, nodes. Returns how many.
std::size_t read_element_block(GmshSource& source, std::size_t most, GmshFile& file) {
    const std::size_t where = source.at();
    const int n_nodes = nodes_of_gmsh_type(source, where, source.integer("the type of elements"));
    const std::int64_t announced = source.integer("the number of elements");
    const std::size_t n_tags = source.checked_count(source.integer("the number of tags"), 4, "tags");
    const std::size_t n = source.checked_count(announced, 4 * (1 + n_tags + n_nodes), "elements");
    if (n == 0 || n > most) source.fail(where, std::to_string(n) + " elements follow here, where 1 to " + std::to_string(most) + " should");
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t here = source.at();
        source.integer("the number of an element");
        const std::int32_t group = read_tags(source, here, static_cast<std::int64_t>(n_tags));
        add_gmsh_element(file, n_nodes, read_gmsh_corners<false>(source, n_nodes), group, here);
    }
    return n;
}

}  // namespace

void read_elements_22(GmshSource& source, GmshFile& file) {
    const std::size_t n = source.checked_count(source.text_integer("the number of elements"), 8, "elements");
    source.end_of_line();
    for (std::size_t i = 0; i < n;) {
        if (source.binary) {
            i += read_element_block(source, n - i, file);
        } else {
            read_element_line(source, file);
            ++i;
        }
    }
}

}  // namespace knap
