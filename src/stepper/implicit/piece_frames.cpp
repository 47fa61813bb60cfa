#include "stepper/implicit/piece_frames.hpp"

#include "stepper/common/pieces_of_body.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

PieceFrames::PieceFrames(const Model& model, std::span<const Dashpot> dashpots)
    : model_(model),
      dashpots_(dashpots),
      has_fixed_axes_(model.mesh.n_corners(), 0),
      of_triangle_(model.mesh.n_triangles()),
      multiple_(model.mesh.n_triangles(), {0, 0}),
      is_changed_(model.mesh.n_triangles(), 0) {
    const auto fix = [&](Index corner) {
        for (const Index c : model.corners(model.fans[model.fan_of_corner[corner]])) has_fixed_axes_[c] = 1;
    };
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        if (const PrescribedMotion* motion = model.motion_of(c))
            if (motion->component[0] != motion->component[1]) fix(c);
    for (const Dashpot& dashpot : dashpots) fix(dashpot.corner);
}

void PieceFrames::find_pieces(const State& begin) {
    const auto n_broken = std::ranges::count(begin.points, 0.0, &PointState::cohesion);
    if (n_split_ == begin.split_fans.size() && n_broken_ == n_broken) return;
    n_split_ = begin.split_fans.size(), n_broken_ = n_broken;
    const std::vector<Index> first = pieces_of_body(model_, begin, dashpots_).first;
    piece_of_triangle_.resize(first.size());
    of_piece_.clear(), is_held_.clear();
    for (Index t = 0; t < static_cast<Index>(first.size()); ++t) {
        if (first[t] == t) {
            piece_of_triangle_[t] = n_pieces();
            of_piece_.push_back({}), is_held_.push_back(0);
        }
        piece_of_triangle_[t] = piece_of_triangle_[first[t]];
        if (is_at_fixed_axes(t)) is_held_[piece_of_triangle_[t]] = 1;
    }
}

void PieceFrames::add_up(const GreenStep& green, const GreenStep::Motion& motion, std::vector<Rotation>& of_piece) {
    sum_.assign(of_piece_.size(), Vec2::Zero());
    direction_.resize(model_.mesh.n_triangles());
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        direction_[t] = green.direction(t, motion);
        sum_[piece_of_triangle_[t]] += model_.triangle_mass(t) * direction_[t];
    }
    of_piece.clear();
    for (const Vec2& sum : sum_) of_piece.push_back(rotation_along(sum));
}

void PieceFrames::begin(const State& begin, const GreenStep& green, const GreenStep::Motion& motion) {
    find_pieces(begin);
    add_up(green, motion, at_begin_);
    const auto multiple = [](double angle, double unit) {
        return static_cast<std::int16_t>(std::lround(angle / unit));
    };
    for (std::size_t p = 0; p < of_piece_.size(); ++p)
        of_piece_[p] =
            is_held_[p] ? Rotation::by(held_frame * multiple(angle_of(at_begin_[p]), held_frame)) : at_begin_[p];
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        const Index p = piece_of_triangle_[t];
        const double own = angle_of(from_to(of_piece_[p], rotation_along(direction_[t])));
        const std::array now{multiple(own, own_frame),
                             is_at_fixed_axes(t) ? multiple(angle_of(of_piece_[p]), held_frame) : std::int16_t{0}};
        if (now != multiple_[t]) multiple_[t] = now, is_changed_[t] = 1;
    }
}

void PieceFrames::find(const GreenStep& green, const GreenStep::Motion& motion) {
    add_up(green, motion, in_middle_);
    for (std::size_t p = 0; p < of_piece_.size(); ++p)
        if (!is_held_[p]) of_piece_[p] = in_middle_[p];
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        const Rotation& R = of_piece_[piece_of_triangle_[t]];
        of_triangle_[t] = multiple_[t][0] == 0 ? R : composed(R, own_turn(t));
    }
}

std::array<Rotation, 3> PieceFrames::along_nodes(Index triangle) const {
    std::array<Rotation, 3> turns;
    for (Index k = 0; k < 3; ++k)
        turns[k] = has_fixed_axes_[3 * triangle + k] ? of_triangle_[triangle] : own_turn(triangle);
    return turns;
}

std::vector<Index> PieceFrames::take_changed() {
    std::vector<Index> changed;
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
        if (is_changed_[t]) changed.push_back(t), is_changed_[t] = 0;
    return changed;
}

double PieceFrames::turn(Index piece) const { return 2 * angle_of(from_to(at_begin_[piece], in_middle_[piece])); }

Index PieceFrames::turns_far() const {
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
        if (!(std::abs(turn(piece_of_triangle_[t])) <= largest_turn)) return t;
    return -1;
}

}  // namespace knap
