// Random points, their constrained Delaunay triangulation, and Delaunay refinement where that is not good enough.
// Source of the refinement: J. R. Shewchuk, "Delaunay refinement algorithms for triangular mesh generation", Comput.
// Geom. 22 (2002) 21.
#include "mesh/triangulate.hpp"

#include "mesh/constrained_delaunay.hpp"
#include "mesh/poisson_discs.hpp"
#include "mesh/relax.hpp"
#include "mesh/shape_graph.hpp"

#include <cmath>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <map>
#include <numbers>
#include <set>
#include <unordered_map>

namespace knap {
namespace {

using delaunay::Face, delaunay::Point, delaunay::position, delaunay::Vertex;
using Delaunay = delaunay::Triangulation;

/// A triangle is bad when a further point would fit into it (circumradius above the local radius), or for its smallest
/// angle. Interface as CGAL's mesher requires it.
struct Criteria {
    using Quality = double;  // below 1 is bad, and the smallest is refined first
    using Is_bad = Criteria;
    const Is_bad& is_bad_object() const { return *this; }

    CGAL::Mesh_2::Face_badness operator()(Quality q) const { return q < 1 ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD; }

    CGAL::Mesh_2::Face_badness operator()(const Face& face, Quality& q) const {
        const Vec2 a = position(face->vertex(0)), b = position(face->vertex(1)), c = position(face->vertex(2));
        const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
        const double circumradius = ab * bc * ca / (2 * cross(b - a, c - a));
        const double sin_smallest = std::min({ab, bc, ca}) / (2 * circumradius);
        q = std::min((*radius)((a + b + c) / 3) / circumradius, sin_smallest / sin_min_angle);
        return (*this)(q);
    }

    const SizeField* radius;
    double sin_min_angle;
};

/// The constrained Delaunay triangulation of a planar straight-line graph and of points in the body, refined.
class RefinedDelaunay {
public:
    /// Circumradii end below `radius` and angles above `min_angle` [degree], except in sharp corners of the lines.
    RefinedDelaunay(const PlanarGraph& lines, const std::vector<Vec2>& points, const SizeField& radius,
                    double min_angle)
        : lines_(lines) {
        insert_lines();
        const std::vector<Point> outside = points_outside();
        insert_points(points);
        // the refinement must end where it converges on a needle: many times the expected number
        const std::size_t max_vertices = 10 * (points.size() + lines.nodes.size()) + 10000;
        Criteria criteria{&radius, std::sin(min_angle * std::numbers::pi / 180)};
        CGAL::Delaunay_mesher_2<Delaunay, Criteria> mesher(delaunay_, criteria);
        mesher.set_seeds(outside.begin(), outside.end());
        mesher.init();
        while (!mesher.is_refinement_done()) {
            mesher.step_by_step_refine_mesh();
            if (delaunay_.number_of_vertices() > max_vertices)
                throw ShapeError("size", "the refinement does not end: the shape has details far below the mesh size");
        }
    }

    /// The triangles of the body. From here on `info` of a vertex is its number in the mesh.
    Mesh mesh() {
        Mesh mesh;
        for (const Vertex v : delaunay_.finite_vertex_handles()) v->info().value = -1;
        for (const Face face : delaunay_.finite_face_handles()) {
            if (!face->is_in_domain()) continue;
            std::array<Index, 3>& corners = mesh.triangles.emplace_back();
            for (int k = 0; k < 3; ++k) {
                Index& number = face->vertex(k)->info().value;
                if (number < 0) number = mesh.n_vertices(), mesh.vertices.push_back(position(face->vertex(k)));
                corners[k] = number;
            }
        }
        return mesh;
    }

    /// The edges of the mesh on lines, by its vertices, with the labels of their segments: walks along every segment,
    /// which the refinement may have split, always to the neighbour that lies straightest ahead.
    std::vector<GraphSegment> edges_on_lines() const {
        std::map<Index, std::vector<Vertex>> neighbours;
        for (const auto& [face, i] : delaunay_.finite_edges()) {
            if (!face->is_constrained(i)) continue;
            const Vertex a = face->vertex(Delaunay::cw(i)), b = face->vertex(Delaunay::ccw(i));
            neighbours[a->info().value].push_back(b);
            neighbours[b->info().value].push_back(a);
        }
        std::vector<GraphSegment> found;
        for (const GraphSegment& segment : lines_.segments) {
            Vertex here = vertices_[segment.from];
            const Vertex end = vertices_[segment.to];
            while (here != end) {
                const Vec2 ahead = position(end) - position(here);
                Vertex next;
                double best = -2;
                for (const Vertex& candidate : neighbours.at(here->info().value)) {
                    const Vec2 edge = position(candidate) - position(here);
                    const double straightness = ahead.dot(edge) / edge.norm();
                    if (straightness <= best * ahead.norm()) continue;
                    best = straightness / ahead.norm();
                    next = candidate;
                }
                found.push_back(segment);
                found.back().from = here->info().value, found.back().to = next->info().value;
                here = next;
                if (found.size() > delaunay_.number_of_vertices() + lines_.segments.size())
                    throw ShapeError("outer",
                                     "the mesh does not follow the lines of the shape: two of them are too "
                                     "near or too nearly parallel");
            }
        }
        return found;
    }

private:
    void insert_lines() {
        Face near;
        for (const Vec2& p : lines_.nodes) {
            vertices_.push_back(delaunay_.insert(Point(p.x(), p.y()), near));
            near = vertices_.back()->face();
            vertices_.back()->info().value = static_cast<Index>(vertices_.size()) - 1;
        }
        for (const GraphSegment& s : lines_.segments) delaunay_.insert_constraint(vertices_[s.from], vertices_[s.to]);
    }

    /// Points outside the body, some in every hole. Crossing a ring from outside leads in, and the next one out again;
    /// cracks and region borders change nothing.
    std::vector<Point> points_outside() const {
        std::set<std::uint64_t> on_ring;
        for (const GraphSegment& s : lines_.segments)
            if (s.ring >= 0) on_ring.insert(edge_key({s.from, s.to}));
        std::vector<Point> outside;
        std::vector<std::pair<Face, bool>> front{{delaunay_.infinite_face(), false}};
        std::set<Face> seen{delaunay_.infinite_face()};
        while (!front.empty()) {
            const auto [face, inside] = front.back();
            front.pop_back();
            if (!inside && !delaunay_.is_infinite(face)) {
                // where points of a slanted border bend it by rounding, the centroid of the needle there is in the body
                const Point centre = CGAL::centroid(delaunay_.triangle(face));
                if (delaunay_.triangle(face).has_on_bounded_side(centre)) outside.push_back(centre);
            }
            for (int i = 0; i < 3; ++i) {
                const Face next = face->neighbor(i);
                if (!seen.insert(next).second) continue;
                const Index a = face->vertex(face->cw(i))->info().value, b = face->vertex(face->ccw(i))->info().value;
                front.emplace_back(next, inside != on_ring.contains(edge_key({a, b})));
            }
        }
        return outside;
    }

    void insert_points(const std::vector<Vec2>& points) {
        std::vector<Point> sorted;
        for (const Vec2& p : points) sorted.emplace_back(p.x(), p.y());
        CGAL::spatial_sort(sorted.begin(), sorted.end(), delaunay_.geom_traits());
        Face near;
        for (const Point& p : sorted) near = delaunay_.insert(p, near)->face();
    }

    const PlanarGraph& lines_;
    Delaunay delaunay_;
    std::vector<Vertex> vertices_;  // per node of the lines
};

/// The segments in pieces of the local radius.
PlanarGraph divided(const PlanarGraph& graph, const SizeField& radius, Random& random) {
    PlanarGraph lines{graph.nodes, {}};
    for (const GraphSegment& segment : graph.segments) {
        const auto [a, b] = graph.line(segment);
        GraphSegment piece = segment;
        for (const Vec2& p : points_along(a, b, radius, random)) {
            piece.to = static_cast<Index>(lines.nodes.size());
            lines.nodes.push_back(p);
            lines.segments.push_back(piece);
            piece.from = piece.to;
        }
        piece.to = segment.to;
        lines.segments.push_back(piece);
    }
    return lines;
}

/// Boundary names, cracks and joints, from the segments that the edges lie on.
void label_edges(Mesh& mesh, const std::vector<GraphSegment>& on_lines, const Shape& shape) {
    std::unordered_map<std::uint64_t, const GraphSegment*> segment_of;
    for (const GraphSegment& edge : on_lines) segment_of[edge_key({edge.from, edge.to})] = &edge;
    const auto segment_at = [&](Index triangle, Index side) -> const GraphSegment* {
        const auto found = segment_of.find(edge_key(mesh.side_vertices(triangle, side)));
        return found == segment_of.end() ? nullptr : found->second;
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

void tag_regions(Mesh& mesh, const Shape& shape) {
    mesh.region.assign(mesh.triangles.size(), shape.tag);
    for (const Region& region : shape.regions)
        if (!region.only_line)
            for (const Index t : triangles_in(mesh, region.points)) mesh.region[t] = region.tag;
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
    const SizeField size(options, 1), radius(options, radius_per_size);
    const PlanarGraph graph = checked_graph(shape, options, 0.15 * size.smallest());
    Random random(options.seed, "mesh");
    const PlanarGraph lines = divided(graph, radius, random);
    Mesh mesh;
    std::vector<GraphSegment> on_lines;
    {
        const std::vector<Vec2> points = poisson_points(shape, lines.nodes, radius, random);
        RefinedDelaunay delaunay(lines, points, radius, options.min_angle);
        mesh = delaunay.mesh(), on_lines = delaunay.edges_on_lines();
    }
#ifdef __GLIBC__
    malloc_trim(0);  // 150 bytes a triangle in small pieces, which no later list would use
#endif
    std::vector<char> fixed(mesh.vertices.size(), 0);
    for (const GraphSegment& edge : on_lines) fixed[edge.from] = fixed[edge.to] = 1;
    relax_worst(mesh, fixed, size, QualityTarget(options.min_angle + 2));
    const std::vector<Index> number = order_along_curve(mesh).vertex;
    for (GraphSegment& edge : on_lines) edge.from = number[edge.from], edge.to = number[edge.to];
    tag_regions(mesh, shape);
    find_edges(mesh);
    label_edges(mesh, on_lines, shape);
    check_area(mesh, shape);
    return mesh;
}

}  // namespace knap
