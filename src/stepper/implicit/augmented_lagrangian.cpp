#include "stepper/implicit/augmented_lagrangian.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

constexpr int max_newton_steps = 400, max_outer_steps = 100, max_cycling_steps = 30, max_friction_rounds = 60;
constexpr int max_near = 5, max_completions = 3;
constexpr double full_augmentation = 1e3;  // of the point's mass: each round of multipliers gains three digits
// With friction, and where contacts round a vertex contradict each other, a few fans may cycle through their pieces.
// Which fans do depends on the augmentation, so others are tried, each from the first guess.
constexpr std::array other_augmentations{300.0, 3e3, 100.0, 1e4};
// Where faces meet flush, vertices of both sides bear self-stresses that hardly load their nodes; stiffer springs find
// them in fewer rounds.
constexpr double face_augmentation = 1e4;
constexpr std::array other_face_augmentations{1e3, 3e4, 300.0, 1e5};
// On stiff springs a Newton step ends at the first points that change their piece. Penalty continuation from soft
// springs follows where this many steps do not converge.
constexpr int max_direct_steps = 20;
constexpr int max_swept_steps = 12;       // of a round: where they do not end it, their moves of multipliers may be why
constexpr double sweep_goal = 1e-4;       // of the scale: a smaller residual of the balance is left to Newton's steps
constexpr double inexact_balance = 1e-3;  // of the last move of the multipliers
constexpr std::size_t min_points = 16;    // of a problem for the active set
// The active set is given up after this many steps, or where that many do not lead nearer.
constexpr int max_piece_steps = 40, max_stalled_steps = 6, first_local_step = 2, max_marching_steps = 2;
constexpr int min_stalled_steps = 4;                 // before the friction of points that cycle lags
constexpr double lost_balance = 1e6;                 // of the scale: all friction lags, from the first guess
constexpr double near_balance = 1e-6;                // of the scale
constexpr double slow_ratio = 0.3, same_move = 0.7;  // of a residual, a move of multipliers to the one before
constexpr double soft_augmentation = 10, hardening = 3, soft_tolerance = 1e-4;
// Where a body is driven against itself its contact impulses grow without bound. Beyond this multiple of the largest
// scale their rounding hides the balance, so the attempt is given up, and after three of them the problem.
constexpr double jammed = 1e6;

}  // namespace

AugmentedLagrangian::AugmentedLagrangian(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix,
                                         Iterate& iterate)
    : bulk_(bulk),
      matrix_(matrix),
      x_(iterate),
      system_(model, bulk, matrix, iterate.rate),
      newton_matrix_(model, matrix),
      fans_(model, matrix),
      line_search_(model),
      local_(model, matrix),
      lag_(model.fan_points.size()),
      series_(model, matrix),
      cycle_(model.fan_points.size()) {
    reserve_capacity(model.mesh.n_corners(), before_.rate, first_.rate, completed_.rate);
    reserve_capacity(model.fan_points.size() + 1, pieces_, move_, before_.points, first_.points, completed_.points);
}

bool AugmentedLagrangian::solve(double scale, double largest_scale, Effort effort, Precision precision) {
    const double first_unit = scale > 0 ? scale : 1;
    counts_ = {}, unit_ = first_unit, largest_unit_ = largest_scale, n_jams_ = 0;
    if (!std::isfinite(unit_ + bulk_.largest_impulse())) return false;  // every tolerance would be met
    const bool friction = std::ranges::any_of(x_.points, [](const ActivePoint& p) { return p.law.friction > 0; });
    const bool obstacles = std::ranges::any_of(x_.points, [](const ActivePoint& p) { return p.fan < 0; });
    const bool faces = std::ranges::any_of(x_.points, [](const ActivePoint& p) { return p.fan == between_faces; });
    const auto attempt = [&](int max_steps) {
        before_ = x_;
        if (find_solution(max_steps)) return true;
        restart_from(before_);
        return false;
    };
    const auto begin_again = [&] { restart_from(first_), unit_ = first_unit; };
    first_ = x_, final_augmentation_ = faces ? face_augmentation : full_augmentation;
    sweeps_ = x_.points.size() >= min_points;
    // on ramps of secant unloading the active set found other solutions with friction than the method of multipliers
    const bool has_pieces =
        sweeps_ && std::ranges::none_of(x_.points, [](const ActivePoint& p) { return p.law.ramp > 0; });
    Pieces pieces = Pieces::cycling;
    const auto solve_pieces = [&] {
        pieces = find_pieces(friction);
        if (pieces == Pieces::found && is_preliminary()) return true;
        return pieces != Pieces::cycling && find_solution(max_cycling_steps) &&
               (pieces == Pieces::found || !newton_matrix_.is_indefinite());
    };
    precision_ = Precision::full;
    if (has_pieces && system_.begin_reduced(x_.points)) {  // on the dense matrix of a few points
        const bool solved = solve_pieces();
        if (solved && residual() <= balance_goal(unit_)) return true;
        if (solved) system_.forget();  // its rounding is too large for the balance of the body, which goes on from here
        else begin_again();
    }
    system_.begin(x_.points);
    fans_.begin(x_.points);
    if (sweeps_) {
        precision_ = precision;
        if (!friction) {
            if (find_solution(max_newton_steps)) return true;
            begin_again();
        }
        if (has_pieces && solve_pieces()) return true;
        // Where it cycles, the energy of the springs may lead on; within Assumption 1 the solution is the same one.
        if (pieces != Pieces::found && !friction && !newton_matrix_.is_indefinite() &&
            find_solution(max_newton_steps) && !newton_matrix_.is_indefinite())
            return true;
    }
    begin_again();
    // Coulomb's law has no potential, so Newton's method may cycle. Tresca's law then leads nearer to the solution.
    const int n_attempts = !friction ? 1 : effort == Effort::little ? 3 : 4;
    for (int i = 1; i <= n_attempts; ++i) {
        const bool cycles = has_pieces && friction && i == 1;
        if (!cycles && attempt(i == n_attempts ? max_newton_steps : max_cycling_steps)) return true;
        if (is_jammed()) return false;
        if (friction && i < n_attempts && iterate_friction()) return true;
    }
    // obstacles couple the whole body and may jam it: a smaller step is the better answer
    if (effort == Effort::little || (obstacles && !faces)) return false;
    for (const double other : faces ? other_face_augmentations : other_augmentations) {
        begin_again(), final_augmentation_ = other;
        if (attempt(max_newton_steps)) return true;
        if (is_jammed()) return false;
        if (friction && (iterate_friction() || attempt(max_newton_steps))) return true;
    }
    return false;
}

void AugmentedLagrangian::restart_from(const Iterate& iterate) {
    x_ = iterate;
    system_.forget();
}

/// Rates of all nodes by the method of multipliers; one step of the whole body removes what rounding added on the way.
/// ImplicitScheme::check_residual decides where it cannot.
bool AugmentedLagrangian::find_solution(int max_steps) {
    if (is_preliminary()) {
        if (!find_multipliers(preliminary_goal, 0, max_steps)) return false;
        complete_and_evaluate();
        return true;
    }
    for (int i = 0; i < max_completions; ++i) {
        const bool found = find_multipliers(law_goal, i == 0 && sweeps_ ? sweep_goal * unit_ : 0, max_steps);
        if (!found && i == 0) return false;
        if (!found) restart_from(completed_);
        if (!found) break;
        if (!system_.is_condensed()) return true;  // balanced with these multipliers
        system_.complete();
        completed_ = x_;
        evaluate();
        if (find_direction()) system_.step(1), system_.complete();
    }
    evaluate();
    return true;
}

/// Newton's method on the laws themselves. An augmentation of the size of inertia and stiffness shows on which piece of
/// its law a point is; a step solves the equations of these pieces, on stiff springs, with multipliers that follow at
/// once. (Stiff springs would stop it at the first point that changes its piece.)
AugmentedLagrangian::Pieces AugmentedLagrangian::find_pieces(bool friction) {
    set_augmentation(final_augmentation_);
    double move, best, norm = infinity, unit = unit_;
    double whole = infinity;  // balance of the whole body after the last completion
    bool completed = false, may_restart = friction;
    int n_found = 0, stalled, marching;
    std::size_t fewest;
    const auto begin_anew = [&] { move = best = infinity, fewest = x_.points.size() + 1, stalled = marching = 0; };
    const auto begin = [&] {
        pieces_.assign(x_.points.size(), ~0u), move_.resize(x_.points.size());
        lag_.begin(x_.points.size()), local_.forget();
        begin_anew();
    };
    begin();
    for (int i = 0; i < max_piece_steps; ++i) {
        if (given_up_ && given_up_()) throw StepGivenUp{};
        const std::size_t n_changed = evaluate_pieces();
        if (lag_.settles(n_changed, x_.points)) newton_matrix_.forget(), begin_anew();
        const double last_norm = std::exchange(norm, residual());
        unit = unit_;
        for (const ActivePoint& point : x_.points)
            unit = std::max(unit, std::min(point.response.contact, largest_unit_));
        const double multiplier_unit = final_augmentation_ * unit, tolerance = balance_goal(unit);
        const bool near_enough = is_preliminary() && norm <= preliminary_goal * unit &&
                                 move <= preliminary_goal * multiplier_unit &&
                                 largest_friction_lag(x_.points) <= preliminary_goal * unit;
        // one step more than the tolerance asks for: it costs no factor and takes the error to rounding
        const bool exact = (norm <= tolerance && move <= law_goal * multiplier_unit) ||
                           (norm > 0.5 * best && norm <= 1e3 * tolerance && move <= law_tolerance * multiplier_unit);
        const bool found = near_enough || (exact && !lag_.is_used());
        if (found && system_.is_condensed()) {
            system_.complete();
            completed = true;
            continue;
        }
        const bool of_whole_body = std::exchange(completed, false);
        // the balance of the whole body no longer falls: what is left is rounding
        const bool rounding = of_whole_body && !lag_.is_used() && norm > 0.5 * std::exchange(whole, norm) &&
                              norm <= 1e3 * tolerance && move <= law_tolerance * multiplier_unit;
        // contacts alone, on a dense matrix: steps go on to rounding for nothing, and only those of the body cost
        const bool is_enough = is_preliminary() || (of_whole_body && matrix_.is_reduced() && norm <= tolerance &&
                                                    x_.points.front().fan < 0);  // points of fans come first
        n_found = rounding || (found && is_enough) ? 2 : n_found + found;
        if (n_found == 2) break;
        // nearly redundant points, contradictory bounds: the multipliers converge linearly or move by the same step for
        // ever, and their extrapolation is quicker
        const bool slow =
            (n_changed == 0 && !of_whole_body && norm > slow_ratio * last_norm) || marching >= max_marching_steps;
        const bool is_series = slow && norm <= near_balance * unit && n_found == 0 && !lag_.is_used();
        if (!is_series) series_.forget();
        if (n_changed < fewest || (n_changed == fewest && norm < 0.5 * best)) stalled = 0;
        else if (++stalled == max_stalled_steps) break;
        if (stalled >= min_stalled_steps && lag_.hold_back_cycling(x_.points)) newton_matrix_.forget(), begin_anew();
        fewest = std::min(fewest, n_changed), best = std::min(best, norm);
        if ((may_restart && norm > lost_balance * unit) || !find_direction()) {
            if (!std::exchange(may_restart, false)) break;
            restart_from(first_), set_augmentation(final_augmentation_);
            begin(), lag_.hold_back_all(x_.points), newton_matrix_.forget();
            i = -1, n_found = 0, norm = infinity;
            continue;
        }
        if (friction && i >= first_local_step &&
            local_.solve(x_.points, system_.direction(), newton_matrix_.softening(), unit_, system_.residual()) &&
            !find_direction())
            break;
        const double last_move = std::exchange(move, 0.0);
        for (std::size_t j = 0; j < move_.size(); ++j) {
            const ActivePoint& point = x_.points[j];
            const Vec2 q = local_.has(j) ? local_.impulse(j)
                                         : point.impulse_of_piece(point.rate + point.across(system_.direction()));
            move_[j] = q - Vec2(point.multipliers.contact, point.multipliers.tangential);
            if (std::isinf(point.multipliers.rho_T)) move_[j].y() = 0;
            move = std::max(move, move_[j].cwiseAbs().maxCoeff());
        }
        marching = friction && move > same_move * last_move ? marching + 1 : 0;
        const double a = line_search_.length_on_soft_springs(system_, x_.points, move_);
        system_.step(a);
        for (std::size_t j = 0; j < move_.size(); ++j) {
            x_.points[j].multipliers.contact += a * move_[j].x();
            x_.points[j].multipliers.tangential += a * move_[j].y();
        }
        if (is_series && a == 1) series_.extrapolate(move_, law_goal * multiplier_unit, x_.points);
        lag_.advance(x_.points);
    }
    if (lag_.end(x_.points)) newton_matrix_.forget();
    for (ActivePoint& point : x_.points) point.multipliers.contact = std::max(0.0, point.multipliers.contact);
    if (n_found < 2) return norm <= near_balance * unit ? Pieces::nearly : Pieces::cycling;
    unit_ = unit;
    return newton_matrix_.is_indefinite() ? Pieces::cycling : Pieces::found;
}

/// The residual with the equations of the piece on which each point is; the number of points that changed theirs.
std::size_t AugmentedLagrangian::evaluate_pieces() {
    system_.evaluate();
    std::size_t n_changed = 0;
    for (std::size_t j = 0; j < x_.points.size(); ++j) {
        ActivePoint& point = x_.points[j];
        point.rate = point.rate_at(x_.rate);
        point.response = respond(point.law, point.softened(), point.rate.x(), point.rate.y());
        if (std::exchange(pieces_[j], point.response.state) != point.response.state) ++n_changed, lag_.count_change(j);
        const Vec2 q = point.impulse_of_piece(point.rate);
        const double normal = q.x() - point.law.strength * point.response.cohesion_theta;
        point.sides.add_force(-point.out_of_frame({normal, q.y()}), system_.residual());
    }
    return n_changed;
}

/// The method of multipliers.
bool AugmentedLagrangian::find_multipliers(double goal, double first_tolerance, int max_steps) {
    const bool has_potential = std::ranges::none_of(
        x_.points, [](const ActivePoint& p) { return p.law.friction > 0 && p.multipliers.friction_follows; });
    series_.forget();
    set_augmentation(final_augmentation_);
    // a few points are solved exactly: where bounds contradict each other, the series of their moves must be precise
    const double inexact = sweeps_ ? inexact_balance : 0;
    double change = 0;
    for (int outer = 0, n_near = 0; outer < max_outer_steps; ++outer) {
        const int solves = counts_.linear_solves;
        const double exact = std::max(balance_goal(unit_), sweeps_ ? goal * unit_ : 0),
                     tolerance = std::max(exact, outer == 0 ? first_tolerance : inexact * change);
        const bool first = outer == 0 && has_potential;
        if (!(first ? continue_penalties(tolerance) : find_rates(tolerance, max_steps))) return false;
        if (!first) max_steps -= counts_.linear_solves - solves;
        const auto pressed =
            std::ranges::max_element(x_.points, {}, [](const ActivePoint& p) { return p.response.contact; });
        const double pressing = pressed == x_.points.end() ? 0 : pressed->response.contact;
        unit_ = std::max(unit_, std::min(pressing, largest_unit_));  // an impact may exceed the strengths
        if (pressing > jammed * std::max(unit_, largest_unit_)) {
            ++n_jams_, jammed_node_ = std::max(pressed->sides.before, pressed->sides.after);
            return false;
        }
        const double unit = final_augmentation_ * unit_;
        const double last_change = std::exchange(change, update_multipliers());
        if (tolerance > exact) {
            const bool rounding = change > same_move * last_change && change <= law_tolerance * unit;
            if (change <= goal * unit || rounding) change = 0;  // once more to the end
            else series_.extrapolate(move_, goal * unit, x_.points);
            continue;
        }
        n_near += change <= law_tolerance * unit;
        if (change <= goal * unit || n_near == max_near) return true;
        series_.extrapolate(move_, goal * unit, x_.points);
    }
    return false;
}

/// Newton's method at the final augmentation; where it is slow, by continuation of the penalty from small to large.
bool AugmentedLagrangian::continue_penalties(double tolerance) {
    if (find_rates(tolerance, max_direct_steps)) return true;
    for (double augmentation = soft_augmentation; augmentation < final_augmentation_; augmentation *= hardening) {
        set_augmentation(augmentation);
        if (!find_rates(soft_tolerance * unit_, max_newton_steps)) return false;
        update_multipliers();
    }
    set_augmentation(final_augmentation_);
    return find_rates(tolerance, max_newton_steps);
}

/// Newton's method with line search, for given multipliers. Where it stalls, ImplicitScheme::check_residual decides.
bool AugmentedLagrangian::find_rates(double tolerance, int max_steps) {
    double best = infinity;
    int stalled = 0;
    bool met = false;
    cycle_.begin();
    for (int i = 0; i < max_steps; ++i) {
        if (given_up_ && given_up_()) throw StepGivenUp{};
        evaluate();
        if (sweeps_ && i < max_swept_steps && residual() > sweep_goal * unit_) sweep_fans();
        const double norm = residual();
        // Where find_solution adds no step of the whole body, one more than the tolerance asks for takes the error to
        // rounding; it costs no factor.
        const bool adds = sweeps_ && !matrix_.has_far_nodes() && !met && tolerance <= balance_goal(unit_);
        met = met || norm <= tolerance;
        if (norm <= (adds ? 0.1 : 1) * tolerance) return true;
        stalled = norm > 0.5 * best ? stalled + 1 : 0;
        const bool near = norm <= 1e3 * balance_goal(unit_);
        if (stalled >= 3 && (near || norm <= 1e-12 * bulk_.largest_elastic_impulse(x_.rate))) return true;  // rounding
        best = std::min(best, norm);
        if (cycle_.returns(i, norm, x_.points)) return false;
        if (!find_direction()) return false;
        // near the solution rounding hides the slope
        system_.step(stalled > 0 && near ? 1 : line_search_.length(system_, x_.points));
    }
    return false;
}

/// Tresca's law, friction bounded by the contact impulses of the previous round, with bounds that approach Coulomb's.
/// True: near enough to Coulomb's law for a preliminary solution.
bool AugmentedLagrangian::iterate_friction() {
    for (ActivePoint& point : x_.points) {
        point.multipliers.friction_follows = false;
        point.multipliers.pressed = point.law.ramp > 0 ? point.response.contact : point.multipliers.contact;
    }
    double goal = 1e-4;
    bool near_enough = false;
    for (int round = 0; round < max_friction_rounds && !near_enough; ++round) {
        const int factorisations = counts_.factorisations;
        if (!find_multipliers(goal, 0, max_newton_steps)) break;
        const double largest_lag = largest_friction_lag(x_.points);
        near_enough = is_preliminary() && largest_lag <= preliminary_goal * unit_;
        if (counts_.factorisations == factorisations) break;  // no point changed its piece: Newton's method converges
        for (ActivePoint& p : x_.points)                      // the full way may oscillate without end
            p.multipliers.pressed += 0.5 * (p.response.contact - p.multipliers.pressed);
        goal = std::min(goal, 1e-3 * largest_lag / unit_);
    }
    for (ActivePoint& point : x_.points) point.multipliers.friction_follows = true;
    newton_matrix_.forget();
    if (near_enough) complete_and_evaluate();
    return near_enough;
}

void AugmentedLagrangian::complete_and_evaluate() {
    if (system_.is_condensed()) system_.complete();
    evaluate();
}

void AugmentedLagrangian::evaluate() {
    system_.evaluate();
    for (ActivePoint& point : x_.points) {
        point.rate = point.rate_at(x_.rate);
        point.response = respond(point.law, point.multipliers, point.rate.x(), point.rate.y());
        point.sides.add_force(-point.impulse(), system_.residual());
    }
}

double AugmentedLagrangian::move_freely() {
    evaluate();
    const double largest = system_.move_freely(x_.points);
    evaluate();
    return largest;
}

void AugmentedLagrangian::sweep_fans() {
    if (matrix_.is_reduced()) return;
    fans_.sweep(0.1 * sweep_goal * unit_, x_.points, x_.rate, system_.impulse(), system_.residual());
    if (!system_.is_condensed()) evaluate();  // the impulses of corners, too
}

bool AugmentedLagrangian::find_direction() {
    if (!newton_matrix_.factorise(x_.points, counts_.factorisations) || !system_.find_direction(x_.points))
        return false;
    ++counts_.linear_solves;
    return true;
}

double AugmentedLagrangian::update_multipliers() {
    double longest = 0;
    move_.resize(x_.points.size());
    for (std::size_t j = 0; j < move_.size(); ++j) {
        const PointResponse& q = x_.points[j].response;
        Multipliers& multipliers = x_.points[j].multipliers;
        const double held = q.held(x_.points[j].law);
        move_[j] = {held - multipliers.contact, q.tangential - multipliers.tangential};
        longest = std::max(longest, move_[j].cwiseAbs().maxCoeff());
        multipliers.contact = held, multipliers.tangential = q.tangential;
    }
    return longest;
}

void AugmentedLagrangian::set_augmentation(double augmentation) {
    for (ActivePoint& point : x_.points) point.multipliers = point.augmented(augmentation);
    if (augmentation == augmentation_) return;
    augmentation_ = augmentation;
    newton_matrix_.forget();
}

}  // namespace knap
