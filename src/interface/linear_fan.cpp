#include "interface/linear_fan.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_multipliers = 24;
constexpr double rank_tolerance = 1e-11;

/// The solution of least norm of A x = b, on the stack where Matrix is of bounded size:  x = x_0 - N (N'N)^-1 N' x_0,  A N = 0.
template <class Matrix, class Vector>
Vector solution_of_least_norm(const Matrix& A, const Vector& b) {
    Eigen::FullPivLU<Matrix> lu(A);
    lu.setThreshold(rank_tolerance);
    Vector x = lu.solve(b);
    if (lu.dimensionOfKernel() == 0) return x;
    const Matrix N = lu.kernel();
    const Matrix squares = N.transpose().lazyProduct(N);
    const Vector along = N.transpose().lazyProduct(x);
    const Vector part = Eigen::LDLT<Matrix>(squares).solve(along);
    return x -= N.lazyProduct(part);
}

}  // namespace

void LinearFan::begin(const FanProblem& problem, double speed_tolerance) {
    problem_ = &problem;
    speed_tolerance_ = speed_tolerance;
    list_links();
}

void LinearFan::list_links() {
    first_end_.assign(n_bodies() + 1, 0);
    for (const FanLink& link : problem_->links) {
        if (link.after >= 0) ++first_end_[link.after + 1];
        if (link.before >= 0) ++first_end_[link.before + 1];
    }
    for (Index b = 0; b < n_bodies(); ++b) first_end_[b + 1] += first_end_[b];
    link_ends_.resize(first_end_.back());
    place_.assign(first_end_.begin(), first_end_.end() - 1);
    for (Index i = 0; i < n_links(); ++i) {
        const FanLink& link = problem_->links[i];
        if (link.after >= 0) link_ends_[place_[link.after]++] = {i, 1};
        if (link.before >= 0) link_ends_[place_[link.before]++] = {i, -1};
    }
}

bool LinearFan::solve(const std::vector<LinkState>& states, FanMotion& motion, double& mismatch) {
    if (!make_clusters(states)) return false;
    apply_known_impulses(states, motion);
    if (!prescribe_clusters()) return false;
    list_multipliers(states);
    if (!apply_multipliers(motion)) return false;
    for (Index b = 0; b < n_bodies(); ++b) motion.velocity[b] = cluster_velocity_[cluster_[b]] + offset_[b];
    mismatch = walk_chain(motion);
    return true;
}

double LinearFan::find_unbreakable_impulses(FanMotion& motion) {
    known_.resize(n_links());
    for (Index i = 0; i < n_links(); ++i) known_[i] = !problem_->links[i].unbreakable;
    return walk_chain(motion);
}

bool LinearFan::make_clusters(const std::vector<LinkState>& states) {
    const Index n = n_bodies();
    cluster_.resize(n);
    offset_.assign(n, Vec2::Zero());
    for (Index b = 0; b < n; ++b) cluster_[b] = b;
    support_cluster_ = n;
    support_offset_ = Vec2::Zero();
    bool consistent = true;
    for (Index i = 0; i < n_links(); ++i) {
        if (!states[i].sticks()) continue;
        const FanLink& link = problem_->links[i];
        const Index kept = cluster_of(link.before), joined = cluster_of(link.after);
        const Vec2 shift = offset_of(link.before) + states[i].target(link) - offset_of(link.after);
        if (kept == joined) {  // the loop is closed: its jumps must sum to zero
            consistent = consistent && shift.cwiseAbs().maxCoeff() <= 10 * speed_tolerance_;
            continue;
        }
        for (Index b = 0; b < n; ++b)
            if (cluster_[b] == joined) cluster_[b] = kept, offset_[b] += shift;
        if (support_cluster_ == joined) support_cluster_ = kept, support_offset_ += shift;
    }
    return consistent;
}

/// Cluster velocities with the known impulses:  V_c = sum (m (v_free - offset) + P_known) / sum m.
void LinearFan::apply_known_impulses(const std::vector<LinkState>& states, FanMotion& motion) {
    const Index n = n_bodies();
    cluster_velocity_.assign(n + 1, Vec2::Zero());
    cluster_inverse_mass_.assign(n + 1, Vec2::Zero());
    std::vector<Vec2>& momentum = cluster_velocity_;
    std::vector<Vec2>& mass = cluster_inverse_mass_;
    for (Index b = 0; b < n; ++b) {
        const FanBody& body = problem_->bodies[b];
        const Vec2 m = body.mass();
        momentum[cluster_[b]] += m.cwiseProduct(body.free_velocity - offset_[b]);
        mass[cluster_[b]] += m;
    }
    known_.resize(n_links());
    for (Index i = 0; i < n_links(); ++i) {
        known_[i] = !states[i].sticks();
        if (!known_[i]) continue;
        const FanLink& link = problem_->links[i];
        motion.impulse[i] = states[i].known_impulse(link);
        momentum[cluster_of(link.after)] += motion.impulse[i];
        momentum[cluster_of(link.before)] -= motion.impulse[i];
    }
    for (Index c = 0; c <= n; ++c)
        for (int k = 0; k < 2; ++k) {
            mass[c][k] = mass[c][k] > 0 ? 1 / mass[c][k] : 0;
            cluster_velocity_[c][k] = momentum[c][k] * mass[c][k];
        }
}

/// A prescribed component rules its cluster, and so does the support. False: two of them differ.
bool LinearFan::prescribe_clusters() {
    constexpr double ruled = -1;  // in place of the inverse mass
    bool consistent = true;
    for (int k = 0; k < 2; ++k) {
        const auto rule = [&](Index cluster, double velocity) {
            double& inverse_mass = cluster_inverse_mass_[cluster][k];
            if (inverse_mass == ruled && std::abs(velocity - cluster_velocity_[cluster][k]) > 10 * speed_tolerance_) consistent = false;
            cluster_velocity_[cluster][k] = velocity;
            inverse_mass = ruled;
        };
        rule(support_cluster_, -support_offset_[k]);
        for (Index b = 0; b < n_bodies(); ++b) {
            const FanBody& body = problem_->bodies[b];
            if (body.inverse_mass[k] == 0) rule(cluster_[b], body.free_velocity[k] - offset_[b][k]);
        }
        for (Vec2& w : cluster_inverse_mass_) w[k] = std::max(w[k], 0.0);
    }
    return consistent;
}

/// One for each closed sliding link (along N - s mu T, holds V_N) and each open link at its kink (along T, holds V_T).
void LinearFan::list_multipliers(const std::vector<LinkState>& states) {
    multipliers_.clear();
    for (Index i = 0; i < n_links(); ++i) {
        const LinkState& state = states[i];
        if (!state.partial()) continue;
        const FanLink& link = problem_->links[i];
        const Index after = cluster_of(link.after), before = cluster_of(link.before);
        if (after == before) continue;
        multipliers_.push_back({.link = i,
                                .after = after,
                                .before = before,
                                .row = state.closed ? link.normal : link.tangent(),
                                .force = state.closed ? link.vector(1, -state.tangential.contact_offset) : link.tangent(),
                                .wanted = state.closed ? state.law.bound() : state.tangential.kink});
    }
}

bool LinearFan::apply_multipliers(FanMotion& motion) {
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_multipliers, max_multipliers>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_multipliers, 1>;
    const int n = static_cast<int>(multipliers_.size());
    if (n == 0) return true;
    if (n > max_multipliers) return false;
    Matrix A(n, n);
    Vector rhs(n), size(n);
    for (int a = 0; a < n; ++a) {
        const Multiplier& held = multipliers_[a];
        const FanLink& link = problem_->links[held.link];
        const Vec2 relative =
            cluster_velocity_[held.after] + offset_of(link.after) - cluster_velocity_[held.before] - offset_of(link.before);
        rhs[a] = held.wanted - held.row.dot(relative);
        for (int b = 0; b < n; ++b) {
            const Multiplier& other = multipliers_[b];
            Vec2 response = Vec2::Zero();
            if (other.after == held.after) response += cluster_inverse_mass_[held.after].cwiseProduct(other.force);
            if (other.before == held.after) response -= cluster_inverse_mass_[held.after].cwiseProduct(other.force);
            if (other.after == held.before) response -= cluster_inverse_mass_[held.before].cwiseProduct(other.force);
            if (other.before == held.before) response += cluster_inverse_mass_[held.before].cwiseProduct(other.force);
            A(a, b) = held.row.dot(response);
        }
    }
    if (n == 1) {
        size[0] = A(0, 0) != 0 ? rhs[0] / A(0, 0) : 0;
    } else {
        size = solution_of_least_norm(A, rhs);  // redundant contacts (both ends of a fan on an obstacle) share what they carry
    }
    for (int a = 0; a < n; ++a) {
        const Multiplier& held = multipliers_[a];
        const Vec2 added = size[a] * held.force;
        motion.impulse[held.link] += added;
        cluster_velocity_[held.after] += cluster_inverse_mass_[held.after].cwiseProduct(added);
        cluster_velocity_[held.before] -= cluster_inverse_mass_[held.before].cwiseProduct(added);
    }
    return true;
}

/// sum of P over the links of a body = m (v+ - v_free), body by body, from the links where P is known, each component by itself: where the
/// motion is prescribed, its constraint takes the difference and nothing is passed on. Returns the largest mismatch of what is known twice.
double LinearFan::walk_chain(FanMotion& motion) {
    undetermined_.assign(n_links(), Vec2::Zero());
    return std::max(walk_component(0, motion), walk_component(1, motion));
}

double LinearFan::walk_component(int k, FanMotion& motion) {
    const Index n = n_bodies(), L = n_links();
    reached_ = known_;
    Index n_missing = L - static_cast<Index>(std::count(reached_.begin(), reached_.end(), 1));
    const auto passes = [&](Index b) { return problem_->bodies[b].inverse_mass[k] > 0; };
    const auto required = [&](Index b) {
        const FanBody& body = problem_->bodies[b];
        return (motion.velocity[b][k] - body.free_velocity[k]) / body.inverse_mass[k];
    };
    const auto reach_last_of = [&](Index b) {  // the only link of a body that is not reached
        if (!passes(b)) return;
        const LinkEnd* last = nullptr;
        double given = 0, undetermined = 0;
        for (Index e = first_end_[b]; e < first_end_[b + 1]; ++e) {
            const LinkEnd& end = link_ends_[e];
            if (!reached_[end.link]) {
                if (last) return;
                last = &end;
                continue;
            }
            given += end.sign * motion.impulse[end.link][k];
            undetermined += end.sign * undetermined_[end.link][k];
        }
        if (!last) return;
        motion.impulse[last->link][k] = last->sign * (required(b) - given);
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
    // what no walk reached is free by one constant: round a loop, or between two constraints
    int n_loops = 0;
    for (Index i = 0; i < L && n_missing > 0; ++i) {
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
        if (!passes(b)) continue;
        double sum = -required(b);
        for (Index e = first_end_[b]; e < first_end_[b + 1]; ++e) sum += link_ends_[e].sign * motion.impulse[link_ends_[e].link][k];
        mismatch = std::max(mismatch, std::abs(sum));
    }
    return mismatch;
}

/// More than one loop (several contacts with obstacles, several driven bodies): the impulses of least norm among all that are in balance.
void LinearFan::spread_over_loops(int k, FanMotion& motion) {
    unknown_.clear(), balance_.clear();
    for (Index i = 0; i < n_links(); ++i) {
        undetermined_[i][k] = 0;
        if (known_[i]) continue;
        unknown_.push_back(i);
        motion.impulse[i][k] = 0;
    }
    for (Index b = 0; b < n_bodies(); ++b)
        if (problem_->bodies[b].inverse_mass[k] > 0) balance_.push_back(b);
    if (balance_.empty()) return;  // all are driven
    const bool small = std::max(unknown_.size(), balance_.size()) <= max_multipliers;  // then without the heap
    if (small) find_least_norm<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_multipliers, max_multipliers>>(k, motion);
    else find_least_norm<Eigen::MatrixXd>(k, motion);
}

template <class Matrix>
void LinearFan::find_least_norm(int k, FanMotion& motion) const {
    constexpr int most = Matrix::MaxRowsAtCompileTime;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1>;
    Matrix A = Matrix::Zero(static_cast<Eigen::Index>(balance_.size()), static_cast<Eigen::Index>(unknown_.size()));
    Vector rhs(A.rows());
    for (Eigen::Index row = 0; row < A.rows(); ++row) {
        const Index b = balance_[row];
        const FanBody& body = problem_->bodies[b];
        rhs[row] = (motion.velocity[b][k] - body.free_velocity[k]) / body.inverse_mass[k];
        for (Index e = first_end_[b]; e < first_end_[b + 1]; ++e) {
            const LinkEnd& end = link_ends_[e];
            if (known_[end.link]) rhs[row] -= end.sign * motion.impulse[end.link][k];
            else A(row, std::lower_bound(unknown_.begin(), unknown_.end(), end.link) - unknown_.begin()) += end.sign;
        }
    }
    const Vector found = solution_of_least_norm(A, rhs);
    for (std::size_t j = 0; j < unknown_.size(); ++j) motion.impulse[unknown_[j]][k] = found[static_cast<Eigen::Index>(j)];
}

}  // namespace knap
