#include "stepper/contact/nearby_pieces.hpp"

#include "mesh/polygon.hpp"
#include "model/obstacle.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

constexpr double kept_list = 0.25;   // [-] of an edge: by which pieces move until the list of a pair is made anew
constexpr double turned_list = 0.1;  // [rad] likewise
constexpr double prolonged = 1.25;   // [-] points of prolonged edges, over the radius of a piece
constexpr double handed_on = 0.1;    // [-] of an edge, in a step: what contacts may add (RigidContacts::misses)
constexpr double reach_margin = NearbyEdges::reach_margin;
constexpr double motion_margin = NearbyEdges::motion_margin / 2;  // relative motions are of two

}  // namespace

void NearbyPieces::read(std::span<const FreeEdge> edges, std::span<const Vec2> undeformed, const FrozenBody& body) {
    const std::size_t ground = body.pieces.size();
    const auto piece_of = [&](const FreeEdge& edge) {
        return edge.ground ? ground : static_cast<std::size_t>(body.piece_of_triangle[edge.start / 3]);
    };
    const auto along = [&](Index e) -> Vec2 {
        return undeformed[edges[e].end_place] - undeformed[edges[e].start_place];
    };
    outlines_.assign(ground + 1, {});
    for (std::size_t p = 0; p < ground; ++p) outlines_[p].radius = body.pieces[p].radius;
    std::vector<std::uint8_t> touches(edges.size());
    for (Index e = 0; e < std::ssize(edges); ++e) {
        Outline& outline = outlines_[piece_of(edges[e])];
        touches[e] = NearbyEdges::is_vertex(edges, e);
        ++outline.last_edge, outline.last_vertex += touches[e];
        outline.longest = std::max(outline.longest, along(e).norm());
    }
    Index n_edges = 0, n_vertices = 0;
    for (Outline& outline : outlines_) {
        outline.first_edge = std::exchange(n_edges, n_edges + outline.last_edge);
        outline.first_vertex = std::exchange(n_vertices, n_vertices + outline.last_vertex);
        outline.last_edge = outline.first_edge, outline.last_vertex = outline.first_vertex;
    }
    edges_.resize(n_edges), vertices_.resize(n_vertices);
    for (Index e = 0; e < std::ssize(edges); ++e) {
        Outline& outline = outlines_[piece_of(edges[e])];
        edges_[outline.last_edge++] = e;
        if (touches[e]) vertices_[outline.last_vertex++] = e;
    }
    order_.clear();
    for (std::size_t p = 0; p < outlines_.size(); ++p)
        if (outlines_[p].last_edge > outlines_[p].first_edge) order_.push_back(static_cast<Index>(p));
    pairs_.clear(), before_.clear();
}

void NearbyPieces::find_boxes(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners,
                              std::span<const RigidPiece> pieces, AddedRates added, double h) {
    Vec2 mean = Vec2::Zero();  // velocity: what the pieces have in common brings none nearer to another one
    for (const RigidPiece& piece : pieces) mean += piece.velocity / static_cast<double>(pieces.size());
    boxes_.resize(outlines_.size());
    for (const Index p : order_) {
        const Outline& outline = outlines_[p];
        Box& box = boxes_[p] = {Vec2::Constant(infinity), Vec2::Constant(-infinity),
                                (touching_part + handed_on) * outline.longest};
        double fastest = 0;  // [m/s] of the corners
        for (Index k = outline.first_edge; k < outline.last_edge; ++k)
            for (const Index end : {edges[edges_[k]].start_place, edges[edges_[k]].end_place}) {
                box.low = box.low.cwiseMin(corners[end].x), box.high = box.high.cwiseMax(corners[end].x);
                fastest = std::max(fastest, (corners[end].v - mean).squaredNorm());
            }
        const bool is_rigid = p < std::ssize(pieces) && pieces[p].state != PieceState::deformable;
        box.room +=
            h * (is_rigid ? (pieces[p].velocity - mean).norm() + prolonged * std::abs(pieces[p].spin) * outline.radius
                          : std::sqrt(fastest));
        for (const std::vector<Vec3>& rates : added)
            if (p < std::ssize(rates)) box.room += h * largest_speed(rates[p], prolonged * outline.radius);
    }
}

/// The pairs whose boxes overlap, with the lists that they had before.
void NearbyPieces::find_pairs() {
    Vec2 low = Vec2::Constant(infinity), high = -low;
    for (const Index p : order_) low = low.cwiseMin(boxes_[p].low), high = high.cwiseMax(boxes_[p].low);
    const int axis = (high - low).y() > (high - low).x() ? 1 : 0;
    const auto start = [&](Index p) { return boxes_[p].low[axis] - boxes_[p].room; };
    for (std::size_t k = 1; k < order_.size(); ++k)  // hardly anything changes between two steps
        for (std::size_t m = k; m > 0 && start(order_[m]) < start(order_[m - 1]); --m)
            std::swap(order_[m], order_[m - 1]);
    near_.clear();
    for (std::size_t k = 0; k < order_.size(); ++k)
        for (std::size_t m = k + 1; m < order_.size(); ++m) {
            const Index p = order_[k], q = order_[m];
            const Box &one = boxes_[p], &two = boxes_[q];
            const double room = one.room + two.room;
            if (two.low[axis] - two.room > one.high[axis] + one.room) break;
            if (two.low[1 - axis] > one.high[1 - axis] + room || one.low[1 - axis] > two.high[1 - axis] + room)
                continue;
            const bool is_first =
                outlines_[p].radius > outlines_[q].radius || (outlines_[p].radius == outlines_[q].radius && p < q);
            near_.push_back(is_first ? std::array{p, q} : std::array{q, p});
        }
    std::ranges::sort(near_);
    pairs_.swap(before_);
    pairs_.resize(near_.size());
    auto old = before_.begin();
    for (std::size_t n = 0; n < near_.size(); ++n) {
        while (old != before_.end() && old->of < near_[n]) ++old;
        if (old != before_.end() && old->of == near_[n]) std::swap(pairs_[n], *old++);
        else pairs_[n].of = near_[n], pairs_[n].margin = -1;
    }
}

void NearbyPieces::find(std::span<const FreeEdge> edges, std::span<const CornerMotion> corners,
                        std::span<const RigidPiece> pieces, AddedRates added, double h) {
    find_boxes(edges, corners, pieces, added, h);
    find_pairs();
    passing_ = {};
    const RigidPiece still;
    const auto piece = [&](Index p) -> const RigidPiece& { return p < std::ssize(pieces) ? pieces[p] : still; };
    for (Pair& pair : pairs_) {
        const RigidPiece &one = piece(pair.of[0]), &two = piece(pair.of[1]);
        const double radius = prolonged * outlines_[pair.of[1]].radius,
                     longest = std::max(outlines_[pair.of[0]].longest, outlines_[pair.of[1]].longest);
        const Vec2 between = two.centre - one.centre, offset = Rotation::by(one.angle).turned_back(between);
        const double turn = two.angle - one.angle;
        const auto relative_speed = [&](const Vec3& of_one, const Vec3& of_two) {
            const Vec3 relative = of_two - of_one;
            return (relative.head<2>() - of_one.z() * turned_left(between)).norm() + std::abs(relative.z()) * radius;
        };
        double speed = relative_speed(one.rates(), two.rates());
        for (const std::vector<Vec3>& rates : added) {
            const auto of = [&](Index p) -> Vec3 { return p < std::ssize(rates) ? rates[p] : Vec3::Zero(); };
            speed += relative_speed(of(pair.of[0]), of(pair.of[1]));
        }
        pair.reach = std::min((touching_part + handed_on) * longest + h * speed,
                              boxes_[pair.of[0]].room + boxes_[pair.of[1]].room);
        const bool deforms = one.state == PieceState::deformable || two.state == PieceState::deformable;
        if (deforms) pair.reach = boxes_[pair.of[0]].room + boxes_[pair.of[1]].room;
        else
            passing_.at_least({h * speed / std::min(outlines_[pair.of[0]].longest, outlines_[pair.of[1]].longest),
                               (pair.of[1] < std::ssize(pieces) ? two : one).centre});
        const double moved = (offset - pair.offset).norm() + std::abs(turn - pair.turn) * radius;
        if (!deforms && reach_margin * pair.reach + motion_margin * moved <= pair.margin &&
            std::abs(turn - pair.turn) <= turned_list)
            continue;
        pair.offset = offset, pair.turn = turn;
        pair.margin = reach_margin * pair.reach + motion_margin * kept_list * longest;
        search(pair, edges, corners);
    }
}

void NearbyPieces::search(Pair& pair, std::span<const FreeEdge> edges, std::span<const CornerMotion> corners) const {
    pair.near.clear();
    const auto start = [&](Index e) -> const Vec2& { return corners[edges[e].start_place].x; };
    const auto end = [&](Index e) -> const Vec2& { return corners[edges[e].end_place].x; };
    for (const int k : {0, 1}) {
        const Outline &with_vertices = outlines_[pair.of[k]], &with_edges = outlines_[pair.of[1 - k]];
        const Box& box = boxes_[pair.of[k]];
        for (Index m = with_edges.first_edge; m < with_edges.last_edge; ++m) {
            const Index e = edges_[m];
            const FreeEdge& edge = edges[e];
            const double far = edge.depth + pair.margin;
            const Vec2 low = start(e).cwiseMin(end(e)), high = start(e).cwiseMax(end(e));
            if (((low - box.high).array() > far).any() || ((box.low - high).array() > far).any()) continue;
            const Vec2 n = placed_edge(start(e), end(e)).outward;
            for (Index v = with_vertices.first_vertex; v < with_vertices.last_vertex; ++v) {
                const Index i = vertices_[v];
                const Vec2 x = 0.5 * (end(edges[i].entering) + start(i)), from_a = x - start(e);
                if (n.dot(from_a) > pair.margin) continue;
                if (distance_to_segment(start(e), end(e), x) > far || !NearbyEdges::may_meet(edges, i, e)) continue;
                const Vec2 in = end(edges[i].entering) - start(edges[i].entering), out = end(i) - start(i);
                const double turn = cross(in, out), beside = in.dot(out);
                if (beside >= 0 && turn <= even_turn * in.norm() * out.norm()) continue;
                if (n.dot(in) > (VertexCone::widened + turned_list) * in.norm() ||
                    n.dot(out) < -(VertexCone::widened + turned_list) * out.norm())
                    continue;
                pair.near.push_back({i, e});
            }
        }
    }
}

}  // namespace knap
