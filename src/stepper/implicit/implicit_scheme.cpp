#include "stepper/implicit/implicit_scheme.hpp"

#include "base/room.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/implicit/lemke_fallback.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace knap {
namespace {

constexpr double rounding = 1e-14;    // of the rates
constexpr int max_passes = 40;
// Over momenta, loads and strengths: what presses harder is jammed, and no measure of what else may be off. Where a body that is driven against
// itself has no lawful motion, the impulses that look for one grow for ever. (Impacts of whole bodies, the weight on a column: up to 100.)
constexpr double max_pressing = 1e3;
constexpr double obstacle_tolerance = 1e-12;  // of the largest impulse
constexpr double max_missed = 1e-11;  // of the energies of a step; 1e-15 is usual, the tolerance of the balance leaves 1e-12

}  // namespace

ImplicitScheme::ImplicitScheme(const Model& model, const SchemeOptions& options)
    : model_(model),
      options_(options),
      bulk_(model, options),
      matrix_(model),
      solver_(model, matrix_),
      sticking_(model),
      bond_check_(model),
      contacts_(model),
      obstacles_(model) {
    active_point_of_.assign(model.fan_points.size(), -1);
    make_room(model.mesh.n_corners(), rate_, node_inertia_);
    make_room(model.fan_points.size(), points_);
}

StepReport ImplicitScheme::step(const State& begin, double h, State& end) {
    StepReport report;
    bulk_.begin_step(begin, h);
    active_.assign(model_.fans.size(), 0);
    for (const Index f : begin.split_fans) active_[f] = 1;
    has_guess_.assign(model_.fan_points.size(), 0);
    guess_.assign(model_.fan_points.size(), Vec2::Zero());
    corner_rate_.clear();
    if (!begin.rate.empty())  // the rate of the last step is a better guess than the velocities, which theta = 1/2 lets ring
        for (const Index node : begin.node_of_corner) corner_rate_.push_back(begin.rate[node]);

    obstacles_.begin_theta(begin, h, options_.theta);
    contacts_.find(begin, h, obstacles_.rate(), {});
    contact_guess_.resize(contacts_.all().size());
    std::ranges::fill(contact_guess_, Vec2::Zero());
    find_obstacle_rates(begin, h, report);
    solve_points(begin, h, report);
    if (report.rejection == Rejection::none && options_.respect_assumption_1 && solver_.has_several_solutions(points_))
        report.rejection = Rejection::assumption_1;
    if (report.rejection != Rejection::none) return rejected(report, report.rejection);
    sticking_.merge(active_, active_point_of_, points_, bulk_.prescribed(), rate_);
    check_residual(report);
    if (report.residual > max_residual) return rejected(report, Rejection::not_converged);
    account_points(h, report);
    bulk_.account(rate_, solver_.residual_impulse(), report);
    if (energy_balance_error_exceeds(report)) return rejected(report, Rejection::not_converged);
    store(begin, h, end, report);
    obstacles_.finish(begin, contact_wrenches(), end, report);
    return report;
}

void ImplicitScheme::solve_points(const State& begin, double h, StepReport& report) {
    bool pivoted = false;
    for (int pass = 0;; ++pass) {
        choose_partition(begin, h);  // bonded fans are one node
        guess_multipliers(begin, h);
        const auto status = solver_.solve(bulk_, points_, rate_, scale_, largest_scale_);
        report.linear_solves += solver_.counts().linear_solves;
        report.factorisations += solver_.counts().factorisations;
        if (status != AugmentedLagrangian::Status::solved && !pivoted && (pivoted = start_from_lemke(begin, h))) continue;
        if (status != AugmentedLagrangian::Status::solved || pass == max_passes) {
            report.rejection = Rejection::not_converged;
            return;
        }
        if (!activate_opening_fans(h, report)) break;
    }
    report.fan_fallbacks += pivoted;
}

bool ImplicitScheme::start_from_lemke(const State& begin, double h) {
    const std::optional<StepLcpEnd> found = solve_by_lemke(model_, begin, h, options_);
    if (!found) return false;
    corner_rate_ = found->rate;
    active_.assign(model_.fans.size(), 1);
    has_guess_.assign(model_.fan_points.size(), 1);
    for (std::size_t i = 0; i < model_.fan_points.size(); ++i) {
        const Index point = model_.fan_points[i].point;
        guess_[i] = options_.theta * Vec2(found->contact[point], found->impulse[point].y());
    }
    return true;
}

void ImplicitScheme::choose_partition(const State& begin, double h) {
    const bool same = matrix_active_ == active_;
    if (!same) partition_corners(model_, active_, partition_);
    bulk_.set_partition(partition_, rate_);
    for (Index i = 0; i < partition_.n_nodes() && !corner_rate_.empty(); ++i)
        for (int k = 0; k < 2; ++k)
            if (!bulk_.prescribed()[i][k]) rate_[i][k] = corner_rate_[partition_.corner_of_node[i]][k];
    make_points(begin, h);
    if (!same) matrix_.set_nodes(partition_, bulk_.prescribed());
    if (!same || matrix_step_ != h) {
        matrix_.set_bulk(options_.theta * options_.theta * h * h, options_.mass);
        solver_.forget_factor();
    }
    matrix_active_ = active_;
    matrix_step_ = h;
}

void ImplicitScheme::make_points(const State& begin, double h) {
    points_.clear();
    std::fill(active_point_of_.begin(), active_point_of_.end(), -1);
    node_inertia_.assign(partition_.n_nodes(), 0.0);
    const double stiffness_factor = options_.theta * options_.theta * h * h;
    for (Index c = 0; c < model_.mesh.n_corners(); ++c)
        node_inertia_[partition_.node_of_corner[c]] += bulk_.corner_mass(c) + stiffness_factor * bulk_.corner_stiffness(c);
    for (std::size_t f = 0; f < model_.fans.size(); ++f) {
        if (!active_[f]) continue;
        const Fan& fan = model_.fans[f];
        for (Index i = fan.first_point; i < fan.first_point + fan.n_points; ++i) {
            if (unbreakable(model_, model_.fan_points[i])) continue;
            active_point_of_[i] = static_cast<Index>(points_.size());
            points_.push_back(make_point(begin, h, static_cast<Index>(f), i));
        }
    }
    for (const ObstacleContact& contact : contacts_.all()) points_.push_back(make_contact_point(contact, begin, h));
}

ActivePoint ImplicitScheme::make_point(const State& begin, double h, Index f, Index i) const {
    const FanPoint& point = model_.fan_points[i];
    const CohesiveLaw& law = model_.laws[point.law];
    const auto node_of = [&](Index corner) { return corner == rigid_support ? -1 : partition_.node_of_corner[corner]; };
    const auto at_begin = [&](const std::vector<Vec2>& of_node, Index corner) -> Vec2 {
        return corner == rigid_support ? Vec2::Zero() : of_node[begin.node_of_corner[corner]];
    };
    ActivePoint made{.fan = f, .fan_point = i, .before = node_of(point.before), .after = node_of(point.after), .normal = point.normal};
    made.mass = mass_between(made.before, made.after);
    const Vec2 jump = made.in_frame(at_begin(begin.displacement, point.after) - at_begin(begin.displacement, point.before));
    const Vec2 speed = made.in_frame(at_begin(begin.velocity, point.after) - at_begin(begin.velocity, point.before));
    const Index rank = begin.split_rank[f];
    const double beta = point.cracked || law.sigma_c == 0 ? 0
                        : rank < 0 ? 1 : begin.points[begin.first_point[rank] + i - model_.fans[f].first_point].cohesion;
    const double u_N = point.gap + jump.x();
    made.law = {.u_N = u_N,
                .u_T = jump.y(),
                .strength = beta > 0 ? options_.theta * h * point.area * law.sigma_c : 0,
                .cohesion = beta,
                .material = &law,
                .friction = law.friction,
                .contact = contact_bound_theta(u_N, speed.x(), law.restitution_at(beta), h, options_.theta, touching_gap(model_, begin, point)),
                .implicit_beta = options_.cohesion == CohesionScheme::implicit_beta,
                .h = h,
                .theta = options_.theta};
    impose(made);
    made.law.set_staircase();
    return made;
}

bool ImplicitScheme::is_given(Index node, int component) const { return node < 0 || bulk_.prescribed()[node][component]; }

double ImplicitScheme::mass_between(Index before, Index after) const {
    const auto compliance = [&](Index node) { return is_given(node, 0) && is_given(node, 1) ? 0 : 1 / node_inertia_[node]; };
    const double whole = compliance(before) + compliance(after);
    return whole > 0 ? 1 / whole : node_inertia_[std::max(before, after)];
}

void ImplicitScheme::impose(ActivePoint& point) const {
    std::array<bool, 2> given, along{false, false};  // x, y; N, T
    for (int k = 0; k < 2; ++k) given[k] = is_given(point.before, k) && is_given(point.after, k) && is_given(point.beside, k);
    for (int k = 0; k < 2; ++k) {
        if (!given[k]) continue;
        along[0] = along[0] || given[1 - k] || std::abs(point.normal[k]) > 1 - 1e-9;
        along[1] = along[1] || given[1 - k] || std::abs(point.normal[k]) < 1e-9;
    }
    if (along[0]) point.law.contact.may_touch = false;
    if (along[1]) point.law.rho_T = std::numeric_limits<double>::infinity();
}

void ImplicitScheme::guess_multipliers(const State& begin, double h) {
    for (ActivePoint& point : points_) {
        const Index i = point.fan_point;
        if (i < 0) continue;
        if (!has_guess_[i]) {  // of a fan that was active before: its tractions go on
            const FanPoint& at = model_.fan_points[i];
            const Index f = model_.fan_of_corner[at.after == rigid_support ? at.before : at.after], rank = begin.split_rank[f];
            const double impulse = options_.theta * h * at.area;
            if (rank >= 0) {
                const PointState& known = begin.points[begin.first_point[rank] + i - model_.fans[f].first_point];
                guess_[i] = {impulse * known.traction.x() + point.law.strength * point.law.cohesion, impulse * known.traction.y()};
            }
            has_guess_[i] = 1;
        }
        point.law.contact_guess = point.law.contact.may_touch ? std::max(0.0, guess_[i].x()) : 0;
        point.law.tangential_guess = std::isinf(point.law.rho_T) ? 0 : guess_[i].y();
    }
    guess_contacts();
    find_scales();
}

void ImplicitScheme::find_scales() {
    double momentum = bulk_.largest_impulse(), strength = 0, pressing = 0;
    for (const ActivePoint& point : points_) {
        momentum = std::max(momentum, point.mass * point.support_rate.norm());
        strength = std::max(strength, point.law.strength);
        pressing = std::max(pressing, point.law.contact_guess);
    }
    largest_scale_ = max_pressing * std::max(momentum, strength);
    scale_ = std::max({strength, 1e-3 * momentum, std::min(pressing, largest_scale_)});
}

/// A free obstacle moves as the body lets it: the body is solved for its rates until both agree.
void ImplicitScheme::find_obstacle_rates(const State& begin, double h, StepReport& report) {
    if (!contacts_.find_free(touched_)) return;
    const auto response = [&](std::vector<Vec3>& wrench) {
        report.rejection = Rejection::none;  // of a trial
        solve_points(begin, h, report);
        wrench = contact_wrenches();
    };
    report.residual = obstacles_.solve(begin, touched_, obstacle_tolerance, std::cref(response));  // cref: nothing is copied
    report.rejection = Rejection::none;
}

const std::vector<Vec3>& ImplicitScheme::contact_wrenches() {
    contacts_.sum_wrenches([&](std::size_t i) -> Vec2 { return contact_points()[i].impulse() / options_.theta; }, wrench_);
    return wrench_;
}

ActivePoint ImplicitScheme::make_contact_point(const ObstacleContact& contact, const State& begin, double h) const {
    const CohesiveLaw& law = model_.obstacles[contact.obstacle].contact;
    ActivePoint made{.fan = -1,
                    .fan_point = -1,
                    .before = -1,
                    .after = partition_.node_of_corner[contact.corner],
                    .normal = contact.normal,
                    .leaf_corner = contact.corner,
                    .beside = contact.is_on_edge() ? partition_.node_of_corner[contact.beside] : -1,
                    .share = contact.share};
    made.mass = mass_between(made.before, made.after);
    if (contact.is_on_edge()) {
        const double s = contact.share, other = mass_between(made.before, made.beside);
        made.mass = 1 / ((1 - s) * (1 - s) / made.mass + s * s / other);
    }
    made.support_rate = made.in_frame(velocity_at(obstacles_.rate()[contact.obstacle], contact));
    const Vec2 speed = contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }) -
                       velocity_at(begin.obstacles[contact.obstacle].velocity, contact);
    made.law = {.u_N = contact.gap,
                .u_T = 0,
                .strength = 0,
                .cohesion = 0,
                .material = &law,
                .friction = model_.obstacles[contact.obstacle].is_free() && contact.is_led_along(bulk_.prescribed()[made.after]) ? 0 : law.friction,
                .contact = contact_bound_theta(contact.gap, contact.normal.dot(speed), law.restitution, h, options_.theta, 0),
                .implicit_beta = false,
                .h = h,
                .theta = options_.theta};
    impose(made);
    made.law.set_staircase();
    return made;
}

void ImplicitScheme::guess_contacts() {
    const std::size_t first = points_.size() - contacts_.all().size();
    for (std::size_t i = 0; i < contacts_.all().size(); ++i) {
        ActivePoint& point = points_[first + i];
        point.law.contact_guess = point.law.contact.may_touch ? contact_guess_[i].x() : 0;
        point.law.tangential_guess = std::isinf(point.law.rho_T) ? 0 : contact_guess_[i].y();
    }
}

void ImplicitScheme::keep_contacts() {
    pushed_.assign(model_.mesh.n_corners(), Vec2::Zero());
    for (std::size_t i = 0; i < contacts_.all().size(); ++i) {
        const ActivePoint& point = contact_points()[i];
        contact_guess_[i] = {point.law.contact_guess, point.law.tangential_guess};
        const ObstacleContact& contact = contacts_.all()[i];
        pushed_[contact.corner] += (1 - contact.share) * point.impulse();
        if (contact.is_on_edge()) pushed_[contact.beside] += contact.share * point.impulse();
    }
}

bool ImplicitScheme::activate_opening_fans(double h, StepReport& report) {
    for (const ActivePoint& point : points_)
        if (point.fan_point >= 0) guess_[point.fan_point] = {point.law.contact_guess, point.law.tangential_guess};
    keep_contacts();
    corner_rate_.resize(model_.mesh.n_corners());
    for (std::size_t c = 0; c < corner_rate_.size(); ++c) corner_rate_[c] = rate_[partition_.node_of_corner[c]];
    bool any = false;
    std::vector<Vec2>& required = required_;
    for (std::size_t f = 0; f < model_.fans.size(); ++f) {
        const Fan& fan = model_.fans[f];
        if (active_[f] || fan.n_points == 0) continue;
        const Index* corner = &model_.fan_corners[fan.first_corner];
        const auto& prescribed = bulk_.prescribed()[partition_.node_of_corner[corner[0]]];
        required.resize(fan.n_corners);
        for (Index i = 0; i < fan.n_corners; ++i) {
            required[i] = solver_.corner_impulse()[corner[i]] - pushed_[corner[i]];
            for (int k = 0; k < 2; ++k)
                if (prescribed[k]) required[i][k] = 0;  // what moves a corner takes its reaction too
        }
        ++report.bond_checks;
        if (bond_check_.holds(static_cast<Index>(f), required, options_.theta * h)) continue;
        active_[f] = any = true;
        for (Index j = 0; j < fan.n_points; ++j) {
            const FanPoint& point = model_.fan_points[fan.first_point + j];
            const Vec2 impulse = bond_check_.impulses()[j];
            const double strength = model_.laws[point.law].breakable() ? options_.theta * h * point.area * model_.laws[point.law].sigma_c : 0;
            guess_[fan.first_point + j] = {impulse.dot(point.normal) + strength, impulse.dot(turned_left(point.normal))};
            has_guess_[fan.first_point + j] = 1;
        }
    }
    return any;
}

double ImplicitScheme::momentum_scale() const { return largest_scale_ / max_pressing; }

void ImplicitScheme::check_residual(StepReport& report) const {
    // the laws once more at the joined rates, with one unit of augmentation: the natural residual, as impulses of the scale of the strengths
    const double unit = solver_.unit();
    for (const ActivePoint& point : points_) {
        const Vec2 w = point.rate_at(rate_);
        PointLaw law = point.law;
        law.contact_guess = point.response.contact;
        law.tangential_guess = point.response.tangential;
        law.rho_N = point.mass;
        if (!std::isinf(law.rho_T)) law.rho_T = point.mass;
        const PointResponse again = respond(law, w.x(), w.y());
        report.residual = std::max({report.residual, std::abs(again.normal(law) - point.response.normal(point.law)) / unit,
                                    std::abs(again.tangential - point.response.tangential) / unit});
    }
    // the balance is a sum of momenta and loads, whose rounding a weak interface is no measure of; what it is worth in energy, energy_balance_error_exceeds judges
    const double balance_unit = std::max(unit, 0.1 * momentum_scale());
    for (Index i = 0; i < partition_.n_nodes(); ++i)
        for (int k = 0; k < 2; ++k)
            if (!bulk_.prescribed()[i][k]) report.residual = std::max(report.residual, std::abs(solver_.residual_impulse()[i][k]) / balance_unit);
}

bool ImplicitScheme::energy_balance_error_exceeds(const StepReport& report) const {
    double work = 0, fastest = 0;
    for (Index i = 0; i < partition_.n_nodes(); ++i)
        for (int k = 0; k < 2; ++k) {
            if (!bulk_.prescribed()[i][k]) work += solver_.residual_impulse()[i][k] * rate_[i][k] / options_.theta;
            fastest = std::max(fastest, std::abs(rate_[i][k]));
        }
    return std::abs(work) > max_missed * (report.kinetic + report.strain + momentum_scale() * fastest);
}

void ImplicitScheme::account_points(double h, StepReport& report) const {
    const double theta = options_.theta;
    for (const ActivePoint& point : points_) {
        const PointLaw& law = point.law;
        const Vec2 w = point.rate_at(rate_);
        const double cohesive_N = law.strength * point.response.cohesion_theta;
        const double cohesive_T = -(point.response.tangential - point.response.friction_part);  // resists
        report.cohesive_work += (cohesive_N * w.x() + cohesive_T * w.y()) / theta;
        const double rate_error = (rounding + report.residual) * solver_.unit() / (point.mass * theta);  // [m/s] of w/theta
        const double u_N = law.u_N + h * w.x(), u_T = law.u_T + h * w.y();
        account_contact({point.response.contact, point.response.friction_part, w.x() / theta, w.y() / theta, rate_error, u_N}, report);
        if (point.fan_point < 0) continue;
        report.crossing_loss += (cohesive_T * w.y() - law.material->gamma * cohesive_N * (std::abs(u_T) - std::abs(law.u_T)) / h) / theta;
    }
}

bool ImplicitScheme::holds(Index f) const {
    const Fan& fan = model_.fans[f];
    for (Index j = 0; j < fan.n_points; ++j) {
        const Index i = active_point_of_[fan.first_point + j];
        if (i < 0) continue;
        const ActivePoint& point = points_[i];
        if (!point.holds_still() || point.response.softens) return false;
    }
    return true;
}

void ImplicitScheme::store(const State& begin, double h, State& end, StepReport& report) const {
    end = begin;
    for (std::size_t f = 0; f < model_.fans.size(); ++f) {
        if (!active_[f] || end.split_rank[f] >= 0 || holds(static_cast<Index>(f))) continue;
        split(model_, static_cast<Index>(f), end);
        ++report.released;
    }
    end.rate.resize(end.displacement.size());
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
        const Index node = partition_.node_of_corner[c], to = end.node_of_corner[c];
        end.displacement[to] = begin.displacement[begin.node_of_corner[c]] + h * rate_[node];
        end.velocity[to] = bulk_.end_velocity(node, rate_[node]);
        end.rate[to] = rate_[node];
    }
    end.reaction.assign(model_.prescribed.size(), Vec2::Zero());
    for (Index i = 0; i < partition_.n_nodes(); ++i) {
        const Index motion = model_.prescribed_of_corner[partition_.corner_of_node[i]];
        for (int k = 0; k < 2; ++k)
            if (motion >= 0 && model_.prescribed[motion].component[k])
                end.reaction[motion][k] = solver_.residual_impulse()[i][k] / (options_.theta * h);
    }
    for (std::size_t rank = 0; rank < end.split_fans.size(); ++rank) {
        const Fan& fan = model_.fans[end.split_fans[rank]];
        for (Index j = 0; j < fan.n_points; ++j) {
            const Index i = fan.first_point + j, active = active_point_of_[i];
            const FanPoint& at = model_.fan_points[i];
            PointState& state = end.points[end.first_point[rank] + j];
            if (active < 0) continue;
            const ActivePoint& point = points_[active];
            state.traction = Vec2(point.response.normal(point.law), point.response.tangential) / (options_.theta * h * at.area);
            const auto displacement = [&](Index corner) -> Vec2 {
                return corner == rigid_support ? Vec2::Zero() : end.displacement[end.node_of_corner[corner]];
            };
            const CohesiveLaw& material = model_.laws[at.law];
            const Vec2 u = point.in_frame(displacement(at.after) - displacement(at.before));
            state.cohesion = at.cracked ? 0 : material.next_cohesion(point.law.cohesion, at.gap + u.x(), u.y());
            account_cohesion(at, material, point.law.cohesion, state.cohesion, at.gap + u.x(), u.y(), report);
        }
    }
}

StepReport ImplicitScheme::rejected(StepReport report, Rejection rejection) const {
    report.rejection = rejection;
    report.where = place_of_trouble(rejection);
    return report;
}

Vec2 ImplicitScheme::place_of_trouble(Rejection rejection) const {
    Index corner = partition_.corner_of_node[solver_.worst_node()];
    if (rejection == Rejection::assumption_1)
        for (const ActivePoint& point : points_) {
            if (point.fan_point < 0 || (!point.response.softens && !point.response.breaks)) continue;
            const FanPoint& at = model_.fan_points[point.fan_point];
            corner = at.after == rigid_support ? at.before : at.after;
        }
    return model_.mesh.corner(corner);
}

}  // namespace knap
