#include "stepper/implicit/active_point.hpp"

#include "base/tolerance.hpp"
#include "stepper/common/changing_friction.hpp"

#include <cmath>

namespace knap {
namespace {

// [-] kappa/delta_c. A steeper ramp counts as an opening without one: rounding of the openings would be forces, and its
// energy is less than a millionth of G_c.
constexpr double steepest_ramp = 1e-6;
const CohesiveLaw of_obstacles;  // without cohesion
// [-] Of a slip, with large rotations: strains turn the frames of the points of a vertex by as much against each other,
// so their gaps contradict each other.
constexpr double closed_beside_slip = 1e-3;

}  // namespace

ActivePoint interface_point(const Model& model, const StepContext& step, const CornerPartition& nodes, Index fan,
                            Index fan_point, const PointTurn& turn) {
    const FanPoint& at = model.fan_points[fan_point];
    const CohesiveLaw& law = law_of(model, *step.begin, at);
    const auto velocity = [&](Index corner) -> Vec2 {
        return corner == rigid_support ? Vec2::Zero() : step.begin->velocity[step.begin->node_of_corner[corner]];
    };
    const Vec2 u = opening(model, *step.begin, at.point);
    const Vec2 normal = turn.middle.turned(at.normal);
    const double u_rate = normal.dot(velocity(at.after) - velocity(at.before)) - turn.convected.x();
    double beta = at.cracked || law.sigma_c == 0 ? 0 : cohesion(model, *step.begin, at.point);
    if (beta < relative_tolerance) beta = 0;  // what is left is rounding
    const PointState* known = state_of(model, *step.begin, at.point);
    const double kappa = known ? law.ramp(beta, known->largest_opening) : 0;
    const double ramp = kappa > steepest_ramp * law.delta_c() ? kappa : 0;
    // With vertical unloading what is at kappa but for rounding is held where it is. (Held at a shifted kappa it would
    // contradict the points of its vertex that return to zero, and multipliers would march.)
    const bool drops = ramp > 0 && law.unloading == Unloading::vertical;
    const double touching = touching_gap(model, *step.begin, at),
                 below = drops ? law.equivalent_opening(u.x(), u.y()) - kappa : 0;
    ActivePoint made{
        .sides = nodes.sides(model, fan_point),
        .fan = fan,
        .normal = normal,
        .law = {.u_N = u.x(),
                .u_T = u.y(),
                .strength = beta > 0 ? step.kick() * at.area * step.begin->strength_factor(fan) * law.sigma_c : 0,
                .cohesion = beta,
                .material = &law,
                .ramp = ramp,
                .drops = drops,
                .below = below < -touching ? below : 0,
                .friction = law.friction_after(known ? known->slid : 0),
                .pressed = law.pressed_friction(step.kick() * pressed_area(model, *step.begin, model.fans[fan], at)),
                .contact =
                    contact_bound_theta(u.x(), u_rate, law.restitution_at(beta), step.h, step.theta,
                                        touching + (model.large_rotation ? closed_beside_slip * std::abs(u.y()) : 0)),
                .step = &step},
        .support_rate = turn.convected};
    apply_prescribed(nodes, made);
    made.law.set_staircase();
    return made;
}

ActivePoint obstacle_point(const Model& model, const StepContext& step, const CornerPartition& nodes,
                           const ObstacleContact& contact, const Vec3& obstacle_rate) {
    const State& begin = *step.begin;
    const Obstacle& obstacle = model.obstacles[contact.obstacle];
    const ContactLaw& law = obstacle.law_at(contact.arm, begin.obstacles[contact.obstacle].pose.angle);
    const Index node = nodes.node_of_corner[contact.corner];
    const Vec2 of_body = contact.of_body([&](Index c) -> Vec2 { return begin.velocity[begin.node_of_corner[c]]; }),
               of_obstacle = velocity_at(begin.obstacles[contact.obstacle].velocity, contact);
    const double rate = normal_rate(contact.normal, of_obstacle, of_body);
    const bool slip_follows_normal = obstacle.is_free() && contact.is_led_along(nodes.prescribed[node]);
    ActivePoint made{.sides = {.fan_point = -1,
                               .before = -1,
                               .after = node,
                               .second_node = contact.is_on_edge() ? nodes.node_of_corner[contact.second_corner] : -1,
                               .share = contact.share,
                               .leaf_corner = contact.corner},
                     .normal = contact.normal,
                     .law = {.u_N = contact.gap,
                             .u_T = 0,
                             .strength = 0,
                             .cohesion = 0,
                             .material = &of_obstacles,
                             .friction = slip_follows_normal ? 0 : law.friction,
                             .contact = contact_bound_theta(contact.gap, rate, law.restitution, step.h, step.theta, 0),
                             .step = &step}};
    made.support_rate = made.in_frame(velocity_at(obstacle_rate, contact));
    apply_prescribed(nodes, made);
    made.law.set_staircase();
    return made;
}

double pull_on_contact(const Model& model, const std::vector<ActivePoint>& points, const std::vector<Index>& active_of,
                       const ActivePoint& point) {
    const double pull = point.pull();
    if (!(pull > 0 && point.response.contact > 0 && point.response.friction_part != 0)) return pull;
    const FanPoint* const other = same_face_beyond(model, model.fan_points[point.sides.fan_point]);
    const Index active = other ? active_of[other - model.fan_points.data()] : -1;
    return active < 0 ? pull : pull + std::max(0.0, points[active].pull() - points[active].response.contact);
}

void guess_impulses(std::span<const ObstacleContact> contacts, const State& begin, double kick, std::span<Vec2> guess) {
    if (begin.last_step <= 0) return;
    std::vector<std::size_t> by_corner;
    ImpulsesBefore before(begin, by_corner);
    for (std::size_t i = 0; i < contacts.size(); ++i) guess[i] = kick / begin.last_step * before.next(contacts[i]);
}

void store_impulses(std::span<const ObstacleContact> contacts, std::span<const ActivePoint> points, double lasting,
                    State& end) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const ObstacleContact& contact = contacts[i];
        const PointResponse& q = points[i].response;
        end.obstacle_contacts.push_back(
            {contact.corner, contact.second_corner, contact.obstacle, lasting * q.contact, lasting * q.tangential});
    }
}

void apply_prescribed(const CornerPartition& nodes, ActivePoint& point) {
    std::array<bool, 2> prescribed{true, true}, along{false, false};  // x, y; N, T
    for (int k = 0; k < 2; ++k)
        for (const Index node :
             {point.sides.before, point.sides.after, point.sides.second_node, point.sides.before_too})
            prescribed[k] = prescribed[k] && nodes.is_prescribed(node, k);
    for (int k = 0; k < 2; ++k) {
        if (!prescribed[k]) continue;
        along[0] = along[0] || prescribed[1 - k] || std::abs(point.normal[k]) > 1 - 1e-9;
        along[1] = along[1] || prescribed[1 - k] || std::abs(point.normal[k]) < 1e-9;
    }
    if (along[0]) point.law.contact.may_touch = false, point.is_held = true;
    if (along[1] && (along[0] || !point.law.is_curved())) point.multipliers.rho_T = infinity;
}

}  // namespace knap
