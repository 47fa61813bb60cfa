#include "stepper/implicit/condensed_system.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>

namespace knap {

CondensedSystem::CondensedSystem(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix,
                                 std::vector<Vec2>& rate)
    : bulk_(bulk), matrix_(matrix), rate_(rate) {
    reserve_capacity(model.fan_points.size(), sides_, acting_);
    reserve_capacity(model.mesh.n_corners(), impulse_, residual_, right_side_, direction_, change_, condensed_at_);
}

void CondensedSystem::begin(const std::vector<ActivePoint>& points) {
    sides_.clear();
    for (const ActivePoint& point : points) sides_.push_back(point.sides);
    if (points.size() < min_points || free_) matrix_.set_all_near();
    else matrix_.set_near(sides_);
    forget();
}

bool CondensedSystem::begin_reduced(const std::vector<ActivePoint>& points) {
    if (free_ || matrix_.has_frames()) return false;
    acting_.clear();
    for (const ActivePoint& point : points) {
        const bool both = point.fan >= 0 || point.law.friction > 0;
        acting_.push_back({point.sides, {both || point.normal.x() != 0, both || point.normal.y() != 0}});
    }
    forget();
    return matrix_.set_reduced(acting_);
}

void CondensedSystem::evaluate() {
    if (condensed_) {
        for (const Index node : near_nodes()) residual_[node] = impulse_[node];
        return;
    }
    if (!is_evaluated_) {
        bulk_.impulse(rate_, corner_impulse_);
        bulk_.sum_to_nodes(corner_impulse_, impulse_);
        if (free_) free_->remove_resultants(rate_, impulse_);
    }
    is_evaluated_ = true;
    residual_ = impulse_;
}

bool CondensedSystem::find_direction(const std::vector<ActivePoint>& points) {
    right_side_.resize(rate_.size());
    if (!condensed_ && matrix_.has_far_nodes()) {
        for (const Index node : near_nodes()) residual_[node] -= impulse_[node];
        matrix_.condense(impulse_);
        is_evaluated_ = false;
        for (const Index node : near_nodes()) residual_[node] += impulse_[node];
        condensed_at_ = rate_;
        condensed_ = true;
    }
    for (const Index node : near_nodes()) right_side_[node] = -residual_[node];
    if (!matrix_.solve(right_side_, direction_)) return false;
    matrix_.bulk_part(right_side_, direction_, change_);
    if (!free_ || !free_->find(points)) return true;
    // the matrix has more mass, and nothing of the motion along N: M_hat d is short of M (d - mass_factor d before)
    motion_.clear();
    for (const Vec2& d : direction_) motion_.push_back(-matrix_.mass_factor() * d);
    free_->complete(points, rate_, direction_);
    for (std::size_t i = 0; i < motion_.size(); ++i) motion_[i] += direction_[i];
    bulk_.momentum_of_nodes(motion_, change_);
    return true;
}

double CondensedSystem::move_freely(const std::vector<ActivePoint>& points) {
    if (!free_->find(points)) return 0;
    direction_.assign(rate_.size(), Vec2::Zero());
    const double largest = free_->complete(points, rate_, direction_);
    for (std::size_t i = 0; i < rate_.size(); ++i) rate_[i] += direction_[i];
    forget();
    return largest;
}

void CondensedSystem::step(double a) {
    is_evaluated_ = false;
    for (const Index node : near_nodes()) {
        rate_[node] += a * direction_[node];
        impulse_[node] += a * change_[node];
    }
}

void CondensedSystem::complete() {
    if (!condensed_) return;
    for (const Index node : near_nodes()) right_side_[node] = rate_[node] - condensed_at_[node];
    matrix_.add_change_of_far_nodes(right_side_, rate_);
    forget();
}

Index CondensedSystem::worst_node() const {
    Index worst = -1;
    double largest = -1;
    const auto compare = [&](Index node) {
        if (const double r = residual(node); r > largest) worst = node, largest = r;
    };
    if (condensed_) std::ranges::for_each(near_nodes(), compare);
    else
        for (Index node = 0; node < static_cast<Index>(residual_.size()); ++node) compare(node);
    return worst;
}

double CondensedSystem::slope() const {
    double sum = 0;
    for (const Index node : near_nodes()) sum += direction_[node].dot(impulse_[node]);
    return sum;
}

double CondensedSystem::curvature() const {
    double sum = 0;
    for (const Index node : near_nodes()) sum += direction_[node].dot(change_[node]);
    return sum;
}

}  // namespace knap
