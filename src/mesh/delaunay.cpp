// The only file that includes CGAL (its Mesh_2 package is GPL). Source of the method: J. R. Shewchuk, "Delaunay
// refinement algorithms for triangular mesh generation", Comput. Geom. 22 (2002) 21.
#include "mesh/delaunay.hpp"

#include "mesh/shape.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace knap {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Number {
    Index value = -1;  // also of the infinite vertex
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using FaceBase = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Delaunay = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;
using Point = Kernel::Point_2;

Vec2 position(const Delaunay::Vertex_handle& v) { return {v->point().x(), v->point().y()}; }

/// A triangle is bad when a further point would fit into it (circumradius above the local radius), or for its smallest
/// angle.
class Criteria {
public:
    Criteria(const SizeField& radius, double min_angle)
        : radius_(&radius), sin_min_angle_(std::sin(min_angle * std::numbers::pi / 180)) {}

    using Quality = double;  // below 1 is bad, and the smallest is refined first

    class Is_bad {
    public:
        explicit Is_bad(const Criteria& criteria) : criteria_(criteria) {}

        CGAL::Mesh_2::Face_badness operator()(Quality q) const {
            return q < 1 ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD;
        }

        CGAL::Mesh_2::Face_badness operator()(const Delaunay::Face_handle& face, Quality& q) const {
            const Vec2 a = position(face->vertex(0)), b = position(face->vertex(1)), c = position(face->vertex(2));
            const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
            const double circumradius = ab * bc * ca / (2 * cross(b - a, c - a));
            const double sin_smallest = std::min({ab, bc, ca}) / (2 * circumradius);
            q = std::min((*criteria_.radius_)((a + b + c) / 3) / circumradius, sin_smallest / criteria_.sin_min_angle_);
            return (*this)(q);
        }

    private:
        const Criteria& criteria_;
    };

    Is_bad is_bad_object() const { return Is_bad(*this); }

private:
    const SizeField* radius_;
    double sin_min_angle_;
};

/// Inserts the lines and nothing else; returns points outside the body, some in every hole.
std::vector<Point> insert_lines(Delaunay& delaunay, const Lines& lines,
                                std::vector<Delaunay::Vertex_handle>& vertices) {
    Delaunay::Face_handle near;
    for (const Vec2& p : lines.points) {
        vertices.push_back(delaunay.insert(Point(p.x(), p.y()), near));
        near = vertices.back()->face();
        vertices.back()->info().value = static_cast<Index>(vertices.size()) - 1;
    }
    std::set<std::uint64_t> on_ring;
    for (const Piece& piece : lines.pieces) {
        delaunay.insert_constraint(vertices[piece.from], vertices[piece.to]);
        if (piece.on_ring) on_ring.insert(edge_key(piece.from, piece.to));
    }

    // crossing a ring from outside leads in, and the next one out again; cracks and region borders change nothing
    std::vector<Point> outside;
    std::vector<std::pair<Delaunay::Face_handle, bool>> front{{delaunay.infinite_face(), false}};
    std::set<Delaunay::Face_handle> seen{delaunay.infinite_face()};
    while (!front.empty()) {
        const auto [face, inside] = front.back();
        front.pop_back();
        if (!inside && !delaunay.is_infinite(face)) {
            // where points of a slanted border bend it by rounding, the centroid of the needle beside it lies in the
            // body
            const Point centre = CGAL::centroid(delaunay.triangle(face));
            if (delaunay.triangle(face).has_on_bounded_side(centre)) outside.push_back(centre);
        }
        for (int i = 0; i < 3; ++i) {
            const Delaunay::Face_handle next = face->neighbor(i);
            if (!seen.insert(next).second) continue;
            const Index a = face->vertex(face->cw(i))->info().value, b = face->vertex(face->ccw(i))->info().value;
            front.emplace_back(next, inside != on_ring.contains(edge_key(a, b)));
        }
    }
    return outside;
}

void insert_points(Delaunay& delaunay, const std::vector<Vec2>& points) {
    std::vector<Point> sorted;
    for (const Vec2& p : points) sorted.emplace_back(p.x(), p.y());
    CGAL::spatial_sort(sorted.begin(), sorted.end(), delaunay.geom_traits());
    Delaunay::Face_handle near;
    for (const Point& p : sorted) {
        const Delaunay::Vertex_handle v = delaunay.insert(p, near);
        near = v->face();
    }
}

/// The refinement must not go on for ever where it converges on a needle: `max_vertices` is many times the number
/// expected.
void refine(Delaunay& delaunay, const std::vector<Point>& outside, Criteria& criteria, std::size_t max_vertices) {
    CGAL::Delaunay_mesher_2<Delaunay, Criteria> mesher(delaunay, criteria);
    mesher.set_seeds(outside.begin(), outside.end());
    mesher.init();
    while (!mesher.is_refinement_done()) {
        mesher.step_by_step_refine_mesh();
        if (delaunay.number_of_vertices() > max_vertices)
            throw ShapeError("size", "the refinement does not end: the shape has details far below the mesh size");
    }
}

/// The triangles of the body; from here on `info` of a vertex is its number in the mesh.
Mesh triangles_of_body(const Delaunay& delaunay) {
    Mesh mesh;
    for (auto v = delaunay.finite_vertices_begin(); v != delaunay.finite_vertices_end(); ++v) v->info().value = -1;
    for (auto face = delaunay.finite_faces_begin(); face != delaunay.finite_faces_end(); ++face) {
        if (!face->is_in_domain()) continue;
        std::array<Index, 3> corners;
        for (int k = 0; k < 3; ++k) {
            Index& number = face->vertex(k)->info().value;
            if (number < 0) {
                number = mesh.n_vertices();
                mesh.vertices.push_back(position(face->vertex(k)));
            }
            corners[k] = number;
        }
        mesh.triangles.push_back(corners);
    }
    return mesh;
}

/// Walks along every piece, which the refinement may have split: from its begin always to the neighbour straight ahead.
std::vector<LineEdge> edges_on_lines(const Delaunay& delaunay, const Lines& lines,
                                     const std::vector<Delaunay::Vertex_handle>& vertices) {
    std::map<Index, std::vector<Delaunay::Vertex_handle>> neighbours;
    for (auto edge = delaunay.finite_edges_begin(); edge != delaunay.finite_edges_end(); ++edge) {
        if (!delaunay.is_constrained(*edge)) continue;
        const auto a = edge->first->vertex(Delaunay::cw(edge->second)),
                   b = edge->first->vertex(Delaunay::ccw(edge->second));
        neighbours[a->info().value].push_back(b);
        neighbours[b->info().value].push_back(a);
    }
    std::vector<LineEdge> found;
    for (std::size_t i = 0; i < lines.pieces.size(); ++i) {
        Delaunay::Vertex_handle here = vertices[lines.pieces[i].from];
        const Delaunay::Vertex_handle end = vertices[lines.pieces[i].to];
        while (here != end) {
            const Vec2 ahead = position(end) - position(here);
            Delaunay::Vertex_handle next;
            double best = -2;
            for (const auto& candidate : neighbours.at(here->info().value)) {
                const Vec2 edge = position(candidate) - position(here);
                const double straightness = ahead.dot(edge) / edge.norm();
                if (straightness <= best * ahead.norm()) continue;
                best = straightness / ahead.norm();
                next = candidate;
            }
            found.push_back({here->info().value, next->info().value, lines.pieces[i].segment});
            here = next;
            if (found.size() > delaunay.number_of_vertices() + lines.pieces.size())
                throw ShapeError(
                    "outer",
                    "the mesh does not follow the lines of the shape: two of them are too near or too nearly parallel");
        }
    }
    return found;
}

}  // namespace

RefinedMesh refined_delaunay(const Lines& lines, const std::vector<Vec2>& points, const SizeField& radius,
                             double min_angle, std::size_t max_vertices) {
    Delaunay delaunay;
    std::vector<Delaunay::Vertex_handle> vertices;
    const std::vector<Point> outside = insert_lines(delaunay, lines, vertices);
    insert_points(delaunay, points);
    Criteria criteria(radius, min_angle);
    refine(delaunay, outside, criteria, max_vertices);
    Mesh mesh = triangles_of_body(delaunay);
    return {std::move(mesh), edges_on_lines(delaunay, lines, vertices)};
}

}  // namespace knap
