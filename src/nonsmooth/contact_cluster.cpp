#include "nonsmooth/contact_cluster.hpp"

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {
namespace {

constexpr int first_sweeps = 12;
constexpr int first_body_sweeps = 24, more_body_sweeps = 60, more_rounds = 5;  // of contacts of rigid bodies
constexpr double rough = 1e-3;            // [-] of the speeds: a residual of sweeps that is not left
constexpr double exact = 1e-13;           // [-] of the speeds: a residual at rounding
constexpr double accepted_error = 1e-11;  // [-] of the speeds: not worth proximal points
constexpr double body_error = 1e-9;       // [-] likewise of rigid bodies: sweeps go on in the next steps
constexpr double too_strong = 20;         // impulses of the last step that would cause larger rates are dropped
constexpr std::size_t bold_attempts = 6, max_attempts = 20;  // of the active set
constexpr Eigen::Index max_dense = 60;                       // rows of W: more are solved by blocks
constexpr double surely_regular = 1e-6;  // smallest over largest pivot: no estimate of the condition is needed
constexpr double lack_of_blocks = 1e-9;  // [-] of the right side, after two corrections

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
            .unbreakable = contact.unbreakable,
            .pressed = contact.pressed};
}

/// The impulse whose rates W P are `rate`, by the components that have a mobility.
Vec2 change_to_stop(const Eigen::Matrix2d& W, const Vec2& rate) {
    if (W.determinant() > 1e-12 * W(0, 0) * W(1, 1)) return W.inverse() * rate;
    return {W(0, 0) > 0 ? rate.x() / W(0, 0) : 0, W(1, 1) > 0 ? rate.y() / W(1, 1) : 0};
}

}  // namespace

InterfaceLaw contact_law(double gap, const Vec2& before, double friction, double restitution, double h, double deep,
                         double tolerance, double kept, double given) {
    const double touching = tolerance * h;
    InterfaceLaw law{.contact = contact_bound_explicit(gap, before.x(), restitution, h, touching, given)};
    if (kept > 0 && gap > touching) law.contact.may_touch = false;  // R_T acts once, where the sides touch
    if (-gap > deep && before.x() < 0)
        law.contact.rate = std::max(law.contact.rate, std::min(-0.5 * before.x(), (-gap - deep) / h));
    add_friction_explicit(friction, before.y(), tolerance, law.closed, kept);
    return law;
}

void ContactCluster::couple(Index of, Index on, const Eigen::Matrix2d& W) {
    ClusterContact& c = contacts[of];
    if (c.first_coupling == c.last_coupling) c.first_coupling = c.last_coupling = static_cast<Index>(couplings.size());
    assert(c.last_coupling == static_cast<Index>(couplings.size()));  // one contact after the other
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
    if (c.other) return own.trace() > 0 ? c.other->impulse(own, c.velocity - own * c.impulse, c.impulse) : c.impulse;
    if (c.unbreakable) return c.impulse - change_to_stop(own, c.velocity);
    double p = 0;
    if (own(0, 0) <= 0) p = p_now;
    else if (c.law.contact.may_touch) p = std::max(0.0, p_now - (c.velocity.x() - c.law.contact.rate) / own(0, 0));
    if (p == 0 && c.cohesive == 0) return Vec2::Zero();
    const double P_N = p - c.cohesive, slip = c.velocity.y() + own(1, 0) * (P_N - c.impulse.x());
    const double free = slip - own(1, 1) * c.impulse.y();
    if (!c.pressed || p == 0) return {P_N, c.law.staircase(p > 0).impulse(p, free, own(1, 1))};
    Staircase at_pressure = c.law.closed;
    at_pressure.line = c.pressed.line(c.pressed.line_at(p));
    return {P_N, at_pressure.impulse(p, free, own(1, 1))};
}

/// [m/s] The change of its own rates by an impulse.
double ContactCluster::error(Index i, const Vec2& change) const {
    return std::max(std::abs(change.x()) * own_[i](0, 0), std::abs(change.y()) * own_[i](1, 1));
}

void ContactCluster::add_term(Index contact, const ClusterTerm& term) {
    ClusterContact& c = contacts[contact];
    if (c.first_term == c.last_term) c.first_term = c.last_term = static_cast<Index>(terms.size());
    assert(c.last_term == static_cast<Index>(terms.size()));  // likewise
    terms.push_back(term);
    ++c.last_term;
}

void ContactCluster::hold(ContactCoupling& own, int component) {
    own.W.row(component).setZero(), own.W.col(component).setZero();
    for (ClusterTerm& term : terms_of(own.of)) (component == 0 ? term.along_N : term.along_T).setZero();
}

Eigen::Matrix2d ContactCluster::own_of_bodies(Index i) const {
    Eigen::Matrix2d own = Eigen::Matrix2d::Zero();
    for (const ClusterTerm& term : terms_of(i)) {
        const Vec3& inverse_mass = bodies[term.body].inverse_mass;
        own.col(0) += term.rate(inverse_mass.cwiseProduct(term.along_N));
        own.col(1) += term.rate(inverse_mass.cwiseProduct(term.along_T));
    }
    return own;
}

void ContactCluster::hold_unmoved() {
    find_own();
    for (ContactCoupling& c : couplings)
        for (int k = 0; k < 2; ++k)
            if (own_[c.of](k, k) <= unmoved * own_[c.of].trace()) hold(c, k);
    find_own();
}

void ContactCluster::find_own() {
    own_.assign(contacts.size(), Eigen::Matrix2d::Zero());
    for (const ContactCoupling& c : couplings)
        if (c.of == c.on) own_[c.of] = c.W;
    if (terms.empty()) return;
    for (Index i = 0; i < size(); ++i) own_[i] += own_of_bodies(i);
}

double ContactCluster::largest_error() const {
    double largest = 0;
    for (Index i = 0; i < size(); ++i) largest = std::max(largest, residual(i));
    return largest;
}

void ContactCluster::apply(Index i, const Vec2& impulse) {
    for (Index k = contacts[i].first_coupling; k < contacts[i].last_coupling; ++k)
        contacts[couplings[k].on].velocity += couplings[k].W * impulse;
    for (const ClusterTerm& term : terms_of(i))
        bodies[term.body].change += bodies[term.body].inverse_mass.cwiseProduct(term.wrench(impulse));
}

/// The velocity of a contact takes what its rigid bodies have changed since it was counted last.
void ContactCluster::count_bodies(Index i) {
    for (Index k = contacts[i].first_term; k < contacts[i].last_term; ++k) {
        const Vec2 now = terms[k].rate(bodies[terms[k].body].change);
        contacts[i].velocity += now - counted_[k];
        counted_[k] = now;
    }
}

/// One sweep of Gauss-Seidel; returns the largest change of a rate [m/s] by the impulse of its own contact.
double ContactCluster::sweep() {
    double largest = 0;
    for (Index i = 0; i < size(); ++i) {
        count_bodies(i);
        const Vec2 change = lawful_impulse(i) - contacts[i].impulse;
        if (change.isZero(0)) continue;
        largest = std::max(largest, error(i, change));
        contacts[i].impulse += change;
        apply(i, change);
    }
    return largest;
}

/// V = V_free + W P + L c, without the rounding of many sweeps.
void ContactCluster::find_velocities() {
    for (ClusterContact& c : contacts) c.velocity = c.free;
    for (ClusterBody& body : bodies) body.change.setZero();
    counted_.assign(terms.size(), Vec2::Zero());
    for (Index i = 0; i < size(); ++i)
        if (!contacts[i].impulse.isZero(0)) apply(i, contacts[i].impulse);
    for (Index i = 0; i < size() && !bodies.empty(); ++i) count_bodies(i);
}

double ContactCluster::solve(double speed, double rounding, ClusterEffort effort) {
    const double tolerance = exact * speed + rounding;
    find_own();
    is_analysed_ = false;
    double strongest = 0;
    for (Index i = 0; i < size(); ++i) strongest = std::max(strongest, error(i, contacts[i].impulse));
    if (strongest > too_strong * speed)
        for (ClusterContact& c : contacts) c.impulse.setZero();
    if (effort == ClusterEffort::sweeps) return solve_bodies(speed, rounding);
    // beyond the rounding of gaps, so that what rests does not creep
    double best = sweep_to(exact * speed, first_sweeps);
    if (best <= tolerance) return best;
    best_ = contacts;
    // many contacts are seldom without a redundant one
    if (2 * size() <= max_dense && settle_states(speed, tolerance))
        if (const double now = largest_error(); now < best) best = now, best_ = contacts;
    contacts = best_;
    const auto approach_with = [&](const Weights& weights) {
        if (best > accepted_error * speed + rounding) best = approach(best, speed, rounding, weights);
    };
    // what rigid bodies couple changes many states at once: weights fall slowly
    if (effort != ClusterEffort::active_set)
        approach_with(bodies.empty() ? Weights{1e-4, 0.01, 15} : Weights{1e-3, 0.2, 15});
    if (effort == ClusterEffort::careful) approach_with({1e-2, 0.3, 40});
    return best;
}

/// Of contacts of rigid bodies alone. Few of them are solved to rounding, so that what rests does not creep.
double ContactCluster::solve_bodies(double speed, double rounding) {
    const double tolerance = exact * speed + rounding, enough = body_error * speed + rounding;
    double best = sweep_bodies(speed, first_body_sweeps);
    if (best > enough && 2 * size() <= max_dense) best = sweep_bodies(speed, more_body_sweeps);
    if (best <= enough) return best;
    best_ = contacts;
    if (2 * size() <= max_dense && settle_states(speed, tolerance))
        if (const double now = largest_error(); now < best) best = now, best_ = contacts;
    contacts = best_;
    // one linear system takes as long as 30 sweeps, and proximal points need a hundred systems
    for (int k = 0; k < more_rounds && best > rough * speed + rounding; ++k)
        best = sweep_bodies(speed, more_body_sweeps);
    return best;
}

double ContactCluster::sweep_bodies(double speed, int max_sweeps) {
    body_sweeps_.read(contacts, bodies, terms, own_);
    body_sweeps_.run(exact * speed, max_sweeps, contacts);
    find_velocities();
    return largest_error();
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
    own_coupling_.resize(own_.size());
    for (const ContactCoupling& c : couplings)
        if (c.of == c.on) own_coupling_[c.of] = c.W;
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
                           (alpha >= slow_below && found_after(max_iterations));
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
        if (c.of == c.on)
            c.W = own_coupling_[c.of] + Eigen::Matrix2d((alpha * exact_own_[c.of].diagonal()).asDiagonal());
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
    tried_.clear();
    for (std::size_t attempt = 0; attempt < attempts; ++attempt) {
        const std::size_t last = (attempt < bold_attempts ? std::min(bold_attempts, attempts) : attempts) - 1;
        if (attempt == bold_attempts) tried_.clear();
        // the same states lead to the same ones, but for curved laws: whole periods are left out
        if (const std::size_t period = attempts_since_same(); period > 0 && tangents_.empty())
            attempt += (last - attempt) / period * period;
        if (!solve_states()) return false;
        StateChange worst;
        std::size_t at = 0;
        bool others_hold = true;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (contacts[i].other) others_hold = others_hold && residual(static_cast<Index>(i)) <= tolerance;
            if (contacts[i].unbreakable || contacts[i].other) continue;
            const StateChange change =
                change_of(states_[i], link_in_frame(contacts[i]), contacts[i].velocity, contacts[i].impulse, scales);
            if (change.violation == 0) continue;
            if (change.violation > worst.violation) worst = change, at = i;
            if (attempt < bold_attempts) follow(change, link_in_frame(contacts[i]), states_[i]);
        }
        if (worst.violation == 0 && others_hold) return true;
        if (attempt >= bold_attempts && worst.violation > 0) follow(worst, link_in_frame(contacts[at]), states_[at]);
    }
    return false;
}

/// Adds the states to those that were tried; how many attempts ago they were the same, or 0.
std::size_t ContactCluster::attempts_since_same() {
    const std::size_t n = states_.size(), now = tried_.size();
    for (const LinkState& state : states_)
        tried_.push_back(static_cast<std::uint8_t>(16 * state.line + 2 * state.tangential_state + state.closed));
    for (std::size_t end = now; end > 0; end -= n)
        if (std::equal(tried_.end() - n, tried_.end(), tried_.begin() + (end - n))) return (now - end) / n + 1;
    return 0;
}

void ContactCluster::fit_states(const FanScales& scales) {
    states_.resize(contacts.size());
    tangents_.clear();
    if (std::ranges::any_of(contacts, [](const ClusterContact& c) { return c.other != nullptr; }))
        tangents_.resize(contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        states_[i] = {};
        states_[i].law = contacts[i].law;
        if (contacts[i].unbreakable || contacts[i].other) states_[i].closed = true;
        else states_[i].fit(link_in_frame(contacts[i]), contacts[i].velocity, contacts[i].impulse, scales);
    }
}

/// lack_ = what A times the solution by blocks lacks to the right side, and M c = L' P of rigid bodies.
void ContactCluster::find_lack() {
    lack_.assign(by_rows_.size(), 0);
    const auto of = [](std::vector<double>& all, Eigen::Index first) { return Eigen::Map<Vec2>(all.data() + first); };
    const auto of_body = [&](std::vector<double>& all, Index body) {
        return Eigen::Map<Vec3>(all.data() + 2 * size() + 4 * body);
    };
    for (std::size_t r = 0; r < unknown_.size(); ++r) lack_[unknown_[r]] = rhs_[r];
    for (std::size_t i = 0; i < couplings.size(); ++i)
        of(lack_, 2 * couplings[i].on) -= part_[i] * of(by_rows_, 2 * couplings[i].of);
    for (Index b = 0; b < static_cast<Index>(bodies.size()); ++b) of_body(lack_, b) = of_body(by_rows_, b);
    for (Index i = 0; i < size(); ++i)
        for (Index k = contacts[i].first_term; k < contacts[i].last_term; ++k) {
            const TermPart& part = part_of_term_[k];
            const Index body = terms[k].body;
            of(lack_, 2 * i) -= part.rates * of_body(by_rows_, body);
            of_body(lack_, body) -= bodies[body].inverse_mass.cwiseProduct(Vec3(part.wrenches * of(by_rows_, 2 * i)));
        }
}

/// Each rigid body is two more rows of the factor, M^-1 L' P - c = 0: the velocities, and the spin with a number that
/// nothing uses. A contact of rigid bodies alone has no pivot before one of them is eliminated.
void ContactCluster::analyse() {
    factor_.start(size() + 2 * static_cast<Index>(bodies.size()));
    place_of_part_.clear();
    for (const ContactCoupling& c : couplings) place_of_part_.push_back(c.of == c.on ? c.of : factor_.add(c.on, c.of));
    for (Index i = 0; i < size(); ++i) {
        const ClusterContact& c = contacts[i];
        for (Index k = c.first_term; k < c.last_term; ++k)
            for (int half = 0; half < 2; ++half) {
                const Index row = size() + 2 * terms[k].body + half;
                place_of_part_.push_back(factor_.add(i, row)), place_of_part_.push_back(factor_.add(row, i));
            }
        if (c.last_term > c.first_term && c.last_coupling - c.first_coupling == 1)
            factor_.eliminate_after(i, size() + 2 * terms[c.first_term].body);
    }
    factor_.analyse();
    is_analysed_ = true;
}

/// As solve_dense, of a large problem; components that are known are unknowns without a coupling.
bool ContactCluster::solve_blocks() {
    if (!is_analysed_) analyse();
    factor_.clear();
    for (Index row = 0; row < 2 * size(); ++row)
        if (place_[row] < 0) factor_.block(row / 2)(row % 2, row % 2) = 1;
    for (std::size_t i = 0; i < couplings.size(); ++i) factor_.block(place_of_part_[i]) += part_[i];
    for (Index row = size(); row < size() + 2 * static_cast<Index>(bodies.size()); ++row)
        factor_.block(row) = -Eigen::Matrix2d::Identity();
    auto place = place_of_part_.begin() + static_cast<std::ptrdiff_t>(couplings.size());
    for (std::size_t k = 0; k < terms.size(); ++k) {
        const Eigen::Matrix<double, 2, 3>& rates = part_of_term_[k].rates;
        const Eigen::Matrix<double, 3, 2> changes =
            bodies[terms[k].body].inverse_mass.asDiagonal() * part_of_term_[k].wrenches;
        factor_.block(*place++) = rates.leftCols<2>(), factor_.block(*place++) = changes.topRows<2>();
        factor_.block(*place++).col(0) = rates.col(2), factor_.block(*place++).row(0) = changes.row(2);
    }
    if (!factor_.factorise()) return false;
    by_rows_.assign(2 * size() + 4 * bodies.size(), 0);
    const auto mapped = [](std::vector<double>& all) {
        return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
    };
    find_lack();
    by_rows_ = lack_;
    factor_.solve(mapped(by_rows_));
    find_lack();
    factor_.solve(mapped(lack_));
    mapped(by_rows_) += mapped(lack_);
    find_lack();
    if (!bodies.empty()) {  // c exactly, so that no spin is compared with a velocity
        const Eigen::Index n = 4 * static_cast<Eigen::Index>(bodies.size());
        mapped(by_rows_).tail(n) -= mapped(lack_).tail(n);
        find_lack();
    }
    for (std::size_t r = 0; r < unknown_.size(); ++r) p_[r] = by_rows_[unknown_[r]];
    return mapped(p_).allFinite() &&
           mapped(lack_).head(2 * size()).cwiseAbs().maxCoeff() <= lack_of_blocks * mapped(rhs_).cwiseAbs().maxCoeff();
}

/// p_ = A^-1 rhs_, with the least norm where contacts are redundant.
bool ContactCluster::solve_dense() {
    const auto n = static_cast<Eigen::Index>(unknown_.size());
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_dense, max_dense>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_dense, 1>;
    Matrix A = Matrix::Zero(n, n);
    const auto add = [&](Index on, Index of, const Eigen::Matrix2d& part) {
        for (int k = 0; k < 2; ++k)
            for (int l = 0; l < 2; ++l) {
                const Eigen::Index row = place_[2 * on + k], column = place_[2 * of + l];
                if (row >= 0 && column >= 0) A(row, column) += part(k, l);
            }
    };
    for (std::size_t i = 0; i < couplings.size(); ++i) add(couplings[i].on, couplings[i].of, part_[i]);
    for (Index body = 0; body < static_cast<Index>(bodies.size()); ++body) {
        body_rows_.clear();
        for (Index i = 0; i < size(); ++i)
            for (Index k = contacts[i].first_term; k < contacts[i].last_term; ++k)
                for (int c = 0; c < 2 && terms[k].body == body; ++c)
                    if (const Eigen::Index row = place_[2 * i + c]; row >= 0)
                        body_rows_.push_back(
                            {row, part_of_term_[k].rates.row(c),
                             bodies[body].inverse_mass.cwiseProduct(part_of_term_[k].wrenches.col(c))});
        for (const BodyRow& of : body_rows_)
            for (const BodyRow& on : body_rows_) A(on.row, of.row) += on.rate.dot(of.change);
    }
    const Eigen::Map<const Eigen::VectorXd> rhs(rhs_.data(), n);
    const Eigen::PartialPivLU<Matrix> factor(A);
    Vector p = factor.solve(rhs);
    p += factor.solve(Vector(rhs - A * p));
    const double scale = rhs.cwiseAbs().maxCoeff();
    const auto pivots = factor.matrixLU().diagonal().cwiseAbs();
    const bool is_regular = pivots.minCoeff() > surely_regular * pivots.maxCoeff() || factor.rcond() >= 1e-12;
    if (!p.allFinite() || (A * p - rhs).cwiseAbs().maxCoeff() > 1e-12 * scale || !is_regular)
        p = A.completeOrthogonalDecomposition().solve(rhs);
    Eigen::Map<Eigen::VectorXd>(p_.data(), n) = p;
    return p.allFinite();
}

/// Impulses and velocities in given states: V_N = b where closed, else P_N = -C; V_T = kink where it sticks, else
/// P_T = -offset - line_offset - contact_offset p; of other laws the tangents. Of least norm where some are redundant.
bool ContactCluster::solve_states() {
    const std::vector<LinkState>& states = states_;
    unknown_.clear();
    for (std::size_t i = 0; i < states.size(); ++i) {
        ClusterContact& c = contacts[i];
        if (c.other) tangents_[i] = c.other->tangent(c.velocity, c.impulse, weight(static_cast<Index>(i)));
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
        else if (!sticks) c.impulse.y() = -tangential.offset - tangential.line_offset - tangential.contact_offset * p;
    }
    find_velocities();
    const std::size_t n = unknown_.size();
    place_.assign(2 * states.size(), -1);
    rhs_.resize(n), p_.resize(n);
    for (std::size_t r = 0; r < n; ++r) {
        const Eigen::Index row = unknown_[r];
        const ClusterContact& c = contacts[row / 2];
        place_[row] = static_cast<Eigen::Index>(r);
        if (c.other) rhs_[r] = (tangents_[row / 2].right - tangents_[row / 2].of_rate * c.velocity)[row % 2];
        else if (row % 2 == 0) rhs_[r] = c.law.contact.rate - c.velocity.x();
        else rhs_[r] = states[row / 2].tangential.kink - c.velocity.y();
    }
    part_.clear();
    for (const ContactCoupling& c : couplings) {
        const StaircasePiece& tangential = states[c.of].tangential;
        Eigen::Matrix2d& part = part_.emplace_back(c.W);
        if (!tangential.stick) part.col(0) -= tangential.contact_offset * part.col(1);
        if (contacts[c.on].other) part = tangents_[c.on].of_rate * part;
        if (contacts[c.on].other && c.on == c.of) part += tangents_[c.on].of_impulse;
        for (int k = 0; k < 2; ++k) {
            if (place_[2 * c.on + k] < 0) part.row(k).setZero();
            if (place_[2 * c.of + k] < 0) part.col(k).setZero();
        }
    }
    part_of_term_.clear();
    for (Index i = 0; i < size(); ++i)
        for (const ClusterTerm& term : terms_of(i)) {
            const StaircasePiece& tangential = states[i].tangential;
            TermPart& part = part_of_term_.emplace_back();
            part.rates << term.along_N.transpose(), term.along_T.transpose();
            part.wrenches << term.along_N, term.along_T;
            if (!tangential.stick) part.wrenches.col(0) -= tangential.contact_offset * part.wrenches.col(1);
            if (contacts[i].other) part.rates = tangents_[i].of_rate * part.rates;
            for (int k = 0; k < 2; ++k)
                if (place_[2 * i + k] < 0) part.rates.row(k).setZero(), part.wrenches.col(k).setZero();
        }
    if (n > 0 && !(2 * size() <= max_dense ? solve_dense() : solve_blocks())) return false;
    for (std::size_t r = 0; r < n; ++r) {
        const Eigen::Index i = unknown_[r] / 2;
        Vec2& impulse = contacts[i].impulse;
        impulse[unknown_[r] % 2] = p_[r];
        if (unknown_[r] % 2 == 0 && place_[2 * i + 1] < 0) impulse.y() -= states[i].tangential.contact_offset * p_[r];
    }
    find_velocities();
    return true;
}

}  // namespace knap
