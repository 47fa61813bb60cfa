// Rigid obstacles beside the explicit bulk, where a contact reaches beyond a fan: free obstacles, and corners of obstacles on edges of the body.
#include "stepper/common/point_work.hpp"
#include "stepper/explicit/vertex_scheme.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace knap {
namespace {

constexpr double max_error = 1e-10;      // of the largest impulse: the gate of every run
constexpr double edge_tolerance = 1e-14;  // likewise
constexpr int swift_sweeps = 10, max_sweeps = 500;

}  // namespace

void VertexScheme::find_obstacle_velocities(const State& begin, const FreeMotion& free, StepReport& report) {
    const std::vector<ObstacleContact>& contacts = contacts_.all();
    if (!contacts_.find_free(touched_)) return;

    std::vector<Index>& fans = touching_fans_;
    fans.clear();
    for (std::size_t i = 0; i < contacts_.n_at_corners(); ++i)
        if (touched_[contacts[i].obstacle] && (fans.empty() || fans.back() != contacts[i].fan)) fans.push_back(contacts[i].fan);
    Workspace& work = workspaces_.front();
    const auto response = [&](std::vector<Vec3>& wrench) {
        StepReport of_trial;
        find_edge_impulses(begin, free, of_trial);
        for (const Index f : fans) {
            assemble_problem(f, begin, free, work.problem);
            solve(f, begin, work);
            const auto of_fan = contacts_.of_fan(f);
            for (std::size_t j = 0; j < of_fan.size(); ++j)
                contact_impulse_[&of_fan[j] - contacts.data()] = work.problem.links[model_.fans[f].n_points + j].impulse;
        }
        wrench = contact_wrenches();
    };
    const double error = motion_.solve(begin, touched_, 1e-14, std::cref(response));  // cref: nothing is copied
    report.residual = std::max(report.residual, error);
    if (error <= max_error) return;
    // a body squeezed with friction has several solutions, or none, and which one its fan finds may jump: smaller steps tell them apart
    report.rejection = Rejection::not_converged;
    report.where = model_.mesh.corner(contacts.front().corner);
}

const std::vector<Vec3>& VertexScheme::contact_wrenches() {
    contacts_.sum_wrenches([&](std::size_t i) -> const Vec2& { return contact_impulse_[i]; }, wrench_);
    return wrench_;
}

Vec2 VertexScheme::edge_impulse_on(Index corner) const {
    Vec2 sum = Vec2::Zero();
    for (std::size_t i = contacts_.n_at_corners(); i < contacts_.all().size(); ++i) {
        const ObstacleContact& contact = contacts_.all()[i];
        if (contact.corner == corner) sum += (1 - contact.share) * contact_impulse_[i];
        if (contact.beside == corner) sum += contact.share * contact_impulse_[i];
    }
    return sum;
}

/// [m/s] Of the body at the contact, with the impulses as they are.
Vec2 VertexScheme::end_velocity_at(const ObstacleContact& contact, const State& begin, const FreeMotion& free, Workspace& work) const {
    return contact.of_body([&](Index c) -> Vec2 {
        const Index f = model_.fan_of_corner[c];
        assemble_problem(f, begin, free, work.problem);
        solve(f, begin, work);
        const Index* corner = &model_.fan_corners[model_.fans[f].first_corner];
        return work.problem.bodies[std::find(corner, corner + model_.fans[f].n_corners, c) - corner].end_velocity;
    });
}

/// A contact on an edge shares its impulse P between the two fans at the ends, which answer with the velocity w(P) of the point in contact. One contact after
/// the other is solved exactly for w = w_now + mobility (P - P_now), the mobility being the last secant, exact at once where the fans stay in one piece; later
/// the largest one, with which it contracts.
void VertexScheme::find_edge_impulses(const State& begin, const FreeMotion& free, StepReport& report) {
    const auto edges = contacts_.on_edges();
    edge_links_.resize(edges.size());
    edge_answers_.clear();
    for (const ObstacleContact& e : edges)
        edge_answers_.push_back({.mobility = (1 - e.share) * (1 - e.share) / model_.fans[e.fan].mass + e.share * e.share / model_.fans[e.fan_beside].mass});
    Workspace& work = workspaces_.front();
    FanProblem& single = edge_problem_;
    double change = 1, largest = 0;
    for (int sweep = 0; sweep < max_sweeps && change > edge_tolerance * largest && !edges.empty(); ++sweep) {
        change = 0;
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const ObstacleContact& contact = edges[i];
            auto& [mobility, last_velocity, last_change] = edge_answers_[i];
            Vec2& impulse = contact_impulse_[contacts_.n_at_corners() + i];
            const Vec2 velocity = end_velocity_at(contact, begin, free, work);
            const double secant = last_change.dot(velocity - last_velocity) / last_change.squaredNorm();
            if (secant > 0 && std::isfinite(secant)) mobility = sweep < swift_sweeps ? secant : std::max(mobility, secant);
            const CohesiveLaw& law = model_.obstacles[contact.obstacle].contact;
            single.drift_time = free.drift_time;
            single.bodies = {{.velocity = velocity_at(begin.obstacles[contact.obstacle].velocity, contact),
                              .free_velocity = velocity_at(motion_.rate()[contact.obstacle], contact),
                              .inverse_mass = Vec2::Zero(),
                              .end_velocity = Vec2::Zero()},
                             {.velocity = contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }),
                              .free_velocity = velocity - mobility * impulse,
                              .inverse_mass = Vec2::Constant(mobility),
                              .end_velocity = Vec2::Zero()}};
            single.links = {{.before = 0, .after = 1, .normal = contact.normal, .u_N = contact.gap, .u_T = 0, .cohesive = 0, .gamma = 0,
                             .friction = law.friction, .restitution = law.restitution, .unbreakable = false}};
            work.solver.solve(single);
            edge_links_[i] = single.links.front();
            last_velocity = velocity;
            last_change = edge_links_[i].impulse - impulse;
            impulse = edge_links_[i].impulse;
            change = std::max(change, last_change.norm());
            largest = std::max(largest, impulse.norm());
        }
    }
    if (change <= edge_tolerance * largest || edges.empty()) return;
    report.residual = std::max(report.residual, change / largest);
    if (change <= max_error * largest) return;
    report.rejection = Rejection::not_converged;
    report.where = model_.mesh.corner(edges.front().corner);
}

void VertexScheme::account_edges(const State& begin, const State& end, const FreeMotion& free, StepReport& report) const {
    for (std::size_t i = 0; i < contacts_.on_edges().size(); ++i) {
        const ObstacleContact& contact = contacts_.on_edges()[i];
        const FanLink& link = edge_links_[i];
        const Vec2 before = contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }) -
                            velocity_at(begin.obstacles[contact.obstacle].velocity, contact);
        const Vec2 after = contact.of_body([&](Index c) -> Vec2 { return end.velocity[end.node_of_corner[c]]; }) -
                           velocity_at(motion_.rate()[contact.obstacle], contact);
        const double rate_error = (edge_tolerance + report.residual) * (before.norm() + after.norm());  // [m/s]
        account_contact({link.contact, link.friction_part, 0.5 * link.normal.dot(before + after), 0.5 * link.tangent().dot(before + after), rate_error,
                         link.u_N + free.drift_time * link.normal.dot(after)},
                        report);
    }
}

}  // namespace knap
