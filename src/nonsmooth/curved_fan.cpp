#include "nonsmooth/curved_fan.hpp"

#include "base/tolerance.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double eps = 1e-7;  // [-]
constexpr int most_newton_steps = 20, most_descents = 40, most_halvings = 12, n_rounds = 7;
constexpr double round_weights[n_rounds] = {1, 1, 30, 1000, 1, 30, 1000};
constexpr double multiplier_weights[] = {10,  10,  10,  30,  30,
                                         100, 100, 1e3, 1e4, 1e5};  // [-] of the method of multipliers
constexpr int most_lags = 56, lags_between = 4;                     // of friction, before Newton's steps
constexpr int most_sweeps = 40, sweeps_between = 4, most_sweep_rounds = 28;
struct Start {
    double impulse, pressed;  // of those of the step before; impulse -1: the best ones found
};
constexpr Start starts[] = {{-1, 0}, {0, 0.25}, {1, 0.5}, {0, 0.75}, {2, 1}};
constexpr double largest_stretch = 1e7, may_worsen[] = {1.01, 1.5};  // [-] of the distance from the laws
// of the way on which friction grows: Newton's steps of a piece, pieces, their lengths, and weights by which rates or
// impulses decide what a link does; the larger ones have more rounding
constexpr int most_path_steps = 8, most_pieces = 2000;
constexpr double first_piece = 0.25, least_piece = 1e-7, path_weights[] = {1e3, 1e5, 1e7, 30, 1};
constexpr double rounding_weight = 1e4;  // [-]

}  // namespace

Vec2 CurvedFan::rate(std::size_t i, const FanVelocities& motion) const {
    const FanLink& link = problem_->links[i];
    const Vec2 V = motion.across(link);
    return {link.normal.dot(V), link.tangent().dot(V)};
}

/// [1/kg] By which the impulse of a link changes its own rate.
Eigen::Matrix2d CurvedFan::mobility(std::size_t i) const {
    const FanLink& link = problem_->links[i];
    const Vec2 w = problem_->inverse_mass(link.after) + problem_->inverse_mass(link.before), T = link.tangent();
    Eigen::Matrix2d W;
    W(0, 0) = link.normal.dot(w.cwiseProduct(link.normal)), W(1, 1) = T.dot(w.cwiseProduct(T));
    W(0, 1) = W(1, 0) = T.dot(w.cwiseProduct(link.normal));
    return W;
}

/// What is driven on both sides along its normal has no contact.
void CurvedFan::start() {
    const std::vector<FanLink>& links = problem_->links;
    rows_.resize(links.size()), at_.resize(links.size());
    flexible_.resize(links.size()), stiff_.resize(links.size());
    for (std::size_t i = 0; i < links.size(); ++i) {
        const FanLink& link = links[i];
        const Eigen::Matrix2d W = mobility(i);
        Row& row = rows_[i];
        row.unbreakable = link.unbreakable;
        row.r = W.trace() > 0 ? 1 / W.trace() : scales_.impulse / scales_.speed;
        row.impulse = W.trace() > 0 ? link.last_impulse : Vec2::Zero();
        row.pressed = 0;
        if (link.unbreakable) continue;
        const Vec2 before = problem_->velocity_before(link.after) - problem_->velocity_before(link.before);
        row.law = norm_law(link, before, problem_->drift_time, scales_.rest);
        if (W(0, 0) <= relative_tolerance * W.trace()) row.law.contact.may_touch = false;
    }
    find_velocities();
}

void CurvedFan::find_velocities() {
    motion_.velocity.clear();
    for (const FanBody& body : problem_->bodies) motion_.velocity.push_back(body.free_velocity);
    for (std::size_t i = 0; i < rows_.size(); ++i) apply(i, rows_[i].impulse);
}

void CurvedFan::apply(std::size_t i, const Vec2& impulse) {
    const FanLink& link = problem_->links[i];
    const Vec2 P = link.vector(impulse.x(), impulse.y());
    if (link.after >= 0) motion_.velocity[link.after] += problem_->bodies[link.after].inverse_mass.cwiseProduct(P);
    if (link.before >= 0) motion_.velocity[link.before] -= problem_->bodies[link.before].inverse_mass.cwiseProduct(P);
}

/// The projection of a link with so many times its weight.
NormLaw::Response CurvedFan::respond(std::size_t i, double weight) const {
    const Row& row = rows_[i];
    const double r = weight * row.r;
    const Vec2 Q = row.impulse - r * rate(i);
    if (!row.unbreakable) return row.law.respond(Q, r);
    return {.at = {.impulse = Q, .slope = Eigen::Matrix2d::Identity()}, .sticks = true};
}

/// The projections of all links; returns the largest distance from them [N s].
double CurvedFan::find_gaps(double weight) {
    double largest = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        at_[i] = respond(i, weight).at;
        largest = std::max(largest, (at_[i].impulse - rows_[i].impulse).norm());
    }
    return largest;
}

/// change_ = (M + H' stiff_ H)^-1 force_, of velocities that are not prescribed. Body after body of the chain is
/// eliminated, each coupled to the next one and to the last, which closes the chain.
bool CurvedFan::find_change() {
    const std::vector<FanBody>& bodies = problem_->bodies;
    const std::size_t n = bodies.size();
    std::size_t last = n - 1;  // of the chain: obstacles behind it, whose motion is given, couple to nothing
    while (last > 0 && bodies[last].inverse_mass.isZero(0)) --last;
    std::vector<Vec2>& change = change_.velocity;
    blocks_.assign(n, {}), change.resize(n);
    const auto is_free = [&](std::size_t body) -> Vec2 {
        return (bodies[body].inverse_mass.array() > 0).cast<double>();
    };
    for (std::size_t body = 0; body < n; ++body) {
        const Vec2 free = is_free(body);
        change[body] = free.cwiseProduct(force_[body]);
        blocks_[body].own.diagonal() = bodies[body].mass() + Vec2::Ones() - free;
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const FanLink& link = problem_->links[i];
        Eigen::Matrix2d axes;
        axes << link.normal, link.tangent();
        const Eigen::Matrix2d K = axes * stiff_[i] * axes.transpose();
        const auto between = [&](std::size_t row, std::size_t column) -> Eigen::Matrix2d {
            return K.cwiseProduct(is_free(row) * is_free(column).transpose());
        };
        for (const Index body : {link.after, link.before})
            if (body >= 0) blocks_[body].own += between(body, body);
        if (link.after < 0 || link.before < 0) continue;
        const std::size_t from = std::min(link.after, link.before), to = std::max(link.after, link.before);
        Block& block = blocks_[from];
        (to == last ? block.to_last : block.to_next) -= between(from, to);
        (to == last ? block.from_last : block.from_next) -= between(to, from);
    }
    for (std::size_t body = 0; body < last; ++body) {
        Block& block = blocks_[body];
        const Eigen::Matrix2d inverse = block.own.inverse();
        block.to_next = inverse * block.to_next, block.to_last = inverse * block.to_last;
        change[body] = inverse * change[body];
        blocks_[last].own -= block.from_last * block.to_last;
        change[last] -= block.from_last * change[body];
        if (body + 1 == last) break;
        Block& next = blocks_[body + 1];
        next.own -= block.from_next * block.to_next;
        next.to_last -= block.from_next * block.to_last;
        next.from_last -= block.from_last * block.to_next;
        change[body + 1] -= block.from_next * change[body];
    }
    change[last] = blocks_[last].own.inverse() * change[last];
    bool is_finite = change[last].allFinite();
    for (std::size_t body = last; body-- > 0;) {
        change[body] -= blocks_[body].to_last * change[last];
        if (body + 1 < last) change[body] -= blocks_[body].to_next * change[body + 1];
        is_finite = is_finite && change[body].allFinite();
    }
    return is_finite;
}

void CurvedFan::add_force(std::size_t i, const Vec2& impulse) {
    const FanLink& link = problem_->links[i];
    const Vec2 P = link.vector(impulse.x(), impulse.y());
    if (link.after >= 0) force_[link.after] += P;
    if (link.before >= 0) force_[link.before] -= P;
}

/// A step of Newton's method from the projections at_.
bool CurvedFan::step(double weight) {
    const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
    force_.assign(problem_->bodies.size(), Vec2::Zero());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        flexible_[i] = (one - (1 - eps) * at_[i].slope).inverse();
        stiff_[i] = weight * rows_[i].r * flexible_[i] * at_[i].slope;
        add_force(i, flexible_[i] * (at_[i].impulse - rows_[i].impulse));
    }
    if (!find_change()) return false;
    for (std::size_t i = 0; i < rows_.size(); ++i)
        rows_[i].impulse +=
            flexible_[i] * (at_[i].impulse - rows_[i].impulse - weight * rows_[i].r * at_[i].slope * rate(i, change_));
    find_velocities();
    return true;
}

/// What the velocities lack to the balance with the projections of heavier weights, of which it is the derivative of a
/// convex function (without friction): force_ = H' project(P - weight r V) - M (v - v_free).
void CurvedFan::find_lack(double weight) {
    find_gaps(weight);
    force_.resize(problem_->bodies.size());
    for (std::size_t b = 0; b < force_.size(); ++b) {
        const FanBody& body = problem_->bodies[b];
        force_[b] = -body.mass().cwiseProduct(motion_.velocity[b] - body.free_velocity);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) add_force(i, at_[i].impulse);
    for (std::size_t b = 0; b < force_.size(); ++b)
        for (int k = 0; k < 2; ++k)
            if (problem_->bodies[b].inverse_mass[k] == 0) force_[b][k] = 0;
}

/// The method of multipliers: a minimum over the velocities by Newton's method with a line search, then the projections
/// become the impulses.
void CurvedFan::approach() {
    const auto along = [&] {
        double sum = 0;
        for (std::size_t b = 0; b < force_.size(); ++b) sum += force_[b].dot(change_.velocity[b]);
        return sum;
    };
    const auto move = [&](double length, double weight) {
        for (std::size_t b = 0; b < force_.size(); ++b) motion_.velocity[b] += length * change_.velocity[b];
        find_lack(weight);
    };
    for (const double weight : multiplier_weights) {
        find_lack(weight);
        bool is_found = false;
        for (int k = 0; k < most_descents; ++k) {
            for (std::size_t i = 0; i < rows_.size(); ++i) stiff_[i] = weight * rows_[i].r * at_[i].slope;
            if (!find_change()) break;
            const double falls = along();
            double length = 1;
            move(length, weight);
            for (int half = 0; half < most_halvings && along() < -0.3 * falls; ++half)
                length *= 0.5, move(-length, weight);
            double largest = 0;
            for (const Vec2& force : force_) largest = std::max(largest, force.norm());
            is_found = largest <= 0.01 * scales_.impulse_tolerance;
            if (is_found) break;
        }
        if (!is_found && weight > multiplier_weights[0]) break;  // too stiff: what was found stays
        for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].impulse = at_[i].impulse;
    }
    find_velocities();
}

/// A solution with friction that is bounded by the mean of the pressures found last and of those that bounded it
/// before: by the last ones alone it may go to and fro.
void CurvedFan::lag_friction() {
    for (Row& row : rows_) row.law.pressed = row.pressed = 0.5 * (row.pressed + std::max(0.0, row.impulse.x()));
    approach();
    for (Row& row : rows_) row.law.pressed = -1;
}

/// Link after link meets its law, the others given. Where some slide in a closed fan whose others stick, every sweep
/// adds the same self-stress until one of these gives way: it is stretched while no link meets its law much worse.
void CurvedFan::sweep(double worse) {
    const auto add = [&](double times) {
        for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].impulse += times * impulse_[i];
        find_velocities();
    };
    for (int k = 1; k <= most_sweeps; ++k) {
        impulse_.clear();
        for (const Row& row : rows_) impulse_.push_back(-row.impulse);
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            Row& row = rows_[i];
            const Eigen::Matrix2d W = mobility(i);
            if (W.determinant() <= relative_tolerance * W.trace() * W.trace()) continue;  // driven
            const Vec2 free = rate(i) - W * row.impulse;
            const Vec2 P = row.unbreakable ? Vec2(-W.inverse() * free) : row.law.impulse(W, free, row.impulse);
            apply(i, P - row.impulse);
            row.impulse = P;
        }
        if (k % sweeps_between != 0) continue;
        for (std::size_t i = 0; i < rows_.size(); ++i) impulse_[i] += rows_[i].impulse;
        const double gap = find_gaps(1);
        for (double times = 1; times < largest_stretch; times *= 2) {
            add(times);
            if (find_gaps(1) <= worse * gap) continue;
            add(-times);
            break;
        }
    }
    find_velocities();
}

/// Newton's steps to rounding; the best impulses of them stay, whose largest distance [N s] from the projections is
/// returned.
double CurvedFan::settle(double weight, int most, int& iterations) {
    const double tolerance = scales_.impulse_tolerance * std::max(1.0, weight / rounding_weight);
    double best = infinity;
    int since = 0;
    for (int k = 0; k < most; ++k) {
        const double gap = find_gaps(weight);
        if (gap < best) {
            best = gap, since = 0;
            get_impulses(best_);
        } else if (++since >= 2 && best <= tolerance) {
            break;
        }
        if (best <= 0.01 * tolerance) break;
        ++iterations;
        if (!step(weight)) break;
    }
    set_impulses(best_);
    return best;
}

void CurvedFan::get_impulses(std::vector<Vec2>& impulses) const {
    impulses.clear();
    for (const Row& row : rows_) impulses.push_back(row.impulse);
}

void CurvedFan::set_impulses(const std::vector<Vec2>& impulses) {
    for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].impulse = impulses[i];
    find_velocities();
}

/// Sliding friction has no potential, and Newton's steps go to and fro between states of links that drive self-stress
/// through a closed fan. Without friction the solution is a minimum, and from there it moves continuously while
/// friction grows to its whole, unless the way turns back.
void CurvedFan::follow_friction(bool from_minimum, int& iterations) {
    std::vector<Staircase> whole;
    for (const Row& row : rows_) whole.push_back(row.law.sliding);
    const auto set_friction = [&](double part) {
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            rows_[i].law.sliding = {};
            for (Staircase::Kink kink : whole[i].kinks()) {
                kink.friction *= part;
                rows_[i].law.sliding.add(kink, 0);
            }
        }
    };
    std::vector<Vec2> last;
    const auto settles = [&](double weight, int most) {
        return settle(weight, most, iterations) <= scales_.impulse_tolerance * std::max(1.0, weight / rounding_weight);
    };
    const auto settles_again = [&](double weight) {
        set_impulses(last);
        return settles(weight, most_path_steps);
    };
    set_friction(0);
    if (from_minimum) approach();
    const bool is_found =
        std::ranges::any_of(path_weights, [&](double weight) { return settles(weight, most_newton_steps); });
    double part = 0, piece = first_piece;
    for (int k = 0; is_found && part < 1 && piece >= least_piece && k < most_pieces; ++k) {
        get_impulses(last);
        const double next = std::min(1.0, part + piece);
        set_friction(next);
        if (std::ranges::any_of(path_weights, settles_again)) part = next, piece *= 2;
        else set_impulses(last), piece *= 0.5;
    }
    set_friction(1);
    for (const double weight : path_weights)
        if (find_gaps(1) > scales_.impulse_tolerance) settle(weight, most_newton_steps, iterations);
}

/// By the ways that lead to a solution where Newton's steps alone do not; the best one of them stays.
void CurvedFan::search(int& iterations) {
    double least = infinity;
    std::vector<Vec2> best;
    const auto is_solved = [&] {
        if (const double gap = find_gaps(1); gap < least) least = gap, get_impulses(best);
        return least <= scales_.impulse_tolerance;
    };
    const auto begin_at = [&](double times) {
        for (std::size_t i = 0; i < rows_.size(); ++i) rows_[i].impulse = times * problem_->links[i].last_impulse;
        find_velocities();
    };
    is_solved();
    const bool rubs = std::ranges::any_of(rows_, [](const Row& row) { return !row.law.sliding.kinks().empty(); });
    for (const double times : {1.0, 0.0}) {
        if (!rubs) break;
        begin_at(times);
        follow_friction(times > 0, iterations);
        if (is_solved()) return;
    }
    for (const Start& start : starts) {
        if (start.impulse >= 0) begin_at(start.impulse);
        else set_impulses(best);
        for (std::size_t i = 0; i < rows_.size(); ++i)
            rows_[i].pressed = start.pressed * std::max(0.0, problem_->links[i].last_impulse.x());
        for (int round = 0; round < most_lags; ++round) {
            lag_friction();
            if (round % lags_between == lags_between - 1 &&
                settle(round_weights[round / lags_between % n_rounds], most_newton_steps, iterations) <=
                    scales_.impulse_tolerance)
                break;
        }
        for (int round = 0; round < most_sweep_rounds && !is_solved(); ++round) {
            sweep(may_worsen[round % 2]);
            settle(round_weights[round % n_rounds], most_newton_steps, iterations);
        }
        if (is_solved()) break;
    }
    set_impulses(best);
}

void CurvedFan::join_what_sticks() {
    clusters_.start(*problem_);
    known_.assign(rows_.size(), 1), impulse_.resize(rows_.size());
    bool is_consistent = true;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const FanLink& link = problem_->links[i];
        impulse_[i] = link.vector(rows_[i].impulse.x(), rows_[i].impulse.y());
        const NormLaw::Response found = respond(i, 1);
        if (!found.sticks) continue;
        known_[i] = 0;
        const Vec2 V = link.vector(found.rate.x(), found.rate.y());
        is_consistent = clusters_.join(link, V, 10 * scales_.speed_tolerance) && is_consistent;
    }
    if (!is_consistent || !clusters_.find_velocities(impulse_, known_, 10 * scales_.speed_tolerance)) return;
    for (std::size_t b = 0; b < motion_.velocity.size(); ++b)
        motion_.velocity[b] = clusters_.velocity_of(static_cast<Index>(b));
}

CurvedFan::Found CurvedFan::solve(const FanProblem& problem, const FanScales& scales, FanResult& result) {
    problem_ = &problem, scales_ = scales;
    start();
    Found found{.bonded = true};
    // heavier weights go more by the rates where they find the states of the links
    bool settled = false;
    for (int round = 0; round < n_rounds && !settled; ++round) {
        if (round > 0) approach();
        settled = settle(round_weights[round], most_newton_steps, found.iterations) <= scales_.impulse_tolerance;
    }
    if (!settled) search(found.iterations);
    join_what_sticks();
    result.velocity = motion_.velocity;
    result.links.resize(rows_.size());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const NormLaw::Response at = respond(i, 1);
        const Vec2& P = rows_[i].impulse;
        if (mobility(i).trace() > 0)  // else nothing is to be decided
            found.residual = std::max(found.residual, (at.at.impulse - P).norm() / scales.impulse);
        found.bonded = found.bonded && at.sticks;
        const double pull = rows_[i].unbreakable ? 0 : -at.cohesion.x();
        result.links[i] = {.impulse = problem.links[i].vector(P.x(), P.y()),
                           .cohesive_impulse = pull,
                           .contact = at.closed ? std::max(0.0, P.x() + pull) : 0,
                           .tangential = P.y(),
                           .friction_part = at.friction,
                           .stuck = at.sticks};
    }
    return found;
}

}  // namespace knap
