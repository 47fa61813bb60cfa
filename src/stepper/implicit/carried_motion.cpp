#include "stepper/implicit/carried_motion.hpp"

#include "base/tolerance.hpp"

#include <algorithm>

namespace knap {
void CarriedMotion::find(const State& begin) {
    const Mesh& mesh = model_.mesh;
    const PiecesOfBody pieces = pieces_of_body(model_, begin, bulk_.dashpots());
    search_.clear(), piece_of_corner_.assign(mesh.n_corners(), -1);
    const Index n = mesh.corners_per_triangle();
    for (Index t = 0; t < mesh.n_triangles(); ++t) {  // the lowest triangle of a piece comes first
        if (pieces.held[t]) continue;
        if (pieces.first[t] == t) search_.push_back({.first_triangle = t});
        const Index piece =
            pieces.first[t] == t ? static_cast<Index>(search_.size()) - 1 : piece_of_corner_[n * pieces.first[t]];
        std::fill_n(piece_of_corner_.begin() + n * t, n, piece);
        search_[piece].n_corners += n;
    }
}

void CarriedMotion::begin(const StepContext& step) {
    const State& begin = *step.begin;
    bulk_.set_carried(nullptr);
    motions_.clear();
    if (!leaves_motion_) return;
    const auto n_broken = std::ranges::count(begin.points, 0.0, &PointState::cohesion);
    if (n_broken != n_broken_) find(begin), n_broken_ = n_broken;
    if (search_.empty()) return;
    rigid_.find(model_, bulk_, piece_of_corner_, static_cast<Index>(search_.size()));
    const auto project = [&](const std::vector<Vec2>& of_node) {
        of_corner_.clear();
        for (const Index node : begin.node_of_corner) of_corner_.push_back(of_node[node]);
        rigid_.project(of_corner_, along_);
    };
    project(begin.velocity);
    for (std::size_t p = 0; p < search_.size(); ++p) {
        search_[p].q = along_[p], search_[p].inverse_slope.setIdentity();
        const double mass = rigid_.inertia[p](0, 0) / bulk_.mass_factor(), length = rigid_.pieces[p].length;
        motions_.push_back({.first_triangle = search_[p].first_triangle,
                            .mass = mass,
                            .momentum = mass * along_[p].head<2>(),
                            .angular_momentum = length * rigid_.inertia[p](2, 2) / bulk_.mass_factor() * along_[p][2]});
    }
    if (begin.has_end_velocities() && begin.last_step > 0) {  // the acceleration goes on
        project(begin.rate);
        for (std::size_t p = 0; p < search_.size(); ++p)
            search_[p].q += step.h / begin.last_step * (search_[p].q - along_[p]);
    }
    is_first_ = true;
    set_carried();
}

void CarriedMotion::set_carried() {
    const Mesh& mesh = model_.mesh;
    carried_.assign(mesh.n_corners(), Vec2::Zero());
    for (Index c = 0; c < mesh.n_corners(); ++c)
        for (int k = 0; k < 3 && piece_of_corner_[c] >= 0; ++k)
            carried_[c] += search_[piece_of_corner_[c]].q[k] * rigid_.motion(c, k, bulk_.place(c));
    bulk_.set_carried(&carried_);
}

bool CarriedMotion::agrees(const std::vector<Vec2>& rate) {
    if (bulk_.frames()) rigid_.find(model_, bulk_, piece_of_corner_, static_cast<Index>(search_.size()));
    rigid_.project(rate, along_);
    const double d = bulk_.mass_factor() - 1;
    bool all = true;
    for (std::size_t p = 0; p < search_.size(); ++p) {
        Search& at = search_[p];
        const Eigen::Vector3d error = at.q - along_[p], rise = error - at.error;
        const double mass = rigid_.inertia[p](0, 0) / bulk_.mass_factor() / at.n_corners;
        if (d * mass * error.norm() > relative_tolerance * bulk_.largest_impulse()) all = false;
        if (const double slope = at.change.dot(at.inverse_slope * rise);
            !is_first_ && std::abs(slope) > 1e-3 * at.change.squaredNorm() / (1 + d))
            at.inverse_slope +=
                (at.change - at.inverse_slope * rise) * (at.change.transpose() * at.inverse_slope) / slope;
        at.error = error;
    }
    if (all) return true;
    for (Search& at : search_) at.change = -at.inverse_slope * at.error, at.q += at.change;
    is_first_ = false;
    set_carried();
    return false;
}

}  // namespace knap
