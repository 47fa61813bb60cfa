#include "stepper/explicit/vertex_obstacles.hpp"

#include "stepper/common/point_work.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace knap {
namespace {

constexpr double edge_tolerance = 1e-14;  // [-] of the largest impulse
constexpr int fast_sweeps = 10, max_sweeps = 500;
constexpr double faces_agree = 1e-12;     // [-] of the momenta, a free obstacle and the faces that it touches
constexpr double contacts_agree = 1e-12;  // [-] of the largest impulse
constexpr int max_obstacle_rounds = 200;  // of contacts between faces and on edges

}  // namespace

void VertexObstacles::begin(const ExplicitStep& step) {
    now_.motion.begin_explicit(step.begin, step.kick_time, step.drift_time, step.obstacle_damping);
    now_.contacts.find(step.begin, step.drift_time, now_.motion.rate(), step.corner_force);
    now_.impulse.assign(now_.contacts.all().size(), Vec2::Zero());
    edges_.clear();  // of the step before; solve_edges() is not called where there are none
}

bool VertexObstacles::couple(Index fan) const {
    const auto is_free = [&](const ObstacleContact& c) { return model_.obstacles[c.obstacle].is_free(); };
    return (any_is_free_ && std::ranges::any_of(now_.contacts.of_fan(fan), is_free)) ||
           std::ranges::any_of(now_.contacts.on_edges(),
                               [&](const ObstacleContact& c) { return c.fan == fan || c.second_fan == fan; });
}

void VertexObstacles::solve(const ExplicitStep& step, const BetweenFaces& between_faces, VertexSolver::Workspace& work,
                            StepReport& report) {
    if (now_.contacts.find_free(touched_)) solve_obstacles(step, between_faces, work, report);
    solve_at_rates(step, between_faces, work, report);
}

/// At given rates of the obstacles.
void VertexObstacles::solve_at_rates(const ExplicitStep& step, const BetweenFaces& between_faces,
                                     VertexSolver::Workspace& work, StepReport& report) {
    if (!between_faces) return solve_edges(step, work, report);
    StepReport last;
    double change = 1;
    for (int round = 0; round < max_obstacle_rounds && change > contacts_agree; ++round) {
        last = {};
        change = between_faces(last);
        if (now_.contacts.on_edges().empty()) break;
        solve_edges(step, work, last);
    }
    if (change > max_residual && !now_.contacts.on_edges().empty())
        last.reject(Rejection::not_converged, model_.mesh.corner(now_.contacts.on_edges().front().corner));
    report += last;
}

void VertexObstacles::solve_obstacles(const ExplicitStep& step, const BetweenFaces& between_faces,
                                      VertexSolver::Workspace& work, StepReport& report) {
    const std::vector<ObstacleContact>& contacts = now_.contacts.all();
    std::vector<Index>& fans = touching_fans_;
    fans.clear();
    for (std::size_t i = 0; i < now_.contacts.n_at_corners(); ++i)
        if (touched_[contacts[i].obstacle] && (fans.empty() || fans.back() != contacts[i].fan))
            fans.push_back(contacts[i].fan);
    const auto response = [&](std::vector<Vec3>& wrench) {
        StepReport of_trial;
        solve_at_rates(step, between_faces, work, of_trial);
        for (const Index f : fans) {
            solver_.solve(f, step, work);
            const auto of_fan = now_.contacts.of_fan(f);
            for (std::size_t j = 0; j < of_fan.size(); ++j)
                now_.impulse[&of_fan[j] - contacts.data()] = work.fan.result.links[model_.fans[f].n_points + j].impulse;
        }
        sum_wrenches(wrench);
    };
    const ObstacleMotion::Accuracy accuracy{.tolerance = between_faces ? faces_agree : 1e-14,
                                            .is_costly = between_faces != nullptr};
    const double error = now_.motion.solve(step.begin, touched_, accuracy, std::cref(response));  // cref: no copy
    // With contacts between faces the error is not judged here. Where friction wedges faces and obstacle the balance
    // may have no solution, whatever the step, and no scale makes the error of the rates comparable: momenta vanish
    // there, impulses do not. What it does is an energy. correct_work() adds it to the impact work, and the gate
    // contact_injection judges the sum of what is positive in it.
    if (between_faces) return;
    report.residual = std::max(report.residual, error);
    // a body squeezed with friction has several solutions, or none, and its fan may jump between them; in a smaller
    // step they are distinct
    if (error > max_residual) report.reject(Rejection::not_converged, model_.mesh.corner(contacts.front().corner));
}

void VertexObstacles::sum_wrenches(std::vector<Vec3>& wrench) const {
    now_.contacts.sum_wrenches([&](std::size_t i) -> const Vec2& { return now_.impulse[i]; }, wrench);
}

/// [m/s] Of the body at the contact, under the present impulses.
Vec2 VertexObstacles::end_velocity_at(const ObstacleContact& contact, const ExplicitStep& step,
                                      VertexSolver::Workspace& work) const {
    return contact.of_body([&](Index c) -> Vec2 {
        const Index f = model_.fan_of_corner[c];
        solver_.solve(f, step, work);
        const auto corners = model_.corners(model_.fans[f]);
        return work.fan.result.velocity[place_among(corners, c)];
    });
}

/// A contact on an edge shares its impulse P between the two fans at the ends, which respond with the velocity w(P) of
/// the point in contact. One contact after the other is solved exactly for w = w_now + mobility (P - P_now). The
/// mobility is the last secant, exact at once where the fans stay bonded; after some sweeps the largest secant, with
/// which the iteration contracts.
void VertexObstacles::solve_edges(const ExplicitStep& step, VertexSolver::Workspace& work, StepReport& report) {
    const auto contacts = now_.contacts.on_edges();
    edges_.clear();
    for (const ObstacleContact& e : contacts)
        edges_.push_back({.mobility = step.mobility * ((1 - e.share) * (1 - e.share) / model_.fans[e.fan].mass +
                                                       e.share * e.share / model_.fans[e.second_fan].mass)});
    double change = 1, largest = 0;
    for (int sweep = 0; sweep < max_sweeps && change > edge_tolerance * largest && !contacts.empty(); ++sweep) {
        change = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const ObstacleContact& contact = contacts[i];
            EdgeContact& edge = edges_[i];
            Vec2& impulse = now_.impulse[now_.contacts.n_at_corners() + i];
            const Vec2 velocity = end_velocity_at(contact, step, work);
            const double secant = edge.last_change.dot(velocity - edge.last_velocity) / edge.last_change.squaredNorm();
            if (secant > 0 && std::isfinite(secant))
                edge.mobility = sweep < fast_sweeps ? secant : std::max(edge.mobility, secant);
            const CohesiveLaw& law = model_.obstacles[contact.obstacle].contact;
            edge_.problem.drift_time = step.drift_time;
            edge_.problem.bodies = {{.velocity = velocity_at(step.begin.obstacles[contact.obstacle].velocity, contact),
                                     .free_velocity = velocity_at(now_.motion.rate()[contact.obstacle], contact),
                                     .inverse_mass = Vec2::Zero()},
                                    {.velocity = contact.of_body([&](Index c) -> Vec2 {
                                         return step.begin.velocity[step.begin.node_of_corner[c]];
                                     }),
                                     .free_velocity = velocity - edge.mobility * impulse,
                                     .inverse_mass = Vec2::Constant(edge.mobility)}};
            edge_.problem.links = {{.before = 0,
                                    .after = 1,
                                    .normal = contact.normal,
                                    .u_N = contact.gap,
                                    .u_T = 0,
                                    .cohesive = 0,
                                    .gamma = 0,
                                    .friction = law.friction,
                                    .restitution = law.restitution,
                                    .unbreakable = false}};
            work.solver.solve(edge_.problem, edge_.result);
            edge.found = edge_.result.links.front();
            edge.last_velocity = velocity;
            edge.last_change = edge.found.impulse - impulse;
            impulse = edge.found.impulse;
            change = std::max(change, edge.last_change.norm());
            largest = std::max(largest, impulse.norm());
        }
    }
    if (change <= edge_tolerance * largest || contacts.empty()) return;
    report.residual = std::max(report.residual, change / largest);
    if (change > max_residual * largest)
        report.reject(Rejection::not_converged, model_.mesh.corner(contacts.front().corner));
}

/// The works of the contacts have the rates with which the body was solved; the obstacle has those of its impulses.
void VertexObstacles::correct_work(const State& end, StepReport& report) const {
    for (std::size_t o = 0; o < wrench_.size(); ++o)
        for (int k = 0; k < 3; ++k) {
            if (!model_.obstacles[o].is_free(k)) continue;
            account_correction(0.5 * wrench_[o][k] * (end.obstacles[o].velocity[k] - now_.motion.rate()[o][k]), report);
        }
}

void VertexObstacles::finish(const ExplicitStep& step, StepReport& report) {
    const State &begin = step.begin, &end = step.end;
    const auto rate_at_begin = [&](const ObstacleContact& contact) -> Vec2 {
        return contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }) -
               velocity_at(begin.obstacles[contact.obstacle].velocity, contact);
    };
    for (std::size_t i = 0; i < edges_.size(); ++i) {
        const ObstacleContact& contact = now_.contacts.on_edges()[i];
        const LinkResult& found = edges_[i].found;
        const Vec2 n = contact.normal;
        const Vec2 before = rate_at_begin(contact);
        const Vec2 after = contact.of_body([&](Index c) -> Vec2 { return end.velocity[end.node_of_corner[c]]; }) -
                           velocity_at(now_.motion.rate()[contact.obstacle], contact);
        const double rate_error = (edge_tolerance + report.residual) * (before.norm() + after.norm());  // [m/s]
        account_contact(
            {found.contact, found.friction_part, 0.5 * n.dot(before + after), 0.5 * turned_left(n).dot(before + after),
             rate_error, contact.gap + step.drift_time * n.dot(after)},
            report);
    }
    for (const ObstacleContact& contact : now_.contacts.all())
        report.add_approach(contact.gap, step.drift_time, contact.normal.dot(rate_at_begin(contact)),
                            begin.obstacles[contact.obstacle].pose.position + contact.arm);
    sum_wrenches(wrench_);
    now_.motion.finish(begin, wrench_, step.end, report);
    if (!model_.contact_of_pair.empty()) correct_work(step.end, report);
}

}  // namespace knap
