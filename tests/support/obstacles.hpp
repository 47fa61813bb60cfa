#pragma once
// Rigid obstacles for small bodies.
#include "model/obstacle.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <numbers>

namespace knap::tests {

inline Obstacle platen(const Vec2& on, const Vec2& normal, const CohesiveLaw& contact = {}) {
    Obstacle made;
    made.name = "platen";
    made.outline = {.kind = Outline::Kind::half_plane, .normal = normal.normalized()};
    made.start.position = on;
    made.contact = contact;
    made.contact.sigma_c = 0;
    return made;
}

inline void set_free(Obstacle& obstacle, double density, double thickness = 1) {
    obstacle.mass = density * thickness * obstacle.outline.area();
    obstacle.inertia = density * thickness * obstacle.outline.second_moment();
    for (Drive& drive : obstacle.drive) drive.kind = Drive::Kind::free;
}

/// A free disc of mass 1 and density 1/area.
inline Obstacle boulder(const Vec2& centre, double radius, const Vec2& velocity, const CohesiveLaw& contact = {}) {
    Obstacle made;
    made.name = "boulder";
    made.outline = {.kind = Outline::Kind::disc, .radius = radius};
    made.start.position = centre;
    made.contact = contact;
    made.contact.sigma_c = 0;
    set_free(made, 1 / made.outline.area());
    made.initial_velocity.head<2>() = velocity;
    return made;
}

inline Obstacle polygon(const std::vector<Vec2>& points, const CohesiveLaw& contact = {}) {
    Obstacle made;
    made.name = "polygon";
    made.outline.kind = Outline::Kind::polygon;
    made.start.position = centroid(points);
    for (const Vec2& p : points) made.outline.points.push_back(p - made.start.position);
    made.contact = contact;
    made.contact.sigma_c = 0;
    return made;
}

/// A free block of 1 x 1 m to meet them, rho = 1, E = 100, of 4 x 4 squares.
inline ModelInput free_block(int order, const CohesiveLaw& law) {
    ModelInput input;
    input.mesh = bar_mesh(4, 4, 1, 1);
    input.mesh.order = order;
    input.materials = {{.density = 1, .E = 100, .nu = 0.2}};
    input.laws = {law};
    input.law_of_pair = {{0}};
    return input;
}

inline Drive driven(double velocity, TimeFunction history = {}) {
    return {.kind = Drive::Kind::velocity, .value = velocity, .history = std::move(history)};
}

/// The balance of energy and the signs of the works of impacts and friction, as parts of the largest energy, and the laws of the interfaces.
inline void check_books(const Run& run, double energy, double work) {
    const double scale = run.ledger.largest_energy();
    CHECK(run.ledger.largest_residual() <= energy * scale);
    CHECK(run.ledger.worst().worst_friction_work <= work * scale);
    CHECK(run.ledger.worst().worst_impact_work <= work * scale);
    CHECK(run.ledger.worst().residual <= 1e-10);
}

}  // namespace knap::tests
