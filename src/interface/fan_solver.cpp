#include "interface/fan_solver.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_corrections = 40;                 // changes of state before the pivots take over
constexpr int patient_corrections = 8;              // from here on only the worst violation changes its state
constexpr int max_tried = 200000;                  // combinations of states, where the pivots end without a solution
constexpr double largest_violation = 1e-10;         // relative, of a solution of the active set: the gate of every run
constexpr double usual_violation = 1e-11;           // beyond it the pivots may do better: contacts that no change of state makes agree
constexpr double largest_pivoted_violation = 1e-8;  // and of the pivots

/// Where the impulse of a link in its state is admissible.
StrengthPolygon strength_of(const FanLink& link, const StaircasePiece& at) {
    return {.normal = link.normal, .cohesion = link.cohesive, .jump = at.jump, .contact_jump = at.contact_jump, .offset = at.offset, .contact_offset = at.contact_offset};
}

}  // namespace

FanSolution FanSolver::solve(FanProblem& problem, double rest) {
    problem_ = &problem;
    scales_ = scales_of(problem);
    scales_.rest = std::max(scales_.rest, rest * scales_.speed);
    states_.resize(problem.links.size());
    for (std::size_t i = 0; i < states_.size(); ++i) states_[i].guess(problem, problem.links[i], scales_);
    linear_.begin(problem, scales_.speed_tolerance);
    motion_.velocity.clear();  // as if no interface acted, until something better is found
    for (const FanBody& body : problem.bodies) motion_.velocity.push_back(body.free_velocity);
    motion_.impulse.assign(problem.links.size(), Vec2::Zero());

    FanSolution solution;
    if (!settle_states(max_corrections, solution.iterations)) {
        solution.status = find_states_by_lemke();
        save();
        if (solution.status != FanSolution::Status::searched && !settle_states(patient_corrections, solution.iterations)) restore();
    } else if (violation_ > usual_violation) {
        solution.status = improve_by_lemke();
    }
    solution.bonded = std::all_of(states_.begin(), states_.end(), [](const LinkState& s) { return s.holds(); });
    const bool lawful = solution.status != FanSolution::Status::relaxed && solution.status != FanSolution::Status::failed;
    solution.residual = lawful ? violation_ : std::max(violation_, 1.0);
    store(problem);
    return solution;
}

bool FanSolver::settle_states(int correction_limit, int& n_solves) {
    for (int correction = 0; correction < correction_limit; ++correction) {
        ++n_solves;
        violation_ = 0;
        double mismatch = 0;
        if (!linear_.solve(states_, motion_, mismatch)) return false;
        violation_ = mismatch / scales_.impulse;
        if (!settle_self_stress()) continue;
        if (correct_states(correction >= patient_corrections) > 0) continue;
        return violation_ <= largest_violation;  // else a law or the balance is violated and no state mends it
    }
    return false;
}

bool FanSolver::settle_self_stress() {
    // every point left undetermined gets the same c on top: first the one of least traction, sum |P/S|^2 S; only if that is not admissible, the climb
    const std::vector<FanLink>& links = problem_->links;
    const Index n_links = static_cast<Index>(links.size());
    LeastNormSelfStress least;
    for (Index i = 0; i < n_links; ++i)
        least.add(links[i].cohesive > 0 ? 1 / links[i].cohesive : 1 / scales_.impulse, motion_.impulse[i], linear_.undetermined(i));
    if (!least.is_free()) return true;
    planes_.clear();
    for (Index i = 0; i < n_links; ++i) {
        if (links[i].unbreakable || linear_.undetermined(i).isZero(0)) continue;
        strength_of(links[i], states_[i].tangential).add_half_planes(i, motion_.impulse[i], linear_.undetermined(i), planes_);
    }
    const SelfStress found = find_self_stress(planes_, least.c());
    for (Index i = 0; i < n_links; ++i) motion_.impulse[i] += linear_.undetermined(i).cwiseProduct(found.c);
    if (found.slack >= -scales_.impulse_tolerance) return true;
    for (int k = 0; k < found.n_binding; ++k) {  // the half planes that bind are the mechanism
        const HalfPlane& plane = planes_[found.binding[k]];
        LinkState& state = states_[plane.link];
        if (plane.kind == 0) {
            state.set(false, state.state_of(false, state.tangential.kink, scales_.speed_tolerance));
        } else if (state.tangential.stick) {
            // pushed towards +T beyond what the point can hold: the sides slide towards -T
            state.set(state.closed, std::clamp(state.tangential_state - plane.kind, 0, state.law.staircase(state.closed).n_states() - 1));
        }
    }
    return false;
}

int FanSolver::correct_states(bool only_worst) {
    StateChange worst;
    std::size_t worst_link = 0;
    int n_changes = 0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        const FanLink& link = problem_->links[i];
        if (link.unbreakable || states_[i].imposed) continue;
        const StateChange change = change_of(states_[i], link, motion_.across(link), motion_.impulse[i], scales_);
        violation_ = std::max({violation_, change.violation, change.unmended});
        if (change.violation == 0) continue;
        ++n_changes;
        if (!only_worst) states_[i].set(change.closed, change.tangential_state);
        else if (change.violation > worst.violation) worst = change, worst_link = i;
    }
    if (only_worst && n_changes > 0) states_[worst_link].set(worst.closed, worst.tangential_state);
    return n_changes;
}

FanSolution::Status FanSolver::find_states_by_lemke() {
    if (solve_by_lemke()) return FanSolution::Status::pivoted;
    if (search_states()) return FanSolution::Status::searched;
    for (LinkState& state : states_) state.law.remove_rebound();
    if (solve_by_lemke()) return FanSolution::Status::relaxed;
    for (LinkState& state : states_) state.law.remove_friction();
    return solve_by_lemke() ? FanSolution::Status::relaxed : FanSolution::Status::failed;
}

FanSolution::Status FanSolver::improve_by_lemke() {
    save();
    if (solve_by_lemke() && violation_ < saved_violation_) return FanSolution::Status::pivoted;
    restore();
    return FanSolution::Status::exact;
}

void FanSolver::save() { saved_states_ = states_, saved_motion_ = motion_, saved_violation_ = violation_; }

void FanSolver::restore() { states_ = saved_states_, motion_ = saved_motion_, violation_ = saved_violation_; }

/// Lemke's method may end without a solution where there is one: friction takes from the matrix what the method rests on. The links that ever moved take
/// every state in turn, all others stick: first all that stay closed, then open ones too. With friction 0.7 about one fan in 10^8 of a crushed body comes here.
bool FanSolver::search_states() {
    const std::vector<FanLink>& links = problem_->links;
    const auto way = [&](std::size_t i) { return std::hypot(links[i].u_N, links[i].u_T); };
    const std::vector<LinkState> before = states_;
    std::vector<std::size_t> moved;
    for (std::size_t i = 0; i < links.size(); ++i) {
        if (links[i].unbreakable || states_[i].imposed) continue;
        states_[i].set(true, states_[i].state_of(true, 0, scales_.speed_tolerance));
        if (way(i) > 0) moved.push_back(i);
    }
    std::stable_sort(moved.begin(), moved.end(), [&](std::size_t a, std::size_t b) { return way(a) > way(b); });
    const std::vector<LinkState> stuck = states_;
    for (const bool may_open : {false, true})
        if (try_combinations(stuck, moved, may_open)) return true;
    states_ = before;
    return false;
}

/// As many of the `moved` links as `max_tried` combinations allow.
bool FanSolver::try_combinations(const std::vector<LinkState>& stuck, const std::vector<std::size_t>& moved, bool may_open) {
    const auto n_closed = [&](std::size_t i) { return stuck[i].law.may_touch() ? stuck[i].law.staircase(true).n_states() : 0; };
    const auto n_states = [&](std::size_t i) { return n_closed(i) + (may_open || n_closed(i) == 0 ? stuck[i].law.staircase(false).n_states() : 0); };
    int n_combinations = 1;
    std::size_t n_varied = 0;
    while (n_varied < moved.size() && n_combinations * n_states(moved[n_varied]) <= max_tried) n_combinations *= n_states(moved[n_varied++]);
    for (int combination = 0; combination < n_combinations; ++combination) {
        states_ = stuck;
        int rest = combination;
        for (std::size_t k = 0; k < n_varied; ++k) {
            const std::size_t i = moved[k];
            const int state = rest % n_states(i);
            states_[i].set(state < n_closed(i), state < n_closed(i) ? state : state - n_closed(i));
            rest /= n_states(i);
        }
        int n_solves = 0;
        if (settle_states(1, n_solves)) return true;  // no correction: this very combination
    }
    return false;
}

bool FanSolver::solve_by_lemke() {
    laws_.clear();
    for (const LinkState& state : states_) laws_.push_back(state.law);
    const FanLcpSolution& found = lcp_.solve(*problem_, laws_, scales_.speed);
    if (!found.solved) return false;
    motion_.velocity = found.velocity;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        const FanLink& link = problem_->links[i];
        if (link.unbreakable) continue;
        motion_.impulse[i] = found.impulse[i];
        states_[i].fit(link, motion_.across(link), motion_.impulse[i], scales_);
    }
    violation_ = std::max(found.residual, linear_.find_unbreakable_impulses(motion_) / scales_.impulse);
    return violation_ <= largest_pivoted_violation;
}

void FanSolver::store(FanProblem& problem) const {
    for (std::size_t b = 0; b < problem.bodies.size(); ++b) problem.bodies[b].end_velocity = motion_.velocity[b];
    for (std::size_t i = 0; i < states_.size(); ++i) {
        FanLink& link = problem.links[i];
        const LinkState& state = states_[i];
        link.impulse = motion_.impulse[i];
        link.contact = state.closed && !link.unbreakable ? std::max(0.0, link.normal.dot(link.impulse) + link.cohesive) : 0;
        link.tangential = link.tangent().dot(link.impulse);
        link.friction_part = state.friction_part(link);
        link.stuck = state.holds();
    }
}

}  // namespace knap
