// Random points, their constrained Delaunay triangulation, and Delaunay refinement where that is not good enough.
#include "mesh/triangulate.hpp"

#include "mesh/check_shape.hpp"
#include "mesh/delaunay.hpp"
#include "mesh/poisson_discs.hpp"
#include "mesh/relax.hpp"

#include <cmath>
#include <unordered_map>

namespace knap {

namespace {

/// Poisson discs of this radius times the requested mean edge length give that mean edge length (measured).
constexpr double radius_per_size = 0.775;

Lines divide_lines(const PlanarGraph& graph, const SizeField& radius, Random& random) {
    Lines lines{graph.nodes, {}};
    for (Index s = 0; s < std::ssize(graph.segments); ++s) {
        const GraphSegment& segment = graph.segments[s];
        const bool on_ring = segment.ring >= 0;
        const auto [a, b] = graph.line(segment);
        Index last = segment.from;
        for (const Vec2& p : points_along(a, b, radius, random)) {
            const Index next = static_cast<Index>(lines.points.size());
            lines.points.push_back(p);
            lines.pieces.push_back({last, next, s, on_ring});
            last = next;
        }
        lines.pieces.push_back({last, segment.to, s, on_ring});
    }
    return lines;
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
    mesh.boundary_names = shape.boundary_names;
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
            const Vec2 centroid = mesh.centroid(t);
            if (box.contains(centroid) && contains(region.points, centroid)) mesh.region[t] = region.tag;
        }
    }
}

void check_area(const Mesh& mesh, const Shape& shape) {
    double total = 0;
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        if (!(mesh.area(t) > 0)) throw ShapeError("outer", "the mesh has a triangle without area");
        total += mesh.area(t);
    }
    if (!(std::abs(total - shape.area()) <= 1e-9 * shape.area()))
        throw ShapeError("outer", "the mesh does not fill the shape");
}

}  // namespace

Mesh triangulate(const Shape& shape, const MeshOptions& options) {
    check_shape(shape);
    check_sizes(shape, options);
    const SizeField size(options, 1), radius(options, radius_per_size);
    const PlanarGraph graph = planar_graph(shape, 0.15 * size.smallest());
    check_details(graph, options);
    Random random(options.seed, "mesh");
    const Lines lines = divide_lines(graph, radius, random);
    const std::vector<Vec2> points = poisson_points(shape, lines.points, radius, random);
    const std::size_t max_vertices = 10 * (points.size() + lines.points.size()) + 10000;
    auto [mesh, on_lines] = refined_delaunay(lines, points, radius, options.min_angle, max_vertices);
    std::vector<char> fixed(mesh.vertices.size(), 0);
    for (const LineEdge& edge : on_lines) fixed[edge.from] = fixed[edge.to] = 1;
    relax_worst(mesh, fixed, size, QualityTarget(options.min_angle + 2));
    const std::vector<Index> number = order_along_curve(mesh);
    for (LineEdge& edge : on_lines) edge.from = number[edge.from], edge.to = number[edge.to];
    tag_regions(mesh, shape.regions);
    find_edges(mesh);
    label_edges(mesh, on_lines, graph, shape);
    check_area(mesh, shape);
    return std::move(mesh);
}

}  // namespace knap
