// Random points, their constrained Delaunay triangulation, and Delaunay refinement where that is not good enough.
#include "geometry/triangulate.hpp"

#include "geometry/delaunay_refinement.hpp"
#include "geometry/mesh_limits.hpp"
#include "geometry/mesh_order.hpp"
#include "geometry/planar_graph.hpp"
#include "geometry/polygon.hpp"
#include "geometry/random_points.hpp"
#include "geometry/relax.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace knap {

namespace {

/// Poisson discs of this radius times the wanted mean edge length give that mean edge length (measured).
constexpr double radius_per_size = 0.775;

Lines cut_lines(const PlanarGraph& graph, const SizeField& radius, Random& random) {
    Lines lines{graph.nodes, {}};
    for (Index s = 0; s < static_cast<Index>(graph.segments.size()); ++s) {
        const GraphSegment& segment = graph.segments[s];
        const bool on_ring = segment.ring >= 0;
        Index last = segment.from;
        for (const Vec2& p : points_along(graph.nodes[segment.from], graph.nodes[segment.to], radius, random)) {
            const Index next = static_cast<Index>(lines.points.size());
            lines.points.push_back(p);
            lines.pieces.push_back({last, next, s, on_ring});
            last = next;
        }
        lines.pieces.push_back({last, segment.to, s, on_ring});
    }
    return lines;
}

std::uint64_t edge_key(Index a, Index b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | static_cast<std::uint32_t>(std::max(a, b));
}

/// Boundary names, cracks and joints, from the segments that the edges lie on.
void label_edges(Mesh& mesh, const std::vector<LineEdge>& on_lines, const PlanarGraph& graph, const Shape& shape) {
    std::unordered_map<std::uint64_t, Index> segment_of;
    for (const LineEdge& edge : on_lines) segment_of[edge_key(edge.from, edge.to)] = edge.segment;
    const auto segment_at = [&](Index triangle, Index side) -> const GraphSegment* {
        const auto& corners = mesh.triangles[triangle];
        const auto found = segment_of.find(edge_key(corners[side], corners[(side + 1) % 3]));
        return found == segment_of.end() ? nullptr : &graph.segments[found->second];
    };
    for (BoundaryEdge& edge : mesh.boundary_edges) {
        const GraphSegment* segment = segment_at(edge.triangle, edge.side);
        if (!segment || segment->ring < 0) throw ShapeError("outer", "the mesh does not follow the rings of the shape");
        edge.boundary = segment->boundary;
    }
    for (InteriorEdge& edge : mesh.interior_edges) {
        const GraphSegment* segment = segment_at(edge.triangle[0], edge.side[0]);
        if (!segment || segment->crack < 0) continue;
        edge.joint = shape.cracks[segment->crack].joint;
        edge.cracked = edge.joint < 0;
    }
}

void tag_regions(Mesh& mesh, const std::vector<Region>& regions) {
    mesh.region.assign(mesh.triangles.size(), 0);
    for (const Region& region : regions) {
        const Box box = bounding_box(region.points);
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const Vec2 centroid = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
            if (box.contains(centroid) && contains(region.points, centroid)) mesh.region[t] = region.tag;
        }
    }
}

std::vector<char> fixed_vertices(const Mesh& mesh, const std::vector<LineEdge>& on_lines) {
    std::vector<char> fixed(mesh.vertices.size(), 0);
    for (const LineEdge& edge : on_lines) fixed[edge.from] = fixed[edge.to] = 1;
    return fixed;
}

double area_of(const Shape& shape) {
    double area = std::abs(signed_area(shape.outer.points));
    for (const Ring& hole : shape.holes) area -= std::abs(signed_area(hole.points));
    return area;
}

void check_area(const Mesh& mesh, const Shape& shape) {
    double total = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        if (!(mesh.area(t) > 0)) throw ShapeError("outer", "the mesh has a triangle without area");
        total += mesh.area(t);
    }
    if (!(std::abs(total - area_of(shape)) <= 1e-9 * area_of(shape))) throw ShapeError("outer", "the mesh does not fill the shape");
}

}  // namespace

Mesh triangulate(const Shape& shape, const MeshOptions& options) {
    check_shape(shape);
    check_sizes(shape, area_of(shape), options);
    const PlanarGraph graph = planar_graph(shape, 0.15 * SizeField(options, 1).smallest());
    check_details(graph, options);
    const SizeField radius(options, radius_per_size);
    Random random(options.seed, "mesh");
    const Lines lines = cut_lines(graph, radius, random);
    const std::vector<Vec2> points = poisson_points(shape, lines.points, radius, random);
    auto [mesh, on_lines] =
        delaunay_refinement(lines, points, radius, options.min_angle, 10 * (points.size() + lines.points.size()) + 10000);
    relax_worst(mesh, fixed_vertices(mesh, on_lines), SizeField(options, 1), {.min_angle = options.min_angle + 2});
    const std::vector<Index> number = order_along_curve(mesh);
    for (LineEdge& edge : on_lines) {
        edge.from = number[edge.from];
        edge.to = number[edge.to];
    }
    tag_regions(mesh, shape.regions);
    find_edges(mesh);
    mesh.boundary_names = shape.boundary_names;
    label_edges(mesh, on_lines, graph, shape);
    check_area(mesh, shape);
    return mesh;
}

}  // namespace knap
