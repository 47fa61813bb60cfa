#include "interfaces/fan_solver.hpp"

#include "interfaces/fan_lcp.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_corrections = 40;     // changes of state before the pivots take over
constexpr int patient_corrections = 8;  // from here on only the worst violation changes its state
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
    for (const FanBody& body : problem.bodies) {
        const Vec2 m = mass_of(body);
        impulse = std::max(impulse, m.cwiseProduct(body.free_velocity - body.velocity).cwiseAbs().maxCoeff());
        speed = std::max({speed, body.free_velocity.cwiseAbs().maxCoeff(), body.velocity.cwiseAbs().maxCoeff()});
        mass = std::max(mass, m.maxCoeff());
    }
    for (const FanLink& link : problem.links) {  // what an impact can give, and how fast the cohesion can make its bodies
        const auto inverse_mass = [&](Index body) -> Vec2 { return body < 0 ? Vec2::Zero() : problem.bodies[body].inverse_mass; };
        const auto free_velocity = [&](Index body) -> Vec2 { return body < 0 ? Vec2::Zero() : problem.bodies[body].free_velocity; };
        const Vec2 w = inverse_mass(link.after) + inverse_mass(link.before);
        const Vec2 approach = (free_velocity(link.after) - free_velocity(link.before)).cwiseAbs();
        for (int k = 0; k < 2; ++k)
            if (w[k] > 0) impulse = std::max(impulse, approach[k] / w[k]);
        if (link.unbreakable) continue;
        impulse = std::max(impulse, link.cohesive);
        speed = std::max(speed, link.cohesive * w.maxCoeff());
    }
    // an impulse is a difference of momenta: near their rounding nothing can be decided. All at rest and unloaded: any unit will do
    impulse_unit_ = impulse + 0.01 * mass * speed;
    if (impulse_unit_ == 0) impulse_unit_ = 1;
    speed_unit_ = speed > 0 ? speed : 1;
    impulse_tolerance_ = relative_tolerance * impulse_unit_;
    speed_tolerance_ = relative_tolerance * speed_unit_;
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
        links_[i].known = !links_[i].sticks();
        if (!links_[i].known) continue;
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
    for (int k = 0; k < 2; ++k) {  // a prescribed component rules its cluster, and so does the ground
        const auto rule = [&](Index cluster, double velocity) {
            const bool ruled = cluster_inverse_mass_[cluster][k] < 0;
            if (ruled && std::abs(velocity - cluster_velocity_[cluster][k]) > 10 * speed_tolerance_) consistent_ = false;
            cluster_velocity_[cluster][k] = velocity;
            cluster_inverse_mass_[cluster][k] = -1;
        };
        rule(ground_cluster_, -ground_offset_[k]);
        for (Index b = 0; b < n; ++b)
            if (problem.bodies[b].inverse_mass[k] == 0) rule(cluster_[b], problem.bodies[b].free_velocity[k] - offset_[b][k]);
        for (Vec2& w : cluster_inverse_mass_) w[k] = std::max(w[k], 0.0);
    }
    if (!consistent_) return false;

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

void FanSolver::find_neighbours(const FanProblem& problem) {
    left_.assign(n_bodies(problem), -1);
    right_.assign(n_bodies(problem), -1);
    for (Index i = 0; i < n_links(problem); ++i) {
        if (problem.links[i].after >= 0) left_[problem.links[i].after] = i;
        if (problem.links[i].before >= 0) right_[problem.links[i].before] = i;
    }
}

double FanSolver::walk_chain(const FanProblem& problem) {
    // P_right = P_left - m (v+ - v_free), body by body, from the links where P is known, each component by itself: where the motion is
    // prescribed, its constraint takes the difference and nothing is passed on. Returns the largest mismatch of what is known twice.
    const Index n = n_bodies(problem), L = n_links(problem);
    double mismatch = 0;
    for (LinkState& link : links_) link.loose = Vec2::Zero();
    for (int k = 0; k < 2; ++k) {
        reached_.assign(L, 0);
        for (Index i = 0; i < L; ++i) reached_[i] = links_[i].known;
        const auto impulse = [&](Index i) { return i < 0 ? 0 : links_[i].impulse[k]; };
        const auto is_reached = [&](Index i) { return i < 0 || reached_[i]; };
        const auto passes = [&](Index b) { return problem.bodies[b].inverse_mass[k] > 0; };
        const auto taken = [&](Index b) { return (velocity_[b][k] - problem.bodies[b].free_velocity[k]) / problem.bodies[b].inverse_mass[k]; };
        bool loose = false;
        Index n_missing = L - static_cast<Index>(std::count(reached_.begin(), reached_.end(), 1));
        const auto reach = [&](Index i, double value) {
            links_[i].impulse[k] = value;
            links_[i].loose[k] = loose;
            reached_[i] = 1;
            --n_missing;
        };
        const auto walk = [&] {
            for (Index before = n_missing + 1; n_missing > 0 && n_missing < before;) {
                before = n_missing;
                for (Index b = 0; b < n; ++b)
                    if (passes(b) && is_reached(left_[b]) && !is_reached(right_[b])) reach(right_[b], impulse(left_[b]) - taken(b));
                for (Index b = n - 1; b >= 0 && n_missing > 0; --b)
                    if (passes(b) && is_reached(right_[b]) && !is_reached(left_[b])) reach(left_[b], impulse(right_[b]) + taken(b));
            }
        };
        walk();
        loose = true;  // what no walk reached is free by one constant: round a loop, or between two constraints
        for (Index i = 0; i < L && n_missing > 0; ++i) {
            if (reached_[i]) continue;
            reach(i, 0);
            walk();
        }
        for (Index b = 0; b < n; ++b)
            if (passes(b)) mismatch = std::max(mismatch, std::abs(impulse(left_[b]) - taken(b) - impulse(right_[b])));
    }
    return mismatch;
}

bool FanSolver::settle_circulation(const FanProblem& problem) {
    // every loose point gets the same c on top: first the one of least traction, sum |P/S|^2 S; only if that is not admissible, the climb
    planes_.clear();
    Vec2 sum = Vec2::Zero(), weight = Vec2::Zero();
    for (Index i = 0; i < n_links(problem); ++i) {
        const double w = problem.links[i].cohesive > 0 ? 1 / problem.links[i].cohesive : 1 / impulse_unit_;
        sum += w * links_[i].loose.cwiseProduct(links_[i].impulse);
        weight += w * links_[i].loose;
    }
    if (weight.isZero(0)) return true;
    for (Index i = 0; i < n_links(problem); ++i) {
        const FanLink& link = problem.links[i];
        const Vec2& loose = links_[i].loose;
        if (link.unbreakable || loose.isZero(0)) continue;
        const Vec2 n = link.normal, t = turned_left(n);
        const TangentialLaw& law = links_[i].tangential;
        const double p = n.dot(links_[i].impulse) + link.cohesive, q = t.dot(links_[i].impulse) + law.at + law.contact * p;
        const Vec2 slope = t + law.contact * n;
        planes_.push_back({p, loose.cwiseProduct(n), i, 0});
        planes_.push_back({law.play + law.contact_play * p - q, loose.cwiseProduct(law.contact_play * n - slope), i, +1});
        planes_.push_back({law.play + law.contact_play * p + q, loose.cwiseProduct(law.contact_play * n + slope), i, -1});
    }
    Vec2 start = Vec2::Zero();
    for (int k = 0; k < 2; ++k)
        if (weight[k] > 0) start[k] = -sum[k] / weight[k];
    const Circulation found = find_circulation(planes_, start);
    for (LinkState& link : links_) link.impulse += link.loose.cwiseProduct(found.c);
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
            if (violates(std::abs(q) - most, impulse_tolerance_, impulse_unit_)) change.state += q > 0 ? -1 : 1;
            // what its cluster holds already may hold it elsewhere than at the kink
            if (!here.closed && violates(std::abs(v_T - law.velocity), 10 * speed_tolerance_, speed_unit_)) change.state = here.law.state_of(false, v_T, 0);
        } else if (violates(here.tangential.low - v_T, speed_tolerance_, speed_unit_)) {
            --change.state;
        } else if (violates(v_T - here.tangential.high, speed_tolerance_, speed_unit_)) {
            ++change.state;
        }
        if (here.closed && violates(-p, impulse_tolerance_, impulse_unit_)) {
            change.closed = false;
            const bool was_stick = here.tangential.stick && change.state == here.tangential_state;
            const double nudge = (change.state - here.tangential_state) * 2 * speed_tolerance_;
            const double at = here.tangential.stick ? here.tangential.velocity + nudge : v_T;
            change.state = here.law.state_of(false, at, was_stick ? speed_tolerance_ : 0);
        } else if (!here.closed && here.law.may_touch() && violates(here.law.bound() - v_N, speed_tolerance_, speed_unit_)) {
            change.closed = true;
            change.state = here.law.state_of(true, v_T, speed_tolerance_);
        } else if (here.closed && violates(v_N - here.law.bound(), 10 * speed_tolerance_, speed_unit_)) {
            change.closed = false;
            change.state = here.law.state_of(false, v_T, speed_tolerance_);
        } else if (here.closed) {
            violation_ = std::max(violation_, (here.law.bound() - v_N) / speed_unit_);  // must hold; no state mends it
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
    violation_ = mismatch / impulse_unit_;
    return true;
}

bool FanSolver::solve_by_pivots(const FanProblem& problem) {
    std::vector<LinkLaw> laws;
    for (const LinkState& link : links_) laws.push_back(link.law);
    const FanLcpSolution found = solve_fan_lcp(problem, laws, speed_unit_);
    if (!found.solved) return false;
    velocity_ = found.velocity;
    for (Index i = 0; i < n_links(problem); ++i) {
        const FanLink& link = problem.links[i];
        links_[i].known = !link.unbreakable;
        if (link.unbreakable) continue;
        links_[i].impulse = found.impulse[i];
        const double v_T = turned_left(link.normal).dot(velocity_of(link.after) - velocity_of(link.before));
        const bool closed = link.normal.dot(links_[i].impulse) + link.cohesive > impulse_tolerance_;
        set_state(i, closed, links_[i].law.state_of(closed, v_T, 1e-9 * speed_unit_));
    }
    violation_ = std::max(found.residual, walk_chain(problem) / impulse_unit_);
    return violation_ <= 1e-8;
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
        link.stuck = links_[i].holds();
    }
}

bool FanSolver::solve_relaxed(const FanProblem& problem) {
    for (LinkState& link : links_) link.law.forget_rebound();
    if (solve_by_pivots(problem)) return true;
    for (LinkState& link : links_) link.law.forget_friction();
    return solve_by_pivots(problem);
}

bool FanSolver::settle_states(FanProblem& problem, int most_corrections, int& n_solves) {
    for (int correction = 0; correction < most_corrections; ++correction) {
        ++n_solves;
        violation_ = 0;
        if (!solve_states(problem)) return false;
        if (!settle_circulation(problem)) continue;
        if (correct_states(problem, correction >= patient_corrections) > 0) continue;
        return violation_ <= 1e-9;  // else a law or the balance is violated and no state mends it
    }
    return false;
}

FanSolution FanSolver::solve(FanProblem& problem) {
    problem_ = &problem;
    FanSolution solution;
    set_scales(problem);
    guess(problem);
    find_neighbours(problem);
    if (!settle_states(problem, max_corrections, solution.iterations)) {
        solution.status = FanSolution::Status::pivoted;
        if (!solve_by_pivots(problem)) {
            solution.status = solve_relaxed(problem) ? FanSolution::Status::relaxed : FanSolution::Status::failed;
        }
        const std::vector<LinkState> found = links_;
        const std::vector<Vec2> velocity = velocity_;
        const double violation = violation_;
        if (!settle_states(problem, patient_corrections, solution.iterations)) {
            links_ = found;
            velocity_ = velocity;
            violation_ = violation;
        }
    }
    solution.bound = std::all_of(links_.begin(), links_.end(), [](const LinkState& l) { return l.holds(); });
    const bool lawful = solution.status == FanSolution::Status::exact || solution.status == FanSolution::Status::pivoted;
    solution.residual = lawful ? violation_ : std::max(violation_, 1.0);
    store(problem);
    return solution;
}

}  // namespace knap
