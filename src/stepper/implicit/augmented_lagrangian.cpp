#include "stepper/implicit/augmented_lagrangian.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

constexpr int max_newton_steps = 400, max_cycling_steps = 30, max_friction_rounds = 60;
constexpr int max_found_steps = 10;  // of the method of multipliers, from a solution of the active set
constexpr int max_near = 5, max_completions = 3;
constexpr double full_augmentation = 1e3;  // of the point's mass: each round of multipliers gains three digits
// With friction, and where contacts round a vertex contradict each other, a few fans may cycle through their pieces.
// Which fans do depends on the augmentation, so others are tried, each from the first guess.
constexpr std::array other_augmentations{300.0, 3e3, 100.0, 1e4};
// Where faces meet flush, vertices of both sides bear self-stresses that hardly load their nodes; stiffer springs find
// them in fewer rounds.
constexpr double face_augmentation = 1e4;
// (Three corners at one seam bear nearly redundant forces, which follow slowly where springs are softer than 1e6.)
constexpr std::array other_face_augmentations{1e6, 1e7, 1e3, 3e4};
// On stiff springs a Newton step ends at the first points that change their piece. Penalty continuation from soft
// springs follows where this many steps do not converge.
constexpr int max_direct_steps = 20;
constexpr int max_swept_steps = 12;       // of a round: where they do not end it, their moves of multipliers may be why
constexpr double inexact_balance = 1e-3;  // of the last move of the multipliers
constexpr double soft_augmentation = 10, hardening = 3;
// Where a body is driven against itself its contact impulses grow without bound. Beyond this multiple of the largest
// scale their rounding hides the balance, so the attempt is given up, and after three of them the problem.
constexpr double jammed = 1e6;

}  // namespace

AugmentedLagrangian::AugmentedLagrangian(const Model& model, const ImplicitBulk& bulk, ThetaMatrix& matrix,
                                         Iterate& iterate)
    : bulk_(bulk),
      matrix_(matrix),
      newton_(model, bulk, matrix, iterate),
      fans_(model, matrix),
      line_search_(model),
      active_set_(model, matrix, newton_, line_search_),
      interior_point_(matrix, newton_),
      series_(model, matrix),
      cycle_(model.fan_points.size()) {
    reserve_capacity(model.mesh.n_corners(), before_.rate, first_.rate, completed_.rate);
    reserve_capacity(model.fan_points.size() + 1, move_, before_.points, first_.points, completed_.points);
}

bool AugmentedLagrangian::solve(double scale, double largest_scale, Effort effort, Precision precision) {
    const std::vector<ActivePoint>& points = newton_.x.points;
    first_unit_ = scale > 0 ? scale : 1;
    newton_.counts = {}, newton_.unit = first_unit_, newton_.largest_unit = largest_scale, n_jams_ = 0;
    if (!std::isfinite(first_unit_ + bulk_.largest_impulse())) return false;  // every tolerance would be met
    kind_ = {.friction = std::ranges::any_of(points, [](const ActivePoint& p) { return p.law.friction > 0; }),
             .obstacles = std::ranges::any_of(points, [](const ActivePoint& p) { return p.fan < 0; }),
             .faces = std::ranges::any_of(points, [](const ActivePoint& p) { return p.fan == between_faces; }),
             .curved = std::ranges::any_of(points, [](const ActivePoint& p) { return p.law.is_curved(); })};
    first_ = newton_.x, newton_.final_augmentation = kind_.faces ? face_augmentation : full_augmentation;
    sweeps_ = points.size() >= CondensedSystem::min_points;
    // on ramps of secant unloading the active set found other solutions with friction than the method of multipliers
    kind_.has_pieces =
        sweeps_ && std::ranges::none_of(points, [](const ActivePoint& p) { return p.law.holds_cohesion(); });
    return (kind_.faces && solve_with_cohesion_kept(effort, precision)) || solve_from_first(effort, precision);
}

/// With the cohesion of its start the law of a point is friction. What solves these laws is the solution of the step
/// where no opening asks for less cohesion, and the first guess where one does. (Where contacts cycle, an iterate may
/// open far; from there a point ended broken, with several solutions, that could have held.)
bool AugmentedLagrangian::solve_with_cohesion_kept(Effort effort, Precision precision) {
    if (std::ranges::none_of(first_.points, [](const ActivePoint& p) { return p.law.may_soften(); })) return false;
    keep_cohesion(true);
    const bool solved = solve_from_first(effort, precision);
    keep_cohesion(false);
    if (!solved) {
        begin_again();
        return false;
    }
    complete_and_evaluate();
    if (std::ranges::none_of(newton_.x.points, [](const ActivePoint& p) { return p.response.loses_cohesion(); }))
        return true;
    first_ = newton_.x;
    return false;
}

void AugmentedLagrangian::keep_cohesion(bool keeps) {
    for (Iterate* iterate : {&newton_.x, &first_})
        for (ActivePoint& point : iterate->points) point.law.keeps_cohesion = keeps;
}

bool AugmentedLagrangian::solve_from_first(Effort effort, Precision precision) {
    const std::vector<ActivePoint>& points = newton_.x.points;
    pieces_ = ActiveSet::Result::cycling;
    newton_.precision = Precision::full;
    if (kind_.has_pieces && solve_on_points_alone()) return true;
    newton_.system.begin(points);
    fans_.begin(points);
    if (sweeps_) {
        newton_.precision = precision;
        if (solve_by_pieces()) return true;
    }
    begin_again();
    if (kind_.has_pieces && kind_.faces && kind_.friction && InteriorPoint::fits(points)) {
        if (solve_from_inside()) return true;
        begin_again();
    }
    const Outcome outcome = alternate_with_friction(effort);
    // obstacles couple the whole body and may jam it: a smaller step is the better answer
    if (outcome != Outcome::cycling || effort == Effort::little || (kind_.obstacles && !kind_.faces))
        return outcome == Outcome::solved;
    return solve_with_other_augmentations();
}

void AugmentedLagrangian::begin_again() { newton_.restart_from(first_), newton_.unit = first_unit_; }

/// The method of multipliers; where it ends without a solution, nothing has changed.
bool AugmentedLagrangian::attempt(int max_steps) {
    before_ = newton_.x;
    if (find_solution(max_steps)) return true;
    newton_.restart_from(before_);
    return false;
}

/// The active set, and the method of multipliers from where it ends. Where bounds contradict each other by rounding,
/// multipliers march on within the tolerance of the laws, and the latter may cycle: what was found is the solution.
bool AugmentedLagrangian::find_pieces() {
    using Result = ActiveSet::Result;
    pieces_ = active_set_.find(kind_.friction, first_);
    const bool found = pieces_ == Result::found;
    if (found && is_preliminary()) return true;
    if (pieces_ == Result::cycling) return false;
    const bool may_march = found && kind_.faces;
    if (may_march) found_ = newton_.x;
    if (find_solution(may_march ? max_found_steps : max_cycling_steps))
        return found || !newton_.newton_matrix.is_indefinite();
    if (!may_march) return false;
    newton_.restart_from(found_);
    complete_and_evaluate();
    return true;
}

/// On the dense matrix of a few points. Where its rounding is too large for the balance of the body, the other methods
/// go on from here.
bool AugmentedLagrangian::solve_on_points_alone() {
    if (!newton_.system.begin_reduced(newton_.x.points)) return false;
    const bool solved = find_pieces();
    if (solved && residual() <= newton_.balance_goal(newton_.unit)) return true;
    if (solved) newton_.system.forget();
    else begin_again();
    return false;
}

/// Without friction the springs lead on, before the active set, and after it where it cycles: within Assumption 1 the
/// solution is the same one.
bool AugmentedLagrangian::solve_by_pieces() {
    if (!kind_.friction) {
        if (find_solution(max_newton_steps)) return true;
        begin_again();
    }
    if (kind_.has_pieces && find_pieces()) return true;
    return pieces_ != ActiveSet::Result::found && !kind_.friction && !newton_.newton_matrix.is_indefinite() &&
           find_solution(max_newton_steps) && !newton_.newton_matrix.is_indefinite();
}

/// Where the pieces are not found from an approximation, a better one follows.
bool AugmentedLagrangian::solve_from_inside() {
    interior_point_.begin();
    return std::ranges::any_of(std::array{1e-3, 1e-5, 1e-7, 1e-9},
                               [&](double goal) { return interior_point_.approach(goal) && find_pieces(); });
}

/// Coulomb's law has no potential, so Newton's method may cycle. Tresca's law then leads nearer to the solution.
AugmentedLagrangian::Outcome AugmentedLagrangian::alternate_with_friction(Effort effort) {
    const int n_attempts = !kind_.friction ? 1 : effort == Effort::little ? 3 : 4;
    for (int i = 1; i <= n_attempts; ++i) {
        const bool is_last = i == n_attempts, cycles = kind_.has_pieces && kind_.friction && i == 1;
        if (!cycles && attempt(is_last ? max_newton_steps : max_cycling_steps)) return Outcome::solved;
        if (is_jammed()) return Outcome::jammed;
        if (!is_last && iterate_friction()) return Outcome::solved;
    }
    return Outcome::cycling;
}

bool AugmentedLagrangian::solve_with_other_augmentations() {
    for (const double other : kind_.faces ? other_face_augmentations : other_augmentations) {
        begin_again(), newton_.final_augmentation = other;
        if (attempt(max_newton_steps)) return true;
        if (is_jammed()) return false;
        if (kind_.friction && (iterate_friction() || attempt(max_newton_steps))) return true;
    }
    return false;
}

/// Rates of all nodes by the method of multipliers; one step of the whole body removes what rounding added on the way.
/// ImplicitScheme::check_residual decides where it cannot.
bool AugmentedLagrangian::find_solution(int max_steps) {
    if (is_preliminary()) {
        if (!find_multipliers(NewtonIteration::preliminary_goal, 0, max_steps)) return false;
        complete_and_evaluate();
        return true;
    }
    for (int i = 0; i < max_completions; ++i) {
        const bool found =
            find_multipliers(NewtonIteration::law_goal,
                             i == 0 && sweeps_ ? NewtonIteration::preliminary_goal * newton_.unit : 0, max_steps);
        if (!found && i == 0) return false;
        if (!found) newton_.restart_from(completed_);
        if (!found) break;
        if (!newton_.system.is_condensed()) return true;  // balanced with these multipliers
        newton_.system.complete();
        completed_ = newton_.x;
        evaluate();
        if (newton_.find_direction()) newton_.system.step(1), newton_.system.complete();
    }
    evaluate();
    return true;
}

/// The method of multipliers.
bool AugmentedLagrangian::find_multipliers(double goal, double first_tolerance, int max_steps) {
    const bool has_potential = std::ranges::none_of(
        newton_.x.points, [](const ActivePoint& p) { return p.law.friction > 0 && p.multipliers.friction_follows; });
    series_.forget();
    newton_.set_augmentation(newton_.final_augmentation);
    // a few points are solved exactly: where bounds contradict each other, the series of their moves must be precise
    const double inexact = sweeps_ ? inexact_balance : 0;
    double change = 0;
    for (int outer = 0, n_near = 0; outer < max_iterations; ++outer) {
        const int solves = newton_.counts.linear_solves;
        const double exact = std::max(newton_.balance_goal(newton_.unit), sweeps_ ? goal * newton_.unit : 0),
                     tolerance = std::max(exact, outer == 0 ? first_tolerance : inexact * change);
        const bool first = outer == 0 && has_potential;
        if (!(first ? continue_penalties(tolerance) : find_rates(tolerance, max_steps))) return false;
        if (!first) max_steps -= newton_.counts.linear_solves - solves;
        const auto pressed =
            std::ranges::max_element(newton_.x.points, {}, [](const ActivePoint& p) { return p.response.contact; });
        const double pressing = pressed == newton_.x.points.end() ? 0 : pressed->response.contact;
        newton_.unit =
            std::max(newton_.unit, std::min(pressing, newton_.largest_unit));  // an impact may exceed the strengths
        if (pressing > jammed * std::max(newton_.unit, newton_.largest_unit)) {
            ++n_jams_, jammed_node_ = std::max(pressed->sides.before, pressed->sides.after);
            return false;
        }
        const double unit = newton_.final_augmentation * newton_.unit;
        const double last_change = std::exchange(change, update_multipliers());
        if (tolerance > exact) {
            const bool rounding =
                change > NewtonIteration::same_move * last_change && change <= NewtonIteration::law_tolerance * unit;
            if (change <= goal * unit || rounding) change = 0;  // once more to the end
            else series_.extrapolate(move_, goal * unit, newton_.x.points);
            continue;
        }
        n_near += change <= NewtonIteration::law_tolerance * unit;
        if (change <= goal * unit || n_near == max_near) return true;
        series_.extrapolate(move_, goal * unit, newton_.x.points);
    }
    return false;
}

/// Newton's method at the final augmentation; where it is slow, by continuation of the penalty from small to large.
bool AugmentedLagrangian::continue_penalties(double tolerance) {
    if (find_rates(tolerance, max_direct_steps)) return true;
    for (double augmentation = soft_augmentation; augmentation < newton_.final_augmentation;
         augmentation *= hardening) {
        newton_.set_augmentation(augmentation);
        if (!find_rates(NewtonIteration::preliminary_goal * newton_.unit, max_newton_steps)) return false;
        update_multipliers();
    }
    newton_.set_augmentation(newton_.final_augmentation);
    return find_rates(tolerance, max_newton_steps);
}

/// Newton's method with line search, for given multipliers. Where it stalls, ImplicitScheme::check_residual decides.
bool AugmentedLagrangian::find_rates(double tolerance, int max_steps) {
    double best = infinity, last = infinity;
    int stalled = 0;
    bool met = false;
    cycle_.begin();
    for (int i = 0; i < max_steps; ++i) {
        newton_.give_up_if_asked();
        evaluate();
        if (sweeps_ && i < max_swept_steps && residual() > NewtonIteration::preliminary_goal * newton_.unit)
            sweep_fans();
        const double norm = residual();
        // Where find_solution adds no step of the whole body, one more than the tolerance asks for takes the error to
        // rounding; it costs no factor.
        const bool adds =
            sweeps_ && !matrix_.has_far_nodes() && !met && tolerance <= newton_.balance_goal(newton_.unit);
        met = met || norm <= tolerance;
        if (norm <= (adds ? 0.1 : 1) * tolerance) return true;
        // states of curved laws are alike within some hundredths: the factor may be that of other directions
        if (kind_.curved && norm > NewtonIteration::slow_ratio * std::exchange(last, norm))
            newton_.newton_matrix.forget();
        stalled = norm > 0.5 * best ? stalled + 1 : 0;
        const bool near = norm <= 1e3 * newton_.balance_goal(newton_.unit);
        if (stalled >= 3 && (near || norm <= 1e-12 * bulk_.largest_elastic_impulse(newton_.x.rate)))
            return true;  // rounding
        best = std::min(best, norm);
        if (cycle_.returns(i, norm, newton_.x.points)) return false;
        if (!newton_.find_direction()) return false;
        // near the solution rounding hides the slope
        newton_.system.step(stalled > 0 && near ? 1 : line_search_.length(newton_.system, newton_.x.points));
    }
    return false;
}

/// Tresca's law, friction bounded by the contact impulses of the previous round, with bounds that approach Coulomb's.
/// True: near enough to Coulomb's law for a preliminary solution.
bool AugmentedLagrangian::iterate_friction() {
    for (ActivePoint& point : newton_.x.points) {
        point.multipliers.friction_follows = false;
        point.multipliers.pressed = point.law.holds_cohesion() ? point.response.contact : point.multipliers.contact;
    }
    double goal = 1e-4;
    bool near_enough = false;
    for (int round = 0; round < max_friction_rounds && !near_enough; ++round) {
        const int factorisations = newton_.counts.factorisations;
        if (!find_multipliers(goal, 0, max_newton_steps)) break;
        const double largest_lag = largest_friction_lag(newton_.x.points);
        near_enough = is_preliminary() && largest_lag <= NewtonIteration::preliminary_goal * newton_.unit;
        if (newton_.counts.factorisations == factorisations)
            break;                               // no point changed its piece: Newton's method converges
        for (ActivePoint& p : newton_.x.points)  // the full way may oscillate without end
            p.multipliers.pressed += 0.5 * (p.response.contact - p.multipliers.pressed);
        goal = std::min(goal, 1e-3 * largest_lag / newton_.unit);
    }
    for (ActivePoint& point : newton_.x.points) point.multipliers.friction_follows = true;
    newton_.newton_matrix.forget();
    if (near_enough) complete_and_evaluate();
    return near_enough;
}

void AugmentedLagrangian::complete_and_evaluate() {
    if (newton_.system.is_condensed()) newton_.system.complete();
    evaluate();
}

void AugmentedLagrangian::evaluate() {
    newton_.system.evaluate();
    for (ActivePoint& point : newton_.x.points) {
        point.rate = point.rate_at(newton_.x.rate);
        point.response = respond(point.law, point.multipliers, point.rate.x(), point.rate.y());
        point.sides.add_force(-point.impulse(), newton_.system.residual());
    }
}

void AugmentedLagrangian::evaluate_body() {
    newton_.system.forget();
    newton_.system.evaluate();
    for (const ActivePoint& point : newton_.x.points)
        point.sides.add_force(-point.impulse(), newton_.system.residual());
}

void AugmentedLagrangian::refine() {
    if (!newton_.find_direction()) return;
    newton_.system.step(1);
    if (newton_.system.is_condensed()) newton_.system.complete();
    for (ActivePoint& point : newton_.x.points) {
        PointResponse& q = point.response;
        point.rate = point.rate_at(newton_.x.rate);
        if (point.law.strength > 0) {
            q = respond(point.law, point.multipliers, point.rate.x(), point.rate.y());
            continue;
        }
        // at the rates themselves the rounding of stiff springs would be larger than what is left of the balance
        const Vec2 change =
            -tangent(point.law, point.multipliers, q, Softening::none) * point.across(newton_.system.direction());
        q.contact = std::max(0.0, q.contact + change.x());
        q.tangential += change.y(), q.friction_part += change.y();
    }
    evaluate_body();
}

double AugmentedLagrangian::move_freely() {
    evaluate();
    const double largest = newton_.system.move_freely(newton_.x.points);
    evaluate();
    return largest;
}

void AugmentedLagrangian::sweep_fans() {
    if (matrix_.is_reduced()) return;
    fans_.sweep(0.1 * NewtonIteration::preliminary_goal * newton_.unit, newton_.x.points, newton_.x.rate,
                newton_.system.impulse(), newton_.system.residual());
    if (!newton_.system.is_condensed()) evaluate();  // the impulses of corners, too
}

double AugmentedLagrangian::update_multipliers() {
    double longest = 0;
    move_.resize(newton_.x.points.size());
    for (std::size_t j = 0; j < move_.size(); ++j) {
        const PointResponse& q = newton_.x.points[j].response;
        Multipliers& multipliers = newton_.x.points[j].multipliers;
        const double held = q.held(newton_.x.points[j].law);
        move_[j] = {held - multipliers.contact, q.tangential - multipliers.tangential};
        longest = std::max(longest, move_[j].cwiseAbs().maxCoeff());
        multipliers.contact = held, multipliers.tangential = q.tangential;
    }
    return longest;
}

}  // namespace knap
