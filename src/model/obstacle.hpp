#pragma once
// Rigid obstacles: platens, jaws, walls, a boulder. Each has a convex outline and three degrees of freedom, x, y and
// the angle about its origin (of a free obstacle: its centre of mass). A component is prescribed by a history, or free,
// with inertia and a force.
#include "material/cohesive_law.hpp"
#include "model/loads.hpp"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace knap {

/// Components x, y, angle of a rigid motion; or force, force, moment.
using Vec3 = Eigen::Vector3d;

struct Rotation {
    double cosine = 1, sine = 0;

    static Rotation by(double angle) { return {.cosine = std::cos(angle), .sine = std::sin(angle)}; }  // [rad]
    Vec2 turned(const Vec2& a) const { return sine == 0 ? a : Vec2(cosine * a + sine * turned_left(a)); }
    Vec2 turned_back(const Vec2& a) const { return sine == 0 ? a : Vec2(cosine * a - sine * turned_left(a)); }
};

/// Position and orientation of a rigid body in the plane.
struct Pose {
    Vec2 position = Vec2::Zero();  // [m] of its origin
    double angle = 0;              // [rad]
};

/// In the frame of the obstacle: the origin is the centre of mass, or lies on the border of a half plane.
struct Outline {
    enum class Kind { half_plane, disc, polygon };
    Kind kind = Kind::half_plane;
    Vec2 normal = Vec2(0, 1);  // of a half plane, outward
    double radius = 0;         // [m] of a disc
    std::vector<Vec2> points;  // [m] of a polygon, counterclockwise, convex

    double area() const;           // [m2]; 0 of a half plane, negative of a clockwise polygon
    double second_moment() const;  // [m4] polar, about the origin; 0 of a half plane
    double half_width() const;  // [m] half of the smallest distance of two parallel tangents; infinite of a half plane
};

/// Distance from a point to the surface of an obstacle.
struct SurfaceDistance {
    double gap;   // [m]; negative inside
    Vec2 normal;  // out of the obstacle
};

/// The outline of an obstacle in its place.
class ObstacleSurface {
public:
    ObstacleSurface(const Outline& outline, const Pose& pose);

    SurfaceDistance distance_to(const Vec2& point) const;
    /// The plane through a side of a polygon that a corner of the body near one of its corners touches, if it is as
    /// near as `tolerance` [m] to two sides or beyond their ends: of the sides that meet there the one from which it is
    /// further away after the motion [m] of the step. So a body that slides from one polygon to the next one passes the
    /// seam. Elsewhere, and of other outlines, as distance_to(point).
    SurfaceDistance distance_to(const Vec2& point, const Vec2& motion, double tolerance) const;
    /// A cheap test before distance_to: false only where the gap exceeds `reach` [m].
    bool may_reach(const Vec2& point, double reach) const;
    const Outline& outline() const { return *outline_; }
    const Vec2& position() const { return position_; }
    const Rotation& rotation() const { return rotation_; }
    /// [m] Of all points about the origin; infinite of a half plane.
    double radius() const { return outline_->kind == Outline::Kind::half_plane ? infinity : radius_; }

private:
    const Outline* outline_;
    Vec2 position_;  // [m]
    Rotation rotation_;
    Vec2 normal_;    // of a half plane
    double radius_;  // [m] of all points about the origin
};

/// The prescribed motion of one component.
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

struct ObstacleState {
    Pose pose;
    Vec3 moved = Vec3::Zero();     // [m, m, rad] since the start
    Vec3 velocity = Vec3::Zero();  // [m/s, m/s, rad/s]
    Vec3 reaction = Vec3::Zero();  // [N, N, N m] of the body on it, about its origin, mean over the last step

    template <class Archive>
    void serialize(Archive& archive) {
        archive(pose.position, pose.angle);
        for (Vec3* v : {&moved, &velocity, &reaction}) archive(v->x(), v->y(), v->z());
    }
};

/// [m/s] of the point of an obstacle at `arm` [m] from its origin.
inline Vec2 velocity_at(const Vec3& velocity, const Vec2& arm) {
    return velocity.head<2>() + velocity.z() * turned_left(arm);
}

/// Force and moment about the origin of a force or impulse at `arm`.
inline Vec3 wrench_of(const Vec2& force, const Vec2& arm) { return {force.x(), force.y(), cross(arm, force)}; }

ObstacleState initial_state(const Obstacle& obstacle);
/// Moves the obstacle by `change` [m, m, rad].
void move(const Obstacle& obstacle, const Vec3& change, ObstacleState& state);
/// [N, N, N m] of all forces at time t; 0 in prescribed components.
Vec3 force_at(const Obstacle& obstacle, double t);
/// [J] of the free components.
double kinetic_energy(const Obstacle& obstacle, const Vec3& velocity);

}  // namespace knap
