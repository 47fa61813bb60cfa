#include "stepper/implicit/lagged_friction.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr std::size_t few_changes = 10;  // in a step: the active set is near its end, or cycles
constexpr int min_changes = 2;           // of a point that cycles, while few change
constexpr int min_quiet_steps = 2;       // without a change of a piece
constexpr double delay = 0.8;            // [-] part of the way that a bound follows in a step

}  // namespace

LaggedFriction::LaggedFriction(std::size_t max_points) { reserve_capacity(max_points, n_changes_); }

void LaggedFriction::begin(std::size_t n_points) {
    n_changes_.assign(n_points, 0);
    n_lagging_ = n_quiet_ = 0;
}

bool LaggedFriction::settles(std::size_t n_changed, std::vector<ActivePoint>& points) {
    if (n_changed > few_changes) std::ranges::fill(n_changes_, 0);
    n_quiet_ = n_changed == 0 ? n_quiet_ + 1 : 0;
    if (n_quiet_ < min_quiet_steps || !end(points)) return false;
    begin(points.size());
    return true;
}

void LaggedFriction::hold_back(ActivePoint& point) {
    if (point.law.friction <= 0 || point.law.cohesion > 0 || !point.multipliers.friction_follows) return;
    point.multipliers.friction_follows = false;
    point.multipliers.pressed = std::max(0.0, point.multipliers.contact);
    ++n_lagging_;
}

bool LaggedFriction::hold_back_cycling(std::vector<ActivePoint>& points) {
    const int before = n_lagging_;
    for (std::size_t j = 0; j < points.size(); ++j)
        if (n_changes_[j] >= min_changes) hold_back(points[j]);
    return n_lagging_ > before;
}

void LaggedFriction::hold_back_all(std::vector<ActivePoint>& points) {
    for (ActivePoint& point : points) hold_back(point);
}

void LaggedFriction::advance(std::vector<ActivePoint>& points) const {
    if (!is_used()) return;
    for (ActivePoint& point : points)
        if (Multipliers& at = point.multipliers; !at.friction_follows)
            at.pressed += delay * (std::max(0.0, at.contact) - at.pressed);
}

bool LaggedFriction::end(std::vector<ActivePoint>& points) {
    if (!is_used()) return false;
    for (ActivePoint& point : points) point.multipliers.friction_follows = true;
    n_lagging_ = 0;
    return true;
}

}  // namespace knap
