#include "nonsmooth/fan_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace knap {

void FanClusters::start(const FanProblem& problem) {
    problem_ = &problem;
    cluster_.resize(problem.bodies.size() + 1);
    std::iota(cluster_.begin(), cluster_.end(), 0);
    next_ = cluster_;
    offset_.assign(cluster_.size(), Vec2::Zero());
}

bool FanClusters::join(const FanLink& link, const Vec2& jump, double tolerance) {
    const Index kept = of(link.before), joined = of(link.after);
    const Vec2 shift = offset_[at(link.before)] + jump - offset_[at(link.after)];
    if (kept == joined) return shift.cwiseAbs().maxCoeff() <= tolerance;  // a closed loop: its jumps must sum to zero
    const Index first = at(link.after);
    for (Index b = first;;) {
        cluster_[b] = kept, offset_[b] += shift;
        if ((b = next_[b]) == first) break;
    }
    std::swap(next_[first], next_[at(link.before)]);
    return true;
}

bool FanClusters::find_velocities(const std::vector<Vec2>& impulse, const std::vector<std::uint8_t>& known,
                                  double tolerance) {
    const std::vector<FanBody>& bodies = problem_->bodies;
    velocity_.assign(cluster_.size(), Vec2::Zero());
    inverse_mass_.assign(cluster_.size(), Vec2::Zero());
    std::vector<Vec2>&momentum = velocity_, &mass = inverse_mass_;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const Vec2 m = bodies[b].mass(), v = bodies[b].free_velocity - offset_[b];
        for (int k = 0; k < 2; ++k) {
            if (m[k] == 0) continue;
            momentum[cluster_[b]][k] += m[k] * v[k];
            mass[cluster_[b]][k] += m[k];
        }
    }
    for (std::size_t i = 0; i < known.size(); ++i) {
        if (!known[i]) continue;
        momentum[of(problem_->links[i].after)] += impulse[i];
        momentum[of(problem_->links[i].before)] -= impulse[i];
    }
    for (std::size_t c = 0; c < cluster_.size(); ++c)
        for (int k = 0; k < 2; ++k) {
            inverse_mass_[c][k] = mass[c][k] > 0 ? 1 / mass[c][k] : 0;
            velocity_[c][k] = momentum[c][k] * inverse_mass_[c][k];
        }

    constexpr double is_prescribed = -1;  // in place of the inverse mass
    bool consistent = true;
    for (int k = 0; k < 2; ++k) {
        const auto prescribe = [&](Index cluster, double velocity) {
            if (inverse_mass_[cluster][k] == is_prescribed && std::abs(velocity - velocity_[cluster][k]) > tolerance)
                consistent = false;
            velocity_[cluster][k] = velocity;
            inverse_mass_[cluster][k] = is_prescribed;
        };
        prescribe(cluster_.back(), -offset_.back()[k]);
        for (std::size_t b = 0; b < bodies.size(); ++b)
            if (bodies[b].inverse_mass[k] == 0) prescribe(cluster_[b], bodies[b].free_velocity[k] - offset_[b][k]);
        for (Vec2& w : inverse_mass_) w[k] = std::max(w[k], 0.0);
    }
    return consistent;
}

void FanClusters::apply(const FanLink& link, const Vec2& impulse) {
    const Index after = of(link.after), before = of(link.before);
    velocity_[after] += inverse_mass_[after].cwiseProduct(impulse);
    velocity_[before] -= inverse_mass_[before].cwiseProduct(impulse);
}

Vec2 FanClusters::response(const FanLink& link, const FanLink& other, const Vec2& impulse) const {
    const Index after = of(link.after), before = of(link.before);
    const Index other_after = of(other.after), other_before = of(other.before);
    Vec2 velocity = Vec2::Zero();
    if (other_after == after) velocity += inverse_mass_[after].cwiseProduct(impulse);
    if (other_before == after) velocity -= inverse_mass_[after].cwiseProduct(impulse);
    if (other_after == before) velocity -= inverse_mass_[before].cwiseProduct(impulse);
    if (other_before == before) velocity += inverse_mass_[before].cwiseProduct(impulse);
    return velocity;
}

}  // namespace knap
