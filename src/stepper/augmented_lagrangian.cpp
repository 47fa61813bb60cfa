#include "stepper/augmented_lagrangian.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int most_newton_steps = 200, most_outer_steps = 60;
constexpr double multiplier_tolerance = 1e-10;  // of the scale: the error of the rates is this over the augmentation, see point_law.hpp
constexpr double balance_tolerance = 1e-13;     // of the scale

Vec2 rate_of(const std::vector<Vec2>& of_node, Index node) { return node < 0 ? Vec2::Zero() : of_node[node]; }

}  // namespace

void AugmentedLagrangian::evaluate(const ImplicitBulk& bulk, std::vector<LoosePoint>& points, const std::vector<Vec2>& rate) {
    bulk.taken(rate, corner_taken_);
    bulk.sum_to_nodes(corner_taken_, taken_);
    residual_ = taken_;
    for (LoosePoint& point : points) {
        point.rate = point.in_frame(rate_of(rate, point.after) - rate_of(rate, point.before));
        point.response = respond(point.law, point.rate.x(), point.rate.y());
        const Vec2 impulse = point.impulse();
        if (point.after >= 0) residual_[point.after] -= impulse;
        if (point.before >= 0) residual_[point.before] += impulse;
    }
}

double AugmentedLagrangian::residual_norm() const {
    double norm = 0;
    for (Index i = 0; i < static_cast<Index>(residual_.size()); ++i)
        for (int k = 0; k < 2; ++k)
            if (matrix_.unknown(i, k) >= 0) norm = std::max(norm, std::abs(residual_[i][k]));
    return norm;
}

bool AugmentedLagrangian::prepare_matrix(const std::vector<LoosePoint>& points) {
    bool same = factored_states_.size() == points.size() + 1;  // one more, so that no points are not the same as no factor
    for (std::size_t i = 0; same && i < points.size(); ++i) same = factored_states_[i] == points[i].response.state;
    if (same) return true;
    factored_states_.resize(points.size() + 1);
    bool symmetric = true, softens = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        factored_states_[i] = points[i].response.state;
        softens = softens || points[i].response.softens;
    }
    for (const bool softening : {true, false}) {
        if (softening && !softens) continue;
        tangents_.clear();
        for (const LoosePoint& point : points) {
            const Eigen::Matrix2d D = tangent(point.law, point.response, softening);
            if (D.isZero(0)) continue;
            symmetric = symmetric && D(0, 1) == D(1, 0);
            Eigen::Matrix2d axes;
            axes << point.normal, turned_left(point.normal);
            tangents_.push_back({point.before, point.after, axes * D * axes.transpose()});
        }
        ++counts_.factorisations;
        indefinite_ = softens && !softening;
        if (matrix_.factorise(tangents_, symmetric)) return true;
    }
    factored_states_.clear();
    return false;
}

double AugmentedLagrangian::step_length(const std::vector<LoosePoint>& points, const std::vector<Vec2>& direction,
                                        const std::vector<Vec2>& changed) const {
    // slope along the step: d . (taken + a M_hat d - H' q(w + a d)); monotone and piecewise linear where the problem is convex
    double at_start = 0, bulk_slope = 0;
    for (std::size_t i = 0; i < direction.size(); ++i) at_start += direction[i].dot(taken_[i]), bulk_slope += direction[i].dot(changed[i]);
    std::vector<Vec2> turn(points.size());
    for (std::size_t j = 0; j < points.size(); ++j)
        turn[j] = points[j].in_frame(rate_of(direction, points[j].after) - rate_of(direction, points[j].before));
    const auto slope = [&](double a) {
        double sum = at_start + a * bulk_slope;
        for (std::size_t j = 0; j < points.size(); ++j) {
            if (turn[j].isZero(0)) continue;
            const Vec2 rate = points[j].rate + a * turn[j];
            const PointResponse r = respond(points[j].law, rate.x(), rate.y());
            sum -= r.normal(points[j].law) * turn[j].x() + r.tangential * turn[j].y();
        }
        return sum;
    };
    double low = 0, slope_low = slope(0), high = 1, slope_high = slope(1);
    if (slope_low >= 0 || slope_high <= 0.1 * std::abs(slope_low)) return 1;
    // overshoot: the zero between, by secants that cannot stall (Illinois)
    double a = 1;
    for (int i = 0, side = 0; i < 30; ++i) {
        a = (low * slope_high - high * slope_low) / (slope_high - slope_low);
        const double here = slope(a);
        if (std::abs(here) <= 1e-3 * std::abs(slope(0))) break;
        if (here > 0) {
            high = a, slope_high = here;
            if (side == 1) slope_low /= 2;
            side = 1;
        } else {
            low = a, slope_low = here;
            if (side == -1) slope_high /= 2;
            side = -1;
        }
    }
    return a;
}

bool AugmentedLagrangian::find_rates(const ImplicitBulk& bulk, std::vector<LoosePoint>& points, std::vector<Vec2>& rate, double tolerance) {
    double before = std::numeric_limits<double>::infinity();
    int stalled = 0;
    for (int i = 0; i < most_newton_steps; ++i) {
        evaluate(bulk, points, rate);
        const double norm = residual_norm();
        if (norm <= tolerance) return true;
        stalled = norm > 0.5 * before ? stalled + 1 : 0;
        if (stalled >= 3 && norm <= 1e3 * tolerance) return true;  // rounding; the judge of the step has the last word
        before = norm;
        if (!prepare_matrix(points)) return false;
        std::vector<Vec2> downhill = residual_;
        for (Vec2& r : downhill) r = -r;
        matrix_.solve(downhill, direction_);
        ++counts_.linear_solves;
        bulk.apply_matrix(direction_, changed_);
        const double a = step_length(points, direction_, changed_);
        for (std::size_t n = 0; n < rate.size(); ++n) rate[n] += a * direction_[n];
    }
    return false;
}

double AugmentedLagrangian::move_multipliers(std::vector<LoosePoint>& points) const {
    double change = 0;
    for (LoosePoint& point : points) {
        change = std::max({change, std::abs(point.response.contact - point.law.contact_guess),
                           std::abs(point.response.tangential - point.law.tangential_guess)});
        point.law.contact_guess = point.response.contact;
        point.law.tangential_guess = point.response.tangential;
    }
    return change;
}

AugmentedLagrangian::Status AugmentedLagrangian::solve(const ImplicitBulk& bulk, std::vector<LoosePoint>& points, std::vector<Vec2>& rate,
                                                       double scale) {
    counts_ = {};
    const double unit = scale > 0 ? scale : 1;
    for (int outer = 0; outer < most_outer_steps; ++outer) {
        ++counts_.outer;
        if (!find_rates(bulk, points, rate, balance_tolerance * unit)) return Status::not_converged;
        if (move_multipliers(points) <= multiplier_tolerance * unit) return Status::solved;
    }
    return Status::not_converged;
}

}  // namespace knap
