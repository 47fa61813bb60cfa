#include "stepper/contact/free_boundary.hpp"

#include "base/reserve_capacity.hpp"
#include "stepper/common/contact_search.hpp"

#include <cassert>
#include <cmath>
#include <cstring>
#include <numbers>

namespace knap {
namespace {

constexpr std::size_t marks_at_once = 256;  // hardly any change in a step

/// [rad] The angle of a triangle at one of its corners.
double angle_at(const Mesh& mesh, Index c) {
    const Index t = c / 3, k = c % 3;
    const Vec2 out = mesh.side_vector(t, k), in = -mesh.side_vector(t, (k + 2) % 3);
    return std::atan2(cross(out, in), out.dot(in));
}

}  // namespace

FreeBoundary::FreeBoundary(const Model& model) : model_(model) {
    if (!model.faces_meet()) return;
    retired_.assign(model.n_points(), Retirement::none);
    const Mesh& mesh = model.mesh;
    assert(mesh.order == 1);
    const std::size_t n = mesh.n_corners();
    twin_.assign(n, -1), point_.assign(n, -1), prev_.assign(n, -1), piece_.assign(n, -1), group_.assign(n, -1),
        last_.assign(n, -1);
    joined_.assign(n, {-1, -1});
    reflex_wedge_.assign(n, 0), reflex_piece_.assign(n, 0);
    place_.assign(n + model.ground.vertices.size(), -1), corner_place_.assign(place_.size(), -1);
    const auto half_edge = [&](Index triangle, Index vertex) {
        Index k = 0;
        while (mesh.triangles[triangle][k] != vertex) ++k;
        return 3 * triangle + k;
    };
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
        if (model.is_gone(model.interfaces[i])) continue;
        const auto& triangle = model.interfaces[i].triangle;
        const auto& vertex = model.interfaces[i].vertex;
        const Index point = 2 * static_cast<Index>(i);
        if (triangle[0] == rigid_support) {
            point_[half_edge(triangle[1], vertex[0])] = point;
            continue;
        }
        const Index h = half_edge(triangle[0], vertex[0]), other = half_edge(triangle[1], vertex[1]);
        twin_[h] = other, twin_[other] = h;
        point_[h] = point, point_[other] = point + 1;
    }
    reserve_capacity(n, edges_, corners_);
    for (const Fan& fan : model.fans)
        if (!fan.closed && !model.has_vanished(model.corners(fan)[0] / 3)) link(fan);
    sort();
}

bool FreeBoundary::update(std::span<const Retirement> retired) {
    if (retired_.empty()) return false;  // the model has no contact between free faces
    std::vector<Index> touched;          // fans
    bool only_more = true;
    for (std::size_t first = 0; first < retired.size(); first += marks_at_once) {
        const auto marks = retired.subspan(first, std::min(marks_at_once, retired.size() - first));
        if (std::memcmp(marks.data(), retired_.data() + first, marks.size_bytes()) == 0) continue;  // most steps
        for (std::size_t p = first; p < first + marks.size(); ++p) {
            if (retired[p] == retired_[p]) continue;
            only_more = only_more && retired[p] != Retirement::none;
            retired_[p] = retired[p];
            for (const std::size_t end : {p, p ^ 1})
                touched.push_back(model_.fan_of_corner[model_.fan_points[model_.fan_point_of[end]].corner()]);
        }
    }
    if (touched.empty()) return false;
    std::ranges::sort(touched);
    touched.erase(std::ranges::unique(touched).begin(), touched.end());
    for (const Index f : touched) link(model_.fans[f]);
    if (!only_more) {  // another state than before
        sort();
        return true;
    }
    changed_.clear();
    const auto for_free_edges = [&](const auto& visit) {
        for (const Index f : touched)
            for (const Index c : model_.corners(model_.fans[f])) {
                if (is_free(c)) visit(c);
                if (is_free(previous_in_triangle(c))) visit(previous_in_triangle(c));
            }
    };
    for_free_edges([&](Index h) {
        if (place_[h] < 0) add(h);
    });
    for_free_edges([&](Index h) {
        refresh(h);
        changed_.push_back(place_[h]);
    });
    std::ranges::sort(changed_);
    changed_.erase(std::ranges::unique(changed_).begin(), changed_.end());
    return true;
}

/// Finds the wedges, the contact pieces and the groups of a fan.
void FreeBoundary::link(const Fan& fan) {
    const auto corners = model_.corners(fan);
    const Index n = fan.n_corners;
    const auto separates = [&](Index c) { return twin_[c] < 0 || frees(point_[c]); };
    const auto cuts = [&](Index c) {
        return separates(c) || (is_free(c) && retired_[point_[c]] == Retirement::parted);
    };
    // a group starts with a corner whose leaving edge separates it from the one before, a piece with one whose leaving
    // edge cuts, a wedge with one whose leaving edge is free; an open fan starts with its outer edge, a closed one is
    // read from the strongest of them that it has
    const auto find = [&](const auto& starts) {
        Index first = 0;
        while (first < n && !starts(corners[first])) ++first;
        return first;
    };
    Index first = find(separates);
    if (first == n) first = find(cuts);
    const bool has_cut = first < n;
    if (!has_cut) first = find([&](Index c) { return is_free(c); });
    if (first == n) return;  // nothing is free here
    const auto at = [&](Index i) { return corners[(first + i) % n]; };
    Index group = at(0), piece = -1, wedge = -1;
    double piece_angle = 0, wedge_angle = 0;
    for (Index i = 0; i < n; ++i) {
        const Index c = at(i);
        if (is_free(c)) wedge = c, wedge_angle = 0;
        if (cuts(c)) piece = c, piece_angle = 0;
        if (separates(c)) group = c;
        const double angle = angle_at(model_.mesh, c);
        wedge_angle += angle, piece_angle += angle;
        piece_[c] = has_cut ? piece : -1, group_[c] = group;
        const bool end = i + 1 == n;
        if (end || is_free(at(i + 1))) {
            prev_[wedge] = previous_in_triangle(c);
            reflex_wedge_[wedge] = wedge_angle > std::numbers::pi;
        }
        if (has_cut && (end || cuts(at(i + 1))))
            last_[piece] = c, reflex_piece_[piece] = piece_angle > std::numbers::pi;
    }
    for (const Index c : corners) joined_[c] = {-1, -1};
    for (Index i = 0; i < n; ++i) {
        const Index c = at(i), own = group_[c], before = group_[at(i > 0 ? i - 1 : n - 1)];
        if (twin_[c] < 0 || retired_[point_[c]] != Retirement::meeting) continue;
        for (const Index other : corners) {
            if (group_[other] == own) joined_[other][0] = before;
            if (group_[other] == before) joined_[other][1] = own;
        }
    }
    if (!fan.closed && !model_.ground.of_point.empty()) stand(fan);
}

/// The groups at both ends of an open fan join that of the ground below.
void FreeBoundary::stand(const Fan& fan) {
    const auto corners = model_.corners(fan);
    const auto join = [&](Index corner, Index point) {
        const Index ground = ground_below(point), group = group_[corner];
        for (const Index c : corners)
            if (ground >= 0 && group_[c] == group) group_[c] = number_of(ground);
    };
    const Index first = corners.front(), last = corners.back(), entering = previous_in_triangle(last);
    if (point_[first] >= 0) join(first, point_[first]);
    if (point_[entering] >= 0) join(last, point_[entering] ^ 1);
}

Index FreeBoundary::place_of_corner(Index c) {
    if (corner_place_[c] < 0) {
        corner_place_[c] = static_cast<Index>(corners_.size());
        corners_.push_back(c);
    }
    return corner_place_[c];
}

void FreeBoundary::add(Index h) {
    const Mesh& mesh = model_.mesh;
    place_[h] = static_cast<Index>(edges_.size());
    edges_.push_back({.start = h,
                      .end = next_in_triangle(h),
                      .start_place = place_of_corner(h),
                      .end_place = place_of_corner(next_in_triangle(h)),
                      .joint_law = twin_[h] < 0 ? -1 : model_.interfaces[model_.interface_of(point_[h])].joint_law,
                      .depth = max_depth_in_altitudes * 2 * mesh.area(h / 3) / mesh.side_vector(h / 3, h % 3).norm()});
}

void FreeBoundary::add_ground(Index g) {
    const GroundVertex& at = model_.ground.vertices[g];
    const Index start = number_of(g), end = number_of(at.next);
    place_[start] = static_cast<Index>(edges_.size());
    edges_.push_back({.start = start,
                      .end = end,
                      .start_place = place_of_corner(start),
                      .end_place = place_of_corner(end),
                      .ground = true,
                      .joint_law = -1,
                      .depth = max_depth_in_altitudes * (model_.ground.vertices[at.next].place - at.place).norm()});
}

/// Reads what link() found about an edge.
void FreeBoundary::refresh(Index h) {
    const auto place = [&](Index number) { return number < 0 ? -1 : place_[number]; };
    FreeEdge& edge = edges_[place_[h]];
    edge.prev = place(prev_[h]);
    edges_[edge.prev].next = place_[h];
    edges_[edge.prev].reflex_wedge = reflex_wedge_[h] != 0;
    edge.piece_start = place(piece_[h]), edge.piece_end = place(piece_[edge.end]);
    edge.group_start = group_[h], edge.group_end = group_[edge.end];
    edge.joined = joined_[h];
    edge.entering = piece_[h] == h ? place(previous_in_triangle(last_[h])) : -1;
    edge.reflex_piece = reflex_piece_[h] != 0;
    const bool on_support = twin_[h] < 0 && point_[h] >= 0;
    edge.passive =
        on_support && retired_[point_[h]] != Retirement::retired && retired_[point_[h] ^ 1] != Retirement::retired;
    edge.starts_on_support = edge.group_start >= model_.mesh.n_corners();
    edge.touches = edge.entering >= 0;
}

/// A polyline of its own: each vertex is a contact piece and a group. A side at its end has no further neighbour.
void FreeBoundary::refresh_ground(Index g) {
    const GroundVertex& at = model_.ground.vertices[g];
    const Index own = place_[number_of(g)];
    FreeEdge& edge = edges_[own];
    edge.prev = at.prev < 0 ? own : place_[number_of(at.prev)];
    edge.next = model_.ground.vertices[at.next].next < 0 ? own : place_[edge.end];
    edge.piece_start = own, edge.piece_end = edge.next == own ? -1 : edge.next;
    edge.group_start = edge.start, edge.group_end = edge.end;
    edge.joined = {-1, -1};
    edge.entering = at.prev < 0 ? -1 : edge.prev;
    edge.passive = !at.has_face;
    edge.touches = at.convex;
}

void FreeBoundary::sort() {
    for (const FreeEdge& edge : edges_) place_[edge.start] = -1;
    for (const Index c : corners_) corner_place_[c] = -1;
    edges_.clear(), corners_.clear(), changed_.clear();
    for (Index h = 0; h < model_.mesh.n_corners(); ++h)
        if (is_free(h)) add(h);
    const std::vector<GroundVertex>& ground = model_.ground.vertices;
    ground_corners_[0] = corners_.size();
    for (std::size_t g = 0; g < ground.size(); ++g)
        if (ground[g].next >= 0) add_ground(static_cast<Index>(g));
    ground_corners_[1] = corners_.size();
    for (const FreeEdge& edge : edges_)
        edge.ground ? refresh_ground(edge.start - model_.mesh.n_corners()) : refresh(edge.start);
    n_sorted_ = edges_.size();
}

}  // namespace knap
