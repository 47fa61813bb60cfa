#include "stepper/explicit/vertex_scheme.hpp"

#include "base/parallel.hpp"
#include "base/room.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/explicit/corner_motion.hpp"
#include "stepper/explicit/split_order.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

constexpr std::size_t split_fans_in_a_block = 8;

}  // namespace

VertexScheme::VertexScheme(const Model& model, const SchemeOptions& options)
    : model_(model),
      options_(options),
      blocks_(model),
      circles_(model, blocks_),
      fan_is_candidate_(model.fans.size(), 0),
      splits_(model.fans.size(), 0),
      contacts_(model),
      stationary_(model, options.cohesion, mass_, contacts_),
      motion_(model) {
    for (const Index corner : model.fan_corners) mass_.push_back(model.corner_mass[corner]);
    workspaces_.resize(omp_get_max_threads());
    for (Workspace& work : workspaces_) {
        work.force.resize(blocks_.max_corners());
        make_room(16, work.stationary.required, work.stationary.impulse);  // more corners and points than most vertices have
    }
}

StepReport VertexScheme::advance(const State& begin, const ExplicitBulk& bulk, FreeMotion& free, State& end) {
    copy_partition(begin, end);
    StepReport report = sweep_blocks(begin, bulk, free, end);
    motion_.begin_explicit(begin, free.kick_time, free.drift_time);
    contacts_.find(begin, free.drift_time, motion_.rate(), free.corner_force);
    contact_impulse_.resize(contacts_.all().size());
    std::ranges::fill(contact_impulse_, Vec2::Zero());
    part_from_obstacles(begin);
    report += advance_bordering(begin, free, end);
    release(begin, end, report);
    find_obstacle_velocities(begin, free, report);
    find_edge_impulses(begin, free, report);
    report += advance_split(begin, free, end);
    account_edges(begin, end, free, report);
    motion_.finish(begin, contact_wrenches(), end, report);
    report += account_loads(begin, bulk, free, end);
    if (report.released > 0) order_split_fans(model_, end, unordered_);
    report.largest_speed = std::sqrt(report.largest_speed);  // squares until here
    return report;
}

/// Gives `end` room and the partition of `begin`, which it has until fans come apart. Mostly `end` is the state of the step before and lacks a few fans only.
void VertexScheme::copy_partition(const State& begin, State& end) const {
    const std::size_t known = end.split_fans.size();
    const bool goes_on = end.node_of_corner.size() == begin.node_of_corner.size() && known <= begin.split_fans.size() &&
                         std::equal(end.split_fans.begin(), end.split_fans.end(), begin.split_fans.begin());
    if (!goes_on) {
        end.node_of_corner = begin.node_of_corner;
        end.split_fans = begin.split_fans;
        end.first_point = begin.first_point;
        end.split_rank = begin.split_rank;
    }
    for (std::size_t rank = known; goes_on && rank < begin.split_fans.size(); ++rank) {
        const Index f = begin.split_fans[rank];
        const Fan& fan = model_.fans[f];
        end.split_fans.push_back(f);
        end.first_point.push_back(begin.first_point[rank]);
        end.split_rank[f] = begin.split_rank[f];
        for (Index i = 0; i < fan.n_corners; ++i) {
            const Index corner = model_.fan_corners[fan.first_corner + i];
            end.node_of_corner[corner] = begin.node_of_corner[corner];
        }
    }
    end.displacement.resize(begin.displacement.size());
    end.velocity.resize(begin.velocity.size());
    end.points.resize(begin.points.size());
    end.reaction.assign(model_.prescribed.size(), Vec2::Zero());
}

/// By the threads that moved these corners: a load on a long edge is many of them.
StepReport VertexScheme::account_loads(const State& begin, const ExplicitBulk& bulk, const FreeMotion& free, const State& end) {
    if (model_.corner_loads.empty()) return {};
    const auto blocks = blocks_.blocks();
    return sum_over_blocks(blocks.size(), 1, partial_, [&](std::size_t b, std::size_t, StepReport& report) {
        bulk.account_loads(blocks[b].first_load, blocks[b].last_load, begin, end, free, report);
    });
}

/// Those that came apart in this step; and where obstacles are about, all.
StepReport VertexScheme::advance_split(const State& begin, const FreeMotion& free, State& end) {
    const std::size_t done = fans_are_by_themselves() ? begin.split_fans.size() : 0;
    return sum_over_blocks(end.split_fans.size() - done, split_fans_in_a_block, partial_,
                           [&](std::size_t first, std::size_t last, StepReport& report) {
                               Workspace& work = workspaces_[omp_get_thread_num()];
                               for (std::size_t rank = done + first; rank < done + last; ++rank)
                                   advance_fan(static_cast<Index>(rank), begin, free, end, work, report);
                           });
}

Vec2 VertexScheme::prescribed_velocity(const PrescribedMotion& motion, const Vec2& displacement, const State& begin, double h) const {
    Vec2 velocity = Vec2::Zero();
    for (int k = 0; k < 2; ++k)
        if (motion.component[k])
            velocity[k] = motion.rate(k, model_.histories, displacement[k], {.begin = begin.time, .h = h, .central_differences = true}).rate;
    return velocity;
}

double VertexScheme::cohesion_before(Index fan, Index point, const State& begin) const {
    if (begin.split_rank[fan] >= 0) return begin.points[begin.first_point[begin.split_rank[fan]] + point].cohesion;
    return model_.laws[model_.fan_points[model_.fans[fan].first_point + point].law].sigma_c > 0 ? 1 : 0;
}

namespace {

/// Newton's coefficient in this step: none for what would come to rest within the step under `push` [m/s], the
/// approach that lasting pressure makes in a step: a ball rests after infinitely many rebounds, in 2 e |V_N|/((1 - e) push) steps.
double restitution_under(const FanProblem& problem, const FanLink& link, double push) {
    const double approach = -link.normal.dot(problem.velocity_before(link.after) - problem.velocity_before(link.before));
    const bool rests = 2 * link.restitution * std::max(approach, 0.0) < (1 - link.restitution) * push;
    return rests ? 0 : link.restitution;
}

}  // namespace

void VertexScheme::assemble_problem(Index f, const State& begin, const FreeMotion& free, FanProblem& problem) const {
    const Fan& fan = model_.fans[f];
    problem.closed = fan.closed;
    problem.drift_time = free.drift_time;
    problem.bodies.resize(fan.n_corners);
    problem.links.resize(fan.n_points);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index corner = model_.fan_corners[fan.first_corner + i];
        const Index node = begin.node_of_corner[corner];
        const double inverse_mass = 1 / mass_[fan.first_corner + i];
        FanBody& body = problem.bodies[i];
        body.velocity = begin.velocity[node];
        body.free_velocity = body.velocity + free.kick_time * inverse_mass * free.corner_force[corner];
        if (!contacts_.on_edges().empty()) body.free_velocity += inverse_mass * edge_impulse_on(corner);
        body.inverse_mass = Vec2::Constant(inverse_mass);
        const PrescribedMotion* motion = prescribed_motion(model_, corner);
        if (!motion) continue;
        const Vec2 given = prescribed_velocity(*motion, begin.displacement[node], begin, free.drift_time);
        for (int k = 0; k < 2; ++k)
            if (motion->component[k]) body.free_velocity[k] = given[k], body.inverse_mass[k] = 0;
    }
    // links in counterclockwise order; bodies are numbered in the same order
    const auto body_of = [&](Index corner, Index guess) { return corner == rigid_support ? rigid_support : (guess + fan.n_corners) % fan.n_corners; };
    const bool support_first = fan.n_points > 0 && model_.fan_points[fan.first_point].before == rigid_support;
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanPoint& point = model_.fan_points[fan.first_point + i];
        const CohesiveLaw& law = model_.laws[point.law];
        const Index before = fan.closed || support_first ? i - 1 : i;
        const auto displacement = [&](Index corner) -> Vec2 {
            return corner == rigid_support ? Vec2::Zero() : begin.displacement[begin.node_of_corner[corner]];
        };
        const Vec2 jump = displacement(point.after) - displacement(point.before);
        const bool unbreakable = !law.breakable() && !point.cracked;
        const double beta = unbreakable || point.cracked ? 0 : cohesion_before(f, i, begin);
        problem.links[i] = {.before = body_of(point.before, before),
                            .after = body_of(point.after, before + 1),
                            .normal = point.normal,
                            .u_N = point.gap + point.normal.dot(jump),
                            .u_T = turned_left(point.normal).dot(jump),
                            .cohesive = beta > 0 ? free.kick_time * law.sigma_c * point.area * beta : 0,
                            .gamma = law.gamma,
                            .friction = law.friction,
                            .restitution = law.restitution_at(beta),
                            .unbreakable = unbreakable};
        FanLink& link = problem.links[i];
        if (link.restitution == 0 || begin.split_rank[f] < 0) continue;
        const Vec2 mobility = problem.inverse_mass(link.after) + problem.inverse_mass(link.before);
        const double pressure = begin.points[begin.first_point[begin.split_rank[f]] + i].traction.x();  // of the step before
        link.restitution = restitution_under(problem, link, free.kick_time * point.area * pressure * link.normal.dot(mobility.cwiseProduct(link.normal)));
    }
    for (const ObstacleContact& contact : contacts_.of_fan(f)) {
        const Index* corner = &model_.fan_corners[fan.first_corner];
        const Obstacle& obstacle = model_.obstacles[contact.obstacle];
        const PrescribedMotion* motion = prescribed_motion(model_, contact.corner);
        const bool rubs = !(motion && obstacle.is_free() && contact.is_led_along(motion->component));
        problem.links.push_back({.before = static_cast<Index>(problem.bodies.size()),
                                 .after = static_cast<Index>(std::find(corner, corner + fan.n_corners, contact.corner) - corner),
                                 .normal = contact.normal,
                                 .u_N = contact.gap,
                                 .u_T = 0,
                                 .cohesive = 0,
                                 .gamma = 0,
                                 .friction = rubs ? obstacle.contact.friction : 0,
                                 .restitution = obstacle.contact.restitution,
                                 .unbreakable = false});
        problem.bodies.push_back({.velocity = velocity_at(begin.obstacles[contact.obstacle].velocity, contact),
                                  .free_velocity = velocity_at(motion_.rate()[contact.obstacle], contact),
                                  .inverse_mass = Vec2::Zero(),
                                  .end_velocity = Vec2::Zero()});
        if (obstacle.contact.restitution == 0) continue;
        Vec2 force = Vec2::Zero();  // of the body and the loads on the whole fan
        for (Index i = 0; i < fan.n_corners; ++i) force += free.corner_force[corner[i]];
        FanLink& link = problem.links.back();
        link.restitution = restitution_under(problem, link, -free.kick_time * link.normal.dot(force) / fan.mass);
    }
}

namespace {

constexpr double contradiction = 1e-12;  // residual of a fan whose rebounds do not fit together; rounding leaves less
constexpr double slow = 1e-9;            // of the largest speed

}  // namespace

/// Rebounds at several links of a vertex may contradict each other: their speeds do not add up round it, and no motion has them all. In such a step nothing is
/// thrown back, if that is lawful. So may slips of next to nothing that turn round in every step where several contacts stick, and grow by it: before the residual
/// becomes more than a run allows, they come to rest (at the cost of a friction work below the gate's limit, of either sign).
FanSolution VertexScheme::solve(Index f, const State& begin, Workspace& work) const {
    const FanSolution posed = solve_assembled(f, begin, work);
    if (posed.residual <= contradiction) return posed;
    std::vector<FanLink>& links = work.problem.links;
    std::vector<double>& coefficients = work.restitution;
    coefficients.clear();
    for (FanLink& link : links) coefficients.push_back(std::exchange(link.restitution, 0.0));
    double best = posed.residual;
    if (std::ranges::any_of(coefficients, [](double e) { return e > 0; })) {
        const FanSolution resting = solve_assembled(f, begin, work);
        if (resting.residual <= contradiction) return resting;
        best = std::min(best, resting.residual);
    }
    if (best > 0.5 * max_residual) {
        const FanSolution still = solve_assembled(f, begin, work, slow);
        if (still.residual < best) return still;
    }
    if (best < posed.residual) return solve_assembled(f, begin, work);
    for (std::size_t i = 0; i < links.size(); ++i) links[i].restitution = coefficients[i];
    return solve_assembled(f, begin, work);
}

FanSolution VertexScheme::solve_assembled(Index f, const State& begin, Workspace& work, double rest) const {
    if (options_.cohesion == CohesionScheme::explicit_beta) return work.solver.solve(work.problem, rest);
    const Fan& fan = model_.fans[f];
    work.cohesion.clear();
    for (Index i = 0; i < fan.n_points; ++i) {
        const double strength = work.problem.links[i].cohesive;
        if (strength == 0) continue;
        work.cohesion.push_back({.link = i, .law = &model_.laws[model_.fan_points[fan.first_point + i].law], .start = cohesion_before(f, i, begin), .strength = strength});
    }
    return solve_softening(work.problem, work.solver, work.cohesion, options_.theta);
}

namespace {

constexpr double rounding = 1e-14;  // of the velocities of a fan
constexpr double caught = 1e-9;     // of the tangential cohesion: what pulls with less is held where the slip is zero

/// [m/s] Size of what the velocities of a fan are sums of: impulses that hold a body together cancel.
double speed_scale(const FanProblem& problem) {
    double speed = 0, mobility = 0, impulse = 0;
    for (const FanBody& body : problem.bodies) {
        speed = std::max({speed, body.velocity.norm(), body.end_velocity.norm()});
        mobility = std::max({mobility, body.inverse_mass.x(), body.inverse_mass.y()});
    }
    for (const FanLink& link : problem.links) impulse = std::max({impulse, link.contact, link.impulse.norm()});
    return speed + mobility * impulse;
}

/// What the implicit sign of the tangential cohesion costs where the slip changes its sign: the work of its force minus the change of
/// gamma beta sigma_c |u_T| S, both between the middles of the steps, which is what the mean velocity of an impulse covers.
double crossing_loss(const FanLink& link, double v_T_before, double v_T_after, double last_step, const FreeMotion& free) {
    const double from = link.u_T - 0.5 * last_step * v_T_before, to = link.u_T + 0.5 * free.drift_time * v_T_after;
    const double held = link.friction_part - link.tangential, full = link.gamma * link.cohesive * (1 - caught);
    if (link.cohesive == 0 || (from >= 0 && to >= 0 && held >= full) || (from <= 0 && to <= 0 && held <= -full)) return 0;
    const double work = held * 0.5 * (v_T_before + v_T_after);
    return work - link.gamma * link.cohesive / free.kick_time * (std::abs(to) - std::abs(from));
}

}  // namespace

void VertexScheme::advance_fan(Index rank, const State& begin, const FreeMotion& free, State& end, Workspace& work,
                               StepReport& report) {
    if (stationary_.advance(rank, begin, free, end, work.stationary, report)) return;
    const Index f = end.split_fans[rank];
    const Fan& fan = model_.fans[f];
    FanProblem& problem = work.problem;
    assemble_problem(f, begin, free, problem);
    const FanSolution solution = solve(f, begin, work);
    ++report.fan_solves;
    report.fan_iterations += solution.iterations;
    if (solution.status != FanSolution::Status::exact) ++report.fan_fallbacks;
    report.residual = std::max(report.residual, solution.residual);
    const bool inexact = options_.cohesion == CohesionScheme::implicit_beta && solution.residual > max_residual;  // a shorter step softens less
    if ((!solution.settled || inexact) && report.rejection == Rejection::none) {
        report.rejection = Rejection::not_converged;
        report.where = model_.mesh.corner(model_.fan_corners[fan.first_corner]);
    }

    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index corner = model_.fan_corners[fan.first_corner + i];
        const double mass = mass_[fan.first_corner + i];
        const Vec2 before = problem.bodies[i].velocity, velocity = problem.bodies[i].end_velocity, force = free.corner_force[corner];
        move_corner(corner, mass, velocity, begin, free, end, report);
        for (int k = 0; k < 2; ++k) {  // the reaction of a prescribed motion works; the impulses of the links are taken off below
            if (problem.bodies[i].inverse_mass[k] != 0) continue;
            const double impulse = mass * (velocity[k] - before[k]) - free.kick_time * force[k] - edge_impulse_on(corner)[k];
            report.external_work += 0.5 * impulse * (velocity[k] + before[k]);
            end.reaction[model_.prescribed_of_corner[corner]][k] = impulse / free.kick_time;
        }
    }

    const auto reaction_at = [&](Index body) -> Vec2& {
        return end.reaction[model_.prescribed_of_corner[model_.fan_corners[fan.first_corner + body]]];
    };
    const double rate_error = (rounding + solution.residual) * speed_scale(problem);  // [m/s]
    const auto relieve_drives = [&](const FanLink& link) {
        for (int k = 0; k < 2; ++k) {
            const auto driven = [&](Index body) { return body >= 0 && body < fan.n_corners && problem.bodies[body].inverse_mass[k] == 0; };
            const double mean_after = 0.5 * (problem.velocity_before(link.after)[k] + problem.velocity_after(link.after)[k]);
            const double mean_before = 0.5 * (problem.velocity_before(link.before)[k] + problem.velocity_after(link.before)[k]);
            if (driven(link.after)) report.external_work -= link.impulse[k] * mean_after, reaction_at(link.after)[k] -= link.impulse[k] / free.kick_time;
            if (driven(link.before)) report.external_work += link.impulse[k] * mean_before, reaction_at(link.before)[k] += link.impulse[k] / free.kick_time;
        }
    };
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanLink& link = problem.links[i];
        const FanPoint& point = model_.fan_points[fan.first_point + i];
        const CohesiveLaw& law = model_.laws[point.law];
        const Vec2 n = link.normal, t = turned_left(n);
        const Vec2 before = problem.velocity_before(link.after) - problem.velocity_before(link.before);
        const Vec2 after = problem.velocity_after(link.after) - problem.velocity_after(link.before);
        relieve_drives(link);
        const double mean_N = 0.5 * n.dot(before + after), mean_T = 0.5 * t.dot(before + after);
        PointState& state = end.points[end.first_point[rank] + i];
        const double S = point.area;
        state.traction = Vec2(link.contact - link.cohesive, link.tangential) / (free.kick_time * S);
        if (link.unbreakable) {
            state.cohesion = 1;
            continue;
        }
        report.cohesive_work += link.cohesive * mean_N - (link.tangential - link.friction_part) * mean_T;
        report.crossing_loss += crossing_loss(link, t.dot(before), t.dot(after), begin.last_step, free);
        const double u_N = link.u_N + free.drift_time * n.dot(after), u_T = link.u_T + free.drift_time * t.dot(after);
        const double cohesion = point.cracked ? 0 : cohesion_before(f, i, begin);
        state.cohesion = law.next_cohesion(cohesion, u_N, u_T);
        account_cohesion(point, law, cohesion, state.cohesion, u_N, u_T, report);
        account_contact({link.contact, link.friction_part, mean_N, mean_T, rate_error, u_N}, report);
    }

    const auto contacts = contacts_.of_fan(f);
    for (std::size_t j = 0; j < contacts.size(); ++j) {
        const FanLink& link = problem.links[fan.n_points + j];
        const Vec2 before = problem.velocity_before(link.after) - problem.velocity_before(link.before);
        const Vec2 after = problem.velocity_after(link.after) - problem.velocity_after(link.before);
        relieve_drives(link);
        account_contact({link.contact, link.friction_part, 0.5 * link.normal.dot(before + after), 0.5 * link.tangent().dot(before + after), rate_error,
                         link.u_N + free.drift_time * link.normal.dot(after)},
                        report);
        contact_impulse_[&contacts[j] - contacts_.all().data()] = link.impulse;
    }
}

}  // namespace knap
