#include "interfaces/fan_solver.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_corrections = 40;     // changes of state before the sweeps take over
constexpr int patient_corrections = 8;  // from here on only the worst violation changes its state
constexpr int max_sweeps = 20000;
constexpr double relative_tolerance = 1e-12;  // of the largest impulse, or speed

Index n_links(const FanProblem& p) { return static_cast<Index>(p.links.size()); }
Index n_bodies(const FanProblem& p) { return static_cast<Index>(p.bodies.size()); }

/// Mass per component; 0 where the motion is prescribed: the constraint takes what acts there.
Vec2 mass_of(const FanBody& body) {
    return {body.inverse_mass.x() > 0 ? 1 / body.inverse_mass.x() : 0, body.inverse_mass.y() > 0 ? 1 / body.inverse_mass.y() : 0};
}

Vec2 frame_to_plane(const FanLink& link, double normal, double tangential) {
    return normal * link.normal + tangential * turned_left(link.normal);
}

}  // namespace

void FanSolver::set_scales(const FanProblem& problem) {
    double impulse = 0, speed = 0, mass = 0;
    Vec2 low = Vec2::Constant(1e300), high = -low;
    for (const FanBody& body : problem.bodies) {
        const Vec2 m = mass_of(body);
        impulse = std::max(impulse, m.cwiseProduct(body.free_velocity - body.velocity).cwiseAbs().maxCoeff());
        speed = std::max({speed, body.free_velocity.cwiseAbs().maxCoeff(), body.velocity.cwiseAbs().maxCoeff()});
        mass = std::max(mass, m.maxCoeff());
        low = low.cwiseMin(body.free_velocity);
        high = high.cwiseMax(body.free_velocity);
    }
    for (const FanLink& link : problem.links)
        if (!link.unbreakable) impulse = std::max(impulse, link.cohesive);
    impulse_scale_ = impulse;
    speed_scale_ = speed;
    // an impulse is a difference of momenta: below their rounding nothing can be decided
    impulse_tolerance_ = relative_tolerance * impulse + 1e-14 * mass * speed;
    speed_tolerance_ = relative_tolerance * speed;
}

void FanSolver::set_state(Index i, bool closed, int tangential_state) {
    LinkState& link = links_[i];
    link.closed = closed;
    link.tangential_state = tangential_state;
    link.tangential = link.law.tangential(closed, tangential_state);
}

void FanSolver::guess(const FanProblem& problem) {
    links_.resize(problem.links.size());
    const auto prescribed = [&](Index body, int k) { return body < 0 || problem.bodies[body].inverse_mass[k] == 0; };
    const auto free_velocity = [&](Index body) -> Vec2 { return body < 0 ? Vec2::Zero() : problem.bodies[body].free_velocity; };
    for (Index i = 0; i < n_links(problem); ++i) {
        const FanLink& link = problem.links[i];
        const Vec2 relative = problem.velocity_before(link.after) - problem.velocity_before(link.before);
        links_[i].imposed = false;
        if (link.unbreakable) {
            links_[i].closed = true;
            links_[i].tangential = {.stick = true, .velocity = 0, .low = 0, .high = 0};
            continue;
        }
        links_[i].law = LinkLaw(link, relative, problem.drift_time, speed_tolerance_);
        const LinkLaw& law = links_[i].law;
        // what is prescribed on both sides is known beforehand, all else is guessed to go on as before
        Vec2 expected = relative;
        int n_imposed = 0;
        for (int k = 0; k < 2; ++k) {
            if (!prescribed(link.before, k) || !prescribed(link.after, k)) continue;
            expected[k] = free_velocity(link.after)[k] - free_velocity(link.before)[k];
            ++n_imposed;
        }
        links_[i].imposed = n_imposed == 2;
        const bool closed = law.may_touch() && link.normal.dot(expected) <= law.bound() + speed_tolerance_;
        set_state(i, closed, law.state_of(closed, turned_left(link.normal).dot(expected), speed_tolerance_));
    }
}

Vec2 FanSolver::target(Index i) const {
    const FanLink& link = problem_->links[i];
    if (link.unbreakable) return Vec2::Zero();
    return frame_to_plane(link, links_[i].law.bound(), links_[i].tangential.velocity);
}

Vec2 FanSolver::known_impulse(Index i) const {
    const FanLink& link = problem_->links[i];
    return frame_to_plane(link, -link.cohesive, -links_[i].tangential.at);
}

void FanSolver::make_clusters(const FanProblem& problem) {
    const Index n = n_bodies(problem);
    cluster_.resize(n);
    offset_.assign(n, Vec2::Zero());
    velocity_.resize(n);
    for (Index b = 0; b < n; ++b) cluster_[b] = b;
    ground_cluster_ = n;
    ground_offset_ = Vec2::Zero();
    consistent_ = true;
    for (Index i = 0; i < n_links(problem); ++i) {
        if (!links_[i].sticks()) continue;
        const FanLink& link = problem.links[i];
        const Index kept = cluster_of(link.before), joined = cluster_of(link.after);
        const Vec2 shift = offset_of(link.before) + target(i) - offset_of(link.after);
        if (kept == joined) {  // the loop is closed: its jumps must sum to zero
            consistent_ = consistent_ && shift.cwiseAbs().maxCoeff() <= 10 * speed_tolerance_;
            continue;
        }
        for (Index b = 0; b < n; ++b)
            if (cluster_[b] == joined) cluster_[b] = kept, offset_[b] += shift;
        if (ground_cluster_ == joined) ground_cluster_ = kept, ground_offset_ += shift;
    }
}

bool FanSolver::solve_partial(const FanProblem& problem) {
    // cluster velocities with the known impulses:  V_c = sum (m (v_free - offset) + P_known) / sum m
    const Index n = n_bodies(problem);
    cluster_velocity_.assign(n + 1, Vec2::Zero());
    cluster_inverse_mass_.assign(n + 1, Vec2::Zero());
    std::vector<Vec2>& momentum = cluster_velocity_;
    std::vector<Vec2>& mass = cluster_inverse_mass_;
    for (Index b = 0; b < n; ++b) {
        const Vec2 m = mass_of(problem.bodies[b]);
        momentum[cluster_[b]] += m.cwiseProduct(problem.bodies[b].free_velocity - offset_[b]);
        mass[cluster_[b]] += m;
    }
    partial_.clear();
    for (Index i = 0; i < n_links(problem); ++i) {
        if (links_[i].sticks()) continue;
        links_[i].impulse = known_impulse(i);
        momentum[cluster_of(problem.links[i].after)] += links_[i].impulse;
        momentum[cluster_of(problem.links[i].before)] -= links_[i].impulse;
        if (links_[i].partial() && cluster_of(problem.links[i].after) != cluster_of(problem.links[i].before)) partial_.push_back(i);
    }
    for (Index c = 0; c <= n; ++c)
        for (int k = 0; k < 2; ++k) {
            mass[c][k] = mass[c][k] > 0 ? 1 / mass[c][k] : 0;
            cluster_velocity_[c][k] = momentum[c][k] * mass[c][k];
        }
    for (Index b = 0; b < n; ++b)  // a prescribed component rules its cluster, and so does the ground
        for (int k = 0; k < 2; ++k)
            if (problem.bodies[b].inverse_mass[k] == 0) {
                cluster_velocity_[cluster_[b]][k] = problem.bodies[b].free_velocity[k] - offset_[b][k];
                cluster_inverse_mass_[cluster_[b]][k] = 0;
            }
    cluster_velocity_[ground_cluster_] = -ground_offset_;
    cluster_inverse_mass_[ground_cluster_] = Vec2::Zero();

    // one multiplier for each closed sliding link (along N - s mu T, holds V_N) and each open link at its kink (along T, holds V_T)
    const int n_partial = static_cast<int>(partial_.size());
    if (n_partial > 0) {
        using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 24, 24>;
        using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 24, 1>;
        if (n_partial > 24) return false;
        const auto row = [&](Index i) -> Vec2 {
            return links_[i].closed ? problem.links[i].normal : turned_left(problem.links[i].normal);
        };
        const auto force = [&](Index i) -> Vec2 {
            return links_[i].closed ? frame_to_plane(problem.links[i], 1, -links_[i].tangential.contact)
                                    : turned_left(problem.links[i].normal);
        };
        Matrix A(n_partial, n_partial);
        Vector rhs(n_partial);
        for (int a = 0; a < n_partial; ++a) {
            const FanLink& link = problem.links[partial_[a]];
            const Index after = cluster_of(link.after), before = cluster_of(link.before);
            const Vec2 relative =
                cluster_velocity_[after] + offset_of(link.after) - cluster_velocity_[before] - offset_of(link.before);
            const double wanted = links_[partial_[a]].closed ? links_[partial_[a]].law.bound() : links_[partial_[a]].tangential.velocity;
            rhs[a] = wanted - row(partial_[a]).dot(relative);
            for (int b = 0; b < n_partial; ++b) {
                const FanLink& other = problem.links[partial_[b]];
                const Vec2 f = force(partial_[b]);
                Vec2 response = Vec2::Zero();
                if (cluster_of(other.after) == after) response += cluster_inverse_mass_[after].cwiseProduct(f);
                if (cluster_of(other.before) == after) response -= cluster_inverse_mass_[after].cwiseProduct(f);
                if (cluster_of(other.after) == before) response -= cluster_inverse_mass_[before].cwiseProduct(f);
                if (cluster_of(other.before) == before) response += cluster_inverse_mass_[before].cwiseProduct(f);
                A(a, b) = row(partial_[a]).dot(response);
            }
        }
        Vector multiplier(n_partial);
        if (n_partial == 1) {
            multiplier[0] = A(0, 0) != 0 ? rhs[0] / A(0, 0) : 0;
        } else {
            Eigen::FullPivLU<Matrix> lu(A);
            lu.setThreshold(1e-11);
            multiplier = lu.solve(rhs);
        }
        for (int a = 0; a < n_partial; ++a) {
            const Vec2 added = multiplier[a] * force(partial_[a]);
            const FanLink& link = problem.links[partial_[a]];
            links_[partial_[a]].impulse += added;
            cluster_velocity_[cluster_of(link.after)] += cluster_inverse_mass_[cluster_of(link.after)].cwiseProduct(added);
            cluster_velocity_[cluster_of(link.before)] -= cluster_inverse_mass_[cluster_of(link.before)].cwiseProduct(added);
        }
    }
    for (Index b = 0; b < n; ++b) velocity_[b] = cluster_velocity_[cluster_[b]] + offset_[b];
    return true;
}

double FanSolver::walk_chain(const FanProblem& problem) {
    // P_right = P_left - m (v+ - v_free), body by body, from a point where P is known; the largest mismatch where it is known twice
    const Index L = n_links(problem);
    double mismatch = 0;
    sticks_all_round_ = false;
    const auto taken = [&](Index body) -> Vec2 {
        return mass_of(problem.bodies[body]).cwiseProduct(velocity_[body] - problem.bodies[body].free_velocity);
    };
    const auto free_of_constraint = [&](Index body) { return (problem.bodies[body].inverse_mass.array() > 0).all(); };
    const auto forward = [&](Index i, Index body, const Vec2& left) {  // link i lies after `body`
        const Vec2 walked = left - taken(body);
        if (links_[i].sticks()) links_[i].impulse = walked;
        else if (free_of_constraint(body)) mismatch = std::max(mismatch, (walked - links_[i].impulse).cwiseAbs().maxCoeff());
    };
    const auto backward = [&](Index i, Index body, const Vec2& right) {  // link i lies before `body`
        const Vec2 walked = right + taken(body);
        if (links_[i].sticks()) links_[i].impulse = walked;
        else if (free_of_constraint(body)) mismatch = std::max(mismatch, (walked - links_[i].impulse).cwiseAbs().maxCoeff());
    };

    if (L == 0) return 0;
    if (!problem.closed && problem.links[0].before >= 0) {  // free left end
        Vec2 left = Vec2::Zero();
        for (Index i = 0; i < L; ++i) forward(i, problem.links[i].before, left), left = links_[i].impulse;
        return mismatch;
    }
    if (!problem.closed && problem.links[L - 1].after >= 0) {  // free right end
        Vec2 right = Vec2::Zero();
        for (Index i = L - 1; i >= 0; --i) backward(i, problem.links[i].after, right), right = links_[i].impulse;
        return mismatch;
    }
    Index known = 0;
    while (known < L && links_[known].sticks()) ++known;
    if (known == L) {
        sticks_all_round_ = true;
        links_[0].impulse = Vec2::Zero();
        known = 0;
    }
    for (Index i = known + 1; i < L; ++i) forward(i, problem.links[i].before, links_[i - 1].impulse);
    if (problem.closed)
        for (Index i = 0; i < known; ++i) forward(i, problem.links[i].before, links_[(i + L - 1) % L].impulse);
    else
        for (Index i = known - 1; i >= 0; --i) backward(i, problem.links[i].after, links_[i + 1].impulse);
    return mismatch;
}

bool FanSolver::settle_circulation(const FanProblem& problem) {
    // every point gets the same c on top: first the one of least traction, sum |P/S|^2 S; only if that is not admissible, the climb
    planes_.clear();
    Vec2 sum = Vec2::Zero();
    double weight = 0;
    for (Index i = 0; i < n_links(problem); ++i) {
        const double w = problem.links[i].cohesive > 0 ? 1 / problem.links[i].cohesive : 1 / (impulse_scale_ + impulse_tolerance_);
        sum += w * links_[i].impulse;
        weight += w;
    }
    for (Index i = 0; i < n_links(problem); ++i) {
        const FanLink& link = problem.links[i];
        if (link.unbreakable) continue;
        const Vec2 n = link.normal, t = turned_left(n);
        const TangentialLaw& law = links_[i].tangential;
        const double p = n.dot(links_[i].impulse) + link.cohesive, q = t.dot(links_[i].impulse) + law.at + law.contact * p;
        const Vec2 slope = t + law.contact * n;
        planes_.push_back({p, n, i, 0});
        planes_.push_back({law.play + law.contact_play * p - q, law.contact_play * n - slope, i, +1});
        planes_.push_back({law.play + law.contact_play * p + q, law.contact_play * n + slope, i, -1});
    }
    const Circulation found = find_circulation(planes_, -sum / weight);
    for (LinkState& link : links_) link.impulse += found.c;
    if (found.slack >= -impulse_tolerance_) return true;
    for (int k = 0; k < found.n_binding; ++k) {  // the half planes that bind are the mechanism
        const HalfPlane& plane = planes_[found.binding[k]];
        LinkState& link = links_[plane.link];
        if (plane.kind == 0) {
            const double v_T = link.tangential.velocity;
            set_state(plane.link, false, link.law.state_of(false, v_T, speed_tolerance_));
        } else if (link.tangential.stick) {
            // pushed towards +T beyond what the point can hold: the sides slide towards -T
            set_state(plane.link, link.closed, std::clamp(link.tangential_state - plane.kind, 0, link.law.n_states(link.closed) - 1));
        }
    }
    return false;
}

int FanSolver::correct_states(const FanProblem& problem, bool only_worst) {
    struct Change {
        double amount = 0;  // relative violation
        Index link = -1;
        bool closed = false;
        int state = 0;
    } worst;
    int n_changes = 0;
    const double impulse_unit = impulse_scale_ + impulse_tolerance_, speed_unit = speed_scale_ + speed_tolerance_;
    for (Index i = 0; i < n_links(problem); ++i) {
        const FanLink& link = problem.links[i];
        if (link.unbreakable || links_[i].imposed) continue;
        LinkState& here = links_[i];
        const Vec2 relative = velocity_of(link.after) - velocity_of(link.before);
        const double v_N = link.normal.dot(relative), v_T = turned_left(link.normal).dot(relative);
        const double p = here.closed ? link.normal.dot(here.impulse) + link.cohesive : 0;
        Change change{.link = i, .closed = here.closed, .state = here.tangential_state};
        const auto violates = [&](double amount, double tolerance, double unit) {
            if (amount <= tolerance) return false;
            change.amount = std::max(change.amount, amount / unit);
            return true;
        };
        if (here.tangential.stick) {
            const TangentialLaw& law = here.tangential;
            const double q = turned_left(link.normal).dot(here.impulse) + law.at + law.contact * p;
            const double most = law.play + law.contact_play * std::max(p, 0.0);
            if (violates(std::abs(q) - most, impulse_tolerance_, impulse_unit)) change.state += q > 0 ? -1 : 1;
        } else if (violates(here.tangential.low - v_T, speed_tolerance_, speed_unit)) {
            --change.state;
        } else if (violates(v_T - here.tangential.high, speed_tolerance_, speed_unit)) {
            ++change.state;
        }
        if (here.closed && violates(-p, impulse_tolerance_, impulse_unit)) {
            change.closed = false;
            const bool was_stick = here.tangential.stick && change.state == here.tangential_state;
            const double nudge = (change.state - here.tangential_state) * 2 * speed_tolerance_;
            const double at = here.tangential.stick ? here.tangential.velocity + nudge : v_T;
            change.state = here.law.state_of(false, at, was_stick ? speed_tolerance_ : 0);
        } else if (!here.closed && here.law.may_touch() && violates(here.law.bound() - v_N, speed_tolerance_, speed_unit)) {
            change.closed = true;
            change.state = here.law.state_of(true, v_T, speed_tolerance_);
        } else if (here.closed) {
            violation_ = std::max(violation_, std::abs(v_N - here.law.bound()) / speed_unit);  // must hold; no state mends it
        }
        if (change.amount == 0) continue;
        ++n_changes;
        violation_ = std::max(violation_, change.amount);
        if (!only_worst) set_state(i, change.closed, change.state);
        else if (change.amount > worst.amount) worst = change;
    }
    if (only_worst && n_changes > 0) set_state(worst.link, worst.closed, worst.state);
    return n_changes;
}

bool FanSolver::solve_states(FanProblem& problem) {
    make_clusters(problem);
    if (!consistent_) return false;
    if (!solve_partial(problem)) return false;
    const double mismatch = walk_chain(problem);
    violation_ = mismatch / (impulse_scale_ + impulse_tolerance_);
    return true;
}

bool FanSolver::sweep(FanProblem& problem) {
    // Gauss-Seidel over the links: normal, then tangential impulse of one link with all others as they are
    for (LinkState& link : links_) link.impulse = Vec2::Zero();
    for (Index b = 0; b < n_bodies(problem); ++b) velocity_[b] = problem.bodies[b].free_velocity;
    const auto push = [&](Index i, const Vec2& added) {
        const FanLink& link = problem.links[i];
        links_[i].impulse += added;
        if (link.after >= 0) velocity_[link.after] += problem.bodies[link.after].inverse_mass.cwiseProduct(added);
        if (link.before >= 0) velocity_[link.before] -= problem.bodies[link.before].inverse_mass.cwiseProduct(added);
    };
    for (int count = 0; count < max_sweeps; ++count) {
        double change = 0;
        for (Index i = 0; i < n_links(problem); ++i) {
            const FanLink& link = problem.links[i];
            LinkState& here = links_[i];
            Vec2 W = Vec2::Zero();
            if (link.after >= 0) W += problem.bodies[link.after].inverse_mass;
            if (link.before >= 0) W += problem.bodies[link.before].inverse_mass;
            const Vec2 n = link.normal, t = turned_left(n);
            const double w_N = n.cwiseProduct(n).dot(W), w_T = t.cwiseProduct(t).dot(W);
            const auto relative = [&]() -> Vec2 { return velocity_of(link.after) - velocity_of(link.before); };
            if (link.unbreakable) {
                const Vec2 added(W.x() > 0 ? -relative().x() / W.x() : 0, W.y() > 0 ? -relative().y() / W.y() : 0);
                push(i, added);
                change = std::max(change, added.cwiseAbs().maxCoeff());
                continue;
            }
            double p = n.dot(here.impulse) + link.cohesive;
            const double wanted_p = !here.law.may_touch() || w_N == 0 ? 0 : std::max(0.0, p + (here.law.bound() - n.dot(relative())) / w_N);
            change = std::max(change, std::abs(wanted_p - p));
            push(i, (wanted_p - p) * n);
            p = wanted_p;
            const bool closed = p > 0;
            if (w_T == 0) continue;
            // V_T without this link's tangential impulse; the staircase is monotone, so its state is found by going up
            const double P_T = t.dot(here.impulse), v_free = t.dot(relative()) - w_T * P_T;
            double wanted_T = 0;
            for (int state = 0; state < here.law.n_states(closed); ++state) {
                const TangentialLaw law = here.law.tangential(closed, state);
                const double between = -(law.at + law.contact * p);
                if (law.stick) {
                    const double needed = (law.velocity - v_free) / w_T, play = law.play + law.contact_play * p;
                    wanted_T = std::clamp(needed, between - play, between + play);
                    if (needed >= between - play) break;
                } else {
                    wanted_T = between;
                    if (v_free + w_T * between <= law.high) break;
                }
            }
            change = std::max(change, std::abs(wanted_T - P_T));
            push(i, (wanted_T - P_T) * t);
        }
        if (change <= 1e-14 * (impulse_scale_ + impulse_tolerance_)) break;
    }
    violation_ = 0;
    for (Index i = 0; i < n_links(problem); ++i) {
        const FanLink& link = problem.links[i];
        if (link.unbreakable) continue;
        const Vec2 relative = velocity_of(link.after) - velocity_of(link.before);
        const bool closed = link.normal.dot(links_[i].impulse) + link.cohesive > impulse_tolerance_;
        set_state(i, closed, links_[i].law.state_of(closed, turned_left(link.normal).dot(relative), 1e-9 * speed_scale_));
    }
    return true;
}

double FanSolver::friction_part(const LinkState& state, const FanLink& link) {
    if (link.unbreakable) return 0;
    const TangentialLaw& law = state.tangential;
    const double friction = -law.contact * link.contact;  // of the signs that are known
    if (!law.stick || law.contact_play == 0) return friction;
    // at rest both may jump: cohesion takes what it can, friction the rest
    const double lambda = link.tangential + law.at + law.contact * link.contact;
    return friction + lambda - std::clamp(lambda, -law.play, law.play);
}

void FanSolver::store(FanProblem& problem) const {
    for (Index b = 0; b < n_bodies(problem); ++b) problem.bodies[b].end_velocity = velocity_[b];
    for (Index i = 0; i < n_links(problem); ++i) {
        FanLink& link = problem.links[i];
        link.contact = links_[i].closed && !link.unbreakable ? std::max(0.0, link.normal.dot(links_[i].impulse) + link.cohesive) : 0;
        link.tangential = turned_left(link.normal).dot(links_[i].impulse);
        link.impulse = links_[i].impulse;
        link.friction_part = friction_part(links_[i], link);
        link.stuck = links_[i].sticks();
    }
}

FanSolution FanSolver::solve(FanProblem& problem) {
    problem_ = &problem;
    FanSolution solution;
    set_scales(problem);
    guess(problem);
    for (int round = 0; round < 2; ++round) {
        for (int correction = 0; correction < max_corrections; ++correction) {
            ++solution.iterations;
            violation_ = 0;
            if (!solve_states(problem)) break;
            if (sticks_all_round_ && !settle_circulation(problem)) continue;
            if (correct_states(problem, correction >= patient_corrections) > 0) continue;
            if (violation_ > 1e-9) break;  // no state to change, yet a law or the balance is violated
            solution.bound = std::all_of(links_.begin(), links_.end(), [](const LinkState& l) { return l.sticks(); });
            solution.residual = violation_;
            solution.status = FanSolution::Status::exact;
            store(problem);
            return solution;
        }
        if (round == 0) sweep(problem);
    }
    sweep(problem);
    correct_states(problem, true);
    solution.status = violation_ <= 1e-8 ? FanSolution::Status::iterated : FanSolution::Status::failed;
    solution.residual = violation_;
    store(problem);
    return solution;
}

}  // namespace knap
