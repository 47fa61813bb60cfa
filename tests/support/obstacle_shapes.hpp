#pragma once
// Rigid obstacles for small bodies: their shapes and how they move.
#include "mesh/polygon.hpp"
#include "model/obstacle.hpp"

namespace knap::tests {

inline Obstacle platen(const Vec2& on, const Vec2& normal, const ContactLaw& contact = {}) {
    Obstacle made;
    made.name = "platen";
    made.outline = {.kind = Outline::Kind::half_plane, .normal = normal.normalized()};
    made.start.position = on;
    made.contact = contact;
    return made;
}

inline void set_free(Obstacle& obstacle, double density, double thickness = 1) {
    obstacle.mass = density * thickness * obstacle.outline.area();
    obstacle.inertia = density * thickness * obstacle.outline.second_moment();
    for (Drive& drive : obstacle.drive) drive.kind = Drive::Kind::free;
}

/// A free disc of mass 1 and density 1/area.
inline Obstacle boulder(const Vec2& centre, double radius, const Vec2& velocity, const ContactLaw& contact = {}) {
    Obstacle made;
    made.name = "boulder";
    made.outline = {.kind = Outline::Kind::disc, .radius = radius};
    made.start.position = centre;
    made.contact = contact;
    set_free(made, 1 / made.outline.area());
    made.initial_velocity.head<2>() = velocity;
    return made;
}

inline Obstacle polygon(const std::vector<Vec2>& points, const ContactLaw& contact = {}) {
    Obstacle made;
    made.name = "polygon";
    made.outline.kind = Outline::Kind::polygon;
    made.start.position = centroid(points);
    for (const Vec2& p : points) made.outline.points.push_back(p - made.start.position);
    made.contact = contact;
    return made;
}

/// Open, with the ground on its left.
inline Obstacle terrain(std::vector<Vec2> points, const ContactLaw& contact = {}) {
    Obstacle made;
    made.name = "terrain";
    made.outline.kind = Outline::Kind::polyline;
    made.start.position = bounding_box(points).middle();
    for (Vec2& p : points) p -= made.start.position;
    made.outline.line = std::make_shared<const Polyline>(points);
    made.outline.points = std::move(points);
    made.contact = contact;
    return made;
}

inline Drive driven(double velocity, TimeFunction history = {}) {
    return {.kind = Drive::Kind::velocity, .value = velocity, .history = std::move(history)};
}

}  // namespace knap::tests
