#include "stepper/explicit/free_pieces.hpp"

#include "base/parallel.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr std::size_t members_in_a_block = 1024;

}  // namespace

FreePieces::Sums& FreePieces::Sums::operator+=(const Sums& other) {
    mass += other.mass, angular += other.angular, inertia += other.inertia;
    first += other.first, momentum += other.momentum;
    return *this;
}

void FreePieces::find(const State& begin) {
    const Mesh& mesh = model_.mesh;
    const Index n = mesh.n_triangles();
    const PiecesOfBody triangles = pieces_of_body(model_, begin, dashpots_);
    pieces_.clear(), members_.clear(), blocks_.clear();
    std::vector<Index> piece_of(n, -1);  // the lowest triangle comes first
    for (Index t = 0; t < n; ++t) {
        const Index first = triangles.first[t];
        if (triangles.held[t]) continue;
        if (first == t) piece_of[t] = static_cast<Index>(pieces_.size()), pieces_.push_back({t, 0, 0});
        piece_of[t] = piece_of[first];
    }
    if (pieces_.empty()) return;
    const auto piece_at = [&](Index corner) { return piece_of[mesh.triangle_of(corner)]; };
    std::vector<std::pair<Index, Member>> found;  // with their pieces
    for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f) {
        const auto corners = model_.corners(model_.fans[f]);
        const Vec2 place = mesh.corner(corners[0]);
        const Index piece = piece_at(corners[0]);
        if (std::ranges::all_of(corners, [&](Index corner) { return piece_at(corner) == piece; })) {
            if (piece >= 0) found.push_back({piece, {place, model_.fans[f].mass, corners[0], f}});
            continue;
        }
        for (const Index corner : corners)
            if (piece_at(corner) >= 0)
                found.push_back({piece_at(corner), {place, model_.corner_mass[corner], corner, -1}});
    }
    std::ranges::stable_sort(found, {}, &std::pair<Index, Member>::first);
    for (const auto& [piece, member] : found) {
        const bool begins = blocks_.empty() || blocks_.back().piece != piece;
        if (begins) pieces_[piece].member = members_.size();
        if (begins || members_.size() - blocks_.back().first == members_in_a_block)
            blocks_.push_back({piece, members_.size(), members_.size()});
        members_.push_back(member);
        pieces_[piece].mass += member.mass;
        blocks_.back().last = members_.size();
    }
}

/// Calls visit(node, mass [kg]).
template <class Visit>
void FreePieces::for_nodes(const State& begin, const Member& member, const Visit& visit) const {
    if (member.fan < 0) return visit(begin.node_of_corner[member.corner], member.mass);
    if (begin.split_rank[member.fan] < 0) return visit(member.fan, member.mass);
    for (const Index corner : model_.corners(model_.fans[member.fan]))
        visit(begin.node_of_corner[corner], model_.corner_mass[corner]);
}

/// [m] y of a node.
Vec2 FreePieces::arm(const State& begin, const Member& member, Index node, const Vec2& origin) const {
    const Vec2 at = member.place - origin;
    return model_.large_rotation ? Vec2(at + begin.displacement[node]) : at;
}

const Vec2* FreePieces::carried(const State& begin, double damping, std::vector<PieceMotion>& now) {
    now.clear();
    if (!leaves_motion_) return nullptr;
    const auto n_broken = std::ranges::count(begin.points, 0.0, &PointState::cohesion);
    if (n_broken != n_broken_) find(begin), n_broken_ = n_broken, carried_.clear();
    if (pieces_.empty()) return nullptr;
    if (carried_.size() != begin.displacement.size() || n_split_ != begin.split_fans.size()) {
        carried_.assign(begin.displacement.size(), Vec2::Zero());
        n_split_ = begin.split_fans.size();
    }

    motions_.resize(pieces_.size()), of_block_.resize(blocks_.size());
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        const Member& member = members_[pieces_[p].member];
        motions_[p].origin = member.place;
        if (model_.large_rotation) motions_[p].origin += begin.displacement[begin.node_of_corner[member.corner]];
    }
    for_blocks(static_cast<std::ptrdiff_t>(blocks_.size()), [&](std::ptrdiff_t b) {
        const Block& block = blocks_[b];
        const Vec2 origin = motions_[block.piece].origin;
        Sums sums;
        for (const Member& member : std::span(members_).subspan(block.first, block.last - block.first))
            for_nodes(begin, member, [&](Index node, double mass) {
                const Vec2 y = arm(begin, member, node, origin), momentum = mass * begin.velocity[node];
                sums.mass += mass, sums.first += mass * y, sums.momentum += momentum;
                sums.angular += cross(y, momentum), sums.inertia += mass * y.squaredNorm();
            });
        of_block_[b] = sums;
    });

    // the pieces are in the order of their lowest triangles in the step before, too
    std::size_t b = 0;
    auto earlier = begin.free_pieces.begin();
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
        Sums sums;
        for (; b < blocks_.size() && blocks_[b].piece == static_cast<Index>(p); ++b) sums += of_block_[b];
        Motion& motion = motions_[p];
        motion.centre = sums.first / sums.mass;
        now.push_back({.first_triangle = pieces_[p].first_triangle,
                       .mass = pieces_[p].mass,
                       .momentum = sums.momentum,
                       .angular_momentum = sums.angular - cross(motion.centre, sums.momentum)});
        const PieceMotion& piece = now.back();
        Vec2 momentum = piece.momentum;
        double angular = piece.angular_momentum;
        while (earlier != begin.free_pieces.end() && earlier->first_triangle < piece.first_triangle) ++earlier;
        if (begin.last_step > 0 && earlier != begin.free_pieces.end() &&
            earlier->first_triangle == piece.first_triangle && earlier->mass == piece.mass) {
            momentum += 0.5 * (momentum - earlier->momentum);
            angular += 0.5 * (angular - earlier->angular_momentum);
        }
        const double inertia = sums.inertia - sums.mass * motion.centre.squaredNorm();
        motion.velocity = momentum / sums.mass, motion.spin = angular / inertia;
    }

    const double part = 2 * damping / (1 + damping);  // 1 - decay
    for_blocks(static_cast<std::ptrdiff_t>(blocks_.size()), [&](std::ptrdiff_t i) {
        const Block& block = blocks_[i];
        const auto& [origin, centre, velocity, spin] = motions_[block.piece];
        for (const Member& member : std::span(members_).subspan(block.first, block.last - block.first))
            for_nodes(begin, member, [&](Index node, double) {
                const Vec2 y = arm(begin, member, node, origin) - centre;
                carried_[node] = part * (velocity + spin * turned_left(y));
            });
    });
    return carried_.data();
}

}  // namespace knap
