#include "model/make_ground.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "mesh/polygon.hpp"

#include <cmath>
#include <map>

namespace knap {
namespace {

constexpr double same_gap = 1e-9;  // [-] of the edge

class GroundMaker {
public:
    explicit GroundMaker(const Model& model) : model_(model), mesh_(model.mesh) {}

    Ground make() {
        for (Index i = 0; i < static_cast<Index>(model_.interfaces.size()); ++i) {
            if (!on_support(i)) continue;
            const auto& [start, end] = model_.interfaces[i].vertex;  // the body lies to the left
            for (auto [at, vertex] : {std::pair(&starting_, start), {&ending_, end}}) {
                const auto [entry, is_new] = at->try_emplace(vertex, i);
                if (!is_new) entry->second = -1;  // several: bodies that touch in a point
            }
        }
        if (starting_.empty()) return {};
        ground_.of_point.assign(model_.n_points(), -1);
        for (Index i = 0; i < static_cast<Index>(model_.interfaces.size()); ++i)
            if (on_support(i)) start_of_[i] = add_face(start_place(i), i, model_.interfaces[i].vertex[1]);
        for (const auto& [i, start] : start_of_) {
            Index end = -1;
            if (const Index next = next_of(i); next >= 0) join(start, end = start_of_[next]);
            else end = end_polyline(i, start);
            if (previous_of(i) < 0) start_polyline(i, start);
            ground_.of_point[2 * i] = end, ground_.of_point[2 * i + 1] = start;
        }
        find_corners();
        return std::move(ground_);
    }

private:
    bool on_support(Index i) const { return model_.interfaces[i].triangle[0] == rigid_support; }

    /// [m] From the place of a vertex to the face of the ground, which lies apart by the gap.
    Vec2 away(const Interface& edge) const { return -edge.gap * edge.normal; }

    /// The polyline goes on from edge i to edge j, which has the mesh vertex between them.
    bool go_on(Index i, Index j) const {
        const Interface &a = model_.interfaces[i], &b = model_.interfaces[j];
        if (std::abs(cross(a.normal, b.normal)) > straight_on) return true;
        return a.normal.dot(b.normal) > 0 && std::abs(a.gap - b.gap) <= same_gap * a.length;
    }
    Index other(const std::map<Index, Index>& at, const std::map<Index, Index>& own, Index vertex) const {
        const auto found = at.find(vertex);
        return found == at.end() || own.at(vertex) < 0 ? -1 : found->second;
    }
    /// With the ground to the left: the edge of the body that ends where edge i starts.
    Index next_of(Index i) const {
        const Index j = other(ending_, starting_, model_.interfaces[i].vertex[0]);
        return j >= 0 && go_on(i, j) ? j : -1;
    }
    Index previous_of(Index i) const {
        const Index j = other(starting_, ending_, model_.interfaces[i].vertex[1]);
        return j >= 0 && go_on(j, i) ? j : -1;
    }

    /// N_i . d = -gap_i of both edges that meet there.
    Vec2 start_place(Index i) const {
        const Interface& edge = model_.interfaces[i];
        const Vec2& x = mesh_.vertices[edge.vertex[1]];
        const Index before = previous_of(i);
        if (before < 0) return x + away(edge);
        const Interface& other = model_.interfaces[before];
        const double sine = cross(edge.normal, other.normal);
        if (std::abs(sine) <= straight_on) return x + away(edge);
        return x + (edge.gap * turned_left(other.normal) - other.gap * turned_left(edge.normal)) / sine;
    }

    Index add(const Vec2& place, Index i, Index mesh_vertex) {
        ground_.vertices.push_back({.place = place, .law = model_.interfaces[i].law, .mesh_vertex = mesh_vertex});
        return static_cast<Index>(ground_.vertices.size()) - 1;
    }
    Index add_face(const Vec2& place, Index i, Index mesh_vertex) {
        const Index vertex = add(place, i, mesh_vertex);
        ground_.vertices[vertex].has_face = true;
        return vertex;
    }
    void join(Index from, Index to) { ground_.vertices[from].next = to, ground_.vertices[to].prev = from; }

    /// Calls visit(place) for the ends of the edges by which the ground goes on from x, as long as those of the body.
    template <class Visit>
    void go_beyond(Index i, const Vec2& x, const Vec2& along, const Visit& visit) const {
        const Interface& edge = model_.interfaces[i];
        const int n = static_cast<int>(std::ceil(edge.beyond / edge.length));
        if (n > 0) check_beyond(x, edge.beyond * along);
        for (int k = 1; k <= n; ++k) visit(Vec2(x + edge.beyond * k / n * along));
    }
    void check_beyond(const Vec2& x, const Vec2& path) const {
        const Vec2 from = x + 1e-6 * path;
        for (const BoundaryEdge& edge : mesh_.boundary_edges) {
            double position = 0;
            const Vec2 a = mesh_.corner(edge.triangle, edge.side), b = mesh_.corner(edge.triangle, (edge.side + 1) % 3);
            if (!segments_cross({from, x + path}, {a, b}, position)) continue;
            const Vec2 at = from + position * (x + path - from);
            throw UserError("overlap",
                            "the continuation of a support beyond its end at " + place_text(x) +
                                " runs into the body at " + place_text(at),
                            "a smaller `beyond`");
        }
    }

    /// With the ground to the left: N points from there to the body.
    static Vec2 along(const Interface& edge) { return turned_left(edge.normal); }

    /// Returns the vertex where edge i ends.
    Index end_polyline(Index i, Index start) {
        const Interface& edge = model_.interfaces[i];
        const Vec2 x = mesh_.vertices[edge.vertex[0]] + away(edge);
        const Index end = add(x, i, edge.vertex[0]);
        join(start, end);
        Index last = end;
        go_beyond(i, x, along(edge), [&](const Vec2& place) {
            ground_.vertices[last].has_face = true;
            const Index further = add(place, i, -1);
            join(last, further);
            last = further;
        });
        join(last, add(ground_.vertices[last].place - edge.length * edge.normal, i, -1));
        return end;
    }

    void start_polyline(Index i, Index start) {
        const Interface& edge = model_.interfaces[i];
        Index first = start;
        const Vec2 x = ground_.vertices[start].place;
        go_beyond(i, x, -along(edge), [&](const Vec2& place) {
            const Index further = add_face(place, i, -1);
            join(further, first);
            first = further;
        });
        join(add(ground_.vertices[first].place - edge.length * edge.normal, i, -1), first);
    }

    void find_corners() {
        for (GroundVertex& at : ground_.vertices) {
            if (at.prev < 0 || at.next < 0) continue;
            const Vec2 in = (at.place - ground_.vertices[at.prev].place).normalized(),
                       out = (ground_.vertices[at.next].place - at.place).normalized();
            at.convex = cross(in, out) > Polyline::flat;
        }
    }

    const Model& model_;
    const Mesh& mesh_;
    std::map<Index, Index> starting_, ending_;  // of mesh vertices: the interface whose edge starts or ends there
    std::map<Index, Index> start_of_;           // of interfaces: the vertex of the ground where they start
    Ground ground_;
};

}  // namespace

Ground make_ground(const Model& model) { return !model.faces_meet() ? Ground{} : GroundMaker(model).make(); }

std::vector<Obstacle> obstacles_of_ground(const Model& model) {
    std::vector<Obstacle> made;
    if (std::ranges::none_of(model.obstacles, [](const Obstacle& o) { return o.is_free(); })) return made;
    const std::vector<GroundVertex>& vertices = model.ground.vertices;
    std::vector<std::uint8_t> done(vertices.size(), 0);
    const auto follows_alike = [&](Index a, Index b) {
        return a >= 0 && vertices[a].has_face && vertices[b].has_face && vertices[a].law == vertices[b].law;
    };
    const auto add = [&](Index first) {
        std::vector<Vec2> points{vertices[first].place};
        Index at = first;
        do {
            done[at] = 1;
            points.push_back(vertices[vertices[at].next].place);
        } while (follows_alike(at, vertices[at].next) && !done[at = vertices[at].next]);
        const CohesiveLaw& law = model.laws[vertices[first].law];
        Obstacle& obstacle = made.emplace_back();
        obstacle.name = "a support";
        obstacle.outline = {.kind = Outline::Kind::polyline, .points = points};
        obstacle.outline.line = std::make_shared<const Polyline>(points);
        obstacle.contact = {.friction = law.friction, .restitution = law.restitution, .gives_restitution = true};
    };
    const auto n = static_cast<Index>(vertices.size());
    for (Index v = 0; v < n; ++v)  // where a stretch begins
        if (vertices[v].has_face && !follows_alike(vertices[v].prev, v)) add(v);
    for (Index v = 0; v < n; ++v)  // round a hole
        if (vertices[v].has_face && !done[v]) add(v);
    return made;
}

}  // namespace knap
