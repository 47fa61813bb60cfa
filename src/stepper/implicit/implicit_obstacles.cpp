// Rigid obstacles in the implicit scheme: a contact is a point whose one side is given, and moves.
#include "stepper/implicit/implicit_scheme.hpp"

#include <algorithm>
#include <functional>

namespace knap {
namespace {

constexpr double tolerance = 1e-12;  // of the largest impulse

}  // namespace

/// A free obstacle moves as the body lets it: the body is solved for its rates until both agree.
void ImplicitScheme::find_obstacle_rates(const State& begin, double h, StepReport& report) {
    std::vector<std::uint8_t>& touched = touched_;
    touched.assign(model_.obstacles.size(), 0);
    for (const ObstacleContact& contact : contacts_.all()) touched[contact.obstacle] = model_.obstacles[contact.obstacle].is_free();
    if (std::find(touched.begin(), touched.end(), 1) == touched.end()) return;
    const auto response = [&](std::vector<Vec3>& wrench) {
        report.rejection = Rejection::none;  // of a trial
        solve_points(begin, h, report);
        wrench = contact_wrenches();
    };
    report.residual = obstacles_.solve(begin, touched, tolerance, std::cref(response));  // cref: nothing is copied
    report.rejection = Rejection::none;
}

const std::vector<Vec3>& ImplicitScheme::contact_wrenches() {
    std::vector<Vec3>& wrench = wrench_;
    wrench.assign(model_.obstacles.size(), Vec3::Zero());
    for (std::size_t i = 0; i < contacts_.all().size(); ++i) {
        const ObstacleContact& contact = contacts_.all()[i];
        wrench[contact.obstacle] -= wrench_of(contact_points()[i].impulse() / options_.theta, contact.arm);
    }
    return wrench;
}

ActivePoint ImplicitScheme::make_contact_point(const ObstacleContact& contact, const State& begin, double h) const {
    const CohesiveLaw& law = model_.obstacles[contact.obstacle].contact;
    ActivePoint made{.fan = -1,
                    .fan_point = -1,
                    .before = -1,
                    .after = partition_.node_of_corner[contact.corner],
                    .normal = contact.normal,
                    .leaf_corner = contact.corner,
                    .beside = contact.is_on_edge() ? partition_.node_of_corner[contact.beside] : -1,
                    .share = contact.share};
    made.mass = mass_between(made.before, made.after);
    if (contact.is_on_edge()) {
        const double s = contact.share, other = mass_between(made.before, made.beside);
        made.mass = 1 / ((1 - s) * (1 - s) / made.mass + s * s / other);
    }
    made.ground_rate = made.in_frame(velocity_at(obstacles_.rate()[contact.obstacle], contact));
    const Vec2 speed = contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }) -
                       velocity_at(begin.obstacles[contact.obstacle].velocity, contact);
    made.law = {.u_N = contact.gap,
                .u_T = 0,
                .strength = 0,
                .cohesion = 0,
                .material = &law,
                .friction = model_.obstacles[contact.obstacle].is_free() && contact.is_led_along(bulk_.prescribed()[made.after]) ? 0 : law.friction,
                .contact = contact_bound_theta(contact.gap, contact.normal.dot(speed), law.restitution, h, options_.theta, 0),
                .implicit_beta = false,
                .h = h,
                .theta = options_.theta};
    impose(made);
    made.law.set_staircase();
    return made;
}

void ImplicitScheme::guess_contacts() {
    const std::size_t first = points_.size() - contacts_.all().size();
    for (std::size_t i = 0; i < contacts_.all().size(); ++i) {
        ActivePoint& point = points_[first + i];
        point.law.contact_guess = point.law.contact.may_touch ? contact_guess_[i].x() : 0;
        point.law.tangential_guess = std::isinf(point.law.rho_T) ? 0 : contact_guess_[i].y();
    }
}

void ImplicitScheme::keep_contacts() {
    pushed_.assign(model_.mesh.n_corners(), Vec2::Zero());
    for (std::size_t i = 0; i < contacts_.all().size(); ++i) {
        const ActivePoint& point = contact_points()[i];
        contact_guess_[i] = {point.law.contact_guess, point.law.tangential_guess};
        const ObstacleContact& contact = contacts_.all()[i];
        pushed_[contact.corner] += (1 - contact.share) * point.impulse();
        if (contact.is_on_edge()) pushed_[contact.beside] += contact.share * point.impulse();
    }
}

}  // namespace knap
