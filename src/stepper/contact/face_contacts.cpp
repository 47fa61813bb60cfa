#include "stepper/contact/face_contacts.hpp"

#include "base/parallel.hpp"
#include "stepper/common/contact_search.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/contact/retirement.hpp"

#include <cassert>
#include <cmath>
#include <cstdint>

namespace knap {
namespace {

constexpr double even_pairs = 1e-5;    // [-] likewise of duplicate pairs, whose edges turn a little
constexpr double deep_in_steps = 2;    // distances covered in a step, for a penetration without a history
constexpr double beyond_end = 0.25;    // [-] of an edge
constexpr double reflex_turn = -0.02;  // sine of a turn to the right that still counts as flat
constexpr double flat_turn = 0.2;      // sine of a turn of a flat vertex
constexpr double opposite = -0.9;      // product of the normals of two contacts between the same faces
constexpr double parallel = 0.97;      // likewise for two edges that are one face
constexpr double beside_end = 0.05;    // [-] of an edge: there a vertex and the end of the edge are a duplicate pair
constexpr double margin_share = 0.2;   // [-] of the mean edge: how far the boundary moves between two searches, x 2.5

/// A polyline that turns right by more than a flat one; `in_body` decides where it turns back.
bool is_reflex(const Vec2& t_in, const Vec2& t_out, bool in_body) {
    const double turn = cross(t_in, t_out);
    if (t_in.dot(t_out) < 0 && std::abs(turn) < flat_turn) return in_body;
    return turn < reflex_turn;
}

/// Along the bisector of a convex or flat corner from the first edge to the second: n_2 - n_1, and t_1 + t_2, which has
/// the same direction and stays definite where the corner is flat.
Vec2 across_corner(const Vec2& t_1, const Vec2& t_2) { return t_1 + t_2 - turned_left(t_2 - t_1); }

/// [m] How far beyond an end of an edge a point may lie; `overrun` is where no edge is beside it.
double largest_overrun(double gap, double reach, double overrun, double length, double depth) {
    return std::min(reach + std::max(0., std::min(overrun, depth + std::min(gap, 0.))), beyond_end * length);
}

/// Keeps the largest; a speed before any depth.
void refuse(const ContactRefusal& now, std::optional<ContactRefusal>& worst) {
    const auto rank = [](const auto& of) { return std::pair(of.reason == ContactRefusal::Reason::speed, of.value); };
    if (!worst || rank(now) > rank(*worst)) worst = now;
}

/// Of a vertex in the step before. (Clang 14 has no std::ranges::equal_range of a vector.)
std::span<const FaceContactState> contacts_before(const State& begin, Index vertex) {
    const auto& all = begin.face_contacts;
    return {std::ranges::lower_bound(all, vertex, {}, &FaceContactState::vertex),
            std::ranges::upper_bound(all, vertex, {}, &FaceContactState::vertex)};
}

/// [m] The longest way between the two sides of the points that retired at the corners of a contact.
double slid_at(const Model& model, const State& begin, const FaceContact& contact) {
    double longest = 0;
    for (const Index corner : {contact.vertex[0], contact.vertex[1], contact.edge[0], contact.edge[1]}) {
        if (model.ground_at(corner)) continue;
        const Index fan = model.fan_of_corner[corner], rank = begin.split_rank[fan];
        if (rank < 0) continue;
        const PointState* state = begin.points.data() + begin.first_point[rank];
        for (const FanPoint& at : model.points(model.fans[fan])) {
            if (begin.has_retired(at.point) && (at.before == corner || at.after == corner))
                longest = std::max(longest, state->slid);
            ++state;
        }
    }
    return longest;
}

/// [Pa] By the stresses of the triangles on both sides. Impulses of explicit steps come and go from vertex to vertex,
/// and a concave friction of them is less than that of their mean; the triangles behind take the mean.
double pressure_at(const Model& model, const State& begin, const FaceContact& contact) {
    double sum = 0;
    int n = 0;
    for (const Index corner : {contact.edge[0], contact.vertex[0], contact.vertex[1]}) {
        if (model.ground_at(corner)) continue;
        sum += traction(stress(model, begin, model.mesh.triangle_of(corner)), contact.normal).x(), ++n;
    }
    return std::max(0.0, sum / n);
}

}  // namespace

ContactLaw law_between_faces(const Model& model, const State& begin, const FaceContact& contact) {
    const auto of_interface = [&](Index law) -> ContactLaw {
        const CohesiveLaw& of = model.laws[law];
        return {.friction = of.friction,
                .restitution = of.restitution,
                .changing = of.friction_changes() ? static_cast<int>(law) : -1};
    };
    const auto constant = [&]() -> ContactLaw {
        for (const Index corner : {contact.edge[0], contact.vertex[1]})
            if (const GroundVertex* ground = model.ground_at(corner)) return of_interface(ground->law);
        if (contact.joint_law >= 0) return of_interface(contact.joint_law);
        const auto material = [&](Index corner) { return model.mesh.region[model.mesh.triangle_of(corner)]; };
        return model.contact_of_pair[material(contact.vertex[1])][material(contact.edge[0])];
    };
    ContactLaw law = constant();
    if (law.changing >= 0)
        law.friction =
            model.laws[law.changing].friction_at(slid_at(model, begin, contact), pressure_at(model, begin, contact));
    return law;
}

/// Undeformed places and lengths; what is known already stays.
void FaceContacts::read_boundary() {
    const auto edges = boundary_.edges();
    for (std::size_t c = reference_.size(); c < boundary_.corners().size(); ++c) {
        const GroundVertex* ground = model_.ground_at(boundary_.corners()[c]);
        reference_.push_back(ground ? ground->place : model_.mesh.corner(boundary_.corners()[c]));
        corners_.push_back({.x = reference_[c], .v = Vec2::Zero()});
    }
    for (; n_read_ < edges.size(); ++n_read_) {
        const FreeEdge& edge = edges[n_read_];
        const double length = (reference_[edge.end_place] - reference_[edge.start_place]).norm();
        longest_ = std::max(longest_, length), total_ += length;
    }
}

void FaceContacts::find(const State& begin, double h, const std::vector<Vec2>* corner_velocity) {
    assert(!corner_velocity || std::ssize(*corner_velocity) >= model_.mesh.n_corners());
    contacts_.clear(), found_.clear(), out_of_reach_.clear(), refusal_.reset();
    const bool boundary_changed = boundary_.update(begin.retired);
    if (boundary_changed && boundary_.changed().empty()) complete_ = false;
    if (boundary_.edges().empty()) return;
    if (pieces_) find_rigid(begin, h, boundary_changed);
    else if (place_corners(begin, h, corner_velocity, boundary_changed)) find_deformable(begin, h);
    else return;
    prune();
}

void FaceContacts::find_of_pieces(const State& begin, double h, AddedRates added) {
    added_ = added;
    find(begin, h);
    added_ = {};
}

/// [m/s] By which the velocity between two corners changes in the step, at most.
double FaceContacts::added_between(Index one, Index other) const {
    double sum = 0;
    for (const std::vector<Vec3>& rates : added_) {
        Vec2 between = Vec2::Zero();
        for (const auto& [corner, sign] : {std::pair(one, 1), std::pair(other, -1)}) {
            if (model_.ground_at(corner)) continue;
            const Index p = pieces_->piece_of_triangle[model_.mesh.triangle_of(corner)];
            between += sign * rates[p].head<2>(), sum += std::abs(rates[p].z()) * pieces_->pieces[p].radius;
        }
        sum += between.norm();
    }
    return sum;
}

void FaceContacts::find_deformable(const State& begin, double h) {
    if (blocks_.size() < nearby_.n_blocks()) blocks_.resize(nearby_.n_blocks());
    for_blocks(static_cast<std::ptrdiff_t>(nearby_.n_blocks()), [&](std::ptrdiff_t b) {
        Block& block = blocks_[b];
        block.found.clear(), block.refusal.reset();
        const auto pairs = nearby_.of_block(b);
        for (std::size_t k = 0; k < pairs.size();) {
            const Index i = pairs[k].vertex;
            const Vec2 x = place_of_vertex(i);
            std::optional<Vertex> at;
            for (; k < pairs.size() && pairs[k].vertex == i; ++k) {
                if (!may_touch(x, pairs[k].edge, reach_)) continue;
                if (!at) at = vertex(i, begin);
                if (!at->reflex) examine(pairs[k], *at, begin, h, block);
            }
        }
    });
    for (std::size_t b = 0; b < nearby_.n_blocks(); ++b) {
        found_.insert(found_.end(), blocks_[b].found.begin(), blocks_[b].found.end());
        if (blocks_[b].refusal) refuse(*blocks_[b].refusal, refusal_);
    }
    const auto n_added =
        static_cast<std::ptrdiff_t>(nearby_.n_blocks() > 0 ? blocks_[nearby_.n_blocks() - 1].found.size() : 0);
    if (n_added > 0) {  // of the last block, in any order
        const auto number = [&](const Found& at) { return std::array{at.contact.vertex[1], at.contact.edge[0]}; };
        std::ranges::sort(found_.end() - n_added, found_.end(), {}, number);
        std::ranges::inplace_merge(found_, found_.end() - n_added, {}, number);
    }
}

void FaceContacts::find_rigid(const State& begin, double h, bool boundary_changed) {
    const bool reads = !complete_ || boundary_changed;
    if (reads) reference_.clear(), corners_.clear(), n_read_ = 0, longest_ = 0, total_ = 0, boundary_.sort();
    read_boundary();
    for (std::size_t c = 0; c < corners_.size(); ++c) {
        const Index number = boundary_.corners()[c];
        if (model_.ground_at(number)) continue;
        const Index node = begin.node_of_corner[number];
        corners_[c] = {.x = reference_[c] + begin.displacement[node], .v = begin.velocity[node]};
    }
    const auto edges = boundary_.edges();
    placed_.resize(edges.size());
    for (Index e = 0; e < std::ssize(edges); ++e) place_edge(e);
    if (reads) nearby_pieces_.read(edges, reference_, *pieces_);
    complete_ = true;
    nearby_pieces_.find(edges, corners_, begin.rigid_pieces, added_, h);
    near_.clear();
    nearby_pieces_.for_near([&](Index i, Index e, double reach) {
        if (may_touch(place_of_vertex(i), e, reach)) near_.push_back({i, e});
    });
    // one number is compared faster than a pair
    std::ranges::sort(near_, {}, [](const NearbyEdge& at) { return (std::int64_t(at.vertex) << 32) + at.edge; });
    blocks_.resize(std::max<std::size_t>(blocks_.size(), 1));
    Block& block = blocks_[0];
    block.found.clear(), block.out_of_reach.clear(), block.refusal.reset();
    for (std::size_t k = 0; k < near_.size();) {
        const Vertex at = vertex(near_[k].vertex, begin);
        for (const Index i = near_[k].vertex; k < near_.size() && near_[k].vertex == i; ++k)
            if (!at.reflex) examine(near_[k], at, begin, h, block);
    }
    found_.swap(block.found), out_of_reach_.swap(block.out_of_reach), refusal_ = block.refusal;
}

/// Positions and velocities of the ends of all free edges, and the search for nearby ones where they have moved too
/// far. False, and a refusal, where a speed leaves nothing to find.
bool FaceContacts::place_corners(const State& begin, double h, const std::vector<Vec2>* rates, bool boundary_changed) {
    constexpr std::size_t block = 1024;
    if (!complete_) reference_.clear(), corners_.clear(), n_read_ = 0, longest_ = 0, total_ = 0, boundary_.sort();
    read_boundary();
    const auto numbers = boundary_.corners();
    const std::size_t ground = boundary_.ground_corners()[0], ground_end = boundary_.ground_corners()[1];
    const std::size_t n_ground = ground_end - ground, n_known = complete_ ? nearby_.n_corners() : 0;
    const Motion motion = sum_over_blocks(
        numbers.size() - n_ground, block, partial_, [&](std::size_t first, std::size_t last, Motion& own) {
            for (std::size_t k = first; k < last; ++k) {
                const std::size_t c = k < ground ? k : k + n_ground;
                const Index node = begin.node_of_corner[numbers[c]];
                const Vec2 v = rates ? (*rates)[numbers[c]] : begin.velocity[node];
                CornerMotion& at = corners_[c] = {.x = reference_[c] + begin.displacement[node], .v = v};
                own += {.squared_move = c < n_known ? nearby_.squared_move(c, at.x) : 0,
                        .squared_speed = at.v.squaredNorm()};
            }
        });
    const double speed = std::sqrt(motion.squared_speed);
    reach_ = touching_part * longest_ + contact_reach_in_steps * h * NearbyEdges::motion_margin * speed;
    if (!(reach_ <= longest_)) {
        for (const CornerMotion& corner : corners_)
            if (corner.v.squaredNorm() == motion.squared_speed)
                refuse({ContactRefusal::Reason::speed, h * speed / longest_, corner.x}, refusal_);
        complete_ = complete_ && !boundary_changed;
        return false;
    }
    const bool moved =
        NearbyEdges::reach_margin * reach_ + NearbyEdges::motion_margin * std::sqrt(motion.squared_move) >
        nearby_.margin();
    bool search = !complete_ || moved;
    if (!search && boundary_changed) {
        is_used_.resize(boundary_.edges().size(), 0);
        search = !nearby_.add(boundary_.edges(), corners_, boundary_.changed());
        if (!search) use_edges_of(nearby_.n_blocks() - 1);
    }
    if (search && !boundary_.is_sorted()) {
        complete_ = false;
        return place_corners(begin, h, rates, boundary_changed);
    }
    if (search) {
        const double mean = total_ / static_cast<double>(boundary_.edges().size());
        nearby_.find(boundary_.edges(), corners_, margin_share * mean + NearbyEdges::reach_margin * reach_);
        is_used_.assign(boundary_.edges().size(), 0), used_.clear();
        for (std::size_t b = 0; b < nearby_.n_blocks(); ++b) use_edges_of(b);
        complete_ = true;
    }
    placed_.resize(boundary_.edges().size());
    for (const Index e : used_) place_edge(e);
    return true;
}

/// Edges whose direction the narrow phase reads: of pairs and their vertices, neighbours, and those at the ends.
void FaceContacts::use_edges_of(std::size_t block) {
    const auto edges = boundary_.edges();
    const auto use = [&](Index e) {
        if (e >= 0 && !is_used_[e]) is_used_[e] = 1, used_.push_back(e);
    };
    const auto use_at = [&](Index piece) {
        if (piece >= 0) use(piece), use(edges[piece].entering);
    };
    for (const auto& [i, e] : nearby_.of_block(block)) {
        use_at(i), use(e), use(edges[e].prev), use(edges[e].next);
        use_at(edges[e].piece_start), use_at(edges[e].piece_end);
    }
}

/// Rule 1 with a reach [m] that no contact exceeds, of a vertex at x. Nearly all pairs end at their gap.
bool FaceContacts::may_touch(const Vec2& x, Index e, double reach) const {
    const double depth = boundary_.edges()[e].depth;
    const PlacedEdge& at = placed_[e];
    const double gap = at.gap(x), along = at.place(x);
    if (!(gap <= reach && gap >= -depth)) return false;
    const double beyond = largest_overrun(gap, reach, overrun(e, x, gap, along / at.length), at.length, depth);
    return along >= -beyond && along <= at.length + beyond;
}

FaceContacts::Vertex FaceContacts::vertex(Index i, const State& begin) const {
    const FreeEdge& leaving = boundary_.edges()[i];
    const CornerMotion &in = end_of(leaving.entering), &out = start_of(i);
    const PlacedEdge &entering = placed_[leaving.entering], &own = placed_[i];
    const Vec2 &t_in = entering.along, &t_out = own.along;
    return {.x = 0.5 * (in.x + out.x),
            .v = 0.5 * (in.v + out.v),
            .cone = {t_in, t_out},
            .l_in = entering.length,
            .l_out = own.length,
            .joint_law = {boundary_.edges()[leaving.entering].joint_law, leaving.joint_law},
            .before = contacts_before(begin, leaving.start),
            .reflex = is_reflex(t_in, t_out, leaving.reflex_piece),
            .flat = t_in.dot(t_out) > 0 && std::abs(cross(t_in, t_out)) < flat_turn};
}

void FaceContacts::examine(const NearbyEdge& pair, const Vertex& at, const State& begin, double h, Block& block) const {
    const FreeEdge &edge = boundary_.edges()[pair.edge], &leaving = boundary_.edges()[pair.vertex];
    const CornerMotion &a = start_of(pair.edge), &b = end_of(pair.edge);
    const PlacedEdge& placed = placed_[pair.edge];
    const Vec2& n = placed.outward;
    const double length = placed.length, gap = placed.gap(at.x), share = placed.share(at.x);
    const Vec2 v = at.v - (1 - share) * a.v - share * b.v;
    const double travel = h * v.norm(),
                 reach = touching_part * length +
                         contact_reach_in_steps * (travel + h * added_between(leaving.start, edge.start));
    if (gap > reach) {
        if (pieces_) block.out_of_reach.push_back(pair);
        return;
    }
    const double beyond =
        largest_overrun(gap, reach, overrun(pair.edge, at.x, gap, share), length, edge.depth) / length;
    if (gap < -edge.depth || share < -beyond || share > 1 + beyond) return;
    if (!at.cone.accepts(n)) return;
    if (!belongs_to(pair.edge, at, gap, share, begin, h)) return;
    const double gap_at_end = gap + h * n.dot(v);
    if (travel > (pieces_ ? largest_rigid_motion : largest_motion) * length && gap_at_end < touching_part * length)
        refuse({ContactRefusal::Reason::speed, travel / length, at.x}, block.refusal);
    // a piece that has just left its fan is as far from the mean of its corners as half their slip
    const double slipped = 0.5 * retirement_slip * std::max(at.l_in, at.l_out);
    // rigid pieces move beside their velocities, too: by corrections of their places, and by blows that an island takes
    const double unseen = pieces_ ? largest_motion * length : 0;
    const bool is_deep = gap < -(touching_part * length + slipped + unseen + deep_in_steps * travel);
    const FaceContactState* before = known(at.before, pair.edge);
    if (is_deep && !before && !was_beside(begin, pair)) return;
    const double depth = gap < -max_contact_depth * length ? overlap(edge, at, gap, begin) : -gap;
    if (depth <= 0 && gap < 0 && !before) return;
    if (!before) before = slid_from(pair.edge, at);
    block.found.push_back(
        {.contact = {.vertex = {boundary_.edges()[leaving.entering].end, leaving.start},
                     .edge = {edge.start, edge.end},
                     .normal = n,
                     .joint_law = at.joint_law_against(placed.along) == edge.joint_law ? edge.joint_law : -1,
                     .length = length,
                     .share = share,
                     .gap = gap,
                     .depth = depth,
                     .contact = before ? before->contact : 0,
                     .tangential = before ? before->tangential : 0},
         .vertex = pair.vertex,
         .edge = pair.edge,
         .gap_at_end = gap_at_end,
         .overhang = at.overhang(n),
         .flat = at.flat,
         .kept = true});
}

/// The corner of the contact piece where its outline goes on: a crack that live points close is none.
FaceContacts::Corner FaceContacts::corner(Index e, bool at_end) const {
    const auto edges = boundary_.edges();
    const Index leaving = at_end ? edges[e].piece_end : e;
    const bool is_outer = leaving >= 0 && edges[leaving].entering >= 0 && (!at_end || edges[leaving].entering == e);
    if (at_end) return {e, is_outer ? leaving : edges[e].next, is_outer};
    return {is_outer ? edges[e].entering : edges[e].prev, e, is_outer};
}

/// [m] How far beyond the end of an edge a point x may be and beside no edge (mouths and notches).
double FaceContacts::overrun(Index e, const Vec2& x, double gap, double share) const {
    if (share >= 0 && share <= 1) return 0;
    const Corner at = corner(e, share > 1);
    const PlacedEdge &first = placed_[at.first], &second = placed_[at.second];
    const Vec2 &t_1 = first.along, &t_2 = second.along;
    const double other_gap = share > 1 ? second.gap(x) : first.outward.dot(x - first.end);
    if (cross(t_1, t_2) < reflex_turn && gap <= other_gap && other_gap < 0) return infinity;
    const double mouth = 0.5 * placed_[e].along.dot(second.start - first.end);
    return std::max(mouth, -gap * std::max(1., -cross(t_1, t_2) / (1 + t_1.dot(t_2))));
}

/// Rule 4.
bool FaceContacts::belongs_to(Index e, const Vertex& at, double gap, double share, const State& begin, double h) const {
    const auto edges = boundary_.edges();
    for (const bool at_end : {false, true}) {
        const auto [first, second, is_outer] = corner(e, at_end);
        // beyond the closed end of a crack, or nearer to it than deep
        if (!is_outer && (at_end ? 1 - share : share) * placed_[e].length < std::max(0.0, -gap)) return false;
        const Vec2 &t_1 = placed_[first].along, &t_2 = placed_[second].along;
        const Vec2 from_corner = at.x - 0.5 * (placed_[first].end + placed_[second].start);
        if (!is_reflex(t_1, t_2, is_outer ? edges[second].reflex_piece : edges[first].reflex_wedge)) {
            const PlacedEdge& other = placed_[at_end ? second : first];
            const Vec2 &n = placed_[e].outward, &other_n = other.outward;
            // two tips: a plane that only the widened cones accept may separate the vertex, but not its edges
            const bool tips = n.dot(other_n) < opposite && at.cone.accepts(other_n);
            if (tips && at.distance(other_n, from_corner) > at.distance(n, from_corner)) return false;
            if (tips || second_is_nearer(first, second, at, h) != at_end) continue;
            if (at.cone.accepts(other_n)) return false;
            // both edges at the vertex lie in front of the nearer edge, which separates them from this one
            if (at.distance(other_n, from_corner) > -touching_part * other.length) return false;
            // gaps between the places of both vertices: else each may seem smaller than the other
            const Index j = at_end ? edges[e].piece_end : edges[e].piece_start;
            if (meets_nearer(j, at, n.dot(from_corner), begin)) return false;
            continue;
        }
        const bool beside_other = at_end ? t_2.dot(from_corner) > 0 : t_1.dot(from_corner) < 0;
        if (gap < 0 && beside_other && (at_end ? share > 1 : share < 0)) return false;
    }
    return true;
}

/// The vertex j of the other side has a larger gap than `gap` to an edge at this vertex, and its cone accepts it.
bool FaceContacts::meets_nearer(Index j, const Vertex& at, double gap, const State& begin) const {
    if (j < 0) return true;
    const Vertex other = vertex(j, begin);
    return !other.reflex && std::ranges::any_of(at.normals(), [&](const Vec2& n) {
        return other.cone.accepts(n) && other.distance(n, other.x - at.x) > gap;
    });
}

/// [m] -g, or less where the vertex overlaps less with a convex corner at an end of the edge (deep pairs).
double FaceContacts::overlap(const FreeEdge& edge, const Vertex& at, double gap, const State& begin) const {
    double least = -gap;
    for (const Index j : {edge.piece_start, edge.piece_end}) {
        if (j < 0 || vertex(j, begin).reflex) continue;
        const Vertex other = vertex(j, begin);
        for (const auto& [one, two] : {std::pair(&at, &other), std::pair(&other, &at)})
            for (const Vec2& n : one->normals()) least = std::min(least, -two->distance(n, two->x - one->x));
    }
    return least;
}

/// At a convex or flat corner between two edges: the one with the larger gap, but for seams.
bool FaceContacts::second_is_nearer(Index first, Index second, const Vertex& at, double h) const {
    const PlacedEdge &one = placed_[first], &two = placed_[second];
    const Vec2 &n_1 = one.outward, &n_2 = two.outward, across = across_corner(one.along, two.along);
    const CornerMotion &a = end_of(first), &b = start_of(second);
    const Vec2 from_corner = at.x - 0.5 * (a.x + b.x), v = at.v - 0.5 * (a.v + b.v);
    const double gap_1 = n_1.dot(from_corner), gap_2 = n_2.dot(from_corner), rate_1 = n_1.dot(v), rate_2 = n_2.dot(v);
    const double rounding_1 = touching_part * one.length, rounding_2 = touching_part * two.length;
    const double tie = geometric_rounding * across.norm() * std::min(one.length, two.length);
    if (n_1.dot(n_2) > parallel || gap_1 < -rounding_1 || gap_2 < -rounding_2) return across.dot(from_corner) > tie;
    const auto slides_on = [&](const Vec2& n, double gap, double rate, double rounding) {
        return gap < rounding && h * rate > -std::max(VertexCone::widened * h * v.norm(), touching_part * rounding) &&
               was_on_face(at, n);
    };
    const bool slides_on_1 = slides_on(n_1, gap_1, rate_1, rounding_1),
               slides_on_2 = slides_on(n_2, gap_2, rate_2, rounding_2);
    if (slides_on_1 != slides_on_2) return slides_on_2;
    const double then_1 = gap_1 + h * rate_1, then_2 = gap_2 + h * rate_2;
    const bool both_rounding = std::max(then_1, then_2) < 0 && then_1 > -rounding_1 && then_2 > -rounding_2;
    if (both_rounding && std::abs(rate_2 - rate_1) > VertexCone::widened * v.norm()) return rate_2 > rate_1;
    return across.dot(from_corner + h * v) > tie;
}

/// The vertex was in contact with an edge of nearly this normal in the step before.
bool FaceContacts::was_on_face(const Vertex& at, const Vec2& normal) const {
    return std::ranges::any_of(at.before, [&](const FaceContactState& contact) {
        const Index e = boundary_.place_of(contact.edge);
        return e >= 0 && placed_edge(start_of(e).x, end_of(e).x).outward.dot(normal) > parallel;
    });
}

/// The contact of the step before with an edge; null where there was none.
const FaceContactState* FaceContacts::known(std::span<const FaceContactState> of_vertex, Index edge) const {
    const auto at = std::ranges::find(of_vertex, boundary_.edges()[edge].start, &FaceContactState::edge);
    return at == of_vertex.end() ? nullptr : &*at;
}

/// The contact of the step before with a neighbour of the edge that is the same face; null where there was none.
const FaceContactState* FaceContacts::slid_from(Index e, const Vertex& at) const {
    if (at.before.empty()) return nullptr;
    for (const Index other : {boundary_.edges()[e].prev, boundary_.edges()[e].next})
        if (const auto* before = known(at.before, other);
            before && placed_[other].along.dot(placed_[e].along) > parallel)
            return before;
    return nullptr;
}

/// Rule 5. Any corner of a fan counts, since a vertex that falls into pieces has been all of them.
bool FaceContacts::was_beside(const State& begin, const NearbyEdge& pair) const {
    const auto edges = boundary_.edges();
    const FreeEdge& edge = edges[pair.edge];
    const Index vertex = edges[pair.vertex].start;
    const auto met = [&](Index at, const auto& accepts) {
        const auto corners = model_.ground_at(at) ? std::span<const Index>(&at, 1)
                                                  : model_.corners(model_.fans[model_.fan_of_corner[at]]);
        return std::ranges::any_of(corners, [&](Index corner) {
            return std::ranges::any_of(contacts_before(begin, corner), accepts, &FaceContactState::edge);
        });
    };
    const auto near_edge = [&](Index e) {
        return e == edge.start || e == edges[edge.prev].start || e == edges[edge.next].start;
    };
    const auto is_vertex = [&](Index corner) { return boundary_.are_one_vertex(corner, vertex); };
    const auto at_vertex = [&](Index e) { return is_vertex(e) || is_vertex(boundary_.end_of(e)); };
    return is_vertex(edge.start) || is_vertex(edge.end) || met(vertex, near_edge) || met(edge.start, at_vertex) ||
           met(edge.end, at_vertex);
}

/// The contacts of a vertex in found_: first_found_ holds numbers of any earlier step where there is none.
std::span<FaceContacts::Found> FaceContacts::of_vertex(Index i) {
    std::size_t first = first_found_[i], end = first;
    while (end < found_.size() && found_[end].vertex == i) ++end;
    return end == first ? std::span<Found>() : std::span(found_.data() + first, end - first);
}

void FaceContacts::prune() {
    first_found_.resize(boundary_.edges().size());
    for (std::size_t k = found_.size(); k-- > 0;) first_found_[found_[k].vertex] = k;
    for (Found& at : found_) prune_corners(at);
    for (Found& at : found_) {
        const FreeEdge& edge = boundary_.edges()[at.edge];
        const auto meets = [&](Index i) {
            return i >= 0 && std::ranges::any_of(of_vertex(i), [&](const Found& other) {
                       return other.kept && ends_in(other.edge, at.vertex) &&
                              other.contact.normal.dot(at.contact.normal) < opposite &&
                              other.contact.gap < at.contact.gap + touching_part * at.contact.length;
                   });
        };
        if (at.kept && at.flat && meets(edge.piece_start) && meets(edge.piece_end)) at.kept = false;
    }
    for (const Found& at : found_) {
        if (!at.kept) continue;
        const FaceContact& c = contacts_.emplace_back(at.contact);
        if (c.depth > max_contact_depth * c.length)  // of another one the sides may be apart
            refuse({ContactRefusal::Reason::depth, c.depth / c.length, place_of_vertex(at.vertex)}, refusal_);
    }
}

/// Vertex against the vertex at an end of its edge.
void FaceContacts::prune_corners(Found& at) {
    const FreeEdge& edge = boundary_.edges()[at.edge];
    for (const Index j : {edge.piece_start, edge.piece_end}) {
        if (j < 0) continue;
        for (Found& other : of_vertex(j)) {
            if (!at.kept || !other.kept || !ends_in(other.edge, at.vertex)) continue;
            const double length = std::min(at.contact.length, other.contact.length);
            const auto prefers = [&](double more, double even) {
                const bool is_first = at.contact.vertex[1] < other.contact.vertex[1];
                return more > even * length || (more >= -even * length && is_first);
            };
            if (at.contact.normal.dot(other.contact.normal) < opposite) {
                const double share = j == edge.piece_start ? at.contact.share : 1 - at.contact.share;
                if (std::abs(share) > beside_end) continue;
                Found &stays = prefers(other.contact.gap - at.contact.gap, even_pairs) ? at : other,
                      &goes = &stays == &at ? other : at;
                goes.kept = false;
                stays.contact.contact += goes.contact.contact;
                stays.contact.tangential += goes.contact.tangential;
            } else {
                const double less = at.overhang - other.overhang;
                const Found& then = prefers(at.gap_at_end - other.gap_at_end - less, geometric_rounding) ? at : other;
                const Found& now = prefers(at.contact.gap - other.contact.gap - less, geometric_rounding) ? at : other;
                const Found& stays = then.contact.gap > -touching_part * then.contact.length ? then : now;
                (&stays == &at ? other : at).kept = false;
            }
        }
    }
}

}  // namespace knap
