#include "geometry/gmsh_lines.hpp"

#include <algorithm>

namespace knap {
namespace {

std::uint64_t edge_key(Index a, Index b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint32_t>(std::max(a, b));
}

Index number_of_name(std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    const auto number = static_cast<Index>(found - names.begin());
    if (found == names.end()) names.push_back(name);
    return number;
}

class EdgeNames {
public:
    EdgeNames(const GmshSource& source, const GmshFile& file, GmshMesh& made) : source_(source), file_(file), made_(made) {}

    /// Lines in a group, by the vertices that they join.
    void sort_lines(const GmshNodeNumbers& numbers, const std::vector<Index>& vertex_of_node) {
        for (const auto& line : file_.lines) {
            const Index a = vertex_of_node[numbers.of(line.nodes[0], line.where)],
                        b = vertex_of_node[numbers.of(line.nodes[1], line.where)];
            if (line.group == 0) continue;
            if (a < 0 || b < 0)
                ++n_lost_[line.group];
            else
                lines_.push_back({edge_key(a, b), line.group, line.where});
        }
        std::sort(lines_.begin(), lines_.end(),
                  [](const Line& a, const Line& b) { return std::tie(a.key, a.group, a.where) < std::tie(b.key, b.group, b.where); });
    }

    void name_boundary() {
        Mesh& mesh = made_.mesh;
        std::vector<std::int32_t> group_of(mesh.boundary_edges.size(), 0);
        std::map<std::int32_t, Index> number;  // ascending, so that names are in the order of the tags
        bool all_named = true;
        for (std::size_t i = 0; i < group_of.size(); ++i) {
            group_of[i] = group_on(mesh.boundary_edges[i]);
            if (group_of[i] != 0) number[group_of[i]] = 0;
            all_named = all_named && group_of[i] != 0;
        }
        mesh.boundary_names.clear();
        for (auto& [group, n] : number) n = number_of_name(mesh.boundary_names, file_.group_name(1, group));
        if (!all_named) number[0] = number_of_name(mesh.boundary_names, "");
        for (std::size_t i = 0; i < group_of.size(); ++i) mesh.boundary_edges[i].boundary = number[group_of[i]];
    }

    void name_inner_edges() {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < made_.mesh.interior_edges.size(); ++i) {
            const InteriorEdge& edge = made_.mesh.interior_edges[i];
            for (Line* line = first_on(edge.triangle[0], edge.side[0]); line; line = next(line)) {
                const Index number = number_of_name(names, file_.group_name(1, line->group));
                if (names.size() > made_.inner_groups.size())
                    made_.inner_groups.push_back({names.back(), file_.group_names.contains({1, line->group}), 0});
                made_.inner_lines.push_back({static_cast<Index>(i), number});
                ++made_.inner_groups[number].n;
            }
        }
    }

    void warn_of_lost_lines() {
        for (const Line& line : lines_)
            if (!line.found) ++n_lost_[line.group];
        for (const auto& [group, n] : n_lost_)
            made_.warnings.push_back(std::to_string(n) + (n == 1 ? " line" : " lines") + " of the group `" + file_.group_name(1, group) +
                                     "` " + (n == 1 ? "is no side of a triangle and has" : "are no sides of triangles and have") +
                                     " no effect");
    }

private:
    struct Line {
        std::uint64_t key;
        std::int32_t group;  // tag
        std::size_t where;   // in the file
        bool found = false;  // it is a side of a triangle
    };

    /// The first line on a side of a triangle; null for none.
    Line* first_on(Index triangle, Index side) {
        const auto& corners = made_.mesh.triangles[triangle];
        const std::uint64_t key = edge_key(corners[side], corners[(side + 1) % 3]);
        const auto first =
            std::lower_bound(lines_.begin(), lines_.end(), key, [](const Line& line, std::uint64_t k) { return line.key < k; });
        if (first == lines_.end() || first->key != key) return nullptr;
        first->found = true;
        return &*first;
    }

    /// The next one on the same edge.
    Line* next(Line* line) {
        if (line == &lines_.back() || line[1].key != line->key) return nullptr;
        line[1].found = true;
        return line + 1;
    }

    std::int32_t group_on(const BoundaryEdge& edge) {
        Line* first = first_on(edge.triangle, edge.side);
        if (!first) return 0;
        const std::string name = file_.group_name(1, first->group);
        for (Line* line = next(first); line; line = next(line)) {
            const std::string other = file_.group_name(1, line->group);
            if (other != name)
                source_.fail(line->where, "this edge of the boundary is in two physical groups, `" + name + "` and `" + other +
                                              "`, and can have one name only");
        }
        return first->group;
    }

    const GmshSource& source_;
    const GmshFile& file_;
    GmshMesh& made_;
    std::vector<Line> lines_;
    std::map<std::int32_t, Index> n_lost_;  // lines per group that are no side
};

}  // namespace

void name_edges(const GmshSource& source, const GmshFile& file, const GmshNodeNumbers& numbers, const std::vector<Index>& vertex_of_node,
                GmshMesh& made) {
    EdgeNames names(source, file, made);
    names.sort_lines(numbers, vertex_of_node);
    names.name_boundary();
    names.name_inner_edges();
    names.warn_of_lost_lines();
}

}  // namespace knap
