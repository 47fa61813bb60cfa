#pragma once
// Rigid obstacles beside the body: platens, jaws, walls, a boulder. Each has three degrees of freedom, x, y and the angle about its origin (of a
// free one: its centre of mass); a component is prescribed by a history, or free, with inertia and a force.
#include "material/cohesive_law.hpp"
#include "model/loads.hpp"
#include "model/outline.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace knap {

/// Components x, y, angle of what moves rigidly.
using Vec3 = Eigen::Vector3d;

/// What is prescribed of one component.
struct Drive {
    enum class Kind { displacement, velocity, free };
    Kind kind = Kind::displacement;
    double value = 0;      // [m] or [rad], [m/s] or [rad/s]
    TimeFunction history;  // multiplies the value
};

/// [N, N, N m] on the free components, times a history.
struct ObstacleForce {
    Vec3 value;
    TimeFunction history;
};

struct Obstacle {
    std::string name;
    Outline outline;
    Pose start;
    std::array<Drive, 3> drive;
    double mass = 0;     // [kg] of a free component
    double inertia = 0;  // [kg m2] likewise
    std::vector<ObstacleForce> forces;
    Vec3 initial_velocity = Vec3::Zero();  // [m/s, m/s, rad/s] of free components
    CohesiveLaw contact;                   // friction and restitution; it has no cohesion

    bool is_free(int k) const { return drive[k].kind == Drive::Kind::free; }
    bool is_free() const { return is_free(0) || is_free(1) || is_free(2); }
    double inertia_of(int k) const { return k < 2 ? mass : inertia; }
};

/// Where an obstacle is and how it moves.
struct ObstacleState {
    Pose pose;
    Vec3 moved = Vec3::Zero();     // [m, m, rad] since the start
    Vec3 velocity = Vec3::Zero();  // [m/s, m/s, rad/s]
    Vec3 reaction = Vec3::Zero();  // [N, N, N m] of the body on it, mean over the last step, the moment about its origin

    template <class Archive>
    void serialize(Archive& archive) {
        archive(pose.position, pose.angle);
        for (Vec3* v : {&moved, &velocity, &reaction}) archive(v->x(), v->y(), v->z());
    }
};

/// Velocity [m/s] of the point of an obstacle at `arm` from its origin.
inline Vec2 velocity_at(const Vec3& velocity, const Vec2& arm) { return velocity.head<2>() + velocity.z() * turned_left(arm); }

/// What a force or an impulse at `arm` is for the obstacle.
inline Vec3 wrench_of(const Vec2& force, const Vec2& arm) { return {force.x(), force.y(), cross(arm, force)}; }

/// State at the start.
ObstacleState initial_state(const Obstacle& obstacle);

/// After moving by `change` [m, m, rad].
void move(const Obstacle& obstacle, const Vec3& change, ObstacleState& state);

/// [N, N, N m] of all forces at time t; 0 in prescribed components.
Vec3 force_at(const Obstacle& obstacle, double t);

/// Kinetic energy [J] of the free components.
double kinetic_energy(const Obstacle& obstacle, const Vec3& velocity);

}  // namespace knap
