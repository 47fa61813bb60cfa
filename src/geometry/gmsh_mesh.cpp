// From the file's nodes and triangles to a Mesh: numbers for tags, counterclockwise triangles, edges.
#include "geometry/gmsh_mesh.hpp"

#include "geometry/gmsh_lines.hpp"
#include "geometry/gmsh_warnings.hpp"
#include "geometry/mesh_limits.hpp"
#include "geometry/mesh_order.hpp"
#include "geometry/overlaps.hpp"
#include "geometry/shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

constexpr double flattest = 1e-10;            // height over longest side of a triangle
constexpr double plane_tolerance = 1e-8;      // of z, relative to the extent of the mesh
constexpr double largest_coordinate = 1e100;  // so that its square is a number

class MeshMaker {
public:
    MeshMaker(const GmshSource& source, const GmshFile& file) : source_(source), file_(file), numbers_(source, file.nodes) {}

    GmshMesh make() {
        check_number();
        add_triangles();
        check_plane();
        const std::vector<Index> new_number = order_along_curve(made_.mesh);
        for (Index& vertex : vertex_of_node_)
            if (vertex >= 0) vertex = new_number[vertex];
        find_edges_or_say_why();
        check_overlap();
        made_.warnings = mesh_warnings(made_.mesh);
        name_edges(source_, file_, numbers_, vertex_of_node_, made_);
        return std::move(made_);
    }

private:
    void check_number() const {
        if (file_.triangles.empty())
            source_.fail(source_.at(), "this mesh has no triangles",
                         file_.lines.empty() ? "mesh in two dimensions: gmsh -2" : saved_in_groups);
        if (static_cast<double>(file_.triangles.size()) > most_triangles) source_.fail(source_.at(), "this mesh has too many triangles");
    }

    Vec2 position(Index node) const { return {file_.nodes[node].position[0], file_.nodes[node].position[1]}; }

    void add_triangles() {
        std::map<std::int32_t, Index> number;  // of groups
        vertex_of_node_.assign(file_.nodes.size(), -1);
        made_.mesh.triangles.reserve(file_.triangles.size());
        made_.mesh.region.reserve(file_.triangles.size());
        for (std::size_t t = 0; t < file_.triangles.size(); ++t) {
            const auto& triangle = file_.triangles[t];
            if (t == 0 || triangle.group != file_.triangles[t - 1].group) {
                const auto [found, is_new] = number.try_emplace(triangle.group, static_cast<Index>(number.size()));
                if (is_new)
                    made_.surface_groups.push_back(
                        {file_.group_name(2, triangle.group), file_.group_names.contains({2, triangle.group}), 0});
                made_.mesh.region.push_back(found->second);
            } else {
                made_.mesh.region.push_back(made_.mesh.region.back());
            }
            ++made_.surface_groups[made_.mesh.region.back()].n;
            made_.mesh.triangles.push_back(vertices(triangle));
        }
    }

    /// Counterclockwise.
    std::array<Index, 3> vertices(const GmshElement<3>& triangle) {
        std::array<Index, 3> nodes;
        for (int k = 0; k < 3; ++k) {
            nodes[k] = numbers_.of(triangle.nodes[k], triangle.where);
            for (const double x : file_.nodes[nodes[k]].position)
                if (std::abs(x) > largest_coordinate)
                    source_.fail(triangle.where, "node " + std::to_string(triangle.nodes[k]) + " is too far away");
        }
        const Vec2 a = position(nodes[0]), b = position(nodes[1]), c = position(nodes[2]);
        const double area = cross(b - a, c - a);
        const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
        if (!(std::abs(area) > flattest * longest))
            source_.fail(triangle.where, "the triangle of the nodes " + std::to_string(triangle.nodes[0]) + ", " +
                                             std::to_string(triangle.nodes[1]) + " and " + std::to_string(triangle.nodes[2]) +
                                             " has no area in the x-y plane");
        if (area < 0) std::swap(nodes[1], nodes[2]);
        for (Index& n : nodes) n = vertex_of(n);
        return nodes;
    }

    Index vertex_of(Index node) {
        Index& vertex = vertex_of_node_[node];
        if (vertex < 0) {
            vertex = made_.mesh.n_vertices();
            made_.mesh.vertices.push_back(position(node));
        }
        return vertex;
    }

    /// All z alike, compared with the extent.
    void check_plane() const {
        Eigen::Array3d low = Eigen::Array3d::Constant(largest_coordinate), high = -low;
        for (std::size_t i = 0; i < file_.nodes.size(); ++i) {
            if (vertex_of_node_[i] < 0) continue;
            const Eigen::Map<const Eigen::Array3d> x(file_.nodes[i].position.data());
            low = low.min(x), high = high.max(x);
        }
        const Eigen::Array3d extent = high - low;
        if (extent.z() > plane_tolerance * extent.maxCoeff())
            source_.fail(source_.at(), "this mesh does not lie in a plane z = const", "a body is meshed in the x-y plane");
    }

    void check_overlap() const {
        const auto found = find_overlap(made_.mesh);
        if (!found) return;
        const auto place = [&](Index t) {
            const Vec2 x = (made_.mesh.corner(t, 0) + made_.mesh.corner(t, 1) + made_.mesh.corner(t, 2)) / 3;
            char text[80];
            std::snprintf(text, sizeof text, "(%.6g, %.6g)", x.x(), x.y());
            return std::string(text);
        };
        source_.fail(source_.at(), "the triangle round " + place((*found)[0]) + " lies over the one round " + place((*found)[1]) + ", with which it shares no edge");
    }

    void find_edges_or_say_why() {
        try {
            find_edges(made_.mesh);
        } catch (const ShapeError&) {
            say_why_not();
            throw;
        }
    }

    /// Finds the first triangle of the file that lies on the same side of an edge as one before it.
    void say_why_not() const {
        struct Side {
            std::int64_t from, to;  // tags of nodes
            std::size_t triangle;
        };
        std::vector<Side> sides;
        for (std::size_t t = 0; t < file_.triangles.size(); ++t) {
            std::array<std::int64_t, 3> tags = file_.triangles[t].nodes;
            std::array<Vec2, 3> x;
            for (int k = 0; k < 3; ++k) x[k] = position(numbers_.of(tags[k], 0));
            if (cross(x[1] - x[0], x[2] - x[0]) < 0) std::swap(tags[1], tags[2]);
            for (int k = 0; k < 3; ++k) sides.push_back({tags[k], tags[(k + 1) % 3], t});
        }
        std::sort(sides.begin(), sides.end(),
                  [](const Side& a, const Side& b) { return std::tie(a.from, a.to, a.triangle) < std::tie(b.from, b.to, b.triangle); });
        const Side* first = nullptr;  // of a pair
        for (std::size_t i = 1; i < sides.size(); ++i) {
            const bool same = sides[i].from == sides[i - 1].from && sides[i].to == sides[i - 1].to;
            if (same && (!first || sides[i].triangle < first[1].triangle)) first = &sides[i - 1];
        }
        if (first) say_why_not(file_.triangles[first[0].triangle], file_.triangles[first[1].triangle], first->from, first->to);
    }

    void say_why_not(const GmshElement<3>& first, const GmshElement<3>& second, std::int64_t from, std::int64_t to) const {
        auto a = first.nodes, b = second.nodes;
        std::sort(a.begin(), a.end());
        std::sort(b.begin(), b.end());
        if (a == b && first.group != second.group)
            source_.fail(second.where, "this triangle is in two physical groups, `" + file_.group_name(2, first.group) + "` and `" +
                                           file_.group_name(2, second.group) + "`, and can have one material only");
        if (a == b) source_.fail(second.where, "this triangle is in the file twice");
        source_.fail(second.where, "this triangle and one before it overlap: both lie on the same side of the edge between the nodes " +
                                       std::to_string(from) + " and " + std::to_string(to));
    }

    const GmshSource& source_;
    const GmshFile& file_;
    const GmshNodeNumbers numbers_;
    std::vector<Index> vertex_of_node_;  // -1 for a node without triangles
    GmshMesh made_;
};

}  // namespace

GmshMesh read_gmsh(const std::string& bytes, const std::string& name) {
    GmshSource source(bytes, name);
    const GmshFile file = read_gmsh_file(source);
    return MeshMaker(source, file).make();
}

}  // namespace knap
