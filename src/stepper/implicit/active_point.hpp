#pragma once
// An interface point of an active fan, or a contact with an obstacle, in the equations of an implicit step.
#include "law/point_law.hpp"
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/implicit/implicit_bulk.hpp"
#include "stepper/implicit/turned_points.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

constexpr Index at_obstacle = -1, between_faces = -2;  // ActivePoint::fan of contacts

constexpr double ramp_share = 0.01;  // of its stiffness, so that 10 times it are the stiffness of usual springs

struct ActivePoint {
    PointSides sides;
    Index fan = at_obstacle;  // into Model::fans, points of a fan in succession; or a contact
    Vec2 normal;
    PointLaw law;
    Multipliers multipliers = {};
    PointResponse response = {};
    Vec2 rate = Vec2::Zero();          // [m/s] (w_N, w_T)
    Vec2 support_rate = Vec2::Zero();  // [m/s] (N, T) of the obstacle, or of an opening that turns with its frame
    double mass = 0;                   // [kg] that an impulse between the two sides moves: scale of impulses over rates
    double ramp_stiffness = 0;         // [kg] of the steepest ramp of its fan
    bool is_held = false;              // along its normal, on all sides of the body

    Vec2 in_frame(const Vec2& a) const { return {normal.dot(a), turned_left(normal).dot(a)}; }
    Vec2 out_of_frame(const Vec2& a) const { return a.x() * normal + a.y() * turned_left(normal); }
    Eigen::Matrix2d axes() const { return (Eigen::Matrix2d() << normal, turned_left(normal)).finished(); }
    /// (N, T) of the difference of a nodal field between the two sides.
    Vec2 across(const std::vector<Vec2>& of_node) const { return in_frame(sides.jump(of_node)); }
    Vec2 rate_at(const std::vector<Vec2>& rate) const { return across(rate) - support_rate; }
    Vec2 impulse() const { return out_of_frame({response.normal(law), response.tangential}); }  // [N s] q
    /// Its multipliers on springs of so many times the stiffness of the body. Redundant points round a vertex share
    /// their forces by the stiffness of its ramps, which multipliers on much softer springs would follow slowly.
    Multipliers augmented(double augmentation) const {
        return on_springs(augmentation * std::max(mass, ramp_share * ramp_stiffness));
    }
    Multipliers softened() const { return on_springs(mass); }
    Multipliers on_springs(double rho) const {
        Multipliers at = multipliers;
        at.rho_N = rho;
        if (!std::isinf(at.rho_T)) at.rho_T = rho;
        return at;
    }
    double pull() const { return law.strength * response.cohesion_theta * response.pull; }  // [N s] of cohesion along N
    /// (p, q_T) [N s] at a rate by the equations of the piece of its response.
    Vec2 impulse_of_piece(const Vec2& at_rate) const {
        const double contact =
            response.closed ? multipliers.contact - multipliers.rho_N * (at_rate.x() - law.contact.rate) : 0;
        if (response.sticks && !std::isinf(multipliers.rho_T))
            return {contact, multipliers.tangential - multipliers.rho_T * (at_rate.y() - response.kink)};
        const double rubs = multipliers.friction_follows ? law.rubbing_slope(response.contact) *
                                                               response.friction_sign * (contact - response.contact)
                                                         : 0;
        return {contact, response.tangential - rubs};
    }
    /// Its sides move as one.
    bool is_stationary() const {
        return response.closed && response.sticks && law.contact.rate == 0 && response.kink == 0;
    }
};

/// Of a tangent: all but the friction that follows the contact impulse.
inline Eigen::Matrix2d symmetric_part(Eigen::Matrix2d D) {
    if (D(1, 0) != D(0, 1)) D(0, 1) = D(1, 0) = 0;
    return D;
}

/// [N s] Between the bounds of their friction and those of Coulomb's law.
inline double largest_friction_lag(const std::vector<ActivePoint>& points) {
    double largest = 0;
    for (const ActivePoint& point : points)
        if (const Multipliers& at = point.multipliers; !at.friction_follows)
            largest = std::max(largest, point.law.rubbing_between(point.response.contact, at.pressed));
    return largest;
}

/// [N s] The pull that the contact of a point balances: its own, and what the contact of the other point of the same
/// face leaves, since the two share what presses on both in any way. `active_of`: into `points`, per fan point, or -1.
double pull_on_contact(const Model& model, const std::vector<ActivePoint>& points, const std::vector<Index>& active_of,
                       const ActivePoint& point);

/// The end of the points of the fan whose first one is `first`.
inline std::size_t end_of_fan(const std::vector<ActivePoint>& points, std::size_t first) {
    std::size_t end = first;
    while (end < points.size() && points[end].fan == points[first].fan) ++end;
    return end;
}

/// Of a fan, with its law over the step; all but its mass. `turn`: of large rotations.
ActivePoint interface_point(const Model& model, const StepContext& step, const CornerPartition& nodes, Index fan,
                            Index fan_point, const PointTurn& turn = {});

/// A contact with an obstacle that moves with the rate `obstacle_rate` over the step, as a point.
ActivePoint obstacle_point(const Model& model, const StepContext& step, const CornerPartition& nodes,
                           const ObstacleContact& contact, const Vec3& obstacle_rate);
/// [N s] The impulses of contacts with obstacles in the step before, for a step of the kick [s]: where it starts.
void guess_impulses(std::span<const ObstacleContact> contacts, const State& begin, double kick, std::span<Vec2> guess);
/// Into State::obstacle_contacts; `lasting` [-]: the size of the step over its kick.
void store_impulses(std::span<const ObstacleContact> contacts, std::span<const ActivePoint> points, double lasting,
                    State& end);

/// [m/s] V_N of two sides, or zero where it is rounding: no w would meet the bound that follows from it.
inline double normal_rate(const Vec2& normal, const Vec2& first, const Vec2& second) {
    const double rate = normal.dot(second - first);
    return std::abs(rate) <= rate_rounding * (first.norm() + second.norm()) ? 0 : rate;
}

/// Components (N, T) of its rate that are prescribed on all sides: no contact forms, and the rate alone decides
/// friction.
void apply_prescribed(const CornerPartition& nodes, ActivePoint& point);

}  // namespace knap
