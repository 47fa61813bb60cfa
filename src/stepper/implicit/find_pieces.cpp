// AugmentedLagrangian: the primal-dual active set.
#include "base/secant.hpp"
#include "stepper/implicit/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

// The active set is given up after this many steps, or where that many do not lead nearer.
constexpr int max_piece_steps = 40, max_stalled_steps = 8;
constexpr double min_length = 0.05;  // of its steps

}  // namespace

/// Newton's method on the laws themselves. An augmentation of the size of inertia and stiffness shows on which piece of
/// its law a point is; a step solves the equations of these pieces, on stiff springs, with multipliers that follow at
/// once. (Stiff springs would stop it at the first point that changes its piece.) False: it cycles.
bool AugmentedLagrangian::find_pieces() {
    set_augmentation(final_augmentation_);
    pieces_.assign(x_.points.size(), ~0u);
    move_.resize(x_.points.size());
    double move = infinity, best = infinity;
    int n_found = 0, stalled = 0;
    std::size_t fewest = x_.points.size() + 1;
    for (int i = 0; i < max_piece_steps; ++i) {
        if (given_up_ && given_up_()) throw StepGivenUp{};
        evaluate_bulk();
        std::size_t n_changed = 0;
        double pressing = 0;
        for (std::size_t j = 0; j < x_.points.size(); ++j) {
            ActivePoint& point = x_.points[j];
            point.rate = point.rate_at(x_.rate);
            point.response = respond(point.law, point.softened(), point.rate.x(), point.rate.y());
            n_changed += pieces_[j] != point.response.state;
            pieces_[j] = point.response.state;
            pressing = std::max(pressing, point.response.contact);
            const Vec2 q = impulse_of_piece(point, point.rate);
            const double normal = q.x() - point.law.strength * point.response.cohesion_theta;
            point.sides.add_force(-point.out_of_frame({normal, q.y()}), residual_);
        }
        const double norm = residual(worst_node()), unit = std::max(unit_, std::min(pressing, largest_unit_)),
                     multiplier_unit = final_augmentation_ * unit, tolerance = balance_goal(unit);
        // one step more than the tolerance asks for: it costs no factor and takes the error to rounding
        n_found += (norm <= tolerance && move <= law_goal * multiplier_unit) ||
                   (norm > 0.5 * best && norm <= 1e3 * tolerance && move <= law_tolerance * multiplier_unit);
        if (n_found == 2) {
            for (ActivePoint& point : x_.points) point.multipliers.contact = std::max(0.0, point.multipliers.contact);
            unit_ = unit;
            return !indefinite_;
        }
        if (n_changed < fewest || (n_changed == fewest && norm < 0.5 * best)) stalled = 0;
        else if (++stalled == max_stalled_steps) break;
        fewest = std::min(fewest, n_changed), best = std::min(best, norm);
        if (!find_direction()) break;
        move = 0;
        for (std::size_t j = 0; j < move_.size(); ++j) {
            const ActivePoint& point = x_.points[j];
            const Vec2 q = impulse_of_piece(point, point.rate + point.across(direction_));
            move_[j] = q - Vec2(point.multipliers.contact, point.multipliers.tangential);
            if (std::isinf(point.multipliers.rho_T)) move_[j].y() = 0;
            move = std::max(move, move_[j].cwiseAbs().maxCoeff());
        }
        const double a = step_length_of_pieces();
        for (std::size_t n = 0; n < x_.rate.size(); ++n) x_.rate[n] += a * direction_[n];
        for (std::size_t j = 0; j < move_.size(); ++j) {
            x_.points[j].multipliers.contact += a * move_[j].x();
            x_.points[j].multipliers.tangential += a * move_[j].y();
        }
    }
    for (ActivePoint& point : x_.points) point.multipliers.contact = std::max(0.0, point.multipliers.contact);
    return false;
}

/// (p, q_T) [N s] at a rate by the equations of the piece of its response.
Vec2 AugmentedLagrangian::impulse_of_piece(const ActivePoint& point, const Vec2& rate) const {
    const Multipliers& at = point.multipliers;
    const PointResponse& q = point.response;
    const double contact = q.closed ? at.contact - at.rho_N * (rate.x() - point.law.contact.rate) : 0;
    if (q.sticks && !std::isinf(at.rho_T)) return {contact, at.tangential - at.rho_T * (rate.y() - q.kink)};
    const double rubs = at.friction_follows ? point.law.friction * q.friction_sign * (contact - q.contact) : 0;
    return {contact, q.tangential - rubs};
}

/// Its zero where the points change so much on the way that the step goes too far.
double AugmentedLagrangian::step_length_of_pieces() {
    begin_slope();
    const auto at = [&](double a) { return slope(a, true); };
    const double slope_at_start = at(0), slope_at_end = at(1);
    if (slope_at_end <= 0.1 * std::abs(slope_at_start)) return 1;
    if (slope_at_start >= 0) return 0.5;
    return std::clamp(zero_between(0, slope_at_start, 1, slope_at_end, 1e-2 * std::abs(slope_at_start), 30, at),
                      min_length, 1.0);
}

}  // namespace knap
