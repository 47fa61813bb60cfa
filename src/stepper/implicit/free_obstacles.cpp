#include "stepper/implicit/free_obstacles.hpp"

#include "base/secant.hpp"
#include "stepper/common/point_work.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_steps = 60, max_secants = 20;
constexpr double no_line_search_below = 1e3;  // times the tolerance: the last digits are not worth a line search
constexpr double difference = 1e-6;           // [-] of the speeds, for the slope: exact up to rounding
constexpr double too_coarse = 1e-3;           // [-] of the impulses: a change by a difference
constexpr double same_piece = 1e-3;           // [-] of the error that a step leaves there
constexpr int max_smaller = 3, may_cycle = 10;
constexpr double least_length = 1. / 128;  // [-] of a step where they cycle
constexpr int few = 12;                    // components that are solved on the stack
// [-] of the largest momentum of the body: to 1e-10 of it an impulse is known where the body is far heavier
constexpr double of_body_momentum = 1e-2;

/// The theta law of a contact of rigid bodies: of points, but with the friction of explicit steps,
///
///     -P_T in mu p 1/2 [sgn(V_T+) + sgn(w_T)],     V_T+ = (w_T - (1 - theta) V_T-)/theta
///
/// With sgn(w_T) alone what sticks has V_T+ = -(1 - theta)/theta V_T-, for ever with theta = 1/2: a heap never comes to
/// rest, and each approach to a neighbour adds (1 - theta) h |V_N-| to their overlap. The work P_T w_T stays
/// non-positive: between the two kinks P_T = 0.
InterfaceLaw law_of_rigid(double gap, const Vec2& before, const ContactLaw& pair, const StepContext& step,
                          double tolerance) {
    InterfaceLaw law{.contact = contact_bound_theta(gap, before.x(), pair.restitution, step.h, step.theta, 0)};
    for (const double rate : {(1 - step.theta) * before.y(), 0.0})  // rest comes first: merged kinks keep it
        law.closed.add({.rate = rate, .cohesive = 0, .friction = 0.5 * pair.friction}, tolerance);
    return law;
}

}  // namespace

FreeObstacles::FreeObstacles(const Model& model, ObstacleMotion& motion, const ObstacleContacts& contacts)
    : model_(model), motion_(motion), contacts_(contacts), pairs_(model, ObstaclePairs::Supports::meet) {}

bool FreeObstacles::begin(const StepContext& step) {
    step_ = &step;
    rows_.clear(), free_.clear();
    residual_ = residual_work_ = rate_error_ = 0;
    without_contact_ = under_ = motion_.rate();
    row_wrench_.assign(model_.obstacles.size(), Vec3::Zero());
    place_.assign(model_.obstacles.size(), {-1, -1, -1});
    if (std::ranges::none_of(model_.obstacles, [](const Obstacle& o) { return o.is_free(); })) return false;
    const State& begin = *step.begin;
    pairs_.find(begin, step.h, motion_.rate());
    for (const ObstaclePairContact& at : pairs_.all()) {
        Row& row = rows_.emplace_back(Row{row_of(model_, begin, at), -1});
        visit_terms(at, [&](const ClusterTerm& term) { row.add(term); });
        const Vec2 v_1 = velocity_at(at.velocity(0, begin), at.arm[0]),
                   v_2 = velocity_at(at.velocity(1, begin), at.arm[1]);
        row.before = {normal_rate(at.normal, v_1, v_2), turned_left(at.normal).dot(v_2 - v_1)};
    }
    return !rows_.empty() || std::ranges::any_of(contacts_.all(), [&](const ObstacleContact& at) {
        return model_.obstacles[at.obstacle].is_free();
    });
}

/// Contacts of free obstacles along whose normals the body is held; it slips where it is held along the surface, too.
void FreeObstacles::add_held(const Body& body) {
    std::erase_if(rows_, [](const Row& row) { return row.contact >= 0; });
    const State& begin = *step_->begin;
    for (std::size_t i = 0; i < body.points.size(); ++i) {
        const ObstacleContact& at = contacts_.all()[i];
        const Obstacle& obstacle = model_.obstacles[at.obstacle];
        const ActivePoint& point = body.points[i];
        if (!point.is_held || !obstacle.is_free()) continue;
        const ContactLaw& law = contacts_.law_of(at, begin);
        Row& row = rows_.emplace_back(Row{{.gap = at.gap,
                                           .law = {.friction = std::isinf(point.multipliers.rho_T) ? law.friction : 0,
                                                   .restitution = law.restitution}},
                                          static_cast<Index>(i)});
        row.add(term_on(at.obstacle, -at.normal, at.arm));
        const auto rate = [&](Index c) -> Vec2 { return body.rate[body.nodes.node_of_corner[c]]; };
        const Vec2 of_body = at.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }),
                   of_obstacle = velocity_at(begin.obstacles[at.obstacle].velocity, at);
        row.given = point.in_frame(at.of_body(rate));
        row.before = {normal_rate(at.normal, of_obstacle, of_body), turned_left(at.normal).dot(of_body - of_obstacle)};
    }
}

/// [m/s] (V_N, V_T)
Vec2 FreeObstacles::rate_of(const Row& row, const std::vector<Vec3>& velocity) {
    Vec2 V = row.given;
    for (const ClusterTerm& term : row.on_obstacles()) V += term.rate(velocity[term.body]);
    return V;
}

/// The rows, where touched components answer impulses with B from x_free on, and all others with their masses.
void FreeObstacles::solve_rows(const Matrix& B, const Vector& x_free) {
    const auto n_rows = static_cast<Eigen::Index>(rows_.size());
    along_.setZero(x_free.size(), 2 * n_rows);
    under_ = without_contact_;
    for (Eigen::Index i = 0; i < x_free.size(); ++i)
        under_[free_[i].obstacle][free_[i].k] += x_free[i] / free_[i].root_mass;
    cluster_.contacts.clear(), cluster_.couplings.clear(), cluster_.bodies.clear(), cluster_.terms.clear();
    for (Index o = 0; o < static_cast<Index>(under_.size()); ++o)
        cluster_.bodies.push_back({is_touched(o) ? Vec3(Vec3::Zero()) : motion_.inverse_mass(o)});
    double speed = 0;
    for (Index i = 0; i < n_rows; ++i) {
        const Row& row = rows_[i];
        ClusterContact& made = cluster_.contacts.emplace_back();
        made.free = rate_of(row, under_);
        speed = std::max({speed, row.before.norm(), made.free.norm()});
        for (const ClusterTerm& term : row.on_obstacles()) {
            for (int k = 0; k < 3; ++k)
                if (const Index c = place_[term.body][k]; c >= 0) {
                    along_(c, 2 * i) += term.along_N[k] / free_[c].root_mass;
                    along_(c, 2 * i + 1) += term.along_T[k] / free_[c].root_mass;
                }
            if (!is_touched(term.body) && model_.obstacles[term.body].is_free()) cluster_.add_term(i, term);
        }
    }
    for (Index i = 0; i < n_rows; ++i)
        cluster_.contacts[i].law =
            law_of_rigid(rows_[i].gap, rows_[i].before, rows_[i].law, *step_, relative_tolerance * speed);
    answer_ = step_->theta * B * along_;
    for (Index of = 0; of < n_rows; ++of) {
        cluster_.couple(of, of, Eigen::Matrix2d::Zero());
        for (Index on = 0; on < n_rows; ++on)
            if (const Eigen::Matrix2d W = along_.middleCols<2>(2 * on).transpose() * answer_.middleCols<2>(2 * of);
                !W.isZero(0))
                cluster_.couple(of, on, W);
    }
    cluster_.hold_unmoved();
    const double error = cluster_.solve(speed, 0);
    rate_error_ = error + rate_rounding * speed;
    residual_ = speed > 0 ? error / speed : 0;
    Vector x = x_free;
    pressed_.setZero(x.size());
    row_wrench_.assign(row_wrench_.size(), Vec3::Zero());
    for (Index i = 0; i < n_rows; ++i) {
        const Vec2& P = cluster_.contacts[i].impulse;
        x += answer_.middleCols<2>(2 * i) * P;
        pressed_ += step_->theta * (along_.middleCols<2>(2 * i) * P);
        for (const ClusterTerm& term : rows_[i].on_obstacles()) row_wrench_[term.body] += term.wrench(P);
    }
    for (std::size_t o = 0; o < under_.size(); ++o) under_[o] += cluster_.bodies[o].change;
    for (Eigen::Index i = 0; i < x.size(); ++i)
        under_[free_[i].obstacle][free_[i].k] =
            without_contact_[free_[i].obstacle][free_[i].k] + x[i] / free_[i].root_mass;
    x_under_ = x;
}

bool FreeObstacles::presses_on_held() const {
    return std::ranges::any_of(rows_, [](const Row& row) { return row.contact >= 0; });
}

void FreeObstacles::subtract_impulses(const CornerPartition& nodes, std::vector<Vec2>& of_node) const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const Row& row = rows_[i];
        if (row.contact < 0) continue;
        const Vec2& P = cluster_.contacts[i].impulse;
        const ObstacleContact& at = contacts_.all()[row.contact];
        const Vec2 impulse = step_->theta * (P.x() * at.normal + P.y() * turned_left(at.normal));
        of_node[nodes.node_of_corner[at.corner]] -= (1 - at.share) * impulse;
        if (at.is_on_edge()) of_node[nodes.node_of_corner[at.second_corner]] -= at.share * impulse;
    }
}

void FreeObstacles::account(StepReport& report) const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const Vec2 V = rate_of(rows_[i], motion_.rate()), P = cluster_.contacts[i].impulse;
        account_contact({.contact = P.x(),
                         .friction = P.y(),
                         .rate_N = V.x(),
                         .rate_T = V.y(),
                         .rate_error = rate_error_,
                         .opening = rows_[i].gap + step_->h * V.x()},
                        report);
    }
}

void FreeObstacles::solve(const Body& body, const Response& response) {
    touched_.assign(model_.obstacles.size(), 0);  // by a part of the body that gives way
    for (std::size_t i = 0; i < body.points.size(); ++i)
        if (!body.points[i].is_held) touched_[contacts_.all()[i].obstacle] = 1;
    for (Index o = 0; o < static_cast<Index>(model_.obstacles.size()); ++o)
        for (int k = 0; k < 3 && touched_[o]; ++k)
            if (model_.obstacles[o].is_free(k)) {
                place_[o][k] = static_cast<Index>(free_.size());
                free_.push_back({o, k, std::sqrt(motion_.mass(o, k))});
            }
    add_held(body);
    double error = 0;
    if (free_.empty() && !rows_.empty()) solve_rows(Matrix(0, 0), Vector(0)), motion_.set_rate(under_);
    if (!free_.empty()) error = free_.size() <= few ? find_rates<few>(response) : find_rates<Eigen::Dynamic>(response);
    residual_ = std::max(residual_, error);
}

void FreeObstacles::finish(const Body& body) {
    find_wrench(body);
    for (std::size_t o = 0; o < wrench_.size(); ++o) wrench_[o] += row_wrench_[o];
    if (rows_.empty() || free_.empty()) return;
    for (const Component& c : free_) under_[c.obstacle][c.k] = motion_.rate()[c.obstacle][c.k];
    motion_.set_rate(under_);
}

/// [N s] Of the body.
void FreeObstacles::find_wrench(const Body& body) {
    contacts_.sum_wrenches([&](std::size_t i) -> Vec2 { return body.points[i].impulse() / step_->theta; }, wrench_);
}

/// Unknowns x = sqrt(M) (W - W without contact), so that all components have one unit. Without the rows they miss
/// g = x - theta Q/sqrt(M), with them by the error g - theta R/sqrt(M), R: impulses of the rows. A step solves the rows
/// for the body linearised at x, with B the inverse of the slope of g: they are solved as they are, however stiff the
/// body.
template <int max_components>
double FreeObstacles::find_rates(const Response& response) {
    using Few = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_components, max_components>;
    using FewRows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_components, 1>;
    const Eigen::Index n = static_cast<Eigen::Index>(free_.size());
    const State& begin = *step_->begin;
    const double theta = step_->theta;
    double speed = 0;  // [sqrt(kg) m/s]
    for (const Component& c : free_)
        speed = std::max(speed, c.root_mass * std::max(std::abs(begin.obstacles[c.obstacle].velocity[c.k]),
                                                       std::abs(without_contact_[c.obstacle][c.k])));
    double scale = 0, of_trial = 0;  // of the impulses of x, and of the last trial, which may press beyond all measure
    const auto missed_at = [&](const FewRows& x) {
        trial_ = without_contact_;
        for (Eigen::Index i = 0; i < n; ++i) trial_[free_[i].obstacle][free_[i].k] += x[i] / free_[i].root_mass;
        motion_.set_rate(trial_);
        const Body body = response();
        find_wrench(body), add_held(body);
        body_momentum_ = body.momentum;
        FewRows missed(n);
        of_trial = 0.01 * speed;  // an impulse is a difference of momenta: it has their rounding
        for (Eigen::Index i = 0; i < n; ++i) {
            const double given = theta * wrench_[free_[i].obstacle][free_[i].k] / free_[i].root_mass;
            of_trial = std::max({of_trial, std::abs(given), std::abs(x[i])});
            missed[i] = x[i] - given;
        }
        return missed;
    };
    const auto with_rows = [&](const FewRows& missed) { return rows_.empty() ? missed : FewRows(missed - pressed_); };
    FewRows x(n);  // starts with the reaction of the last step
    for (Eigen::Index i = 0; i < n; ++i)
        x[i] = step_->kick() * begin.obstacles[free_[i].obstacle].reaction[free_[i].k] / free_[i].root_mass;
    FewRows missed = missed_at(x);
    if (!rows_.empty()) solve_rows(Matrix::Identity(n, n), x - missed);
    const auto largest = [&] { return rows_.empty() ? of_trial : std::max(of_trial, pressed_.cwiseAbs().maxCoeff()); };
    FewRows error = with_rows(missed);
    scale = largest();
    // rows press with impulses of which nothing is left in x, and hold places: until x follows them it is the measure
    double goal = relative_tolerance * (rows_.empty() ? scale : std::max(0.01 * speed, x.cwiseAbs().maxCoeff()));
    Eigen::PartialPivLU<Few> slope;
    bool slope_is_known = false;
    for (int step = 0; step < max_steps && error.norm() > goal; ++step) {
        if (!slope_is_known) {
            Few columns(n, n);
            for (Eigen::Index j = 0; j < n; ++j) {
                double delta = difference * std::max(speed, scale);
                FewRows changed = missed_at(x + delta * FewRows::Unit(n, j)) - missed;
                // beside a stiff body the difference must not part what touches: the error changes more than the rate
                for (int again = 0; again < max_smaller && changed.norm() > too_coarse * scale; ++again) {
                    delta *= difference * scale / changed.norm();
                    changed = missed_at(x + delta * FewRows::Unit(n, j)) - missed;
                }
                columns.col(j) = changed / delta;
            }
            slope.compute(columns);
        }
        FewRows change = -slope.solve(missed);
        if (!rows_.empty()) solve_rows(slope.inverse(), x + change), change = x_under_ - x;
        const double before = error.norm();
        FewRows next = x + change, next_missed = missed_at(next), next_error = with_rows(next_missed);
        double of_next = largest();
        // without friction `missed` is the gradient of a convex function: the zero of its slope along Newton's step is
        // the length of the step
        if (next_error.norm() > 0.1 * before && before > no_line_search_below * relative_tolerance * scale) {
            const double at_0 = change.dot(missed), at_1 = change.dot(next_missed);
            const auto along = [&](double part) { return change.dot(missed_at(x + part * change)); };
            const double length =
                at_0 < 0 && at_1 > 0 ? zero_between(0, at_0, 1, at_1, 1e-3 * std::abs(at_0), max_secants, along) : 1;
            next = x + length * change, next_missed = missed_at(next), next_error = with_rows(next_missed);
            of_next = largest();
        }
        // between the pieces of friction, which has no potential, full steps may cycle
        if (step >= may_cycle && before > no_line_search_below * relative_tolerance * scale)
            for (double length = 0.5; next_error.norm() >= before && length >= least_length; length *= 0.5) {
                next = x + length * change, next_missed = missed_at(next), next_error = with_rows(next_missed);
                of_next = largest();
            }
        if (before <= no_line_search_below * relative_tolerance * scale && next_error.norm() >= before) break;
        slope_is_known = next_error.norm() <= same_piece * before;  // the same linear piece
        x = next, missed = next_missed, error = next_error, scale = of_next, goal = relative_tolerance * scale;
    }
    if (error.norm() > goal) error = with_rows(missed_at(x));
    if (!error.allFinite()) return infinity;
    const double of_own = scale > 0 ? error.norm() / scale : 0;
    if (of_own <= max_residual) return of_own;
    // an obstacle far lighter than the body: its impulses are as exact as the balance of the body. What their errors
    // work is judged with the balance of energy.
    double lightest = infinity;
    for (const Component& c : free_) {
        lightest = std::min(lightest, c.root_mass);
        residual_work_ +=
            std::abs(error[place_[c.obstacle][c.k]] * c.root_mass * motion_.rate()[c.obstacle][c.k]) / theta;
    }
    return error.norm() / std::max(scale, of_body_momentum * body_momentum_ / lightest);
}

}  // namespace knap
