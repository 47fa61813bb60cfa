#include "stepper/explicit/vertex_solver.hpp"

#include "nonsmooth/fan_ramps.hpp"
#include "stepper/common/changing_friction.hpp"
#include "stepper/common/point_work.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace knap {
namespace {

constexpr double rest_tolerance = 1e-9, max_rest_tolerance = 1e-6;  // [-] of the largest speed
constexpr double far_away = 1e6;                                    // [m] a gap that no step closes
// [-] The width of the ramp of vertical unloading: of the speed that its cohesion causes, and of kappa/h.
constexpr double step_width = 1e-7, least_width = 1e-12;
constexpr double stick_tolerance =
    1e-9;  // [-] of the tangential cohesion: a force smaller by more holds the slip at zero

/// [-] beta at the start of the step, of point i of the fan.
double cohesion_before(const Model& model, Index f, Index i, const State& begin) {
    if (begin.split_rank[f] >= 0) return begin.points[begin.first_point[begin.split_rank[f]] + i].cohesion;
    return model.laws[model.points(model.fans[f])[i].law].sigma_c > 0 ? 1 : 0;
}

/// [m] kappa likewise.
double largest_opening(Index f, Index i, const State& begin) {
    const Index rank = begin.split_rank[f];
    return rank >= 0 ? begin.points[begin.first_point[rank] + i].largest_opening : 0;
}

/// [m] way of the slip likewise.
double slid(Index f, Index i, const State& begin) {
    const Index rank = begin.split_rank[f];
    return rank >= 0 ? begin.points[begin.first_point[rank] + i].slid : 0;
}

/// Newton's coefficient in this step, under the lasting pressure that causes the approach `push` [m/s] in a step.
double restitution_under(const FanProblem& problem, const FanLink& link, double push) {
    const double approach =
        -link.normal.dot(problem.velocity_before(link.after) - problem.velocity_before(link.before));
    return rests_under(link.restitution, approach, push) ? 0 : link.restitution;
}

/// [m] An opening that no step closes.
double far(const Model& model, const FanPoint& point) {
    return model.interfaces[model.interface_of(point.point)].length;
}

/// [m/s] Size of the terms of which the velocities of a fan are sums: impulses that hold a body together cancel.
double speed_scale(const SolvedFan& fan) {
    double speed = 0, mobility = 0, impulse = 0;
    for (std::size_t i = 0; i < fan.problem.bodies.size(); ++i) {
        const FanBody& body = fan.problem.bodies[i];
        speed = std::max({speed, body.velocity.norm(), fan.result.velocity[i].norm()});
        mobility = std::max({mobility, body.inverse_mass.x(), body.inverse_mass.y()});
    }
    for (const LinkResult& link : fan.result.links) impulse = std::max({impulse, link.contact, link.impulse.norm()});
    return speed + mobility * impulse;
}

/// [J] Loss by the implicit sign of the tangential cohesion where the slip changes its sign: the work of its force
/// minus the change of gamma beta sigma_c |u_T| S, both from the middle of the last step to the middle of this one, the
/// interval to which the mean velocity of an impulse belongs.
double crossing_loss(const FanLink& link, const LinkResult& found, double V_T_before, double V_T_after,
                     const ExplicitStep& step) {
    const double from = link.u_T - 0.5 * step.begin.last_step * V_T_before,
                 to = link.u_T + 0.5 * step.drift_time * V_T_after;
    const double force = found.friction_part - found.tangential,
                 full = link.gamma * found.cohesive_impulse * (1 - stick_tolerance);
    if (found.cohesive_impulse == 0 || (from >= 0 && to >= 0 && force >= full) ||
        (from <= 0 && to <= 0 && force <= -full))
        return 0;
    const double work = force * 0.5 * (V_T_before + V_T_after);
    return work - link.gamma * found.cohesive_impulse / step.kick_time * (std::abs(to) - std::abs(from));
}

/// [J] Likewise of a curved link, in both components: its force has the direction of one opening of the step. No less
/// than zero by the convexity of s where this is the middle of the step (norm_law.hpp).
double convexity_loss(const FanLink& link, const CohesiveLaw& law, const LinkResult& found, const Vec2& before,
                      const Vec2& after, const ExplicitStep& step) {
    if (link.cohesive == 0) return 0;
    const Vec2 mean = 0.5 * (before + after), to = Vec2(link.u_N, link.u_T) + 0.5 * step.drift_time * after,
               from = to - step.kick_time * mean;
    const auto stored = [&](const Vec2& at) {
        return CohesiveLaw::stored_opening(link.kappa, law.equivalent_opening(at.x(), at.y()));
    };
    const Vec2 force(found.cohesive_impulse, found.friction_part - found.tangential);
    return force.dot(mean) - link.cohesive / step.kick_time * (stored(to) - stored(from));
}

}  // namespace

/// The dashpot of a corner of mass m acts at the mean velocity of the step: per component
///
///     (m + k/2 C_xx) v_x+ = (m - k/2 C_xx) v_x + k (f_x - C_xy (v_y + v_y+)/2) + P_x
///
/// where C_xy is zero unless the boundary is oblique; its term is a force at the guess of the mean velocity.
void VertexSolver::add_dashpots(Index f, const ExplicitStep& step, Workspace& work) const {
    const Fan& fan = model_.fans[f];
    const auto corners = model_.corners(fan);
    for (const Dashpot& dashpot : absorbing_.of_fan(f)) {
        const Index i = place_among(corners, dashpot.corner);
        FanBody& body = work.fan.problem.bodies[i];
        const double mass = step.mass[fan.first_corner + i];
        const Vec2 half = 0.5 * step.kick_time * dashpot.C.diagonal(), force = step.corner_force[dashpot.corner],
                   mean = work.mean_velocity.empty() ? body.velocity : work.mean_velocity[i],
                   across = dashpot.C(0, 1) * Vec2(mean.y(), mean.x());
        for (int k = 0; k < 2; ++k) {
            body.inverse_mass[k] = 1 / ((1 + step.damping) * mass + half[k]);
            body.free_velocity[k] = body.inverse_mass[k] * (((1 - step.damping) * mass - half[k]) * body.velocity[k] +
                                                            step.kick_time * (force[k] - across[k]));
        }
    }
}

void VertexSolver::assemble(Index f, const ExplicitStep& step, Workspace& work) const {
    FanProblem& problem = work.fan.problem;
    const Fan& fan = model_.fans[f];
    const State& begin = step.begin;
    const auto corners = model_.corners(fan);
    const auto points = model_.points(fan);
    problem.closed = fan.closed;
    problem.has_ramps = problem.is_curved = false;
    problem.turns = model_.large_rotation;
    problem.drift_time = step.drift_time;
    problem.bodies.clear();
    problem.links.clear();
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index corner = corners[i], node = begin.node_of_corner[corner];
        const double inverse_mass = step.mobility / step.mass[fan.first_corner + i];
        const FanBody body{
            .velocity = begin.velocity[node],
            .free_velocity = step.damped(node) + step.kick_time * inverse_mass * step.corner_force[corner],
            .inverse_mass = Vec2::Constant(inverse_mass)};
        problem.bodies.push_back(body);
    }
    add_dashpots(f, step, work);
    for (Index i = 0; i < fan.n_corners; ++i) {
        FanBody& body = problem.bodies[i];
        if (!step.corner_impulse.empty())
            body.free_velocity += body.inverse_mass.cwiseProduct(step.corner_impulse[corners[i]]);
        if (const PrescribedMotion* motion = model_.motion_of(corners[i])) {
            const Vec2 displacement = begin.displacement[begin.node_of_corner[corners[i]]],
                       given = step.prescribed_velocity(model_, *motion, displacement);
            for (int k = 0; k < 2; ++k)
                if (motion->component[k]) body.free_velocity[k] = given[k], body.inverse_mass[k] = 0;
        }
    }
    // both in counterclockwise order: point i lies between the bodies shift + i - 1 and shift + i
    const Index shift = fan.closed || (fan.n_points > 0 && points[0].before == rigid_support) ? 0 : 1;
    const auto body = [&](Index corner, Index i) {
        return corner == rigid_support ? rigid_support : (i + fan.n_corners) % fan.n_corners;
    };
    const double factor = step.end.strength_factor(f);
    for (Index i = 0; i < fan.n_points; ++i) {
        const FanPoint& point = points[i];
        const CohesiveLaw& law = law_of(model_, begin, point);
        const bool retired = begin.has_retired(point.point);  // its sides meet as free faces, elsewhere
        const Rotation frame = retired ? point_frame(model_, begin, point) : step.frame(model_, f, i);
        const bool sticks = unbreakable(model_, point);
        const double beta = sticks || point.cracked ? 0 : cohesion_before(model_, f, i, begin);
        const Vec2 u = retired ? Vec2(far(model_, point), 0) : cohesive_opening(model_, begin, point, frame, beta);
        problem.links.push_back(
            {.before = body(point.before, shift + i - 1),
             .after = body(point.after, shift + i),
             .normal = frame.turned(point.normal),
             .u_N = u.x(),
             .u_T = u.y(),
             .cohesive = beta > 0 ? step.kick_time * law.sigma_c * (point.area * factor) * beta : 0,
             .gamma = law.gamma,
             .friction = law.friction_after(slid(f, i, begin)),
             .restitution = retired ? 0 : law.restitution_at(beta),
             .unbreakable = sticks,
             .pressed = law.pressed_friction(step.kick_time * pressed_area(model_, begin, fan, point))});
        FanLink& link = problem.links.back();
        if (law.coupling != Coupling::sum && !sticks) {
            link.coupling = law.coupling;
            problem.is_curved = problem.is_curved || beta > 0;
        }
        const double kappa = law.ramp(beta, largest_opening(f, i, begin));
        if (kappa > 0 && law.unloading == Unloading::vertical) {
            const Vec2 mobility = problem.inverse_mass(link.after) + problem.inverse_mass(link.before);
            link.floor = kappa;
            link.set_floor(step.drift_time,
                           step_width * link.cohesive * mobility.sum() + least_width * kappa / step.drift_time);
            problem.has_ramps = true;
        } else if (kappa > 0) {
            const Vec2 rate = problem.velocity_before(link.after) - problem.velocity_before(link.before),
                       u(link.u_N, link.u_T),
                       half = 0.5 * begin.last_step * Vec2(link.normal.dot(rate), link.tangent().dot(rate));
            link.kappa = kappa;
            link.middle = u - half;
            if (link.coupling == Coupling::sum) {
                link.set_ramp(step.drift_time);
                link.ramp_start =
                    2 / step.drift_time * Vec2(2 * u.x() - half.x() + law.gamma * std::abs(link.middle.y()), u.y());
                problem.has_ramps = true;
            }
        }
        if ((link.coupling != Coupling::sum || link.pressed) && begin.split_rank[f] >= 0)
            link.last_impulse =
                step.kick_time * point.area * begin.points[begin.first_point[begin.split_rank[f]] + i].traction;
        if (link.restitution == 0 || begin.split_rank[f] < 0) continue;
        const Vec2 mobility = problem.inverse_mass(link.after) + problem.inverse_mass(link.before);
        const double pressure =
            begin.points[begin.first_point[begin.split_rank[f]] + i].traction.x();  // of the step before
        link.restitution = restitution_under(
            problem, link,
            step.kick_time * point.area * pressure * link.normal.dot(mobility.cwiseProduct(link.normal)));
    }
    add_contacts(f, step, problem);
}

void VertexSolver::add_contacts(Index f, const ExplicitStep& step, FanProblem& problem) const {
    const Fan& fan = model_.fans[f];
    const auto corners = model_.corners(fan);
    for (const ObstacleContact& contact : obstacles_.contacts.of_fan(f)) {
        if (!is_within_fan(contact)) continue;
        const ContactLaw& law = obstacles_.contacts.law_of(contact, step.begin);
        const GivingWay gives = obstacles_.given_at(contact);
        problem.links.push_back({.before = static_cast<Index>(problem.bodies.size()),
                                 .after = place_among(corners, contact.corner),
                                 .normal = contact.normal,
                                 .u_N = gives.pushes ? contact.gap : far_away,
                                 .u_T = 0,
                                 .cohesive = 0,
                                 .gamma = 0,
                                 .friction = gives.rubs ? law.friction : 0,
                                 .restitution = law.restitution_of_faces(),
                                 .unbreakable = false,
                                 .given = gives.rate});
        problem.bodies.push_back({.velocity = velocity_at(step.begin.obstacles[contact.obstacle].velocity, contact),
                                  .free_velocity = velocity_at(obstacles_.motion.rate()[contact.obstacle], contact),
                                  .inverse_mass = Vec2::Zero()});
        if (law.restitution_of_faces() == 0) continue;
        Vec2 force = Vec2::Zero();  // on the whole fan
        for (const Index c : corners) force += step.corner_force[c];
        FanLink& link = problem.links.back();
        link.restitution = restitution_under(problem, link, -step.kick_time * link.normal.dot(force) / fan.mass);
    }
}

FanSolution VertexSolver::solve(Index f, const ExplicitStep& step, Workspace& work) const {
    work.mean_velocity.clear();
    FanSolution solution = solve_for_mean(f, step, work);
    if (!absorbing_.is_oblique(f)) return solution;
    // a contraction, by less than (c_p - c_s)/(c_p + c_s)
    work.mean_velocity.assign(model_.fans[f].n_corners, Vec2::Zero());
    double change = 1, speed = 0;
    for (int sweep = 0; sweep < max_iterations; ++sweep) {
        change = 0;
        for (std::size_t i = 0; i < work.mean_velocity.size(); ++i) {
            const Vec2 before = work.fan.problem.bodies[i].velocity, after = work.fan.result.velocity[i],
                       mean = 0.5 * (before + after);
            change = std::max(change, (mean - work.mean_velocity[i]).norm());
            speed = std::max(speed, before.norm() + after.norm());
            work.mean_velocity[i] = mean;
        }
        if (change <= rate_rounding * speed) return solution;
        solution = solve_for_mean(f, step, work);
    }
    solution.residual = std::max(solution.residual, change / speed);
    return solution;
}

/// Rebounds at several links of a vertex may contradict each other: their speeds do not add up round it, and no motion
/// has them all. The fan is then solved without restitution. Slips near zero that reverse in every step where several
/// contacts stick may contradict each other too, and grow: before the residual exceeds the limit of a run they are set
/// to rest, at the cost of a friction work of either sign below the limit of its gate. Where fans turn, a slip before
/// the step is a slow separation in it, with the same effect.
FanSolution VertexSolver::solve_for_mean(Index f, const ExplicitStep& step, Workspace& work) const {
    FanSolution best = solve_once(f, step, true, 0, work);
    const auto try_without_rebounds = [&](double rest) {
        std::swap(work.fan, work.kept);
        const FanSolution other = solve_once(f, step, false, rest, work);
        if (other.residual < best.residual) best = other;
        else std::swap(work.fan, work.kept);
    };
    const auto rebounds = [](const FanLink& link) { return link.restitution > 0; };
    if (best.residual > relative_tolerance && std::ranges::any_of(work.fan.problem.links, rebounds))
        try_without_rebounds(0);
    if (best.residual > (model_.large_rotation ? 0.1 : 0.5) * max_residual) try_without_rebounds(rest_tolerance);
    for (double rest = 10 * rest_tolerance;
         model_.large_rotation && rest <= max_rest_tolerance && best.residual > 0.1 * max_residual; rest *= 10)
        try_without_rebounds(rest);
    return best;
}

FanSolution VertexSolver::solve_once(Index f, const ExplicitStep& step, bool rebounds, double rest,
                                     Workspace& work) const {
    FanProblem& problem = work.fan.problem;
    assemble(f, step, work);
    for (FanLink& link : problem.links)
        if (!rebounds) link.restitution = 0;
    if (options_.cohesion == CohesionScheme::explicit_beta) return solve_on_ramps(work.fan, work.solver, rest);
    work.cohesion.clear();
    for (Index i = 0; i < model_.fans[f].n_points; ++i)
        if (const double strength = problem.links[i].cohesive; strength > 0)
            work.cohesion.push_back({.link = i,
                                     .law = &law_of(model_, step.begin, model_.points(model_.fans[f])[i]),
                                     .start = cohesion_before(model_, f, i, step.begin),
                                     .strength = strength});
    return solve_softening(work.fan, work.solver, work.cohesion, options_.theta, rest);
}

void VertexSolver::advance(Index rank, const ExplicitStep& step, Workspace& work, StepReport& report,
                           Known* known) const {
    State& end = step.end;
    const Index f = end.split_fans[rank];
    const Fan& fan = model_.fans[f];
    const auto dashpots = absorbing_.of_fan(f);
    if (options_.cohesion == CohesionScheme::explicit_beta && !has_outer_forces(f) &&
        advance_stationary(model_, rank, step, work.stationary, report))
        return;
    if (known) std::swap(work.fan, known->fan);
    const FanSolution solution = known ? known->solution : solve(f, step, work);
    const FanProblem& problem = work.fan.problem;
    const FanResult& result = work.fan.result;
    const auto corners = model_.corners(fan);
    ++report.fan_solves;
    report.fan_iterations += solution.iterations;
    if (solution.status != FanSolution::Status::exact) ++report.fan_fallbacks;
    report.residual = std::max(report.residual, solution.residual);
    const bool inexact = options_.cohesion == CohesionScheme::implicit_beta &&
                         solution.residual > max_residual;  // a shorter step softens less
    if (!solution.settled || inexact)
        report.reject(solution.is_lawful() ? Rejection::not_converged : Rejection::jammed,
                      model_.mesh.corner(corners[0]));

    // the reaction of a prescribed motion is the residual of the momentum balance of its corner; its work is booked
    const auto drive = [&](Index body, int k, double impulse) {
        if (body < 0 || body >= fan.n_corners || problem.bodies[body].inverse_mass[k] != 0) return;
        step.drive(model_.prescribed_of_corner[corners[body]], k, impulse,
                   0.5 * (problem.bodies[body].velocity[k] + result.velocity[body][k]), report);
    };
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index corner = corners[i];
        const double mass = step.mass[fan.first_corner + i];
        const Vec2 before = problem.bodies[i].velocity, after = result.velocity[i], force = step.corner_force[corner];
        NodeMotion motion(step);
        motion.move(step.begin.node_of_corner[corner], end.node_of_corner[corner], mass, force, after);
        motion.add_to(report);
        if (!model_.motion_of(corner)) continue;
        const Vec2 shared = step.corner_impulse.empty() ? Vec2(Vec2::Zero()) : step.corner_impulse[corner];
        const Vec2 needed = step.impulse(mass, before, after) -
                            step.kick_time * dashpot_force(corner, dashpots, 0.5 * (before + after));
        for (int k = 0; k < 2; ++k) drive(i, k, needed[k] - step.kick_time * force[k] - shared[k]);
    }

    // normals round a vertex that turns differ: rates that cancel along it leave their tolerance
    const double tolerance = problem.turns ? 10 * relative_tolerance : rate_rounding,
                 rate_error = (tolerance + solution.residual) * speed_scale(work.fan);  // [m/s]
    auto contact = obstacles_.contacts.of_fan(f).begin();
    for (Index i = 0; i < static_cast<Index>(problem.links.size()); ++i) {
        const FanLink& link = problem.links[i];
        const LinkResult& found = result.links[i];
        for (int k = 0; k < 2; ++k) {
            drive(link.after, k, -found.impulse[k]);
            drive(link.before, k, found.impulse[k]);
        }
        const Vec2 n = link.normal, t = turned_left(n);
        const Vec2 before = problem.velocity_before(link.after) - problem.velocity_before(link.before);
        const Vec2 after = result.across(link);
        const double mean_N = 0.5 * n.dot(before + after), mean_T = 0.5 * t.dot(before + after);
        const double u_N = link.u_N + step.drift_time * n.dot(after), u_T = link.u_T + step.drift_time * t.dot(after);
        double overlap = u_N;  // [m] negative: what gave way is none
        if (i < fan.n_points) {
            const FanPoint& point = model_.points(fan)[i];
            const CohesiveLaw& law = law_of(model_, step.begin, point);
            const double area = point.area * end.strength_factor(f);
            PointState& state = end.points[end.first_point[rank] + i];
            state.largest_opening = largest_opening(f, i, step.begin), state.slid = slid(f, i, step.begin);
            state.traction =
                Vec2(found.contact - found.cohesive_impulse, found.tangential) / (step.kick_time * point.area);
            if (link.unbreakable) {
                state.cohesion = 1;
                continue;
            }
            if (step.begin.has_retired(point.point)) {
                account_rest(point, law, area, state.cohesion = 0, 0, report);
                continue;
            }
            report.cohesive_work += found.cohesive_impulse * mean_N - (found.tangential - found.friction_part) * mean_T;
            if (link.coupling == Coupling::sum)
                report.crossing_loss += crossing_loss(link, found, t.dot(before), t.dot(after), step);
            else
                report.crossing_loss += convexity_loss(link, law, found, {n.dot(before), t.dot(before)},
                                                       {n.dot(after), t.dot(after)}, step);
            const double beta = point.cracked ? 0 : cohesion_before(model_, f, i, step.begin);
            state.cohesion = law.next_cohesion(beta, u_N, u_T, step.drift_time);
            const double middle = law.equivalent_opening(u_N - 0.5 * step.drift_time * n.dot(after),
                                                         u_T - 0.5 * step.drift_time * t.dot(after));
            state.largest_opening =
                law.largest_opening(state.largest_opening,
                                    law.unloading == Unloading::vertical ? law.equivalent_opening(u_N, u_T) : middle);
            account_cohesion(point, law,
                             {.area = area,
                              .before = beta,
                              .after = state.cohesion,
                              .opening = law.equivalent_opening(u_N, u_T),
                              .at_works = middle,
                              .at_fall = middle,
                              .kappa = law.ramp(state.cohesion, state.largest_opening),
                              .energy_factor = law.energy_factor(u_N, u_T)},
                             report);
        } else {
            while (!is_within_fan(*contact)) ++contact;
            if (obstacles_.given_at(*contact).lies_deep) overlap = 0;
            obstacles_.impulse[&*contact++ - obstacles_.contacts.all().data()] = found.impulse;
        }
        double pull = link.coupling == Coupling::sum ? found.cohesive_impulse : 0;
        if (pull > 0 && found.contact > 0 && found.friction_part != 0 && i < fan.n_points) {
            const auto points = model_.points(fan);
            if (const FanPoint* other = same_face_beyond(model_, points[i])) {
                const LinkResult& beside = result.links[other - points.data()];
                pull += std::max(0.0, beside.cohesive_impulse - beside.contact);
            }
        }
        account_contact({.contact = found.contact,
                         .friction = found.friction_part,
                         .rate_N = mean_N,
                         .rate_T = mean_T,
                         .rate_error = rate_error,
                         .opening = overlap,
                         .cohesive = pull,
                         .may_flutter = i < fan.n_points && model_.laws[model_.points(fan)[i].law].friction_changes()},
                        report);
    }
}

}  // namespace knap
