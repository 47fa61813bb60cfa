#include "stepper/implicit/implicit_scheme.hpp"

#include "base/reserve_capacity.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/contact/retirement.hpp"
#include "stepper/implicit/step_lcp.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_passes = 40;
constexpr std::size_t max_lcp_points = 100;  // in the body: up to nine unknowns each, in a dense tableau at last
// Over momenta, loads and strengths: a larger contact impulse is jammed and measures nothing else. Where a body that is
// driven against itself has no admissible motion, the impulses of the iteration grow without bound. (Impacts of whole
// bodies and the weight on a column reach 100.)
constexpr double max_pressing = 1e3;
constexpr double max_energy_balance_error = 1e-11;  // of the energies; usual: 1e-15, tolerance of the balance: 1e-12
constexpr int max_face_rounds = 5;                  // until no faces meet that were not found before
constexpr int max_free_rounds = 2;
// Of large rotations. Errors of the linear equations over momenta, loads and forces: below the first one bonded fans
// are tested, the second one ends the step, and below the third one what falls no more by `falls` in two rounds is
// rounding.
constexpr double near_solution = 1e-6, turned_to = 5e-13, turned_at_all = 1e-9, falls = 0.7;
constexpr double far_from_rounding = 100;
constexpr double coarse = 1e-6;  // of the error of the last solution: balance of the next one
constexpr int max_turning_rounds = 40, max_rising_rounds = 6;

}  // namespace

ImplicitScheme::ImplicitScheme(const Model& model, const SchemeOptions& options)
    : model_(model),
      options_(options),
      bulk_(model, options.mass, options.damping, options.absorbing),
      carried_(model, options, bulk_),
      matrix_(model, options.mass, bulk_.dashpots(), bulk_.frames()),
      solver_(model, bulk_, matrix_, x_),
      bond_check_(model),
      contacts_(model),
      obstacles_(model),
      free_obstacles_(model, obstacles_, contacts_),
      faces_(model),
      free_motions_(model, bulk_),
      sticking_rates_(model),
      turned_points_(model),
      active_point_of_(model.fan_points.size(), -1) {
    step_.theta = options.theta;
    step_.implicit_beta = options.cohesion == CohesionScheme::implicit_beta;
    reserve_capacity(model.mesh.n_corners(), x_.rate, node_inertia_);
    reserve_capacity(model.fan_points.size(), x_.points);
}

StepReport ImplicitScheme::step(const State& begin, double h, State& end) {
    guess_rates(begin, face_rate_);
    for (int round = 1;; ++round) {
        StepReport report;
        if (faces_.find(begin, h, face_rate_)) report = solve_step(begin, h, end);
        else faces_.reject(report);
        if (!faces_.may_meet() || report.rejection != Rejection::none) return report;
        read_corner_rates(face_rate_);
        if (!faces_.lacked(begin, h, face_rate_)) return report;
        if (round == max_face_rounds) return rejected(report, Rejection::contact_speed);
    }
}

StepReport ImplicitScheme::solve_step(const State& begin, double h, State& end) {
    StepReport report;
    begin_step(begin, h, end.temperature);  // K u, F_theta, contacts with obstacles, first guesses
    solve_free_obstacles(report);           // rates of obstacles, each trial with a solution of the next line
    solve_body(report);                     // r(w) = H' q(w): impulses that the bulk needs, and those of the points
    free_obstacles_.finish(body_at_contacts());
    if (const Index far = bulk_.frames() ? bulk_.frames()->turns_far() : -1;
        far >= 0 && report.rejection == Rejection::none) {
        report = rejected(report, Rejection::turn);
        report.where = model_.mesh.centroid(far), report.rejected_value = bulk_.frames()->turn_of(far);
        return report;
    }
    if (report.rejection == Rejection::none && options_.respect_assumption_1 && solver_.violates_assumption_1())
        report.rejection = Rejection::assumption_1;
    if (report.rejection != Rejection::none) return rejected(report, report.rejection);
    sticking_rates_.merge(points_of_fans(), partition_, x_.rate);
    check_residual(report);
    report.residual = std::max(report.residual, free_obstacles_.residual());
    if (report.residual > max_residual) return rejected(report, Rejection::not_converged);
    account_points(report);
    free_obstacles_.account(report);
    bulk_.account(x_.rate, reactions(), work_, report);
    if (energy_balance_error_exceeds(report)) return rejected(report, Rejection::not_converged);
    store(end, report);  // u+ = u + h w,  v+ = (w - (1 - theta) v)/theta,  beta+
    obstacles_.finish(begin, free_obstacles_.wrenches(), end, report);
    return report;
}

void ImplicitScheme::begin_step(const State& begin, double h, SharedTemperatures end_temperature) {
    step_.begin = &begin;
    step_.end_temperature = std::move(end_temperature);
    step_.h = h;
    moves_freely_ = false, solver_.use(nullptr);
    bulk_.begin_step(step_);
    carried_.begin(step_);
    obstacles_.begin_theta(begin, h, step_.theta,
                           options_.damping_of == DampingOf::motion ? step_.kick() * options_.damping : 0);
    contacts_.find(begin, h, obstacles_.rate(), {});
    guess_rates(begin, corner_rate_);  // of the last step, since velocities oscillate with theta = 1/2
    if (bulk_.frames()) bulk_.turn_rates(corner_rate_), turn();
    active_.assign(model_.fans.size(), 0);
    guess_.assign(model_.fan_points.size() + faces_.size() + contacts_.all().size(), Vec2::Zero());
    for (std::size_t i = 0; i < faces_.size(); ++i)
        guess_[model_.fan_points.size() + i] = step_.kick() * faces_.force_before(i, begin);
    if (bulk_.frames())
        guess_impulses(contacts_.all(), begin, step_.kick(), std::span(guess_).last(contacts_.all().size()));
    for (std::size_t rank = 0; rank < begin.split_fans.size(); ++rank) {
        const Fan& fan = model_.fans[begin.split_fans[rank]];
        active_[begin.split_fans[rank]] = 1;
        for (Index j = 0; j < fan.n_points; ++j) {
            const FanPoint& at = model_.fan_points[fan.first_point + j];
            const PointState& known = begin.points[begin.first_point[rank] + j];
            const double impulse = step_.kick() * at.area,
                         strength = known.cohesion > 0 ? impulse * begin.strength_factor(begin.split_fans[rank]) *
                                                             law_of(model_, begin, at).sigma_c
                                                       : 0;
            guess_[fan.first_point + j] = impulse * known.traction + Vec2(strength * known.cohesion, 0);
        }
    }
}

/// Those of the last step.
void ImplicitScheme::guess_rates(const State& begin, std::vector<Vec2>& of_corner) const {
    const std::vector<Vec2>& rate = begin.has_end_velocities() ? begin.rate : begin.velocity;
    of_corner.clear();
    for (const Index node : begin.node_of_corner) of_corner.push_back(Vec2(rate[node]));
}

/// All active points, until no further fan opens: preliminary solutions tell which fans do. Where friction makes the
/// method of multipliers cycle in a small body, Lemke's algorithm is tried before the method is driven to its limits.
void ImplicitScheme::solve_points(StepReport& report) {
    enum { quickly, from_lemke, thoroughly } attempt = lemke_is_cheap() ? quickly : thoroughly;
    Precision precision = Precision::preliminary;
    for (int pass = 0; pass <= max_passes;) {
        if (precision == Precision::preliminary) set_partition(), guess_multipliers();
        solver_.set_coarse_goal(x_.points.empty() ? coarse_goal_ : 0);  // multipliers need an exact balance
        const bool solved = solver_.solve(scale_, max_pressing * momentum_scale_,
                                          attempt == quickly ? Effort::little : Effort::all, precision);
        solver_.counts().add_to(report);
        precision = Precision::preliminary;
        if (solved && may_open_ && activate_opening_fans(report)) ++pass;
        else if (solved && solver_.is_preliminary()) precision = Precision::full;
        else if (solved && !may_open_) return;
        else if (solved && x_.points.empty() && needs_free_motions()) ++pass;
        else if (solved && moves_freely_ && !move_freely()) ++pass;
        else if (solved) return void(report.fan_fallbacks += attempt == from_lemke);
        else if (!solver_.is_jammed() && needs_free_motions()) attempt = thoroughly, ++pass;
        else if (attempt == thoroughly || solver_.is_jammed()) break;
        else {
            if (attempt == quickly) own_guess_ = {corner_rate_, active_, guess_};
            else std::tie(corner_rate_, active_, guess_) = own_guess_;
            attempt = attempt == quickly && start_from_lemke() ? from_lemke : thoroughly;
        }
    }
    report.rejection = solver_.rejection();
}

/// Injected fluids: under given pressures, until each fills its volume.
void ImplicitScheme::solve_body(StepReport& report) {
    solve_under_pressures(report);
    if (!bulk_.has_injected_fluids() || report.rejection != Rejection::none) return;
    const FluidStep step = bulk_.fluid_step(x_.rate, [&] {
        read_corner_rates(corner_rate_), store_guesses();
        solve_under_pressures(report);
        return report.rejection == Rejection::none;
    });
    const auto unsettled = unsettled_fluid(bulk_.crack_forces(), step);
    if (unsettled) report.reject(Rejection::not_converged, bulk_.place_of_fluid(*unsettled));
}

/// With damping of vibrations the rigid motions of free pieces are known only with the solution.
void ImplicitScheme::solve_under_pressures(StepReport& report) {
    if (bulk_.frames()) return solve_turning_body(report);
    for (int round = 1;; ++round) {
        solve_points(report);
        if (!carried_.has_pieces() || report.rejection != Rejection::none) return;
        read_corner_rates(corner_rate_);
        if (carried_.agrees(corner_rate_)) return;
        if (round == CarriedMotion::max_rounds) return void(report.rejection = Rejection::not_converged);
    }
}

/// The fixed point of solutions that are linear in the bulk.
void ImplicitScheme::solve_turning_body(StepReport& report) {
    const double scale = bulk_.balance_scale();
    turned_rate_ = corner_rate_;
    turn();
    fixed_point_.begin(), may_open_ = false;
    double before_last = infinity, last = scale, least = infinity;
    for (int round = 1, n_rising = 0;; ++round) {
        const double rounding = bulk_.rounding(), least_error = std::max(turned_to * scale, rounding);
        coarse_goal_ = std::max(round == 1 ? 0 : coarse * last, 0.1 * least_error);
        solve_points(report);
        if (report.rejection != Rejection::none) return;
        read_corner_rates(corner_rate_);
        store_guesses();
        const bool carried = !carried_.has_pieces() || carried_.agrees(corner_rate_);
        const double error = turning_error(), falling = falls * std::exchange(before_last, last);
        const bool turned = error <= least_error ||
                            (error <= std::max(turned_at_all * scale, far_from_rounding * rounding) && error > falling);
        if (carried && turned && coarse_goal_ <= least_error && std::exchange(may_open_, true)) return solver_.refine();
        may_open_ = may_open_ || error <= near_solution * scale;
        n_rising = error > least ? n_rising + 1 : 0;
        least = std::min(least, error), last = error;
        if (round == max_turning_rounds || n_rising == max_rising_rounds)
            return void(report.rejection = Rejection::not_converged);
        fixed_point_.advance(corner_rate_, turned_rate_);
        corner_rate_ = turned_rate_;
        turn();
    }
}

/// The linear equations of the body, and the frames of the points, at corner_rate_.
void ImplicitScheme::turn() {
    bulk_.linearise(corner_rate_);
    turned_points_.set(*step_.begin, step_.h, corner_rate_);
    faces_.turn(*step_.begin, step_.h, corner_rate_);
}

/// turn() at the solution. Returns by how much its equations were wrong [N s].
double ImplicitScheme::turning_error() {
    solver_.evaluate_body();
    std::vector<Vec2> change = solver_.residual_impulse();
    turn();
    solver_.evaluate_body();
    double error = 0;
    for (Index node = 0; node < partition_.n_nodes(); ++node) {
        change[node] -= solver_.residual_impulse()[node];
        error = std::max(error, matrix_.largest_free(change, node));
    }
    for (const ActivePoint& point : points_of_fans()) {
        const FanPoint& at = model_.fan_points[point.sides.fan_point];
        const PointTurn now = turned_points_.of(point.fan, at);
        error = std::max({error, point.mass * (now.convected - point.support_rate).norm(),
                          point.impulse().norm() * (now.middle.turned(at.normal) - point.normal).norm()});
    }
    for (std::size_t i = 0; i < faces_.size(); ++i)
        error = std::max(error, face_points()[i].impulse().norm() * faces_.change(i, face_points()[i]));
    return std::isfinite(error) ? error : infinity;
}

/// The motion of a free obstacle depends on the body: the body is solved for given rates until both agree.
void ImplicitScheme::solve_free_obstacles(StepReport& report) {
    if (!free_obstacles_.begin(step_)) return;
    set_partition();  // tells which contacts are held
    free_obstacles_.solve(body_at_contacts(), [&] {
        report.rejection = Rejection::none;  // of the previous trial
        solve_body(report);
        return body_at_contacts();
    });
    report.rejection = Rejection::none;
}

/// [N s] Per node: theta times the impulses that it needs from elsewhere, in prescribed components.
const std::vector<Vec2>& ImplicitScheme::reactions() {
    if (!free_obstacles_.presses_on_held()) return solver_.residual_impulse();
    reaction_ = solver_.residual_impulse();
    free_obstacles_.subtract_impulses(partition_, reaction_);
    return reaction_;
}

/// True: from now on, since a motion of the present solution is free and its inertia hidden.
bool ImplicitScheme::needs_free_motions() {
    if (leaves_free_motions_ || moves_freely_ || bulk_.frames()) return false;
    if (step_.stiffness_factor() * bulk_.largest_stiffness() <= FreeMotions::hidden) return false;
    free_motions_.set(partition_);
    if (!free_motions_.find(x_.points)) return false;
    moves_freely_ = true, n_free_rounds_ = 0;
    solver_.use(&free_motions_);
    return true;
}

/// False: the problem is solved once more, from the rates to which the motions have led.
bool ImplicitScheme::move_freely() {
    double fastest = 0;
    for (const Vec2& rate : x_.rate) fastest = std::max(fastest, rate.norm());
    const bool moved = solver_.move_freely() > max_residual * fastest;
    read_corner_rates(corner_rate_);
    return !moved || ++n_free_rounds_ == max_free_rounds;
}

void ImplicitScheme::read_corner_rates(std::vector<Vec2>& of_corner) const {
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) of_corner[c] = x_.rate[partition_.node_of_corner[c]];
}

bool ImplicitScheme::lemke_is_cheap() const {
    return model_.fan_points.size() <= max_lcp_points && model_.obstacles.empty() && faces_.size() == 0 &&
           StepLcp::fits(model_, options_);
}

/// Rates and multipliers from the step's complementarity problem, with all fans active. The method of
/// multipliers starts again from them, so the step is found to its tolerance and judged like any other.
bool ImplicitScheme::start_from_lemke() {
    SchemeOptions of_step = options_;
    of_step.theta = step_.theta;
    const auto found = StepLcp(model_, *step_.begin, step_.h, of_step, step_.end_temperature).solve();
    if (!found) return false;
    corner_rate_ = found->rate, active_.assign(model_.fans.size(), 1);
    for (std::size_t i = 0; i < model_.fan_points.size(); ++i) {
        const Index point = model_.fan_points[i].point;
        guess_[i] = step_.theta * Vec2(found->held[point], found->impulse[point].y());
    }
    return true;
}

void ImplicitScheme::set_partition() {
    if (partition_.active != active_) partition_corners(model_, active_, partition_);
    bulk_.set_nodes(partition_, corner_rate_, x_.rate);
    make_points();
    double mass_factor = bulk_.mass_factor();
    if (moves_freely_) {
        free_motions_.set(partition_);
        mass_factor =
            std::max(mass_factor, FreeMotions::least_inertia * step_.stiffness_factor() * bulk_.largest_stiffness());
    }
    if (matrix_.set(partition_, step_.stiffness_factor(), mass_factor, faces_.sides(partition_)))
        solver_.forget_factor();
}

void ImplicitScheme::make_points() {
    node_inertia_.assign(partition_.n_nodes(), 0.0);
    for (Index c = 0; c < model_.mesh.n_corners(); ++c)
        node_inertia_[partition_.node_of_corner[c]] += bulk_.corner_inertia(c);
    x_.points.clear();
    std::ranges::fill(active_point_of_, -1);
    for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f) {
        const Fan& fan = model_.fans[f];
        const std::size_t first = x_.points.size();
        double stiffest = 0;
        for (Index i = fan.first_point; active_[f] && i < fan.first_point + fan.n_points; ++i) {
            const FanPoint& at = model_.fan_points[i];
            if (unbreakable(model_, at) || step_.begin->has_retired(at.point)) continue;
            active_point_of_[i] = static_cast<Index>(x_.points.size());
            ActivePoint& made = x_.points.emplace_back(interface_point(
                model_, step_, partition_, f, i, bulk_.frames() ? turned_points_.of(f, at) : PointTurn{}));
            made.mass = mass_between(made.sides.before, made.sides.after);
            stiffest = std::max(stiffest, made.law.ramp_stiffness());
        }
        for (std::size_t j = first; j < x_.points.size(); ++j) x_.points[j].ramp_stiffness = stiffest;
    }
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        ActivePoint& made = x_.points.emplace_back(faces_.point(i, step_, partition_));
        double compliance = 0;
        made.sides.for_each_node(
            [&](Index node, const auto& weight) { compliance += squared(weight) / mass_between(-1, node); });
        made.mass = 1 / compliance;
    }
    for (const ObstacleContact& contact : contacts_.all()) {
        ActivePoint& made = x_.points.emplace_back(
            obstacle_point(model_, step_, partition_, contact, obstacles_.rate()[contact.obstacle]));
        made.mass = mass_between(-1, made.sides.after);
        if (const double s = contact.share; contact.is_on_edge())
            made.mass = 1 / ((1 - s) * (1 - s) / made.mass + s * s / mass_between(-1, made.sides.second_node));
    }
}

double ImplicitScheme::mass_between(Index before, Index after) const {
    const auto compliance = [&](Index node) {
        return partition_.is_prescribed(node, 0) && partition_.is_prescribed(node, 1) ? 0 : 1 / node_inertia_[node];
    };
    const double sum = compliance(before) + compliance(after);
    return sum > 0 ? 1 / sum : node_inertia_[std::max(before, after)];
}

Vec2& ImplicitScheme::guess_of(std::size_t j) {
    const Index i = x_.points[j].sides.fan_point;
    if (i >= 0) return guess_[i];
    return guess_[j + guess_.size() - x_.points.size()];  // contacts are last in both
}

void ImplicitScheme::guess_multipliers() {
    double momentum = bulk_.largest_impulse(), strength = 0, pressing = 0;
    for (std::size_t j = 0; j < x_.points.size(); ++j) {
        ActivePoint& point = x_.points[j];
        point.multipliers.contact = point.law.contact.may_touch ? std::max(0.0, guess_of(j).x()) : 0;
        point.multipliers.tangential = std::isinf(point.multipliers.rho_T) ? 0 : guess_of(j).y();
        momentum = std::max(momentum, point.mass * point.support_rate.norm());
        strength = std::max(strength, point.law.strength);
        pressing = std::max(pressing, point.multipliers.contact);
    }
    momentum_scale_ = std::max(momentum, strength);
    scale_ = std::max({strength, 1e-3 * momentum, std::min(pressing, max_pressing * momentum_scale_)});
}

void ImplicitScheme::store_guesses() {
    for (std::size_t j = 0; j < x_.points.size(); ++j)
        guess_of(j) = {x_.points[j].multipliers.contact, x_.points[j].multipliers.tangential};
}

/// Bonded fans whose interfaces cannot carry the impulses that their corners need. False: there are none.
bool ImplicitScheme::activate_opening_fans(StepReport& report) {
    store_guesses();
    read_corner_rates(corner_rate_);
    contact_impulse_.assign(model_.mesh.n_corners(), Vec2::Zero());
    for (std::size_t i = 0; i < faces_.size(); ++i) faces_.add_impulse(i, face_points()[i].impulse(), contact_impulse_);
    for (std::size_t i = 0; i < contacts_.all().size(); ++i) {
        const ObstacleContact& contact = contacts_.all()[i];
        const Vec2 impulse = contact_points()[i].impulse();
        contact_impulse_[contact.corner] += (1 - contact.share) * impulse;
        if (contact.is_on_edge()) contact_impulse_[contact.second_corner] += contact.share * impulse;
    }
    bool any = false;
    for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f) {
        const Fan& fan = model_.fans[f];
        if (active_[f] || fan.n_points == 0) continue;
        const Index* corner = &model_.fan_corners[fan.first_corner];
        required_.resize(fan.n_corners);
        for (Index i = 0; i < fan.n_corners; ++i) {
            required_[i] = solver_.corner_impulse()[corner[i]] - contact_impulse_[corner[i]];
            for (int k = 0; k < 2; ++k)  // a prescribed motion supplies its own reaction
                if (partition_.prescribed[partition_.node_of_corner[corner[0]]][k]) required_[i][k] = 0;
        }
        if (bulk_.frames()) {  // the strengths are those of the normals in the undeformed body
            const Rotation frame = turned_points_.of_fan(f);
            for (Vec2& impulse : required_) impulse = frame.turned_back(impulse);
        }
        ++report.bond_checks;
        if (bond_check_.is_bonded(f, *step_.begin, required_, step_.kick())) continue;
        active_[f] = any = true;
        for (Index j = 0; j < fan.n_points; ++j) {
            const FanPoint& at = model_.fan_points[fan.first_point + j];
            const CohesiveLaw& law = law_of(model_, *step_.begin, at);
            const Vec2 impulse = bond_check_.impulses()[j];
            const double strength = law.breakable() ? step_.kick() * at.area * law.sigma_c : 0;
            guess_[fan.first_point + j] = {impulse.dot(at.normal) + strength, impulse.dot(turned_left(at.normal))};
        }
    }
    return any;
}

void ImplicitScheme::check_residual(StepReport& report) const {
    // the laws at the merged rates with an augmentation of 1: the natural residual, over the scale of the impulses
    const double unit = solver_.unit();
    for (const ActivePoint& point : x_.points) {
        if (point.law.is_curved() && point.is_held && std::isinf(point.multipliers.rho_T)) continue;  // driven
        const Vec2 w = point.rate_at(x_.rate);
        Multipliers multipliers = point.softened();
        multipliers.contact = point.response.held(point.law), multipliers.tangential = point.response.tangential;
        const PointResponse again = respond(point.law, multipliers, w.x(), w.y());
        report.residual =
            std::max({report.residual, std::abs(again.normal(point.law) - point.response.normal(point.law)) / unit,
                      std::abs(again.tangential - point.response.tangential) / unit});
    }
    // the balance sums momenta, loads, and elastic terms: the strength of interfaces is no measure of its rounding
    double balance_unit = std::max({unit, 0.1 * momentum_scale_, far_from_rounding * bulk_.rounding() / max_residual});
    const double balance = solver_.residual();
    if (balance > max_residual * balance_unit)
        balance_unit = std::max(balance_unit, 0.1 * bulk_.largest_elastic_impulse(x_.rate));
    report.residual = std::max(report.residual, balance / balance_unit);
}

/// The work of the residual is the error of the energy balance.
bool ImplicitScheme::energy_balance_error_exceeds(const StepReport& report) const {
    double work = free_obstacles_.residual_work(), fastest = 0;
    for (Index i = 0; i < partition_.n_nodes(); ++i)
        for (int k = 0; k < 2; ++k) {
            if (!partition_.prescribed[i][k]) work += solver_.residual_impulse()[i][k] * x_.rate[i][k] / step_.theta;
            fastest = std::max(fastest, std::abs(x_.rate[i][k]));
        }
    // right after an impact a body may rest without forces, while its impulses were found to the scale of the impact
    const double impulse =
        std::max({momentum_scale_, solver_.unit(), far_from_rounding * bulk_.rounding() / max_energy_balance_error});
    // of a body at rest that has only been shifted the strain energy is rounding, of either sign
    return std::abs(work) > max_energy_balance_error * (report.kinetic + std::abs(report.strain) + impulse * fastest);
}

void ImplicitScheme::account_points(StepReport& report) const {
    for (const ActivePoint& point : x_.points) {
        const PointLaw& law = point.law;
        const PointResponse& q = point.response;
        const Vec2 w = point.rate_at(x_.rate);
        const double cohesive_N = point.pull(), cohesive_T = q.friction_part - q.tangential;
        const double work = (cohesive_N * w.x() + cohesive_T * w.y()) / step_.theta;
        report.cohesive_work += work;
        const double u_N = law.u_N + step_.h * w.x(), u_T = law.u_T + step_.h * w.y();
        account_contact({.contact = q.contact,
                         .friction = q.friction_part,
                         .rate_N = w.x() / step_.theta,
                         .rate_T = w.y() / step_.theta,
                         .rate_error = (rate_rounding + report.residual) * solver_.unit() / (point.mass * step_.theta),
                         .opening = u_N,
                         .cohesive = pull_on_contact(model_, x_.points, active_point_of_, point),
                         .may_flutter = law.material->friction_changes() && step_.theta < 1},
                        report);
        if (point.fan < 0) continue;
        report.rotation_work += Vec2(q.normal(law), q.tangential).dot(point.support_rate) / step_.theta;
        if (law.is_curved() || law.drops) {  // the force is that of the end of the step
            const auto stored = [&](double N, double T) { return law.stored(law.material->equivalent_opening(N, T)); };
            report.crossing_loss +=
                work - law.strength * q.full_cohesion / step_.kick() * (stored(u_N, u_T) - stored(law.u_N, law.u_T));
            continue;
        }
        if (law.ramp > 0) {  // secant unloading: the works of both components, where the slip changes its sign
            const double s = law.material->equivalent_opening(law.u_N, law.u_T),
                         s_end = law.material->equivalent_opening(u_N, u_T);
            if (law.u_T * u_T < 0 && s_end < law.ramp)
                report.crossing_loss +=
                    work - law.strength * law.cohesion / step_.kick() * (s_end * s_end - s * s) / (2 * law.ramp);
            continue;
        }
        const double stored_T = law.material->gamma * cohesive_N * (std::abs(u_T) - std::abs(law.u_T)) / step_.h;
        report.crossing_loss += (cohesive_T * w.y() - stored_T) / step_.theta;
    }
}

bool ImplicitScheme::opens(Index f) const {
    const Fan& fan = model_.fans[f];
    return std::ranges::any_of(std::span(active_point_of_).subspan(fan.first_point, fan.n_points), [&](Index i) {
        return i >= 0 && (!x_.points[i].is_stationary() || x_.points[i].response.softens);
    });
}

void ImplicitScheme::store(State& end, StepReport& report) {
    const State& begin = *step_.begin;
    end = begin;
    end.obstacle_contacts.clear(), end.impacts.clear();
    end.free_pieces = carried_.motions();
    end.fluid_pressure = bulk_.fluid_pressure();
    end.temperature = step_.end_temperature, end.temperature_before = begin.temperature;
    for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f) {
        if (!active_[f] || end.split_rank[f] >= 0 || !opens(f)) continue;
        split(model_, f, end);
        ++report.released;
    }
    end.rate.resize(end.displacement.size());
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
        const Index node = partition_.node_of_corner[c], to = end.node_of_corner[c];
        end.displacement[to] = begin.displacement[begin.node_of_corner[c]] + step_.h * x_.rate[node];
        end.velocity[to] = bulk_.end_velocity(node, x_.rate[node]);
        end.rate[to] = x_.rate[node];
    }
    faces_.store(face_points(), step_, end, report);
    if (bulk_.frames()) store_impulses(contacts_.all(), contact_points(), step_.h / step_.kick(), end);
    end.reaction.assign(model_.prescribed.size(), Vec2::Zero());
    const std::vector<Vec2>& reaction = reactions();
    for (Index i = 0; i < partition_.n_nodes(); ++i) {
        const Index motion = model_.prescribed_of_corner[partition_.corner_of_node[i]];
        for (int k = 0; k < 2; ++k)
            if (motion >= 0 && model_.prescribed[motion].component[k])
                end.reaction[motion][k] = reaction[i][k] / step_.kick();
    }
    for (std::size_t rank = 0; rank < end.split_fans.size(); ++rank) {
        const Fan& fan = model_.fans[end.split_fans[rank]];
        for (Index j = 0; j < fan.n_points; ++j) {
            const Index active = active_point_of_[fan.first_point + j];
            const FanPoint& at = model_.fan_points[fan.first_point + j];
            if (begin.has_retired(at.point)) {
                end.points[end.first_point[rank] + j].traction.setZero();
                account_rest(at, law_of(model_, begin, at), at.area * end.strength_factor(end.split_fans[rank]), 0, 0,
                             report);
            }
            if (active < 0) continue;
            const ActivePoint& point = x_.points[active];
            PointState& state = end.points[end.first_point[rank] + j];
            const Vec2 u = opening(model_, end, at.point);
            state.traction =
                Vec2(point.response.normal(point.law), point.response.tangential) / (step_.kick() * at.area);
            const CohesiveLaw& law = *point.law.material;
            state.cohesion = law.next_cohesion(point.law.cohesion, u.x(), u.y(), step_.h);
            const double s = law.equivalent_opening(u.x(), u.y()),
                         before = law.equivalent_opening(point.law.u_N, point.law.u_T);
            state.largest_opening = law.largest_opening(state.largest_opening, s);
            // the work of beta_theta over the whole way is that of beta+ and beta on its two parts
            account_cohesion(at, law,
                             {.area = at.area * begin.strength_factor(end.split_fans[rank]),
                              .before = point.law.cohesion,
                              .after = state.cohesion,
                              .opening = s,
                              .at_works = s,
                              .at_fall = step_.implicit_beta ? (1 - step_.theta) * s + step_.theta * before : s,
                              .kappa = law.ramp(state.cohesion, state.largest_opening),
                              .energy_factor = law.energy_factor(u.x(), u.y())},
                             report);
        }
    }
    if (bulk_.frames() && faces_.may_meet()) retire_points(model_, begin.retired, end);
}

/// With the place: a point that lost cohesion, or the node with the largest residual.
StepReport ImplicitScheme::rejected(StepReport report, Rejection rejection) const {
    Index corner = partition_.corner_of_node[solver_.worst_node()];
    for (const ActivePoint& point : x_.points) {
        if (rejection != Rejection::assumption_1 || point.fan < 0) continue;
        if (!point.response.softens && !point.response.breaks) continue;
        const FanPoint& at = model_.fan_points[point.sides.fan_point];
        corner = at.after == rigid_support ? at.before : at.after;
    }
    report.rejection = rejection;
    report.where = model_.mesh.corner(corner);
    return report;
}

}  // namespace knap
