// Entities, nodes and elements of Gmsh's format 4.1. Text and binary have the same numbers in the same order.
#include "geometry/gmsh_sections.hpp"

namespace knap {
namespace {

std::size_t read_count(GmshSource& source, std::size_t bytes_each, const char* what) {
    const std::string number = std::string("the number of ") + what;
    return source.checked_count(source.long_integer(number.c_str()), source.binary ? bytes_each : 2, what);
}

/// Points have a place, the others a box; then come the physical groups, and the entities of the boundary (not of points).
void read_entity(GmshSource& source, int dimension, GmshEntities& entities) {
    const std::size_t where = source.at();
    const std::int64_t tag = source.integer("the tag of an entity");
    for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) source.real("a coordinate");
    std::vector<std::int32_t> groups(read_count(source, 4, "physical groups"));
    for (std::int32_t& group : groups) group = gmsh_group(source, where, source.integer("the tag of a physical group"));
    if (dimension > 0) {
        const std::size_t n = read_count(source, 4, "entities of a boundary");
        for (std::size_t i = 0; i < n; ++i) source.integer("the tag of an entity");
    }
    source.end_of_record();
    entities.groups[{dimension, tag}] = std::move(groups);
}

}  // namespace

GmshEntities read_entities_41(GmshSource& source) {
    GmshEntities entities{.given = true, .groups = {}};
    std::array<std::size_t, 4> n{};
    for (std::size_t& count : n) count = read_count(source, 4, "entities");
    source.end_of_record();
    for (int dimension = 0; dimension < 4; ++dimension)
        for (std::size_t i = 0; i < n[dimension]; ++i) read_entity(source, dimension, entities);
    return entities;
}

void read_nodes_41(GmshSource& source, GmshFile& file) {
    const std::size_t n_blocks = read_count(source, 20, "blocks of nodes");
    const std::size_t n_nodes = read_count(source, 32, "nodes");
    for (const char* end : {"the smallest tag", "the largest tag"}) source.long_integer(end);
    source.end_of_record();
    for (std::size_t block = 0; block < n_blocks; ++block) {
        const std::size_t where = source.at();
        const std::int64_t dimension = source.integer("a dimension");
        source.integer("the tag of an entity");
        const bool parametric = source.integer("0 or 1 (parametric)") != 0;
        const std::size_t n = read_count(source, 32, "nodes"), first = file.nodes.size();
        source.end_of_record();
        if (dimension < 0 || dimension > 3) source.fail(where, "nodes cannot have the dimension " + std::to_string(dimension));
        if (n > n_nodes - first)
            source.fail(where, "the blocks hold more than the " + std::to_string(n_nodes) + " nodes that are announced");
        file.nodes.resize(first + n);
        for (std::size_t i = first; i < first + n; ++i) {
            file.nodes[i].tag = source.long_integer("the tag of a node");
            source.end_of_record();
        }
        for (std::size_t i = first; i < first + n; ++i) {
            for (double& x : file.nodes[i].position) x = source.real("a coordinate");
            for (std::int64_t d = 0; parametric && d < dimension; ++d) source.real("a parametric coordinate");
            source.end_of_record();
        }
    }
    if (file.nodes.size() != n_nodes)
        source.fail(source.at(),
                    "the blocks hold " + std::to_string(file.nodes.size()) + " nodes, announced are " + std::to_string(n_nodes));
}

void read_elements_41(GmshSource& source, const GmshEntities& entities, GmshFile& file) {
    static const std::vector<std::int32_t> none{0};
    const std::size_t n_blocks = read_count(source, 20, "blocks of elements");
    const std::size_t n_elements = read_count(source, 16, "elements");
    for (const char* end : {"the smallest tag", "the largest tag"}) source.long_integer(end);
    source.end_of_record();
    std::size_t n_read = 0;
    for (std::size_t block = 0; block < n_blocks; ++block) {
        const std::size_t where = source.at();
        const std::int64_t dimension = source.integer("a dimension"), tag = source.integer("the tag of an entity");
        const int n_nodes = nodes_of_gmsh_type(source, where, source.integer("the type of elements"));
        const std::size_t n = read_count(source, 8 * (1 + static_cast<std::size_t>(n_nodes)), "elements");
        source.end_of_record();
        if (n > n_elements - n_read)
            source.fail(where, "the blocks hold more than the " + std::to_string(n_elements) + " elements that are announced");
        if (dimension != n_nodes - 1) source.fail(where, "elements of this type cannot have the dimension " + std::to_string(dimension));
        const auto entity = entities.groups.find({n_nodes - 1, tag});
        if (entities.given && entity == entities.groups.end())
            source.fail(where, "$Entities has no entity " + std::to_string(tag) + " of dimension " + std::to_string(dimension));
        const std::vector<std::int32_t>& groups = !entities.given || entity->second.empty() ? none : entity->second;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t here = source.at();
            source.long_integer("the tag of an element");
            const auto corners = read_gmsh_corners<true>(source, n_nodes);
            source.end_of_record();
            for (const std::int32_t group : groups) add_gmsh_element(file, n_nodes, corners, group, here);
        }
        n_read += n;
    }
    if (n_read != n_elements)
        source.fail(source.at(), "the blocks hold " + std::to_string(n_read) + " elements, announced are " + std::to_string(n_elements));
}

}  // namespace knap
