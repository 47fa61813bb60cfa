#include "nonsmooth/fan_solver.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_corrections = 40;           // changes of state before Lemke's method
constexpr int patient_corrections = 8;        // from here on only the worst violation changes its state
constexpr int max_tried = 200000;             // combinations of states, where Lemke's method ends without a solution
constexpr double max_lemke_violation = 1e-8;  // of a solution of Lemke's method

}  // namespace

FanSolution FanSolver::solve(const FanProblem& problem, FanResult& result, double rest) {
    using Status = FanSolution::Status;
    problem_ = &problem;
    scales_ = scales_of(problem, rest);
    if (problem.is_curved) {
        const CurvedFan::Found found = curved_.solve(problem, scales_, result);
        return {.bonded = found.bonded, .iterations = found.iterations, .residual = found.residual};
    }
    now_.states.resize(problem.links.size());
    for (std::size_t i = 0; i < problem.links.size(); ++i) now_.states[i].guess(problem, problem.links[i], scales_);
    linear_.start(problem, scales_.speed_tolerance);
    now_.motion.velocity.clear();  // as if no interface acted, until a solution is found
    for (const FanBody& body : problem.bodies) now_.motion.velocity.push_back(body.free_velocity);
    now_.motion.impulse.assign(problem.links.size(), Vec2::Zero());
    now_.motion.cohesive_impulse.assign(problem.links.size(), 0);

    FanSolution solution;
    if (!settle_states(max_corrections, solution.iterations)) {
        solution.status = find_states_by_lemke();
        saved_ = now_;
        if (solution.status != Status::searched && !settle_states(patient_corrections, solution.iterations))
            now_ = saved_;
    }
    solution.bonded = std::ranges::all_of(now_.states, &LinkState::holds);
    solution.residual = solution.is_lawful() ? now_.violation : std::max(now_.violation, 1.0);
    store(result);
    return solution;
}

bool FanSolver::settle_states(int correction_limit, int& n_solves) {
    for (int correction = 0; correction < correction_limit; ++correction) {
        ++n_solves;
        now_.violation = 0;
        double mismatch = 0;
        if (!linear_.solve(now_.states, now_.motion, mismatch)) return false;
        now_.violation = mismatch / scales_.impulse;
        for (std::size_t i = 0; i < now_.states.size(); ++i)
            now_.states[i].find_part(problem_->links[i], now_.motion.across(problem_->links[i]),
                                     now_.motion.cohesive_impulse[i]);
        if (!settle_self_stress()) continue;
        if (correct_states(correction >= patient_corrections) > 0) continue;
        return now_.violation <= max_residual;  // else a law or the balance is violated, and no state repairs it
    }
    return false;
}

/// Every undetermined impulse gets the same constant c: first the one of least traction, sum |P/S|^2 S, and only if
/// that is not admissible the one of largest smallest slack. False where none is admissible: then the links of the
/// opening mechanism have changed state.
bool FanSolver::settle_self_stress() {
    const std::vector<FanLink>& links = problem_->links;
    const Index n_links = static_cast<Index>(links.size());
    LeastNormSelfStress least_norm;
    for (Index i = 0; i < n_links; ++i) {
        const double cohesive_impulse = now_.states[i].cohesive_impulse(links[i]);
        least_norm.add(cohesive_impulse > 0 ? 1 / cohesive_impulse : 1 / scales_.impulse, now_.motion.impulse[i],
                       linear_.undetermined(i));
    }
    if (!least_norm.is_free()) return true;
    planes_.clear();
    for (Index i = 0; i < n_links; ++i) {
        if (links[i].unbreakable || linear_.undetermined(i).isZero(0)) continue;
        const LinkState& state = now_.states[i];
        StrengthPolygon{state.range(), links[i].normal, state.cohesive_impulse(links[i])}.add_half_planes(
            i, now_.motion.impulse[i], linear_.undetermined(i), planes_);
    }
    const SelfStress found = find_self_stress(planes_, least_norm.c());
    for (Index i = 0; i < n_links; ++i) now_.motion.impulse[i] += linear_.undetermined(i).cwiseProduct(found.c);
    if (found.slack >= -scales_.impulse_tolerance) return true;
    for (int k = 0; k < found.n_binding; ++k) {
        const HalfPlane& plane = planes_[found.binding[k]];
        LinkState& state = now_.states[plane.link];
        if (plane.shear == 0) {
            state.set(false, state.state_of(false, state.tangential.kink, scales_.speed_tolerance));
        } else if (state.tangential.stick) {
            // loaded towards +T beyond its strength: the sides slide towards -T
            const int last = state.law.staircase(state.closed).n_states() - 1;
            state.set(state.closed, std::clamp(state.tangential_state - plane.shear, 0, last));
        }
    }
    return false;
}

int FanSolver::correct_states(bool only_worst) {
    StateChange worst;
    std::size_t worst_link = 0;
    int n_changes = 0;
    for (std::size_t i = 0; i < now_.states.size(); ++i) {
        const FanLink& link = problem_->links[i];
        LinkState& state = now_.states[i];
        if (link.unbreakable || state.imposed) continue;
        const StateChange change = change_of(state, link, now_.motion.across(link), now_.motion.impulse[i], scales_);
        now_.violation = std::max({now_.violation, change.violation, change.irreparable});
        if (change.violation == 0) continue;
        ++n_changes;
        if (!only_worst) follow(change, link, state);
        else if (change.violation > worst.violation) worst = change, worst_link = i;
    }
    if (only_worst && n_changes > 0) follow(worst, problem_->links[worst_link], now_.states[worst_link]);
    return n_changes;
}

FanSolution::Status FanSolver::find_states_by_lemke() {
    if (solve_by_lemke()) return FanSolution::Status::by_lemke;
    // on ramps much smaller than what they could bear Lemke's method loses digits; their states are right
    int n_solves = 0;
    const auto has_ramp = [](const FanLink& link) { return link.ramp > 0; };
    if (std::ranges::any_of(problem_->links, has_ramp) && settle_states(max_corrections, n_solves))
        return FanSolution::Status::by_lemke;
    if (search_states()) return FanSolution::Status::searched;
    for (LinkState& state : now_.states) {
        state.law.contact.rate = std::min(state.law.contact.rate, 0.0);
        state.law.closed = state.law.open;
    }
    return solve_by_lemke() ? FanSolution::Status::relaxed : FanSolution::Status::failed;
}

bool FanSolver::solve_by_lemke() {
    const std::optional<double> residual = lcp_.solve(*problem_, now_.states, scales_.speed, now_.motion);
    if (!residual) return false;
    for (std::size_t i = 0; i < now_.states.size(); ++i) {
        const FanLink& link = problem_->links[i];
        if (!link.unbreakable)
            now_.states[i].fit(link, now_.motion.across(link), now_.motion.impulse[i], scales_,
                               now_.motion.cohesive_impulse[i]);
    }
    now_.violation = std::max(*residual, linear_.find_unbreakable_impulses(now_.motion) / scales_.impulse);
    return now_.violation <= max_lemke_violation;
}

/// Lemke's method may end without a solution where there is one, because with friction the matrix has not the
/// properties that the method needs. The links that ever moved take every state in turn, all others stick: first all
/// that stay closed, then open ones too. With friction 0.7 about one fan in 10^8 of a crushed body comes here.
bool FanSolver::search_states() {
    const std::vector<FanLink>& links = problem_->links;
    const auto distance = [&](std::size_t i) { return std::hypot(links[i].u_N, links[i].u_T); };
    const std::vector<LinkState> before = now_.states;
    std::vector<std::size_t> moved;
    for (std::size_t i = 0; i < links.size(); ++i) {
        LinkState& state = now_.states[i];
        if (links[i].unbreakable || state.imposed) continue;
        state.set(true, state.state_of(true, 0, scales_.speed_tolerance));
        if (distance(i) > 0) moved.push_back(i);
    }
    std::ranges::stable_sort(moved, std::greater(), distance);
    const std::vector<LinkState> stuck = now_.states;
    for (const bool may_open : {false, true})
        if (try_combinations(stuck, moved, may_open)) return true;
    now_.states = before;
    return false;
}

/// As many of the `moved` links as `max_tried` combinations permit.
bool FanSolver::try_combinations(const std::vector<LinkState>& stuck, const std::vector<std::size_t>& moved,
                                 bool may_open) {
    const auto n_closed = [&](std::size_t i) {
        return stuck[i].law.contact.may_touch ? stuck[i].law.closed.n_states() : 0;
    };
    const auto n_states = [&](std::size_t i) {
        return n_closed(i) + (may_open || n_closed(i) == 0 ? stuck[i].law.open.n_states() : 0);
    };
    int n_combinations = 1;
    std::size_t n_varied = 0;
    while (n_varied < moved.size() && n_combinations * n_states(moved[n_varied]) <= max_tried)
        n_combinations *= n_states(moved[n_varied++]);
    for (int combination = 0; combination < n_combinations; ++combination) {
        now_.states = stuck;
        int rest = combination;
        for (std::size_t k = 0; k < n_varied; ++k) {
            const std::size_t i = moved[k];
            const int state = rest % n_states(i);
            now_.states[i].set(state < n_closed(i), state < n_closed(i) ? state : state - n_closed(i));
            rest /= n_states(i);
        }
        int n_solves = 0;
        if (settle_states(1, n_solves)) return true;  // without corrections: this very combination
    }
    return false;
}

void FanSolver::store(FanResult& result) const {
    result.velocity = now_.motion.velocity;
    result.links.resize(problem_->links.size());
    for (std::size_t i = 0; i < result.links.size(); ++i) {
        const FanLink& link = problem_->links[i];
        const LinkState& state = now_.states[i];
        LinkResult& found = result.links[i];
        found.impulse = now_.motion.impulse[i];
        found.cohesive_impulse = state.cohesive_impulse(link);
        const double contact = link.normal.dot(found.impulse) + found.cohesive_impulse;
        found.contact = state.closed && !link.unbreakable ? std::max(0.0, contact) : 0;
        found.tangential = link.tangent().dot(found.impulse);
        found.friction_part = link.unbreakable ? 0 : state.friction_part(found.contact, found.tangential);
        found.stuck = state.holds();
    }
}

}  // namespace knap
