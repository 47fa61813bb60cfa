#include "nonsmooth/linear_fan.hpp"

#include "base/tolerance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace knap {
namespace {

constexpr int max_multipliers = 24;

template <int max>  // on the stack, or on the heap where max is Eigen::Dynamic
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max, max>;
template <int max>
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max, 1>;

/// The solution of least norm of A x = b:  x = x_0 - N (N'N)^-1 N' x_0,  A N = 0.
template <int max>
Vector<max> solution_of_least_norm(const Matrix<max>& A, const Vector<max>& b) {
    Eigen::FullPivLU<Matrix<max>> lu(A);
    lu.setThreshold(pivot_tolerance);
    Vector<max> x = lu.solve(b);
    if (lu.dimensionOfKernel() == 0) return x;
    const Matrix<max> N = lu.kernel();
    const Matrix<max> squares = N.transpose().lazyProduct(N);
    const Vector<max> along = N.transpose().lazyProduct(x);
    const Vector<max> part = Eigen::LDLT<Matrix<max>>(squares).solve(along);
    return x -= N.lazyProduct(part);
}

}  // namespace

void LinearFan::start(const FanProblem& problem, double speed_tolerance) {
    problem_ = &problem;
    speed_tolerance_ = speed_tolerance;
    const auto for_each_end = [&](const auto& visit) {
        for (Index i = 0; i < n_links(); ++i) {
            const FanLink& link = problem.links[i];
            if (link.after >= 0) visit(link.after, LinkEnd{i, 1});
            if (link.before >= 0) visit(link.before, LinkEnd{i, -1});
        }
    };
    first_end_.assign(n_bodies() + 2, 0);  // shifted by one until all ends are in place
    for_each_end([&](Index body, const LinkEnd&) { ++first_end_[body + 2]; });
    for (Index b = 0; b < n_bodies(); ++b) first_end_[b + 2] += first_end_[b + 1];
    link_ends_.resize(first_end_.back());
    for_each_end([&](Index body, const LinkEnd& end) { link_ends_[first_end_[body + 1]++] = end; });
}

bool LinearFan::solve(const std::vector<LinkState>& states, FanMotion& motion, double& mismatch) {
    assert(states.size() == problem_->links.size());
    bool consistent = true;
    clusters_.start(*problem_);
    known_.resize(n_links());
    for (Index i = 0; i < n_links(); ++i) {
        const FanLink& link = problem_->links[i];
        known_[i] = !states[i].sticks();
        if (known_[i]) motion.impulse[i] = states[i].known_impulse(link);
        else consistent = clusters_.join(link, states[i].target(link), 10 * speed_tolerance_) && consistent;
    }
    if (!consistent || !clusters_.find_velocities(motion.impulse, known_, 10 * speed_tolerance_)) return false;
    if (!find_multipliers(states, motion)) return false;
    for (Index b = 0; b < n_bodies(); ++b) motion.velocity[b] = clusters_.velocity_of(b);
    mismatch = walk_chain(motion);
    return true;
}

double LinearFan::find_unbreakable_impulses(FanMotion& motion) {
    known_.resize(n_links());
    for (Index i = 0; i < n_links(); ++i) known_[i] = !problem_->links[i].unbreakable;
    return walk_chain(motion);
}

/// Secant unloading: the cohesion C r between its bounds, along -d, d = N + gamma sgn T,
///     (4 kappa/(h C)) C r - d . V = 4/h of the mean opening without V,
/// where d . V is gamma sgn V_T if the link is closed, and V_N at the kink of an open one.
void LinearFan::add_ramp(Index i, const LinkState& state, FanMotion& motion) {
    const FanLink& link = problem_->links[i];
    const double slope = state.tangential.offset / link.cohesive,  // gamma sgn
        compliance = link.ramp / link.cohesive, mobility = clusters_.inverse_mass(link).sum();
    const Vec2 force = link.vector(-1, -slope), row = link.vector(state.closed ? 0 : -1, -slope);
    const double start =
        link.ramp_start.x() + (state.closed ? state.law.contact.rate : 0) + slope * link.ramp_start.y();
    if (mobility == 0 || clusters_.has_one(link)) {  // the velocity is known
        motion.cohesive_impulse[i] = (start - row.dot(clusters_.across(link))) / compliance;
        motion.impulse[i] += motion.cohesive_impulse[i] * force;
        return;
    }
    const double unit = std::sqrt(mobility / (mobility + compliance));  // a row of the size of the others
    multipliers_.push_back({i, unit * row, unit * force, unit * start, unit * unit * compliance, unit});
}

/// One for each link on its ramp, for each closed sliding link (along N - s mu T, for V_N) and for each open link at
/// its kink (along T, for V_T).
bool LinearFan::find_multipliers(const std::vector<LinkState>& states, FanMotion& motion) {
    multipliers_.clear();
    for (Index i = 0; i < n_links(); ++i) {
        const LinkState& state = states[i];
        const FanLink& link = problem_->links[i];
        if (state.is_on_ramp(link)) add_ramp(i, state, motion);
        if (!state.partial() || clusters_.has_one(link)) continue;
        if (state.closed)
            multipliers_.push_back(
                {i, link.normal, link.vector(1, -state.tangential.contact_offset), state.law.contact.rate});
        else multipliers_.push_back({i, link.tangent(), link.tangent(), state.tangential.kink});
    }
    const int n = static_cast<int>(multipliers_.size());
    if (n == 0) return true;
    if (n > max_multipliers) return false;
    Matrix<max_multipliers> A(n, n);
    Vector<max_multipliers> rhs(n), size(n);
    for (int a = 0; a < n; ++a) {
        const auto& [i, row, force, target, compliance, unit] = multipliers_[a];
        rhs[a] = target - row.dot(clusters_.across(problem_->links[i]));
        for (int b = 0; b < n; ++b)
            A(a, b) = row.dot(
                clusters_.response(problem_->links[i], problem_->links[multipliers_[b].link], multipliers_[b].force));
        A(a, a) += compliance;
    }
    // of contacts that bound the same motion the one that bounds it most counts
    const auto is_contact = [&](int a) {
        return multipliers_[a].compliance == 0 && states[multipliers_[a].link].closed;
    };
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b)
            if (rhs[a] > rhs[b] && is_contact(a) && is_contact(b) &&
                (A.row(a) - A.row(b)).cwiseAbs().maxCoeff() <= pivot_tolerance * A(a, a))
                rhs[b] = rhs[a];
    // redundant contacts (both ends of a fan on an obstacle) share their load
    if (n == 1) size[0] = A(0, 0) != 0 ? rhs[0] / A(0, 0) : 0;
    else size = solution_of_least_norm<max_multipliers>(A, rhs);
    for (int a = 0; a < n; ++a) {
        const Vec2 added = size[a] * multipliers_[a].force;
        if (multipliers_[a].compliance > 0)
            motion.cohesive_impulse[multipliers_[a].link] = multipliers_[a].unit * size[a];
        motion.impulse[multipliers_[a].link] += added;
        clusters_.apply(problem_->links[multipliers_[a].link], added);
    }
    return true;
}

/// sum of P over the links of a body = m (v+ - v_free), body by body, from the links where P is known, each component
/// by itself: where the motion is prescribed, its constraint takes the difference. Returns the largest mismatch.
double LinearFan::walk_chain(FanMotion& motion) {
    undetermined_.assign(n_links(), Vec2::Zero());
    return std::max(walk_component(0, motion), walk_component(1, motion));
}

double LinearFan::walk_component(int k, FanMotion& motion) {
    const Index n = n_bodies();
    reached_ = known_;
    Index n_missing = static_cast<Index>(std::count(reached_.begin(), reached_.end(), 0));
    const auto is_free = [&](Index b) { return problem_->bodies[b].inverse_mass[k] > 0; };
    const auto reach_last_of = [&](Index b) {  // the only link of a body that is not reached
        if (!is_free(b)) return;
        const LinkEnd* last = nullptr;
        double given = 0, undetermined = 0;
        for (const LinkEnd& end : ends_at(b)) {
            if (!reached_[end.link]) {
                if (last) return;
                last = &end;
                continue;
            }
            given += end.sign * motion.impulse[end.link][k];
            undetermined += end.sign * undetermined_[end.link][k];
        }
        if (!last) return;
        motion.impulse[last->link][k] = last->sign * (required(b, k, motion) - given);
        undetermined_[last->link][k] = -last->sign * undetermined;
        reached_[last->link] = 1;
        --n_missing;
    };
    const auto walk = [&] {
        for (Index before = n_missing + 1; n_missing > 0 && n_missing < before;) {
            before = n_missing;
            for (Index b = 0; b < n; ++b) reach_last_of(b);
            for (Index b = n - 1; b >= 0 && n_missing > 0; --b) reach_last_of(b);
        }
    };
    walk();
    // links that no walk reached have a free constant: round a loop, or between two constraints
    int n_loops = 0;
    for (Index i = 0; i < n_links() && n_missing > 0; ++i) {
        if (reached_[i]) continue;
        if (++n_loops > 1) break;
        motion.impulse[i][k] = 0;
        undetermined_[i][k] = 1;
        reached_[i] = 1;
        --n_missing;
        walk();
    }
    if (n_loops > 1) spread_over_loops(k, motion);
    double mismatch = 0;
    for (Index b = 0; b < n; ++b) {
        if (!is_free(b)) continue;
        double sum = -required(b, k, motion);
        for (const LinkEnd& end : ends_at(b)) sum += end.sign * motion.impulse[end.link][k];
        mismatch = std::max(mismatch, std::abs(sum));
    }
    return mismatch;
}

/// More than one loop (several contacts with obstacles, several driven bodies): the impulses of least norm among all
/// that are in balance.
void LinearFan::spread_over_loops(int k, FanMotion& motion) {
    unknown_.clear(), balance_.clear();
    for (Index i = 0; i < n_links(); ++i) {
        undetermined_[i][k] = 0;
        if (!known_[i]) unknown_.push_back(i), motion.impulse[i][k] = 0;
    }
    for (Index b = 0; b < n_bodies(); ++b)
        if (problem_->bodies[b].inverse_mass[k] > 0) balance_.push_back(b);
    if (balance_.empty()) return;
    const auto find_impulses = [&]<int max>() {
        const Eigen::Index n_rows = static_cast<Eigen::Index>(balance_.size());
        Matrix<max> A = Matrix<max>::Zero(n_rows, static_cast<Eigen::Index>(unknown_.size()));
        Vector<max> rhs(n_rows);
        for (Eigen::Index row = 0; row < n_rows; ++row) {
            rhs[row] = required(balance_[row], k, motion);
            for (const LinkEnd& end : ends_at(balance_[row]))
                if (known_[end.link]) rhs[row] -= end.sign * motion.impulse[end.link][k];
                else A(row, std::ranges::lower_bound(unknown_, end.link) - unknown_.begin()) += end.sign;
        }
        const Vector<max> found = solution_of_least_norm<max>(A, rhs);
        for (std::size_t j = 0; j < unknown_.size(); ++j) motion.impulse[unknown_[j]][k] = found[j];
    };
    if (std::max(unknown_.size(), balance_.size()) <= max_multipliers)
        find_impulses.template operator()<max_multipliers>();
    else find_impulses.template operator()<Eigen::Dynamic>();
}

}  // namespace knap
