#include "stepper/contact/contact_cluster.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int first_sweeps = 12, last_sweeps = 100;
constexpr double exact = 1e-13;           // [-] of the speeds: a residual at rounding
constexpr double accepted_error = 1e-11;  // [-] of the speeds: not worth proximal points
constexpr double too_strong = 20;         // impulses of the last step that would cause larger rates are dropped
constexpr std::size_t bold_attempts = 6, max_attempts = 20;  // of the active set
constexpr Eigen::Index max_dense = 60;                       // rows of W: more are solved by blocks
constexpr double lack_of_blocks = 1e-9;                      // [-] of the right side, after two corrections

constexpr double min_weight = 1e-10, max_weight = 1;
constexpr double heavier = 10;       // after a problem that was not solved
constexpr double slow_below = 1e-3;  // sweeps

/// The link of a contact in its own frame: N and T are x and y.
FanLink link_in_frame(const ClusterContact& contact) {
    return {.before = 0,
            .after = 1,
            .normal = Vec2(1, 0),
            .u_N = 0,
            .u_T = 0,
            .cohesive = contact.cohesive,
            .gamma = 0,
            .friction = 0,
            .restitution = 0,
            .unbreakable = contact.unbreakable};
}

/// P_T with which V_T = free + mobility P_T obeys the staircase under the contact impulse p: it is monotone, so there
/// is one.
double lawful_tangential(const Staircase& staircase, double p, double free, double mobility) {
    const auto at = [&](const StaircasePiece& piece, double sign) {
        return -(piece.offset + sign * piece.jump) - (piece.contact_offset + sign * piece.contact_jump) * p;
    };
    if (mobility <= 0) return at(staircase.piece(staircase.state_of(free, 0)), 0);
    for (int state = 0; state < staircase.n_states(); ++state) {
        const StaircasePiece piece = staircase.piece(state);
        const double least = at(piece, 1), most = at(piece, -1);
        if (!piece.stick) {
            const double rate = free + mobility * most;
            if (rate <= piece.high) return rate >= piece.low ? most : std::max(most, (piece.low - free) / mobility);
        } else {
            const double needed = (piece.kink - free) / mobility;
            if (needed >= least) return std::min(needed, most);
        }
    }
    return 0;
}

/// The impulse whose rates W P are `rate`, by the components that have a mobility.
Vec2 change_to_stop(const Eigen::Matrix2d& W, const Vec2& rate) {
    if (W.determinant() > 1e-12 * W(0, 0) * W(1, 1)) return W.inverse() * rate;
    return {W(0, 0) > 0 ? rate.x() / W(0, 0) : 0, W(1, 1) > 0 ? rate.y() / W(1, 1) : 0};
}

}  // namespace

InterfaceLaw contact_law(double gap, const Vec2& before, double friction, double restitution, double h, double deep,
                         double tolerance) {
    const double touching = tolerance * h;
    InterfaceLaw law{.contact = contact_bound_explicit(gap, before.x(), restitution, h, touching)};
    if (-gap > deep && before.x() < 0)
        law.contact.rate = std::max(law.contact.rate, std::min(-0.5 * before.x(), (-gap - deep) / h));
    add_friction_explicit(friction, before.y(), tolerance, law.closed);
    return law;
}

void ContactCluster::couple(Index of, Index on, const Eigen::Matrix2d& W) {
    ClusterContact& c = contacts[of];
    if (c.first_coupling == c.last_coupling) c.first_coupling = c.last_coupling = static_cast<Index>(couplings.size());
    for (Index k = c.first_coupling; k < c.last_coupling; ++k)
        if (couplings[k].on == on) {
            couplings[k].W += W;
            return;
        }
    couplings.push_back({of, on, W});
    ++c.last_coupling;
}

/// The impulse that the law gives contact i if the others keep theirs: normal first, then friction.
Vec2 ContactCluster::lawful_impulse(Index i) const {
    const ClusterContact& c = contacts[i];
    const Eigen::Matrix2d& own = own_[i];
    const double p_now = c.impulse.x() + c.cohesive;
    if (c.unbreakable) return c.impulse - change_to_stop(own, c.velocity);
    double p = 0;
    if (own(0, 0) <= 0) p = p_now;
    else if (c.law.contact.may_touch) p = std::max(0.0, p_now - (c.velocity.x() - c.law.contact.rate) / own(0, 0));
    if (p == 0 && c.cohesive == 0) return Vec2::Zero();
    const double P_N = p - c.cohesive, slip = c.velocity.y() + own(1, 0) * (P_N - c.impulse.x());
    return {P_N, lawful_tangential(c.law.staircase(p > 0), p, slip - own(1, 1) * c.impulse.y(), own(1, 1))};
}

/// [m/s] The change of its own rates by an impulse.
double ContactCluster::error(Index i, const Vec2& change) const {
    return std::max(std::abs(change.x()) * own_[i](0, 0), std::abs(change.y()) * own_[i](1, 1));
}

void ContactCluster::find_own() {
    own_.assign(contacts.size(), Eigen::Matrix2d::Zero());
    for (const ContactCoupling& c : couplings)
        if (c.of == c.on) own_[c.of] = c.W;
}

double ContactCluster::largest_error() const {
    double largest = 0;
    for (Index i = 0; i < size(); ++i) largest = std::max(largest, residual(i));
    return largest;
}

void ContactCluster::apply(Index i, const Vec2& impulse) {
    for (Index k = contacts[i].first_coupling; k < contacts[i].last_coupling; ++k)
        contacts[couplings[k].on].velocity += couplings[k].W * impulse;
}

/// One sweep of Gauss-Seidel; returns the largest change of a rate [m/s] by the impulse of its own contact.
double ContactCluster::sweep() {
    double largest = 0;
    for (Index i = 0; i < size(); ++i) {
        const Vec2 change = lawful_impulse(i) - contacts[i].impulse;
        if (change.isZero(0)) continue;
        largest = std::max(largest, error(i, change));
        contacts[i].impulse += change;
        apply(i, change);
    }
    return largest;
}

/// V = V_free + W P, without the rounding of many sweeps.
void ContactCluster::find_velocities() {
    for (ClusterContact& c : contacts) c.velocity = c.free;
    for (Index i = 0; i < size(); ++i)
        if (!contacts[i].impulse.isZero(0)) apply(i, contacts[i].impulse);
}

double ContactCluster::solve(double speed, double rounding) {
    const double tolerance = exact * speed + rounding;
    find_own();
    is_analysed_ = false;
    double strongest = 0;
    for (Index i = 0; i < size(); ++i) strongest = std::max(strongest, error(i, contacts[i].impulse));
    if (strongest > too_strong * speed)
        for (ClusterContact& c : contacts) c.impulse.setZero();
    // beyond the rounding of gaps, so that what rests does not creep
    double best = sweep_to(exact * speed, first_sweeps);
    if (best <= tolerance) return best;
    best_ = contacts;
    // many contacts are seldom without a redundant one
    if (2 * size() <= max_dense && settle_states(speed, tolerance))
        if (const double now = largest_error(); now < best) best = now, best_ = contacts;
    contacts = best_;
    for (const Weights& weights : {Weights{1e-4, 0.01, 15}, {1e-2, 0.3, 40}})  // fast, and where that fails careful
        if (best > accepted_error * speed + rounding) best = approach(best, speed, rounding, weights);
    return best;
}

/// Sweeps until no rate changes by more than `change` [m/s]; returns the residual.
double ContactCluster::sweep_to(double change, int max_sweeps) {
    find_velocities();
    for (int k = 0; k < max_sweeps; ++k)
        if (sweep() <= change) break;
    find_velocities();
    return largest_error();
}

/// Proximal points (R. T. Rockafellar, SIAM J. Control Optim. 14, 1976, 877): P_k+1 solves the problem with the rates
///
///     V = V_free + W P + alpha D (P - P_k),     D: diagonal of the own blocks
///
/// whose operator is definite even where contacts are redundant, so that the states seldom cycle. A solution of the
/// problem itself is a fixed point for any alpha, and the nearer to it, the smaller alpha may be.
double ContactCluster::approach(double best, double speed, double rounding, const Weights& weights) {
    const double tolerance = exact * speed + rounding, enough = accepted_error * speed + rounding;
    exact_own_ = own_;
    free_.clear();
    for (const ClusterContact& c : contacts) free_.push_back(c.free);
    double alpha = weights.first;
    for (int k = 0; k < weights.points && best > enough; ++k) {
        start_ = contacts;
        const auto found_after = [&](int sweeps) {
            contacts = start_;
            bring_near(alpha);
            return sweep_to(0.1 * tolerance, sweeps) <= tolerance || settle_states(speed, tolerance);
        };
        const bool found = (k == 0 && found_after(0)) || found_after(first_sweeps) ||
                           (alpha >= slow_below && found_after(last_sweeps));
        bring_near(0);
        find_velocities();
        const double now = largest_error();
        if (now < best) best = now, best_ = contacts;
        else if (!found && now > 10 * best) contacts = best_;
        alpha = found ? std::max(weights.lighter * alpha, min_weight) : std::min(heavier * alpha, max_weight);
    }
    contacts = best_;
    return best;
}

/// The problem of the next proximal point from the present impulses; with alpha = 0 the given problem.
void ContactCluster::bring_near(double alpha) {
    for (Index i = 0; i < size(); ++i) {
        const Vec2 weight = alpha * exact_own_[i].diagonal();
        own_[i] = exact_own_[i] + Eigen::Matrix2d(weight.asDiagonal());
        contacts[i].free = free_[i] - weight.cwiseProduct(contacts[i].impulse);
    }
    for (ContactCoupling& c : couplings)
        if (c.of == c.on) c.W = own_[c.of];
}

/// The active set: in given states the problem is linear. At first every contact that violates its law changes its
/// state, then only the worst.
bool ContactCluster::settle_states(double speed, double tolerance) {
    double mobility = 0;
    for (const Eigen::Matrix2d& own : own_) mobility = std::max(mobility, own(0, 0));
    if (mobility == 0) return false;
    const FanScales scales{.impulse = speed / mobility,
                           .speed = speed,
                           .impulse_tolerance = tolerance / mobility,
                           .speed_tolerance = tolerance,
                           .rest = tolerance};
    fit_states(scales);
    const std::size_t attempts = std::min<std::size_t>(contacts.size() + 4, max_attempts);
    for (std::size_t attempt = 0; attempt < attempts; ++attempt) {
        if (!solve_states()) return false;
        StateChange worst;
        std::size_t at = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (contacts[i].unbreakable) continue;
            const StateChange change =
                change_of(states_[i], link_in_frame(contacts[i]), contacts[i].velocity, contacts[i].impulse, scales);
            if (change.violation == 0) continue;
            if (change.violation > worst.violation) worst = change, at = i;
            if (attempt < bold_attempts) states_[i].set(change.closed, change.tangential_state);
        }
        if (worst.violation == 0) return true;
        if (attempt >= bold_attempts) states_[at].set(worst.closed, worst.tangential_state);
    }
    return false;
}

void ContactCluster::fit_states(const FanScales& scales) {
    states_.resize(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        states_[i] = {};
        states_[i].law = contacts[i].law;
        if (contacts[i].unbreakable) states_[i].closed = true;
        else states_[i].fit(link_in_frame(contacts[i]), contacts[i].velocity, contacts[i].impulse, scales);
    }
}

/// lack_ = what A times the solution by blocks lacks to the right side.
void ContactCluster::find_lack() {
    lack_.setZero(by_rows_.size());
    for (std::size_t r = 0; r < unknown_.size(); ++r) lack_[unknown_[r]] = rhs_[static_cast<Eigen::Index>(r)];
    for (std::size_t i = 0; i < couplings.size(); ++i)
        lack_.segment<2>(2 * couplings[i].on) -= part_[i] * by_rows_.segment<2>(2 * couplings[i].of);
}

/// As solve_linear, of a large problem; components that are known are unknowns without a coupling.
bool ContactCluster::solve_blocks() {
    if (!is_analysed_) {
        factor_.start(size());
        place_of_part_.clear();
        for (const ContactCoupling& c : couplings)
            place_of_part_.push_back(c.of == c.on ? c.of : factor_.add(c.on, c.of));
        factor_.analyse();
        is_analysed_ = true;
    }
    factor_.clear();
    for (Index row = 0; row < 2 * size(); ++row)
        if (place_[row] < 0) factor_.block(row / 2)(row % 2, row % 2) = 1;
    for (std::size_t i = 0; i < couplings.size(); ++i) factor_.block(place_of_part_[i]) += part_[i];
    if (!factor_.factorise()) return false;
    by_rows_.setZero(2 * size());
    find_lack();
    by_rows_ = lack_;
    factor_.solve(by_rows_);
    find_lack();
    factor_.solve(lack_);
    by_rows_ += lack_;
    find_lack();
    for (std::size_t r = 0; r < unknown_.size(); ++r) p_[static_cast<Eigen::Index>(r)] = by_rows_[unknown_[r]];
    return p_.allFinite() && lack_.cwiseAbs().maxCoeff() <= lack_of_blocks * rhs_.cwiseAbs().maxCoeff();
}

/// p_ = A^-1 rhs_, with the least norm where contacts are redundant and the problem is small.
bool ContactCluster::solve_linear(Eigen::Index n) {
    if (2 * size() > max_dense) return solve_blocks();
    A_.setZero(n, n);
    for (std::size_t i = 0; i < couplings.size(); ++i)
        for (int k = 0; k < 2; ++k)
            for (int l = 0; l < 2; ++l) {
                const Eigen::Index row = place_[2 * couplings[i].on + k], column = place_[2 * couplings[i].of + l];
                if (row >= 0 && column >= 0) A_(row, column) += part_[i](k, l);
            }
    const Eigen::PartialPivLU<Eigen::MatrixXd> factor(A_);
    p_ = factor.solve(rhs_);
    p_ += factor.solve(rhs_ - A_ * p_);
    const double scale = rhs_.cwiseAbs().maxCoeff();
    if (!p_.allFinite() || (A_ * p_ - rhs_).cwiseAbs().maxCoeff() > 1e-12 * scale || factor.rcond() < 1e-12)
        p_ = A_.completeOrthogonalDecomposition().solve(rhs_);
    return p_.allFinite();
}

/// Impulses and velocities in given states: V_N = b where closed, else P_N = -C; V_T = kink where it sticks, else
/// P_T = -offset - contact_offset p. Of least norm where contacts are redundant.
bool ContactCluster::solve_states() {
    const std::vector<LinkState>& states = states_;
    unknown_.clear();
    for (std::size_t i = 0; i < states.size(); ++i) {
        ClusterContact& c = contacts[i];
        const StaircasePiece& tangential = states[i].tangential;
        const bool closed = states[i].closed, sticks = tangential.stick && (closed || c.cohesive > 0);
        const bool finds_N = closed && own_[i](0, 0) > 0, finds_T = sticks && own_[i](1, 1) > 0;
        if (finds_N) unknown_.push_back(2 * static_cast<Eigen::Index>(i));
        if (finds_T) unknown_.push_back(2 * static_cast<Eigen::Index>(i) + 1);
        // what is known; where it slides, P_T = slope P_N + this
        if (finds_N) c.impulse.x() = 0;
        else if (!closed) c.impulse.x() = -c.cohesive;
        const double p = closed ? c.impulse.x() + c.cohesive : 0;
        if (finds_T) c.impulse.y() = 0;
        else if (!sticks) c.impulse.y() = -tangential.offset - tangential.contact_offset * p;
    }
    find_velocities();
    const auto n = static_cast<Eigen::Index>(unknown_.size());
    place_.assign(2 * states.size(), -1);
    rhs_.resize(n), p_.resize(n);
    for (Eigen::Index r = 0; r < n; ++r) {
        const Eigen::Index row = unknown_[r];
        const ClusterContact& c = contacts[row / 2];
        place_[row] = r;
        rhs_[r] = row % 2 == 0 ? c.law.contact.rate - c.velocity.x() : states[row / 2].tangential.kink - c.velocity.y();
    }
    part_.clear();
    for (const ContactCoupling& c : couplings) {
        const StaircasePiece& tangential = states[c.of].tangential;
        Eigen::Matrix2d& part = part_.emplace_back(c.W);
        if (!tangential.stick) part.col(0) -= tangential.contact_offset * part.col(1);
        for (int k = 0; k < 2; ++k) {
            if (place_[2 * c.on + k] < 0) part.row(k).setZero();
            if (place_[2 * c.of + k] < 0) part.col(k).setZero();
        }
    }
    if (n > 0 && !solve_linear(n)) return false;
    for (Eigen::Index r = 0; r < n; ++r) {
        const Eigen::Index i = unknown_[r] / 2;
        Vec2& impulse = contacts[i].impulse;
        impulse[unknown_[r] % 2] = p_[r];
        if (unknown_[r] % 2 == 0 && place_[2 * i + 1] < 0) impulse.y() -= states[i].tangential.contact_offset * p_[r];
    }
    find_velocities();
    return true;
}

}  // namespace knap
