#include "mesh/refine.hpp"

#include "base/random.hpp"
#include "mesh/constrained_delaunay.hpp"
#include "mesh/edge_graph.hpp"
#include "mesh/edge_labels.hpp"
#include "mesh/poisson_discs.hpp"
#include "mesh/relax.hpp"
#include "mesh/triangle_locator.hpp"

#include <cmath>
#include <list>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

namespace knap {
namespace {

using delaunay::Face, delaunay::Point, delaunay::position, delaunay::Vertex;
using Delaunay = delaunay::Triangulation;

constexpr double too_large = 1.25;          // [-] circumradius over the Poisson radius, where sizes may still fall
constexpr double too_large_finest = 1.1;    // [-] likewise at the smallest requested size: no later patch refines them
constexpr double cell = 0.36;               // [-] area of one dart over the square of the Poisson radius
constexpr double spread = 0.15;             // [-] of the factors of discs
constexpr int n_rounds = 12, n_misses = 8;  // of darts; and misses in succession after which a triangle is full
constexpr double min_distance = 0.6;        // [-] of a circumcentre from other vertices, over the Poisson radius
constexpr double min_angle = 20;            // [degree] that the refinement asks for
constexpr int n_passes = 12;                // over triangles that are too large or too flat
constexpr int n_attempts = 6;               // to leave out the vertices of triangles that are not allowed

double circumradius_of(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b - a).norm() * (c - b).norm() * (a - c).norm() / (2 * cross(b - a, c - a));
}

double size_at(const Refinement& requested, const Mesh& mesh, const Place& at) {  // [m]
    double size = 0;
    for (int k = 0; k < 3; ++k) size += at.weight[k] * requested.size[mesh.triangles[at.triangle][k]];
    return size;
}

double radius_of(const Refinement& requested, const Mesh& mesh, Index triangle) {  // [m]
    return radius_per_size * size_at(requested, mesh, {triangle, {1. / 3, 1. / 3, 1. / 3}});
}

/// Those that may change, ascending.
std::vector<Index> too_large_triangles(const Mesh& mesh, const Refinement& requested) {
    std::vector<Index> found;
    const auto [finest, coarsest] = std::ranges::minmax(requested.size);
    for (Index t = 0; t < mesh.n_triangles(); ++t) {
        const double radius = radius_of(requested, mesh, t);
        const bool is_final = finest < coarsest && radius <= 1.01 * finest * radius_per_size;
        if (!requested.frozen[t] && circumradius(mesh, t) > (is_final ? too_large_finest : too_large) * radius)
            found.push_back(t);
    }
    return found;
}

/// The triangles of one piece that are replaced. Its points are numbered: old vertices, points on lines, free points.
class Patch {
public:
    /// `triangles`: ascending. Takes random numbers from where `random` is.
    Patch(const Mesh& mesh, const Refinement& requested, const std::vector<Index>& triangles, const Random& random)
        : mesh_(mesh), requested_(requested), random_(random), triangles_(triangles), old_(mesh, triangles) {
        number_points();
        find_lines();
    }

    const std::vector<Index>& triangles() const { return triangles_; }
    const Random& random() const { return random_; }
    /// The old triangles where new ones are not allowed, to be kept; none: the patch is filled.
    std::vector<Index> fill();
    /// Puts the points and the new triangles behind those that stay.
    void add_to(RefinedMesh& found);
    /// Calls set(a, b, label) with numbers of vertices that add_to gave.
    void for_each_line(const auto& set) const {
        for (const Line& line : lines_) set(vertex_of_[line.from], vertex_of_[line.to], line.label);
    }

private:
    /// Material and grain.
    std::pair<Index, Index> label_of(Index triangle) const {
        return {mesh_.region[triangle], mesh_.grain.empty() ? -1 : mesh_.grain[triangle]};
    }
    /// Along the sides of old triangles, that triangle to the left; by numbers of points.
    struct Line {
        Index from, to;
        Index triangle;
        EdgeLabel label;
    };

    void number_points();
    void find_lines();
    void divide(const Line& line);
    void triangulate();
    void throw_darts();
    bool refine_worst();
    Vertex insert(const Vec2& p, double factor, Face near);
    void mark_inside();
    Mesh inside();
    void relax(Mesh& part);
    std::vector<Index> triangles_at(const std::vector<std::uint8_t>& points) const;
    bool has_room(const Vec2& p, double radius, double factor, Face near) const;

    double radius_at(const Place& at) const { return radius_per_size * size_at(requested_, mesh_, at); }  // [m]

    const Mesh& mesh_;
    const Refinement& requested_;
    Random random_;
    const std::vector<Index> triangles_;     // ascending
    std::vector<std::uint8_t> in_patch_;     // [0/1] per triangle of the mesh before
    std::vector<Index> old_vertices_;        // their points are the first ones, in this order
    std::vector<Index> number_;              // per vertex of the mesh before: its point, or -1
    std::vector<Index> vertex_of_;           // per point: its vertex behind those of the mesh before
    std::vector<Line> lines_;                // the outline of the patch, and lines within; divided
    std::unordered_set<std::uint64_t> rim_;  // directed_key of the lines around the patch, which is to their left
    std::size_t n_fixed_ = 0;                // old vertices and points on lines
    std::vector<char> on_line_;              // [0/1] per point
    std::vector<Vec2> points_;               // [m]
    std::vector<Place> places_;              // per point
    std::vector<double> factor_;             // [-] per point, of its disc
    std::vector<Index> neighbour_;           // per point: an earlier one beside it; -1: the one before it
    const TriangleLocator old_;
    Delaunay fine_;
    Mesh part_;  // the new triangles, its vertices are the points
};

void Patch::number_points() {
    in_patch_.assign(mesh_.n_triangles(), 0);
    number_.assign(mesh_.n_vertices(), -1);
    for (const Index t : triangles_) {
        in_patch_[t] = 1;
        for (const Index v : mesh_.triangles[t]) {
            if (number_[v] >= 0) continue;
            number_[v] = static_cast<Index>(points_.size());
            old_vertices_.push_back(v);
            points_.push_back(mesh_.vertices[v]), places_.push_back({});
        }
    }
}

/// Lines: between materials, joints, the border of the body, which are divided, and the sides towards triangles that
/// stay, which are not.
void Patch::find_lines() {
    const auto line = [&](Index triangle, Index side, const EdgeLabel& label) -> Line {
        const auto [a, b] = mesh_.side_vertices(triangle, side);
        return {number_[a], number_[b], triangle, label};
    };
    for (const InteriorEdge& edge : mesh_.interior_edges) {
        const bool first = in_patch_[edge.triangle[0]], second = in_patch_[edge.triangle[1]];
        if (!first && !second) continue;
        const int own = first ? 0 : 1;
        const Line found = line(edge.triangle[own], edge.side[own], {.joint = edge.joint, .cracked = edge.cracked});
        if (first != second) {
            lines_.push_back(found);
            rim_.insert(directed_key(found.from, found.to));
        } else if (edge.joint >= 0 || label_of(edge.triangle[0]) != label_of(edge.triangle[1])) {
            divide(found);
        }
    }
    for (const BoundaryEdge& edge : mesh_.boundary_edges) {
        if (!in_patch_[edge.triangle]) continue;
        const std::size_t first = lines_.size();
        divide(line(edge.triangle, edge.side, {.boundary = edge.boundary}));
        for (std::size_t i = first; i < lines_.size(); ++i) rim_.insert(directed_key(lines_[i].from, lines_[i].to));
    }
    n_fixed_ = points_.size();
    factor_.assign(n_fixed_, 1);
    neighbour_.assign(n_fixed_, -1);
    on_line_.assign(n_fixed_, 0);
    for (const Line& line : lines_) on_line_[line.from] = on_line_[line.to] = 1;
}

/// Into random pieces of the local radius.
void Patch::divide(const Line& line) {
    const Vec2 a = points_[line.from], b = points_[line.to];
    const auto radius = [&](Index point) { return radius_per_size * requested_.size[old_vertices_[point]]; };
    const auto& corners = mesh_.triangles[line.triangle];
    const auto corner = [&](Index point) { return std::ranges::find(corners, old_vertices_[point]) - corners.begin(); };
    Index from = line.from;
    for (const double x : pieces_along((b - a).norm(), radius(line.from), radius(line.to), random_)) {
        Place place{.triangle = line.triangle};
        place.weight[corner(line.from)] = 1 - x, place.weight[corner(line.to)] = x;
        const Index to = static_cast<Index>(points_.size());
        points_.push_back(a + x * (b - a)), places_.push_back(place);
        lines_.push_back({from, to, line.triangle, line.label});
        from = to;
    }
    lines_.push_back({from, line.to, line.triangle, line.label});
}

/// The lines and all points.
void Patch::triangulate() {
    fine_.clear();
    std::vector<Vertex> vertex;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const Index near = neighbour_[i] >= 0 ? neighbour_[i] : static_cast<Index>(i) - 1;
        vertex.push_back(fine_.insert(delaunay::point(points_[i]), near >= 0 ? vertex[near]->face() : Face()));
        vertex.back()->info().value = static_cast<Index>(i);
    }
    for (const Line& line : lines_) fine_.insert_constraint(vertex[line.from], vertex[line.to]);
}

/// No vertex within the disc, and not in the diametral circle of a piece of a line. The nearest vertex of a Delaunay
/// triangulation is on the rim of the triangles whose circumcircles contain the point.
bool Patch::has_room(const Vec2& p, double radius, double factor, Face near) const {
    std::vector<Delaunay::Edge> rim;
    fine_.get_boundary_of_conflicts(delaunay::point(p), std::back_inserter(rim), near);
    for (const auto& [face, i] : rim) {
        const Vertex a = face->vertex(Delaunay::ccw(i)), b = face->vertex(Delaunay::cw(i));
        for (const Vertex& v : {a, b}) {
            if (fine_.is_infinite(v)) continue;
            const Index number = v->info().value;
            const bool on_line = number < static_cast<Index>(n_fixed_);
            const double apart = radius * (on_line ? factor : factor * 0.5 * (factor + factor_[number]));
            if ((position(v) - p).norm() < apart) return false;
        }
        if (face->is_constrained(i) && (position(a) - p).dot(position(b) - p) < 0) return false;
    }
    return !rim.empty();
}

Vertex Patch::insert(const Vec2& p, double factor, Face near) {
    neighbour_.push_back(std::max(near->vertex(0)->info().value, near->vertex(1)->info().value));  // infinite: -1
    const Vertex vertex = fine_.insert(delaunay::point(p), near);
    vertex->info().value = static_cast<Index>(points_.size());
    points_.push_back(p), places_.push_back({}), factor_.push_back(factor), on_line_.push_back(0);
    return vertex;
}

void Patch::throw_darts() {
    std::vector<int> misses(triangles_.size(), 0);
    std::vector<std::vector<Vec2>> within(triangles_.size());  // points of each triangle
    Face near;
    for (int round = 0; round < n_rounds; ++round)
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            const Index t = triangles_[i];
            const auto is_crowded = [&](const Vec2& p, double distance) {
                return std::ranges::any_of(within[i],
                                           [&](const Vec2& q) { return (q - p).squaredNorm() < distance * distance; });
            };
            const double radius = radius_of(requested_, mesh_, t), n_darts = mesh_.area(t) / (cell * radius * radius);
            for (auto n = static_cast<int>(n_darts + random_.uniform()); n > 0 && misses[i] < n_misses; --n) {
                double u = random_.uniform(), v = random_.uniform();
                if (u + v > 1) u = 1 - u, v = 1 - v;
                const double factor = random_.uniform(1 - spread, 1 + spread);
                const Vec2 a = mesh_.corner(t, 0), p = a + u * (mesh_.corner(t, 1) - a) + v * (mesh_.corner(t, 2) - a);
                const double at = radius_at({t, {1 - u - v, u, v}});
                ++misses[i];
                // nearer to one of them than has_room allows for any: no need to look for the others
                if (is_crowded(p, 0.999 * at * factor * std::min(1.0, 0.5 * (factor + 1 - spread)))) continue;
                near = fine_.locate(delaunay::point(p), near);
                if (!has_room(p, at, factor, near)) continue;
                near = insert(p, factor, near)->face();
                within[i].push_back(p);
                misses[i] = 0;
            }
        }
}

/// Marks the triangles of the patch: those that are reached from the left of its rim.
void Patch::mark_inside() {
    const auto has_rim = [&](const Face& face, int i) {  // the face to the left
        const auto number = [&](int k) { return face->vertex(k)->info().value; };
        return face->is_constrained(i) &&
               rim_.contains(directed_key(number(Delaunay::ccw(i)), number(Delaunay::cw(i))));
    };
    std::vector<Face> front;
    for (const Face face : fine_.all_face_handles()) face->set_in_domain(false);
    for (const Face face : fine_.finite_face_handles()) {
        if (!has_rim(face, 0) && !has_rim(face, 1) && !has_rim(face, 2)) continue;
        face->set_in_domain(true), front.push_back(face);
    }
    while (!front.empty()) {
        const Face face = front.back();
        front.pop_back();
        for (int i = 0; i < 3; ++i) {
            const Face next = face->neighbor(i);
            if (next->is_in_domain() || has_rim(face, i)) continue;
            next->set_in_domain(true), front.push_back(next);
        }
    }
}

/// One pass: circumcentres of the triangles that are too large or too flat, worst first. False: there were none.
bool Patch::refine_worst() {
    struct Bad {
        double quality;  // below 1
        Vec2 centre;
        Vertex corner;
    };
    std::vector<Bad> bad;
    mark_inside();
    for (const Face face : fine_.finite_face_handles()) {
        if (!face->is_in_domain()) continue;
        const Vec2 a = position(face->vertex(0)), b = position(face->vertex(1)), c = position(face->vertex(2));
        const Place middle = old_.place_of((a + b + c) / 3);
        if (middle.triangle < 0) continue;
        const double R = circumradius_of(a, b, c),
                     sine = std::min({(b - a).norm(), (c - b).norm(), (a - c).norm()}) / (2 * R),
                     quality = std::min(radius_at(middle) / R, sine / std::sin(min_angle * std::numbers::pi / 180));
        if (quality >= 1) continue;
        const Point centre = fine_.circumcenter(face);
        bad.push_back({quality, {centre.x(), centre.y()}, face->vertex(0)});
    }
    std::ranges::stable_sort(bad, {}, &Bad::quality);
    bool refined = false;
    for (const auto& [quality, centre, corner] : bad) {
        const Place place = old_.place_of(centre);
        if (place.triangle < 0) continue;
        const Face near = fine_.locate(delaunay::point(centre), corner->face());
        if (!has_room(centre, radius_at(place), min_distance, near)) continue;
        insert(centre, 1, near);
        refined = true;
    }
    return refined;
}

/// The triangles of the patch.
Mesh Patch::inside() {
    mark_inside();
    Mesh part;
    part.vertices = points_;
    for (const Face face : fine_.finite_face_handles()) {
        if (!face->is_in_domain()) continue;
        std::array<Index, 3> corners{};
        for (int k = 0; k < 3; ++k) corners[k] = face->vertex(k)->info().value;
        part.triangles.push_back(corners);
    }
    return part;
}

/// Points on lines stay. Only the smallest requested size matters for the step; where edges grow, large triangles may
/// be of any shape but flat.
void Patch::relax(Mesh& part) {
    const double smallest = std::ranges::min(requested_.size);
    relax_worst(part, on_line_, smallest, QualityTarget(min_angle + 2));
    const auto is_at_home = [&](std::size_t i, const Vec2& x) {
        return i < old_vertices_.size() && mesh_.vertices[old_vertices_[i]] == x;
    };
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (on_line_[i]) continue;
        for (const Vec2& x : {part.vertices[i], points_[i]}) {
            part.vertices[i] = x;
            places_[i] = is_at_home(i, x) ? Place{} : old_.place_of(x);
            if (places_[i].triangle >= 0 || is_at_home(i, x)) break;
        }
    }
}

std::vector<Index> Patch::fill() {
    triangulate();
    throw_darts();
    for (int pass = 0; pass < n_passes && refine_worst();) ++pass;
    for (int attempt = 0; attempt < n_attempts; ++attempt) {
        part_ = inside();
        relax(part_);
        for (Index t = 0; t < part_.n_triangles(); ++t) {
            const Place place = old_.place_of(part_.centroid(t));
            const Index there = place.triangle < 0 ? triangles_.front() : place.triangle;
            part_.region.push_back(mesh_.region[there]);
            if (!mesh_.grain.empty()) part_.grain.push_back(mesh_.grain[there]);
        }
        std::vector<std::uint8_t> leave_out(points_.size(), 0);
        for (Index t = 0; t < part_.n_triangles(); ++t)
            if (!(part_.area(t) > 0) || (requested_.allowed && !requested_.allowed(part_, t)))
                leave_out[std::ranges::max(part_.triangles[t])] = 1;  // the newest
        if (std::ranges::count(leave_out, 1) == 0) return {};
        points_ = part_.vertices;  // the next attempt starts from the better places
        std::size_t n = n_fixed_;
        std::vector<Index> now(n_fixed_);  // numbers of the points, or of neighbours of those that are left out
        std::iota(now.begin(), now.end(), 0);
        for (std::size_t i = n_fixed_; i < points_.size(); ++i) {
            const Index neighbour = neighbour_[i] < 0 ? -1 : now[neighbour_[i]];
            now.push_back(leave_out[i] ? neighbour : static_cast<Index>(n));
            if (leave_out[i]) continue;
            points_[n] = points_[i], neighbour_[n] = neighbour, factor_[n++] = factor_[i];
        }
        if (n == points_.size() || attempt + 1 == n_attempts) return triangles_at(leave_out);
        points_.resize(n), places_.resize(n), factor_.resize(n), neighbour_.resize(n), on_line_.resize(n);
        triangulate();
    }
    return {};
}

/// The old triangles at some points.
std::vector<Index> Patch::triangles_at(const std::vector<std::uint8_t>& points) const {
    std::unordered_set<Index> at_places;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i] && places_[i].triangle >= 0) at_places.insert(places_[i].triangle);
    std::vector<Index> found;
    for (const Index t : triangles_) {
        const bool touches = std::ranges::any_of(mesh_.triangles[t], [&](Index v) { return points[number_[v]] != 0; });
        if (touches || at_places.contains(t)) found.push_back(t);
    }
    return found;
}

void Patch::add_to(RefinedMesh& found) {
    Mesh& mesh = found.mesh;
    vertex_of_ = old_vertices_;
    for (std::size_t i = 0; i < points_.size(); ++i) {
        if (i >= old_vertices_.size()) {
            vertex_of_.push_back(mesh.n_vertices());
            mesh.vertices.emplace_back(), found.origin.emplace_back();
        }
        mesh.vertices[vertex_of_[i]] = part_.vertices[i];
        found.origin[vertex_of_[i]].triangle = places_[i].triangle;
        found.origin[vertex_of_[i]].weight = places_[i].weight;
    }
    for (Index t = 0; t < part_.n_triangles(); ++t) {
        std::array<Index, 3> corners = part_.triangles[t];
        for (Index& v : corners) v = vertex_of_[v];
        mesh.triangles.push_back(corners), mesh.region.push_back(part_.region[t]);
        if (!mesh_.grain.empty()) mesh.grain.push_back(part_.grain[t]);
        found.triangle_before.push_back(-1);
    }
}

/// Each piece along a curve of its own, one after the other. `piece`: per triangle.
CurveOrder order_by_piece(Mesh& mesh, const std::vector<Index>& piece) {
    Mesh ordered;
    CurveOrder all{std::vector<Index>(mesh.vertices.size(), -1), {}};
    std::vector<Index> number(mesh.vertices.size(), -1);  // in its piece
    const Grouped<Index> triangles(std::ranges::max(piece) + 1, [&](const auto& visit) {
        for (Index t = 0; t < mesh.n_triangles(); ++t) visit(piece[t], t);
    });
    for (std::size_t p = 0; p < triangles.n_groups(); ++p) {
        Mesh own;
        std::vector<Index> vertices;
        for (const Index t : triangles[p]) {
            std::array<Index, 3> corners = mesh.triangles[t];
            for (Index& v : corners) {
                if (number[v] < 0)
                    number[v] = own.n_vertices(), vertices.push_back(v), own.vertices.push_back(mesh.vertices[v]);
                v = number[v];
            }
            own.triangles.push_back(corners), own.region.push_back(mesh.region[t]);
        }
        const CurveOrder order = order_along_curve(own);
        for (std::size_t v = 0; v < vertices.size(); ++v)
            all.vertex[vertices[v]] = ordered.n_vertices() + order.vertex[v];
        for (const Index t : order.triangle) all.triangle.push_back(triangles[p][t]);
        append(ordered, own);
    }
    mesh.vertices = std::move(ordered.vertices), mesh.triangles = std::move(ordered.triangles);
    mesh.region = std::move(ordered.region);
    return all;
}

/// The mesh `before` with the patches replaced.
RefinedMesh replaced(const Mesh& before, const std::vector<Index>& piece, std::list<Patch>& patches) {
    RefinedMesh found;
    Mesh& mesh = found.mesh;
    mesh.vertices = before.vertices;
    for (Index v = 0; v < before.n_vertices(); ++v) found.origin.push_back({.vertex = v});
    std::vector<Index> piece_now;
    std::vector<std::uint8_t> stays(before.triangles.size(), 1);
    for (const Patch& patch : patches)
        for (const Index t : patch.triangles()) stays[t] = 0;
    for (Index t = 0; t < before.n_triangles(); ++t) {
        if (!stays[t]) continue;
        mesh.triangles.push_back(before.triangles[t]), mesh.region.push_back(before.region[t]);
        if (!before.grain.empty()) mesh.grain.push_back(before.grain[t]);
        found.triangle_before.push_back(t), piece_now.push_back(piece[t]);
    }
    for (Patch& patch : patches) {
        patch.add_to(found);
        piece_now.resize(mesh.triangles.size(), piece[patch.triangles().front()]);
    }
    const std::vector<Index> grain = std::move(mesh.grain);
    const CurveOrder order = order_by_piece(mesh, piece_now);
    for (const Index t : order.triangle)
        if (!grain.empty()) mesh.grain.push_back(grain[t]);
    std::vector<VertexOrigin> origin(mesh.n_vertices());
    for (std::size_t v = 0; v < order.vertex.size(); ++v)
        if (order.vertex[v] >= 0) origin[order.vertex[v]] = found.origin[v];
    found.origin = std::move(origin);
    std::vector<Index> triangle_before;
    for (const Index t : order.triangle) triangle_before.push_back(found.triangle_before[t]);
    found.triangle_before = std::move(triangle_before);

    EdgeLabels labels;
    const auto set = [&](Index a, Index b, const EdgeLabel& label) {
        labels.set({order.vertex[a], order.vertex[b]}, label);
    };
    for_each_label(before, [&](std::array<Index, 2> ends, const EdgeLabel& label) { set(ends[0], ends[1], label); });
    for (const Patch& patch : patches) patch.for_each_line(set);
    find_edges(mesh);
    mesh.boundary_names = before.boundary_names;
    labels.put_on(mesh);
    mesh.parts = refined_parts(before, mesh);
    return found;
}

}  // namespace

double circumradius(const Mesh& mesh, Index triangle) {
    return circumradius_of(mesh.corner(triangle, 0), mesh.corner(triangle, 1), mesh.corner(triangle, 2));
}

std::vector<MeshPart> refined_parts(const Mesh& before, const Mesh& after) {
    std::vector<MeshPart> parts = before.parts;
    if (parts.empty()) return parts;
    const std::vector<Index> old = pieces_of(before), now = pieces_of(after);  // ascending: bodies are consecutive
    for (auto& [name, first, n] : parts) {
        const auto begin = std::ranges::lower_bound(now, old[first]),
                   end = std::ranges::upper_bound(now, old[first + n - 1]);
        first = static_cast<Index>(begin - now.begin()), n = static_cast<Index>(end - begin);
    }
    return parts;
}

std::optional<RefinedMesh> refined(const Mesh& mesh, const Refinement& requested) {
    const std::vector<Index> piece = pieces_of(mesh), too_large = too_large_triangles(mesh, requested);
    const Grouped<Index> of_piece(std::ranges::max(piece) + 1, [&](const auto& visit) {
        for (const Index t : too_large) visit(piece[t], t);
    });
    Random random(requested.seed, "refine");
    std::list<Patch> patches;
    for (std::size_t p = 0; p < of_piece.n_groups(); ++p) {
        std::vector<Index> triangles(of_piece[p].begin(), of_piece[p].end());
        while (!triangles.empty()) {
            Patch& patch = patches.emplace_back(mesh, requested, triangles, random);
            const std::vector<Index> not_allowed = patch.fill();
            if (not_allowed.empty()) {
                random = patch.random();
                break;
            }
            patches.pop_back();
            std::erase_if(triangles, [&](Index t) { return std::ranges::binary_search(not_allowed, t); });
        }
    }
    if (patches.empty()) return std::nullopt;
    return replaced(mesh, piece, patches);
}

}  // namespace knap
