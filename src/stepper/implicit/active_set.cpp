#include "stepper/implicit/active_set.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

// It is given up after this many steps, or where that many do not lead nearer.
constexpr int max_steps = 40, max_stalled_steps = 6, first_local_step = 2, max_marching_steps = 2;
constexpr int min_stalled_steps = 4;   // before the friction of points that cycle lags
constexpr double lost_balance = 1e6;   // of the scale: all friction lags, from the first guess
constexpr double near_balance = 1e-6;  // of the scale
constexpr double law_goal = NewtonIteration::law_goal, law_tolerance = NewtonIteration::law_tolerance;

}  // namespace

ActiveSet::ActiveSet(const Model& model, ThetaMatrix& matrix, NewtonIteration& newton, LineSearch& line_search)
    : matrix_(matrix),
      newton_(newton),
      line_search_(line_search),
      local_(model, matrix),
      lag_(model.fan_points.size()),
      series_(model, matrix) {
    reserve_capacity(model.fan_points.size() + 1, pieces_, moves_);
}

void ActiveSet::begin() {
    const std::size_t n = newton_.x.points.size();
    pieces_.assign(n, ~0u), moves_.resize(n);
    lag_.begin(n), local_.forget(), series_.forget();
    norm_ = infinity, n_found_ = 0;
    begin_anew();
}

/// What was reached so far says nothing about what follows.
void ActiveSet::begin_anew() {
    longest_move_ = best_ = infinity, fewest_ = newton_.x.points.size() + 1, stalled_ = marching_ = 0;
}

ActiveSet::Result ActiveSet::find(bool friction, const Iterate& first) {
    newton_.set_augmentation(newton_.final_augmentation);
    friction_ = may_restart_ = friction, completed_ = false, whole_ = infinity;
    begin();
    for (int i = 0; i < max_steps; ++i) {
        newton_.give_up_if_asked();
        evaluate();
        Checkpoint next = judge();
        if (next == Checkpoint::move) next = find_direction(i);
        if (next == Checkpoint::solved || next == Checkpoint::given_up) break;
        if (next == Checkpoint::complete) newton_.system.complete(), completed_ = true;
        else if (next == Checkpoint::restart) restart(first), i = -1;
        else move();
    }
    if (lag_.end(newton_.x.points)) newton_.newton_matrix.forget();
    for (ActivePoint& point : newton_.x.points) point.multipliers.contact = std::max(0.0, point.multipliers.contact);
    if (n_found_ < 2) return norm_ <= near_balance * unit_ ? Result::nearly : Result::cycling;
    newton_.unit = unit_;
    return newton_.newton_matrix.is_indefinite() ? Result::cycling : Result::found;
}

/// The residual with the equations of the piece on which each point is, the points that changed theirs, and the scale.
void ActiveSet::evaluate() {
    newton_.system.evaluate();
    std::vector<ActivePoint>& points = newton_.x.points;
    n_changed_ = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
        ActivePoint& point = points[j];
        point.rate = point.rate_at(newton_.x.rate);
        point.response = respond(point.law, point.softened(), point.rate.x(), point.rate.y());
        if (std::exchange(pieces_[j], point.response.state) != point.response.state) ++n_changed_, lag_.count_change(j);
        const Vec2 q = point.impulse_of_piece(point.rate);
        const double normal = q.x() - point.law.strength * point.response.cohesion_theta;
        point.sides.add_force(-point.out_of_frame({normal, q.y()}), newton_.system.residual());
    }
    if (lag_.settles(n_changed_, points)) newton_.newton_matrix.forget(), begin_anew();
    last_norm_ = std::exchange(norm_, newton_.residual());
    unit_ = newton_.unit;
    for (const ActivePoint& point : points)
        unit_ = std::max(unit_, std::min(point.response.contact, newton_.largest_unit));
}

ActiveSet::Checkpoint ActiveSet::judge() {
    const std::vector<ActivePoint>& points = newton_.x.points;
    const double multiplier_unit = newton_.final_augmentation * unit_, tolerance = newton_.balance_goal(unit_);
    const double near = NewtonIteration::preliminary_goal;
    const bool near_enough = newton_.is_preliminary() && norm_ <= near * unit_ &&
                             longest_move_ <= near * multiplier_unit && largest_friction_lag(points) <= near * unit_;
    // one step more than the tolerance asks for: it costs no factor and takes the error to rounding
    const bool exact =
        (norm_ <= tolerance && longest_move_ <= law_goal * multiplier_unit) ||
        (norm_ > 0.5 * best_ && norm_ <= 1e3 * tolerance && longest_move_ <= law_tolerance * multiplier_unit);
    const bool found = near_enough || (exact && !lag_.is_used());
    if (found && newton_.system.is_condensed()) return Checkpoint::complete;
    const bool of_whole_body = std::exchange(completed_, false);
    // the balance of the whole body no longer falls: what is left is rounding
    const bool rounding = of_whole_body && !lag_.is_used() && norm_ > 0.5 * std::exchange(whole_, norm_) &&
                          norm_ <= 1e3 * tolerance && longest_move_ <= law_tolerance * multiplier_unit;
    // contacts alone, on a dense matrix: steps go on to rounding for nothing, and only those of the body cost
    const bool is_enough = newton_.is_preliminary() || (of_whole_body && matrix_.is_reduced() && norm_ <= tolerance &&
                                                        points.front().fan < 0);  // points of fans come first
    n_found_ = rounding || (found && is_enough) ? 2 : n_found_ + found;
    if (n_found_ == 2) return Checkpoint::solved;
    // nearly redundant points, contradictory bounds: the multipliers converge linearly or move by the same step for
    // ever, and their extrapolation is quicker
    const bool slow = (n_changed_ == 0 && !of_whole_body && norm_ > NewtonIteration::slow_ratio * last_norm_) ||
                      marching_ >= max_marching_steps;
    is_series_ = slow && norm_ <= near_balance * unit_ && n_found_ == 0 && !lag_.is_used();
    if (!is_series_) series_.forget();
    if (n_changed_ < fewest_ || (n_changed_ == fewest_ && norm_ < 0.5 * best_)) stalled_ = 0;
    else if (++stalled_ == max_stalled_steps) return Checkpoint::given_up;
    if (stalled_ >= min_stalled_steps && lag_.hold_back_cycling(newton_.x.points))
        newton_.newton_matrix.forget(), begin_anew();
    fewest_ = std::min(fewest_, n_changed_), best_ = std::min(best_, norm_);
    return may_restart_ && norm_ > lost_balance * unit_ ? Checkpoint::restart : Checkpoint::move;
}

/// Newton's direction, and the impulses of points that are solved by themselves.
ActiveSet::Checkpoint ActiveSet::find_direction(int i) {
    if (!newton_.find_direction()) return may_restart_ ? Checkpoint::restart : Checkpoint::given_up;
    const bool are_local = friction_ && i >= first_local_step &&
                           local_.solve(newton_.x.points, newton_.system.direction(), newton_.newton_matrix.softening(),
                                        newton_.unit, newton_.system.residual());
    return are_local && !newton_.find_direction() ? Checkpoint::given_up : Checkpoint::move;
}

void ActiveSet::restart(const Iterate& first) {
    may_restart_ = false;
    newton_.restart_from(first), newton_.set_augmentation(newton_.final_augmentation);
    begin(), lag_.hold_back_all(newton_.x.points), newton_.newton_matrix.forget();
}

/// How far the multipliers are from the impulses of the pieces after the whole step.
void ActiveSet::find_moves() {
    const double last_move = std::exchange(longest_move_, 0.0);
    for (std::size_t j = 0; j < moves_.size(); ++j) {
        const ActivePoint& point = newton_.x.points[j];
        const Vec2 q = local_.has(j) ? local_.impulse(j)
                                     : point.impulse_of_piece(point.rate + point.across(newton_.system.direction()));
        moves_[j] = q - Vec2(point.multipliers.contact, point.multipliers.tangential);
        if (std::isinf(point.multipliers.rho_T)) moves_[j].y() = 0;
        longest_move_ = std::max(longest_move_, moves_[j].cwiseAbs().maxCoeff());
    }
    marching_ = friction_ && longest_move_ > NewtonIteration::same_move * last_move ? marching_ + 1 : 0;
}

void ActiveSet::move() {
    find_moves();
    std::vector<ActivePoint>& points = newton_.x.points;
    const double a = line_search_.length_on_soft_springs(newton_.system, points, moves_);
    newton_.system.step(a);
    for (std::size_t j = 0; j < moves_.size(); ++j) {
        points[j].multipliers.contact += a * moves_[j].x();
        points[j].multipliers.tangential += a * moves_[j].y();
    }
    if (is_series_ && a == 1) series_.extrapolate(moves_, law_goal * newton_.final_augmentation * unit_, points);
    lag_.advance(points);
}

}  // namespace knap
