#include "model/obstacle.hpp"

namespace knap {

ObstacleState initial_state(const Obstacle& obstacle) {
    ObstacleState state{.pose = obstacle.start};
    for (int k = 0; k < 3; ++k) {
        const Drive& drive = obstacle.drive[k];
        if (drive.kind == Drive::Kind::free) state.velocity[k] = obstacle.initial_velocity[k];
        if (drive.kind == Drive::Kind::velocity) state.velocity[k] = drive.value * drive.history(0);
    }
    return state;
}

void move(const Obstacle& obstacle, const Vec3& change, ObstacleState& state) {
    state.moved += change;
    state.pose.position = obstacle.start.position + state.moved.head<2>();
    state.pose.angle = obstacle.start.angle + state.moved.z();
}

Vec3 force_at(const Obstacle& obstacle, double t) {
    Vec3 force = Vec3::Zero();
    for (const ObstacleForce& each : obstacle.forces) force += each.history(t) * each.value;
    for (int k = 0; k < 3; ++k)
        if (!obstacle.is_free(k)) force[k] = 0;
    return force;
}

double kinetic_energy(const Obstacle& obstacle, const Vec3& velocity) {
    double energy = 0;
    for (int k = 0; k < 3; ++k)
        if (obstacle.is_free(k)) energy += 0.5 * obstacle.inertia_of(k) * velocity[k] * velocity[k];
    return energy;
}

}  // namespace knap
