#include "stepper/common/obstacle_contacts.hpp"

#include "model/body_edges.hpp"

#include <cassert>
#include <numbers>

namespace knap {
namespace {

constexpr double almost_as_near = 0.05;         // [-] of an edge: both ends touch as near as a corner between them
constexpr double flat_arc = 8 * touching_part;  // [-] edge over radius: an arc rises by no more between its ends

/// The gap at x, or zero where it is rounding.
double cleared(double gap, const Vec2& x, const ObstacleSurface& surface) {
    return without_rounding(gap, x.norm() + surface.position().norm());
}

/// Of a polygon in its place, with room for rounding.
void find_box(const ObstacleSurface& surface, Vec2& low, Vec2& high) {
    if (surface.outline().kind != Outline::Kind::polygon) return;
    low = Vec2::Constant(infinity), high = -low;
    for (const Vec2& p : surface.outline().points) {
        const Vec2 x = surface.position() + surface.rotation().turned(p);
        low = low.cwiseMin(x), high = high.cwiseMax(x);
    }
    const Vec2 room = Vec2::Constant(relative_tolerance * (low.norm() + high.norm()));
    low -= room, high += room;
}

}  // namespace

ObstacleContacts::ObstacleContacts(const Model& model) : model_(model) {
    if (model.obstacles.empty()) return;
    const Mesh& mesh = model.mesh;
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
        const Fan& fan = model.fans[f];
        const auto corners = model.corners(fan);
        const bool inside = fan.vertex < 0 && (fan.n_corners == 2 || mesh.place_in_triangle(corners[0]) == 6);
        if (fan.closed || inside || model.has_vanished(mesh.triangle_of(corners[0]))) continue;
        boundary_.push_back({.fan = f, .corner = corners.front(), .place = 0});
        if (fan.n_corners > 1) boundary_.push_back({.fan = f, .corner = corners.back(), .place = 1});
    }
    next_.assign(mesh.n_corners(), -1), previous_.assign(mesh.n_corners(), -1);
    for (const auto& [triangle, side, boundary] : mesh.boundary_edges)
        if (!model.has_vanished(triangle)) add_edges(triangle, side, edges_);
    for (const Edge& edge : edges_) next_[edge.a] = edge.b, previous_[edge.b] = edge.a;
    longest_edge_ = largest_edge(mesh);
    corner_size_.resize(mesh.n_corners(), infinity);
    for (Index c = 0; c < mesh.n_corners(); ++c)
        for (Index k = 0; k < mesh.corners_per_triangle(); ++k)
            if (k != mesh.place_in_triangle(c))
                corner_size_[c] =
                    std::min(corner_size_[c], (mesh.corner(mesh.triangle_of(c), k) - mesh.corner(c)).norm());
}

/// The edge of a triangle, of second order in two halves.
void ObstacleContacts::add_edges(Index triangle, Index side, std::vector<Edge>& edges) const {
    const double depth =
        max_depth_in_altitudes * 2 * model_.mesh.area(triangle) / model_.mesh.side_vector(triangle, side).norm();
    visit_side(model_.mesh, triangle, side, [&](Index from, Index to) { edges.push_back({from, to, depth}); });
}

/// Both faces of an interface near an obstacle whose sides are apart, if the vertices at both ends have split.
void ObstacleContacts::add_open_faces(Index f, const State& begin) {
    const Vec2 x = place(model_.corners(model_.fans[f])[0], begin);
    bool is_near = false;
    for (std::size_t o = 0; o < surfaces_.size() && !is_near; ++o)
        is_near = surfaces_[o].outline().kind != Outline::Kind::half_plane &&
                  at_most_[o].may_reach(x, 2 * longest_edge_) && surfaces_[o].may_reach(x, 2 * longest_edge_);
    if (!is_near) return;
    for (const FanPoint& point : model_.points(model_.fans[f])) {
        if (point.on_support() || point.point % 2 != 0) continue;  // each interface once
        if (begin.displacement_of(point.after) == begin.displacement_of(point.before)) continue;
        visit_faces(model_.mesh, model_.interfaces[model_.interface_of(point.point)], [&](Index t, Index k) {
            const Index first = model_.mesh.corners_per_triangle() * t;
            const auto has_split = [&](Index corner) { return begin.split_rank[model_.fan_of_corner[corner]] >= 0; };
            if (has_split(first + k) && has_split(first + (k + 1) % 3)) add_edges(t, k, open_faces_);
        });
    }
}

/// Every piece of a split fan needs a contact of its own: the corner after each point whose sides ever moved.
template <class Visit>
void ObstacleContacts::visit_pieces(Index f, const State& begin, const Visit& visit) const {
    const Fan& fan = model_.fans[f];
    const auto corners = model_.corners(fan);
    const PointState* state = begin.points.data() + begin.first_point[begin.split_rank[f]];
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanPoint& point = model_.points(fan)[i];
        if (point.on_support()) continue;
        if (!fan.closed && (point.after == corners.front() || point.after == corners.back())) continue;  // in boundary_
        const bool together = begin.displacement_of(point.after) == begin.displacement_of(point.before);
        const bool intact = unbreakable(model_, point) || (!point.cracked && state[i].cohesion == 1);
        if (!(intact && together)) visit(Candidate{.fan = f, .corner = point.after, .place = i + 2});
    }
}

void ObstacleContacts::find(const State& begin, double h, const std::vector<Vec3>& end_velocity,
                            const std::vector<Vec2>& corner_force, AddedRates added) {
    contacts_.clear(), kicks_.clear(), passing_ = {};
    if (!added.empty()) kicks_.assign(body_->pieces.size(), 0);
    for (const std::vector<Vec3>& rates : added)
        for (std::size_t p = 0; p < rates.size(); ++p) kicks_[p] += largest_speed(rates[p], body_->pieces[p].radius);
    n_at_corners_ = 0;
    if (model_.obstacles.empty()) return;
    assert(end_velocity.size() == model_.obstacles.size());
    surfaces_.clear();
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o)
        surfaces_.emplace_back(model_.obstacles[o].outline, begin.obstacles[o].pose);
    at_most_.clear(), predicted_ = end_velocity;
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
        const Vec3 &start = begin.obstacles[o].velocity, &end = end_velocity[o];
        at_most_.push_back({.speed = start.head<2>().lpNorm<1>() + end.head<2>().lpNorm<1>(),
                            .spin = std::abs(start.z()) + std::abs(end.z()),
                            .low = Vec2::Constant(-infinity),
                            .high = Vec2::Constant(infinity)});
        find_box(surfaces_[o], at_most_.back().low, at_most_.back().high);
        for (int k = 0; k < 3; ++k)
            if (model_.obstacles[o].is_free(k)) predicted_[o][k] = start[k];
    }
    if (body_) return find_of_pieces(begin, h, end_velocity);
    found_.clear();
    const auto look_from = [&](const Candidate& candidate) {
        const MovingCorner at = moving(candidate, begin, h, corner_force);
        const std::size_t first = contacts_.size();
        for (Index o = 0; o < static_cast<Index>(surfaces_.size()); ++o) find_at_corner(at, o, begin, h, end_velocity);
        for (std::size_t i = first; i < contacts_.size(); ++i) found_.push_back({{candidate.order(), i}, contacts_[i]});
    };
    for (const Candidate& candidate : boundary_) look_from(candidate);
    for (const Index f : begin.split_fans) visit_pieces(f, begin, look_from);
    std::ranges::sort(found_, {}, &Found::order);  // few of the candidates
    std::ranges::transform(found_, contacts_.begin(), &Found::contact);
    n_at_corners_ = contacts_.size();
    open_faces_.clear();
    for (const Index f : begin.split_fans) add_open_faces(f, begin);
    starts_.clear();
    for (const std::vector<Edge>* edges : {&edges_, &open_faces_})
        for (const Edge& edge : *edges) starts_.push_back(place(edge.a, begin));
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o) {
        if (model_.obstacles[o].outline.kind == Outline::Kind::half_plane) continue;  // an end of an edge is nearest
        const Vec2* start = starts_.data();
        for (const std::vector<Edge>* edges : {&edges_, &open_faces_})
            for (const Edge& edge : *edges) find_on_edge(edge, *start++, o, begin, h);
    }
}

/// The obstacle meets an edge beside the corner of the body: the centre of a disc lies beside the edge, or a corner of
/// a polygon in no direction out of the body.
bool ObstacleContacts::meets_beside(Index fan, Index o, const Vec2& x, const SurfaceDistance& distance,
                                    const State& begin) const {
    const ObstacleSurface& surface = surfaces_[o];
    const Outline& outline = surface.outline();
    if (!outline.is_bounded() || outline.line || begin.split_rank[fan] >= 0) return false;
    const auto corners = model_.corners(model_.fans[fan]);
    const Index next = next_[corners.front()], previous = previous_[corners.back()];
    if (next < 0 || previous < 0) return false;
    const PlacedEdge out = placed_edge(x, place(next, begin)), in = placed_edge(place(previous, begin), x);
    if (outline.kind == Outline::Kind::disc) {
        const auto is_beside = [&](const PlacedEdge& edge) {
            const double along = edge.place(surface.position());
            return edge.length > flat_arc * outline.radius && along > 0 && along < edge.length &&
                   edge.gap(surface.position()) >= outline.radius - touching_part * edge.length;
        };
        return is_beside(out) || is_beside(in);
    }
    if (!(distance.gap > 0)) return false;
    const Vec2 nearest = surface.rotation().turned_back(x - distance.gap * distance.normal - surface.position());
    const bool at_corner = std::ranges::any_of(
        outline.points, [&](const Vec2& p) { return (nearest - p).norm() <= geometric_rounding * p.norm(); });
    return at_corner && !VertexCone(in.along, out.along).accepts(distance.normal);
}

ObstacleContacts::MovingCorner ObstacleContacts::moving(const Candidate& at, const State& begin, double h,
                                                        const std::vector<Vec2>& corner_force) const {
    const Index c = at.corner, node = begin.node_of_corner[c];
    const Vec2& v = begin.velocity[node];
    const double kick = corner_force.empty() ? 0 : h / model_.corner_mass[c], of_piece = kick_of(c);
    const Vec2 force = corner_force.empty() ? Vec2::Zero() : corner_force[c];
    return {.corner = c,
            .fan = at.fan,
            .x = model_.mesh.corner(c) + begin.displacement[node],
            .v = v,
            .size = corner_size_[c],
            .kicked = kick * force.norm() + of_piece,
            .nearest = near_contact * corner_size_[c],
            .most = v.lpNorm<1>() + kick * force.lpNorm<1>() + of_piece};
}

double ObstacleContacts::kick_of(Index corner) const {
    return kicks_.empty() ? 0 : kicks_[body_->piece_of_triangle[model_.mesh.triangle_of(corner)]];
}

void ObstacleContacts::find_at_corner(const MovingCorner& at, Index o, const State& begin, double h,
                                      const std::vector<Vec3>& end_velocity) {
    const Index c = at.corner;
    const Vec2 &x = at.x, &v = at.v;
    const double in_steps = contact_reach_in_steps * h;
    const ObstacleSurface& surface = surfaces_[o];
    const Vec2 arm = x - surface.position();
    // in front of a line as deep as an edge
    const double depth = surface.outline().line ? at.size : 0;
    // nearly all corners are far, so at first without roots
    const double most_of_obstacle = at_most_[o].speed + at_most_[o].spin * arm.lpNorm<1>(),
                 furthest = (1 + relative_tolerance) * (at.nearest + in_steps * (at.most + most_of_obstacle)) + depth;
    if (!at_most_[o].may_reach(x, furthest) || !surface.may_reach(x, furthest)) return;
    const double speed = v.norm() + at.kicked;
    const double obstacle_speed =
        velocity_at(begin.obstacles[o].velocity, arm).norm() + velocity_at(end_velocity[o], arm).norm();
    const double reach = at.nearest + contact_reach_in_steps * h * (speed + obstacle_speed);
    if (!surface.may_reach(x, reach + depth)) return;
    const Vec2 motion = h * (v - velocity_at(predicted_[o], arm));
    const auto add = [&](const SurfaceDistance& distance) {
        if (distance.gap > reach || meets_beside(at.fan, o, x, distance, begin)) return;
        contacts_.push_back({.corner = c,
                             .fan = at.fan,
                             .obstacle = o,
                             .arm = arm,
                             .normal = distance.normal,
                             .gap = cleared(distance.gap, x, surface)});
        if (surface.outline().kind == Outline::Kind::disc) return;
        // a surface that turns is taken at the middle of the step: of second order, so that a corner that rides or
        // slides on it does not sink in
        contacts_.back().normal = Rotation::by(0.5 * h * predicted_[o].z()).turned(distance.normal);
        contacts_.back().arm += 0.5 * h * (v - predicted_[o].head<2>());
    };
    surface.visit_planes(x, motion, touching_part * at.size, reach, depth, add);
}

/// Corners of rigid pieces where they protrude, and their edges.
void ObstacleContacts::read_pieces(const State& begin) {
    const Mesh& mesh = model_.mesh;
    const auto piece_of = [&](Index triangle) { return body_->piece_of_triangle[triangle]; };
    const auto angle_at = [&](Index c) {
        const Index first = mesh.corners_per_triangle() * mesh.triangle_of(c), k = c - first;
        const Vec2 to_next = place(first + (k + 1) % 3, begin) - place(c, begin),
                   to_last = place(first + (k + 2) % 3, begin) - place(c, begin);
        return std::atan2(cross(to_next, to_last), to_next.dot(to_last));
    };
    candidates_.clear(), piece_edges_.clear();
    pieces_.assign(body_->pieces.size(), {});
    for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f) {
        const auto corners = model_.corners(model_.fans[f]);
        if (model_.has_vanished(mesh.triangle_of(corners[0]))) continue;
        const auto n = static_cast<Index>(corners.size());
        // a wedge ends at another piece, and at a crack whose sides have parted
        const auto begins = [&](Index i) {
            const Index own = corners[i % n], last = corners[(i + n - 1) % n];
            return piece_of(mesh.triangle_of(own)) != piece_of(mesh.triangle_of(last)) ||
                   begin.displacement_of(own) != begin.displacement_of(last);
        };
        const bool closed = model_.fans[f].closed;
        Index start = 0;
        while (closed && start < n && !begins(start)) ++start;
        for (Index i = start; start < n && i < start + n;) {
            const Index first = i;
            double angle = angle_at(corners[i % n]);
            for (++i; i < start + n && !begins(i); ++i) angle += angle_at(corners[i % n]);
            if (angle <= std::numbers::pi - even_turn) candidates_.push_back({f, corners[first % n], first});
        }
    }
    std::ranges::stable_sort(candidates_, {},
                             [&](const Candidate& at) { return piece_of(mesh.triangle_of(at.corner)); });
    for (const auto& [triangle, side, boundary] : mesh.boundary_edges)
        if (!model_.has_vanished(triangle)) add_edges(triangle, side, piece_edges_);
    const auto is_open = [&](Index point) {
        const FanPoint& at = model_.fan_points[model_.fan_point_of[point]];
        return begin.displacement_of(at.after) != begin.displacement_of(at.before);
    };
    for (std::size_t i = 0; i < model_.interfaces.size(); ++i) {
        const Interface& interface = model_.interfaces[i];
        const auto [a, b] = interface.triangle;
        if (a == rigid_support || b == rigid_support) continue;
        if (const Index p = 2 * static_cast<Index>(i); piece_of(a) == piece_of(b) && !(is_open(p) && is_open(p + 1)))
            continue;
        visit_faces(mesh, interface, [&](Index t, Index k) { add_edges(t, k, piece_edges_); });
    }
    std::ranges::stable_sort(piece_edges_, {}, [&](const Edge& edge) { return piece_of(mesh.triangle_of(edge.a)); });
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
        Piece& piece = pieces_[piece_of(mesh.triangle_of(candidates_[k].corner))];
        if (piece.last_corner == 0) piece.first_corner = k;
        piece.last_corner = k + 1;
    }
    for (std::size_t k = 0; k < piece_edges_.size(); ++k) {
        const Edge& edge = piece_edges_[k];
        Piece& piece = pieces_[piece_of(mesh.triangle_of(edge.a))];
        if (piece.last_edge == 0) piece.first_edge = k;
        piece.last_edge = k + 1;
        piece.longest_edge = std::max(piece.longest_edge, (mesh.corner(edge.b) - mesh.corner(edge.a)).norm());
    }
}

/// [m] Of a piece relative to an obstacle, at most.
double ObstacleContacts::travel_of(Index p, Index o, const State& begin, double h) const {
    const double radius = body_->pieces[p].radius;
    const RigidPiece& at = begin.rigid_pieces[p];
    const double speed = largest_speed(at.rates(), radius) + (kicks_.empty() ? 0 : kicks_[p]),
                 distance = (at.centre - surfaces_[o].position()).norm() + radius;
    return h * (speed + at_most_[o].speed + at_most_[o].spin * distance);
}

void ObstacleContacts::find_of_pieces(const State& begin, double h, const std::vector<Vec3>& end_velocity) {
    if (pieces_.empty()) read_pieces(begin);
    const auto n_obstacles = static_cast<Index>(surfaces_.size()), n_pieces = static_cast<Index>(pieces_.size());
    std::vector<std::array<Index, 2>> meets_edges;  // obstacle, piece
    for (Index o = 0; o < n_obstacles; ++o)
        for (Index p = 0; p < n_pieces; ++p) {
            const double radius = body_->pieces[p].radius, edge = pieces_[p].longest_edge,
                         travel = travel_of(p, o, begin, h),
                         // what is further away from the centre has no contact
                reach = radius + (1 + near_contact) * edge + 2 * contact_reach_in_steps * travel;
            const Vec2& centre = begin.rigid_pieces[p].centre;
            if (!surfaces_[o].may_reach(centre, reach)) continue;
            if (model_.obstacles[o].outline.kind != Outline::Kind::half_plane &&
                surfaces_[o].may_reach(centre, radius + travel))
                passing_.at_least({travel / edge, centre});
            for (std::size_t k = pieces_[p].first_corner; k < pieces_[p].last_corner; ++k)
                find_at_corner(moving(candidates_[k], begin, h, {}), o, begin, h, end_velocity);
            const Outline::Kind kind = surfaces_[o].outline().kind;
            bool any = kind == Outline::Kind::disc;
            if (kind == Outline::Kind::polygon || kind == Outline::Kind::polyline)
                surfaces_[o].visit_corners(centre, reach, [&](std::size_t corner) {
                    any = any || (surfaces_[o].corner(corner) - centre).norm() <= reach;
                });
            if (any) meets_edges.push_back({o, p});
        }
    std::ranges::stable_sort(contacts_, {}, &ObstacleContact::fan);
    n_at_corners_ = contacts_.size();
    for (const auto& [o, p] : meets_edges)
        for (std::size_t k = pieces_[p].first_edge; k < pieces_[p].last_edge; ++k)
            find_on_edge(piece_edges_[k], place(piece_edges_[k].a, begin), o, begin, h);
}

/// A contact at a corner of the body is as near as `gap`.
bool ObstacleContacts::is_carried(Index corner, double gap, const State& begin) const {
    const Index node = begin.node_of_corner[corner];
    return std::ranges::any_of(of_fan(model_.fan_of_corner[corner]), [&](const ObstacleContact& c) {
        return c.gap <= gap && begin.node_of_corner[c.corner] == node;
    });
}

/// Corners and arcs of an obstacle against the inside of an edge.
void ObstacleContacts::find_on_edge(const Edge& edge, const Vec2& x_a, Index o, const State& begin, double h) {
    const ObstacleSurface& surface = surfaces_[o];
    if (!at_most_[o].may_reach(x_a, 2 * longest_edge_) || !surface.may_reach(x_a, 2 * longest_edge_)) return;
    const PlacedEdge at = placed_edge(x_a, place(edge.b, begin));
    if (!(at.length > 0) || !surface.may_reach(x_a, 2 * at.length)) return;
    if (surface.outline().kind == Outline::Kind::disc) find_on_arc(edge, at, o, begin, h);
    else find_at_corners_of(edge, at, o, begin, h);
}

/// The centre of a disc beside the edge, in front of it. Where the arc is flat the ends of the edge are enough, and
/// where an arc fits a round hole, whose edges are chords.
void ObstacleContacts::find_on_arc(const Edge& edge, const PlacedEdge& at, Index o, const State& begin, double h) {
    const ObstacleSurface& surface = surfaces_[o];
    const double radius = surface.outline().radius;
    const double share = at.share(surface.position()), height = at.gap(surface.position());
    if (at.length <= flat_arc * radius || !(share > 0 && share < 1 && height > 0)) return;
    const Vec2 x = at.start + share * (at.end - at.start);
    const double as_near = almost_as_near * at.length;
    if (height - radius < -touching_part * at.length && is_carried(edge.a, as_near, begin) &&
        is_carried(edge.b, as_near, begin))
        return;
    add_on_edge({.corner = edge.a,
                 .fan = model_.fan_of_corner[edge.a],
                 .obstacle = o,
                 .arm = x - surface.position(),
                 .normal = -at.outward,
                 .gap = cleared(height - radius, x, surface),
                 .second_corner = edge.b,
                 .second_fan = model_.fan_of_corner[edge.b],
                 .share = share},
                at.length, begin, h);
}

void ObstacleContacts::find_at_corners_of(const Edge& edge, const PlacedEdge& at, Index o, const State& begin,
                                          double h) {
    surfaces_[o].visit_corners(at.start, 2 * at.length,
                               [&](std::size_t corner) { find_at_corner_of(edge, at, o, corner, begin, h); });
}

/// A point behind an edge lies in front of the next one, beyond a convex corner of the body. Where a fan has split,
/// what goes on beyond the end of the edge is the part of the fan that the edge belongs to.
bool ObstacleContacts::is_in_front_of_next(const Edge& edge, const PlacedEdge& at, const Vec2& x,
                                           const State& begin) const {
    const auto is_right_of = [&](const Vec2& from, const Vec2& to) { return cross(to - from, x - from) < 0; };
    const auto beyond = [&](Index corner, bool at_end) {
        const Fan& fan = model_.fans[model_.fan_of_corner[corner]];
        const auto corners = model_.corners(fan);
        if (begin.split_rank[model_.fan_of_corner[corner]] < 0)
            return at_end ? next_[corners.front()] : previous_[corners.back()];
        if (model_.mesh.order != 1) return Index(-1);
        const std::ptrdiff_t n = std::ssize(corners), own = std::ranges::find(corners, corner) - corners.begin();
        std::ptrdiff_t k = 0;  // corners of the same part beside it
        const auto beside = [&] { return at_end ? own - k : own + k; };
        while (k < n && (fan.closed || (beside() >= 0 && beside() < n)) &&
               begin.node_of_corner[corners[(beside() + n) % n]] == begin.node_of_corner[corner])
            ++k;
        --k;
        const Index last = corners[(beside() + n) % n];
        return at_end ? next_in_triangle(last) : previous_in_triangle(last);
    };
    const Index next = beyond(edge.b, true), previous = beyond(edge.a, false);
    if (next >= 0) {
        const Vec2 end = place(next, begin);
        if (cross(at.along, end - at.end) > 0 && is_right_of(at.end, end)) return true;
    }
    if (previous < 0) return false;
    const Vec2 start = place(previous, begin);
    return cross(at.start - start, at.along) > 0 && is_right_of(start, at.start);
}

/// A corner of an obstacle that no side of it which begins there leaves towards the body, and that lies between the
/// ends of the edge. Where both of these touch as near, the corner adds nothing.
void ObstacleContacts::find_at_corner_of(const Edge& edge, const PlacedEdge& at, Index o, std::size_t corner,
                                         const State& begin, double h) {
    const ObstacleSurface& surface = surfaces_[o];
    const Vec2 arm = surface.arm_of_corner(corner), x = surface.position() + arm;
    const double share = at.share(x), gap = at.gap(x);
    if (share <= touching_part || share >= 1 - touching_part || gap < -edge.depth) return;
    if (!surface.protrudes(corner, at.outward, VertexCone::widened)) return;
    if (gap < 0 && is_in_front_of_next(edge, at, x, begin)) return;
    const double as_near = gap + almost_as_near * at.length;
    if (is_carried(edge.a, as_near, begin) && is_carried(edge.b, as_near, begin)) return;
    const Vec2 foot = arm - gap * at.outward;  // where the body takes the friction, so that it has no moment
    add_on_edge({.corner = edge.a,
                 .fan = model_.fan_of_corner[edge.a],
                 .obstacle = o,
                 .arm = foot + 0.5 * h * predicted_[o].z() * turned_left(foot),
                 .normal = -at.outward,
                 .gap = cleared(gap, x, surface),
                 .second_corner = edge.b,
                 .second_fan = model_.fan_of_corner[edge.b],
                 .share = share},
                at.length, begin, h);
}

/// Unless its gap exceeds what may close.
void ObstacleContacts::add_on_edge(const ObstacleContact& contact, double length, const State& begin, double h) {
    const auto speed = [&](Index c) { return begin.velocity[begin.node_of_corner[c]].norm() + kick_of(c); };
    const AtMost& of_obstacle = at_most_[contact.obstacle];
    const double most = speed(contact.corner) + speed(contact.second_corner) + of_obstacle.speed +
                        of_obstacle.spin * contact.arm.norm();
    if (contact.gap <= near_contact * length + contact_reach_in_steps * h * most) contacts_.push_back(contact);
}

}  // namespace knap
