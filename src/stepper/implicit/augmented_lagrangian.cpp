#include "stepper/implicit/augmented_lagrangian.hpp"

#include "base/room.hpp"
#include "base/secant.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace knap {
namespace {

constexpr int max_newton_steps = 400, max_outer_steps = 100, max_wandering_steps = 30, max_friction_rounds = 60;
constexpr double law_goal = 1e-13;       // of the scale: natural residual of the laws
constexpr double law_tolerance = 5e-11;  // likewise, where rounding leaves no more: so many rounds below it
constexpr int max_near = 5;
constexpr double full_augmentation = 1e3;    // of the inertia and stiffness of a point's corners: a move of the multipliers gains three digits
// With friction, and where contacts round a vertex contradict each other, the pieces of a few fans may go round in a circle from move to move. Which of them do
// depends on the augmentation, so then others are tried, each from the beginning
constexpr std::array other_augmentations{300.0, 3e3, 100.0, 1e4};
constexpr double balance_tolerance = 1e-12;  // of the scale
// On stiff springs a Newton step ends at the first points that change their piece. What so many steps do not find is approached on soft ones
constexpr int max_direct_steps = 20;
constexpr double soft_augmentation = 10, hardening = 3, soft_tolerance = 1e-4;

}  // namespace

AugmentedLagrangian::AugmentedLagrangian(const Model& model, ThetaMatrix& matrix) : matrix_(matrix), extrapolation_(model) {
    make_room(model.mesh.n_corners(), bulk_impulse_, residual_, downhill_, direction_, changed_, rate_before_, first_rate_);
    make_room(model.fan_points.size() + 1, factored_states_, tangents_, turn_, last_multipliers_, points_before_, first_points_);
}

void AugmentedLagrangian::evaluate(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, const std::vector<Vec2>& rate) {
    bulk.bulk_impulse(rate, corner_impulse_);
    bulk.sum_to_nodes(corner_impulse_, bulk_impulse_);
    residual_ = bulk_impulse_;
    for (ActivePoint& point : points) {
        point.rate = point.rate_at(rate);
        point.response = respond(point.law, point.rate.x(), point.rate.y());
        const Vec2 impulse = point.impulse();
        if (point.beside >= 0) residual_[point.beside] -= point.share * impulse;
        if (point.after >= 0) residual_[point.after] -= (1 - point.share) * impulse;
        if (point.before >= 0) residual_[point.before] += impulse;
    }
}

double AugmentedLagrangian::residual(Index node) const {
    double largest = 0;
    for (int k = 0; k < 2; ++k)
        if (matrix_.is_free(node, k)) largest = std::max(largest, std::abs(residual_[node][k]));
    return largest;
}

Index AugmentedLagrangian::worst_node() const {
    Index worst = 0;
    for (Index i = 1; i < static_cast<Index>(residual_.size()); ++i)
        if (residual(i) > residual(worst)) worst = i;
    return worst;
}

void AugmentedLagrangian::make_tangents(const std::vector<ActivePoint>& points, Softening softening) {
    tangents_.clear();
    for (const ActivePoint& point : points) {
        const Eigen::Matrix2d D = tangent(point.law, point.response, softening);
        if (D.isZero(0)) continue;
        Eigen::Matrix2d axes, without_friction = D;
        axes << point.normal, turned_left(point.normal);
        if (D(1, 0) != D(0, 1)) without_friction(0, 1) = without_friction(1, 0) = 0;
        const Eigen::Matrix2d block = axes * D * axes.transpose();
        tangents_.push_back({.fan_point = point.fan_point,
                             .before = point.before,
                             .after = point.after,
                             .block = block,
                             .symmetric_block = D(1, 0) == D(0, 1) ? block : axes * without_friction * axes.transpose(),
                             .leaf_corner = point.leaf_corner,
                             .beside = point.beside,
                             .share = point.share});
    }
}

bool AugmentedLagrangian::has_several_solutions(const std::vector<ActivePoint>& points) {
    if (indefinite_) return true;
    constexpr int max_broken = 8;
    std::array<const ActivePoint*, max_broken> broken;
    Eigen::Index n = 0;
    for (const ActivePoint& point : points) {
        if (!point.response.breaks || point.law.cohesion <= 0) continue;
        if (n < max_broken) broken[n] = &point;
        ++n;
    }
    if (n == 0) return false;
    if (factored_states_.empty() || !matrix_.is_symmetric() || n > max_broken) {
        make_tangents(points, Softening::at_all);
        forget_factor();
        return !matrix_.factorise(tangents_);
    }
    // few: A - G C G' is definite if and only if C^-1 - G' A^-1 G is (A as it is factorised is definite)
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, max_broken, max_broken>;
    Small left = Small::Zero(n, n);
    std::vector<Vec2>& pull = downhill_;
    for (Eigen::Index j = 0; j < n; ++j) {
        const ActivePoint& point = *broken[j];
        pull.assign(residual_.size(), Vec2::Zero());
        const Vec2 g = loss_direction(point.law, point.response), force = g.x() * point.normal + g.y() * turned_left(point.normal);
        if (point.after >= 0) pull[point.after] += force;
        if (point.before >= 0) pull[point.before] -= force;
        matrix_.solve(pull, direction_);
        ++counts_.linear_solves;
        for (Eigen::Index i = 0; i < n; ++i) {
            const ActivePoint& other = *broken[i];
            left(i, j) = -loss_direction(other.law, other.response).dot(other.across(direction_));
        }
        left(j, j) += 1 / softening_modulus(point.law);
    }
    return left.llt().info() != Eigen::Success;
}

bool AugmentedLagrangian::prepare_matrix(const std::vector<ActivePoint>& points) {
    bool same = factored_states_.size() == points.size() + 1;  // one more, so that no points are not the same as no factor
    for (std::size_t i = 0; same && i < points.size(); ++i) same = factored_states_[i] == points[i].response.state;
    if (same) return true;
    factored_states_.resize(points.size() + 1);
    bool softens = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        factored_states_[i] = points[i].response.state;
        softens = softens || points[i].response.softens;
    }
    for (const Softening softening : {Softening::now, Softening::none}) {
        if (softening == Softening::now && !softens) continue;
        make_tangents(points, softening);
        ++counts_.factorisations;
        indefinite_ = softens && softening == Softening::none;
        if (matrix_.factorise(tangents_)) return true;
    }
    factored_states_.clear();
    return false;
}

double AugmentedLagrangian::step_length(const std::vector<ActivePoint>& points, const std::vector<Vec2>& direction,
                                        const std::vector<Vec2>& changed) {
    // slope along the step: d . (bulk_impulse + a M_hat d - H' q(w + a d)); monotone and piecewise linear where the problem is convex
    double at_start = 0, bulk_slope = 0;
    for (std::size_t i = 0; i < direction.size(); ++i) at_start += direction[i].dot(bulk_impulse_[i]), bulk_slope += direction[i].dot(changed[i]);
    std::vector<Vec2>& turn = turn_;
    turn.resize(points.size());
    for (std::size_t j = 0; j < points.size(); ++j) turn[j] = points[j].across(direction);
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
    const double slope_at_start = slope(0);
    double low = 0, slope_low = slope_at_start, high = 1, slope_high = slope(1);
    if (slope_low >= 0 || std::abs(slope_high) <= 0.1 * std::abs(slope_low)) return 1;
    for (int i = 0; slope_high < 0; ++i) {  // still downhill: a majorised step was too short
        if (i == 10) return high;
        low = high, slope_low = slope_high;
        high *= 2, slope_high = slope(high);
    }
    return zero_between(low, slope_low, high, slope_high, 1e-3 * std::abs(slope_at_start), 30, slope);
}

bool AugmentedLagrangian::find_rates(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double tolerance,
                                     int max_steps) {
    double best = std::numeric_limits<double>::infinity();
    int stalled = 0;
    for (int i = 0; i < max_steps; ++i) {
        if (given_up_ && given_up_()) throw StepGivenUp{};
        evaluate(bulk, points, rate);
        const double norm = residual(worst_node());
        if (norm <= tolerance) return true;
        stalled = norm > 0.5 * best ? stalled + 1 : 0;
        if (stalled >= 3 && norm <= 1e3 * tolerance) return true;  // rounding; the judge of the step has the last word
        best = std::min(best, norm);
        if (!prepare_matrix(points)) return false;
        downhill_ = residual_;
        for (Vec2& r : downhill_) r = -r;
        matrix_.solve(downhill_, direction_);
        ++counts_.linear_solves;
        bulk.apply_matrix(direction_, changed_);
        // near the end rounding hides the slope
        const double a = stalled > 0 && norm <= 1e3 * tolerance ? 1 : step_length(points, direction_, changed_);
        for (std::size_t n = 0; n < rate.size(); ++n) rate[n] += a * direction_[n];
    }
    return false;
}

double AugmentedLagrangian::move_multipliers(std::vector<ActivePoint>& points) const {
    double change = 0;
    for (ActivePoint& point : points) {
        change = std::max({change, std::abs(point.response.contact - point.law.contact_guess),
                           std::abs(point.response.tangential - point.law.tangential_guess)});
        point.law.contact_guess = point.response.contact;
        point.law.tangential_guess = point.response.tangential;
    }
    return change;
}

bool AugmentedLagrangian::approach(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double tolerance) {
    if (find_rates(bulk, points, rate, tolerance, max_direct_steps)) return true;
    for (double augmentation = soft_augmentation; augmentation < settled_augmentation_; augmentation *= hardening) {
        augment(points, augmentation);
        if (!find_rates(bulk, points, rate, soft_tolerance * unit_, max_newton_steps)) return false;
        move_multipliers(points);
    }
    augment(points, settled_augmentation_);
    return find_rates(bulk, points, rate, tolerance, max_newton_steps);
}

bool AugmentedLagrangian::settle(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate, double goal,
                                 int max_steps) {
    const bool has_potential = std::none_of(points.begin(), points.end(), [](const ActivePoint& p) { return p.law.friction > 0 && p.law.friction_follows; });
    std::vector<Vec2>& last = last_multipliers_;
    last.resize(points.size());
    extrapolation_.begin();
    augment(points, settled_augmentation_);
    for (int outer = 0, n_near = 0; outer < max_outer_steps; ++outer) {
        const int solves = counts_.linear_solves;
        const double tolerance = std::max(balance_tolerance * unit_, 4e-18 * settled_augmentation_ * bulk.largest_impulse());
        const bool first = outer == 0 && has_potential;
        if (!(first ? approach(bulk, points, rate, tolerance) : find_rates(bulk, points, rate, tolerance, max_steps))) return false;
        if (!first) max_steps -= counts_.linear_solves - solves;
        for (const ActivePoint& point : points)  // impacts give more than strengths
            unit_ = std::max(unit_, std::min(point.response.contact, largest_unit_));
        for (std::size_t j = 0; j < points.size(); ++j) last[j] = {points[j].law.contact_guess, points[j].law.tangential_guess};
        const double unit = settled_augmentation_ * unit_, moved = move_multipliers(points);
        n_near += moved <= law_tolerance * unit;
        if (moved <= goal * unit || n_near == max_near) return true;
        extrapolation_.apply(matrix_, points, last, goal * unit);
    }
    return false;
}

void AugmentedLagrangian::find_friction(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate) {
    for (ActivePoint& point : points) point.law.friction_follows = false, point.law.pressed = point.law.contact_guess;
    double goal = 1e-4;
    for (int round = 0; round < max_friction_rounds; ++round) {
        const int factorisations = counts_.factorisations;
        if (!settle(bulk, points, rate, goal, max_newton_steps)) break;
        double lag = 0;
        for (ActivePoint& p : points) {
            const double behind = p.response.contact - p.law.pressed;
            lag = std::max(lag, p.law.friction * std::abs(behind));
            p.law.pressed += 0.5 * behind;  // half of the way: all of it can swing for ever
        }
        if (counts_.factorisations == factorisations) break;  // the pieces stand: Newton's method will not wander
        goal = std::min(goal, 1e-3 * lag / unit_);
    }
    for (ActivePoint& point : points) point.law.friction_follows = true;
    forget_factor();
}

AugmentedLagrangian::Status AugmentedLagrangian::solve(const ImplicitBulk& bulk, std::vector<ActivePoint>& points, std::vector<Vec2>& rate,
                                                       double scale, double largest_scale) {
    counts_ = {};
    unit_ = scale > 0 ? scale : 1;
    largest_unit_ = largest_scale;
    if (!std::isfinite(unit_ + bulk.largest_impulse())) return Status::not_converged;  // every tolerance would be met
    const bool rubs = std::any_of(points.begin(), points.end(), [](const ActivePoint& p) { return p.law.friction > 0; });
    const auto attempt = [&](int max_steps) {
        points_before_ = points, rate_before_ = rate;
        if (settle(bulk, points, rate, law_goal, max_steps)) return true;
        points = points_before_, rate = rate_before_;
        return false;
    };
    first_points_ = points, first_rate_ = rate;
    settled_augmentation_ = full_augmentation;
    // Coulomb's law is no gradient: Newton's method may wander. Then friction is bounded by the contact of the round before for a while
    const int n_attempts = rubs ? 4 : 1;
    for (int i = 1; i <= n_attempts; ++i) {
        if (attempt(i == n_attempts ? max_newton_steps : max_wandering_steps)) return Status::solved;
        if (rubs) find_friction(bulk, points, rate);
    }
    // obstacles meet through the whole body, and may jam it: then a smaller step is the better answer
    if (std::any_of(points.begin(), points.end(), [](const ActivePoint& p) { return p.fan < 0; })) return Status::not_converged;
    for (const double other : other_augmentations) {
        points = first_points_, rate = first_rate_;
        unit_ = scale > 0 ? scale : 1;
        settled_augmentation_ = other;
        if (attempt(max_newton_steps)) return Status::solved;
        if (!rubs) continue;
        find_friction(bulk, points, rate);
        if (attempt(max_newton_steps)) return Status::solved;
    }
    return Status::not_converged;
}

void AugmentedLagrangian::augment(std::vector<ActivePoint>& points, double augmentation) {
    for (ActivePoint& point : points) {
        point.law.rho_N = augmentation * point.mass;
        if (!std::isinf(point.law.rho_T)) point.law.rho_T = augmentation * point.mass;
    }
    if (augmentation == augmentation_) return;
    augmentation_ = augmentation;
    forget_factor();
}

}  // namespace knap
