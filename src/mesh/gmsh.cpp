// From the nodes, lines and triangles of the file to a Mesh: numbers for tags, counterclockwise triangles, named edges.
#include "mesh/gmsh.hpp"

#include "mesh/edge_graph.hpp"
#include "mesh/gmsh_file.hpp"
#include "mesh/overlap.hpp"
#include "mesh/shape_graph.hpp"

#include <cmath>
#include <set>
#include <unordered_map>

namespace knap {
namespace {

constexpr double min_flatness = 1e-10;    // height over longest side of a triangle
constexpr double plane_tolerance = 1e-8;  // of z, relative to the extent of the mesh
constexpr double same_place = 1e-9;       // of two nodes, relative to the extent of the mesh
constexpr double max_coordinate = 1e100;  // so that its square is a number

/// Vertices of the boundary at the same place as another one (in a grid of the tolerance, so a few may be missed).
std::size_t n_doubled_vertices(const Mesh& mesh) {
    const Box box = bounding_box(mesh.vertices);
    const double scale = 1 / (same_place * box.diagonal());
    std::set<Index> on_boundary;
    for (const BoundaryEdge& edge : mesh.boundary_edges)
        for (const Index v : mesh.side_vertices(edge.triangle, edge.side)) on_boundary.insert(v);
    std::set<std::pair<double, double>> cells;
    for (const Index v : on_boundary) {
        const Vec2 x = (mesh.vertices[v] - box.low) * scale;
        cells.emplace(std::round(x.x()), std::round(x.y()));
    }
    return on_boundary.size() - cells.size();
}

/// The number of a name in a list, appended if it is new.
Index number_of(const std::string& name, std::vector<std::string>& names) {
    const auto found = std::find(names.begin(), names.end(), name);
    const auto number = static_cast<Index>(found - names.begin());
    if (found == names.end()) names.push_back(name);
    return number;
}

class MeshMaker {
public:
    explicit MeshMaker(const GmshFile& file) : file_(file), vertex_of_node_(file.nodes.size(), -1) {}

    GmshMesh make() {
        number_nodes();
        add_triangles();
        check_plane();
        const CurveOrder order = order_along_curve(mesh_);
        for (Index& vertex : vertex_of_node_)
            if (vertex >= 0) vertex = order.vertex[vertex];
        number_surfaces(order.triangle);
        try {
            find_edges(mesh_);
        } catch (const ShapeError&) {
            fail_for_overlapping_neighbours();
            throw;
        }
        if (const auto overlap = find_overlap(mesh_)) {
            const Vec2 x = mesh_.centroid((*overlap)[0]), y = mesh_.centroid((*overlap)[1]);
            file_.fail(file_.end, "the triangle around (", x.x(), ", ", x.y(), ") overlaps the one around (", y.x(),
                       ", ", y.y(), "), with which it shares no edge");
        }
        sort_lines();
        name_boundary();
        name_inner_edges();
        warn();
        return std::move(made_);
    }

private:
    /// A line of the file that is in a group and joins two vertices.
    struct Line {
        std::uint64_t edge;
        std::int32_t group;  // tag
        std::size_t where;   // in the file
        bool found = false;  // it is a side of a triangle
    };

    /// Tags need be neither ascending nor without gaps.
    void number_nodes() {
        node_of_tag_.reserve(file_.nodes.size());
        for (Index i = 0; i < std::ssize(file_.nodes); ++i)
            if (!node_of_tag_.try_emplace(file_.nodes[i].tag, i).second)
                file_.fail(file_.end, "$Nodes has node ", file_.nodes[i].tag, " twice");
    }

    /// `where` is the element that has the node.
    Index node(std::int64_t tag, std::size_t where) const {
        const auto found = node_of_tag_.find(tag);
        if (found == node_of_tag_.end()) file_.fail(where, "$Nodes has no node ", tag);
        return found->second;
    }

    Vec2 position(Index node) const { return {file_.nodes[node].position[0], file_.nodes[node].position[1]}; }

    void add_triangles() {
        if (file_.triangles.empty())
            file_.fail({file_.end, file_.lines.empty() ? "mesh in two dimensions: gmsh -2" : saved_in_groups},
                       "this mesh has no triangles");
        if (static_cast<double>(file_.triangles.size()) > max_triangles)
            file_.fail(file_.end, "this mesh has too many triangles");
        std::map<std::int32_t, Index> number;  // of groups
        for (const auto& triangle : file_.triangles) {
            const auto [found, is_new] = number.try_emplace(triangle.group, static_cast<Index>(number.size()));
            if (is_new) made_.surface_groups.push_back(group(2, triangle.group));
            mesh_.region.push_back(found->second);
            ++made_.surface_groups[found->second].n;
            std::array<Index, 3>& corners = mesh_.triangles.emplace_back(counterclockwise_nodes(triangle));
            for (Index& corner : corners) {
                Index& vertex = vertex_of_node_[corner];
                if (vertex < 0) vertex = mesh_.n_vertices(), mesh_.vertices.push_back(position(corner));
                corner = vertex;
            }
        }
    }

    /// Each group of an elementary surface is one.
    void number_surfaces(const std::vector<Index>& place_in_file) {
        std::map<std::pair<std::int32_t, std::int64_t>, Index> number;
        for (const Index t : place_in_file) {
            const GmshElement<3>& triangle = file_.triangles[t];
            const auto next = static_cast<Index>(number.size());
            made_.surface.push_back(number.try_emplace({triangle.group, triangle.entity}, next).first->second);
        }
    }

    GmshGroup group(int dimension, std::int32_t tag) const {
        return {file_.group_name(dimension, tag), file_.group_names.contains({dimension, tag})};
    }

    std::array<Index, 3> counterclockwise_nodes(const GmshElement<3>& triangle) const {
        std::array<Index, 3> nodes;
        for (int k = 0; k < 3; ++k) {
            nodes[k] = node(triangle.nodes[k], triangle.where);
            for (const double x : file_.nodes[nodes[k]].position)
                if (std::abs(x) > max_coordinate)
                    file_.fail(triangle.where, "node ", triangle.nodes[k], " has a coordinate above 1e100");
        }
        const Vec2 a = position(nodes[0]), b = position(nodes[1]), c = position(nodes[2]);
        const double area = cross(b - a, c - a);
        const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
        if (!(std::abs(area) > min_flatness * longest))
            file_.fail(triangle.where, "the triangle of the nodes ", triangle.nodes[0], ", ", triangle.nodes[1],
                       " and ", triangle.nodes[2], " has no area in the x-y plane");
        if (area < 0) std::swap(nodes[1], nodes[2]);
        return nodes;
    }

    /// All z are equal, compared with the extent.
    void check_plane() const {
        Eigen::Array3d low = Eigen::Array3d::Constant(max_coordinate), high = -low;
        for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
            if (vertex_of_node_[i] < 0) continue;
            const Eigen::Map<const Eigen::Array3d> x(file_.nodes[i].position.data());
            low = low.min(x), high = high.max(x);
        }
        const Eigen::Array3d extent = high - low;
        if (extent.z() > plane_tolerance * extent.maxCoeff())
            file_.fail({file_.end, "a body is meshed in the x-y plane"}, "this mesh does not lie in a plane z = const");
    }

    /// Fails at the first triangle of the file that lies on the same side of an edge as an earlier one.
    void fail_for_overlapping_neighbours() const {
        std::map<std::array<Index, 2>, const GmshElement<3>*> triangle_at;  // of directed sides, by their nodes
        for (const GmshElement<3>& triangle : file_.triangles) {
            const std::array<Index, 3> nodes = counterclockwise_nodes(triangle);
            for (int k = 0; k < 3; ++k) {
                const Index from = nodes[k], to = nodes[(k + 1) % 3];
                const auto [found, is_new] = triangle_at.try_emplace({from, to}, &triangle);
                if (is_new) continue;
                const GmshElement<3>& earlier = *found->second;
                if (!std::is_permutation(earlier.nodes.begin(), earlier.nodes.end(), triangle.nodes.begin()))
                    file_.fail(triangle.where, "this triangle and one before it overlap: both lie on the same side of ",
                               "the edge between the nodes ", file_.nodes[from].tag, " and ", file_.nodes[to].tag);
                if (earlier.group == triangle.group) file_.fail(triangle.where, "this triangle is in the file twice");
                file_.fail(triangle.where, "this triangle is in two physical groups, `",
                           file_.group_name(2, earlier.group), "` and `", file_.group_name(2, triangle.group),
                           "`, and can have one material only");
            }
        }
    }

    void sort_lines() {
        for (const auto& line : file_.lines) {
            const Index a = vertex_of_node_[node(line.nodes[0], line.where)],
                        b = vertex_of_node_[node(line.nodes[1], line.where)];
            if (line.group == 0) continue;
            if (a < 0 || b < 0) ++n_without_effect_[line.group];
            else lines_.push_back({edge_key({a, b}), line.group, line.where});
        }
        std::ranges::sort(lines_, {}, [](const Line& l) { return std::tuple(l.edge, l.group, l.where); });
    }

    /// The lines on a side of a triangle, which are marked as found.
    std::span<Line> lines_on(Index triangle, Index side) {
        const std::uint64_t edge = edge_key(mesh_.side_vertices(triangle, side));
        const auto lines = std::ranges::equal_range(lines_, edge, {}, &Line::edge);
        for (Line& line : lines) line.found = true;
        return lines;
    }

    /// The tag of the group of lines that names an edge, 0 for none.
    std::int32_t group_on(const BoundaryEdge& edge) {
        const std::span<Line> lines = lines_on(edge.triangle, edge.side);
        if (lines.empty()) return 0;
        const std::string name = file_.group_name(1, lines.front().group);
        for (const Line& line : lines)
            if (const std::string other = file_.group_name(1, line.group); other != name)
                file_.fail(line.where, "this edge of the boundary is in two physical groups, `", name, "` and `", other,
                           "`, and can have one name only");
        return lines.front().group;
    }

    /// Names in the order of the tags of their groups; edges without a group come last.
    void name_boundary() {
        std::map<std::int32_t, std::vector<BoundaryEdge*>> edges;  // by group
        for (BoundaryEdge& edge : mesh_.boundary_edges) edges[group_on(edge)].push_back(&edge);
        const auto name = [&](std::int32_t group, const std::vector<BoundaryEdge*>& of_group) {
            const Index number = number_of(file_.group_name(1, group), mesh_.boundary_names);
            for (BoundaryEdge* edge : of_group) edge->boundary = number;
        };
        const auto unnamed = edges.extract(0);
        for (const auto& [group, of_group] : edges) name(group, of_group);
        if (!unnamed.empty()) name(0, unnamed.mapped());
    }

    void name_inner_edges() {
        std::vector<std::string> names;
        for (Index i = 0; i < std::ssize(mesh_.interior_edges); ++i)
            for (const Line& line : lines_on(mesh_.interior_edges[i].triangle[0], mesh_.interior_edges[i].side[0])) {
                const Index number = number_of(file_.group_name(1, line.group), names);
                if (names.size() > made_.inner_groups.size()) made_.inner_groups.push_back(group(1, line.group));
                made_.inner_lines.push_back({i, number});
                ++made_.inner_groups[number].n;
            }
    }

    /// Warns of probable mistakes: separate pieces, vertices at the same place, lines that are no sides of triangles.
    void warn() {
        const auto add = [&](const auto&... parts) { made_.warnings.push_back(concatenated(parts...)); };
        if (file_.n_second_order > 0)
            add(file_.n_second_order, " triangles have 6 nodes: they are read by their corners, with straight sides; ",
                "their order in the run is mesh.order");
        if (const Index n = std::ranges::max(pieces_of(mesh_)) + 1; n > 1)
            add("the mesh consists of ", n, " pieces that share no edge: they do not interact, not even by contact");
        if (const std::size_t n = n_doubled_vertices(mesh_); n > 0)
            add(n, " nodes of the boundary coincide with others: the body is open there, without cohesion and contact ",
                "(`Coherence` in Gmsh joins surfaces; a crack is a group of lines inside the body)");
        for (const Line& line : lines_) n_without_effect_[line.group] += !line.found;
        for (const auto& [group, n] : n_without_effect_)
            if (n > 0)
                add(n, n == 1 ? " line" : " lines", " of the group `", file_.group_name(1, group),
                    n == 1 ? "` is no side of a triangle and has no effect"
                           : "` are no sides of triangles and have no effect");
    }

    const GmshFile& file_;
    std::unordered_map<std::int64_t, Index> node_of_tag_;  // into the nodes of the file
    std::vector<Index> vertex_of_node_;                    // -1 for a node without triangles
    std::vector<Line> lines_;                              // by edge, group and place in the file
    std::map<std::int32_t, Index> n_without_effect_;       // lines per group
    GmshMesh made_;
    Mesh& mesh_ = made_.mesh;
};

}  // namespace

GmshMesh read_gmsh(const std::string& bytes, const std::string& name) {
    return MeshMaker(GmshFile(bytes, name)).make();
}

}  // namespace knap
