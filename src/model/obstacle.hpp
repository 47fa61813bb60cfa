#pragma once
// Rigid obstacles: platens, walls, a boulder, a terrain. The outline is convex or an open polyline; x, y and the angle
// about the origin (of a free obstacle: its centre of mass) are each prescribed by a history, or free, with inertia and
// a force.
#include "base/rotation.hpp"
#include "law/contact_law.hpp"
#include "model/loads.hpp"
#include "model/polyline.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace knap {

/// Position and orientation of a rigid body in the plane.
struct Pose {
    Vec2 position = Vec2::Zero();  // [m] of its origin
    double angle = 0;              // [rad]
};

/// In the frame of the obstacle: the origin is the centre of mass, or lies on the border of a half plane.
struct Outline {
    enum class Kind { half_plane, disc, polygon, polyline };
    Kind kind = Kind::half_plane;
    Vec2 normal = Vec2(0, 1);  // of a half plane, outward
    double radius = 0;         // [m] of a disc
    std::vector<Vec2> points;  // [m] of a polygon, counterclockwise, convex; of a polyline, ground on its left
    std::shared_ptr<const Polyline> line;  // of a polyline; or the surface that a polygon has together with others,
                                           // in its place (joined_polygons.hpp)
    Index owner = Polyline::nobody;        // of its sides in the line

    bool is_joined() const { return kind == Kind::polygon && line; }
    bool is_bounded() const { return kind == Kind::disc || kind == Kind::polygon; }

    double area() const;           // [m2]; 0 of a half plane, negative of a clockwise polygon
    double second_moment() const;  // [m4] polar, about the origin; 0 of a half plane
    double half_width() const;     // [m] half of the smallest distance of two parallel tangents; infinite if unbounded
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
    /// Calls visit(SurfaceDistance) for what the point may touch: that of a convex outline, of a line all its planes as
    /// near as `reach` and as deep as `depth` [m].
    template <class Visit>
    void visit_planes(const Vec2& point, const Vec2& motion, double tolerance, double reach, double depth,
                      const Visit& visit) const {
        if (!outline_->line) return visit(distance_to(point, motion, tolerance));
        outline_->line->visit_planes(line_.from(point), line_.rotation.turned_back(motion), tolerance, reach, depth,
                                     outline_->owner, [&](double gap, const Vec2& normal) {
                                         visit(SurfaceDistance{gap, line_.rotation.turned(normal)});
                                     });
    }
    /// Likewise for the sides of a line beside which the point lies, in front of them.
    template <class Visit>
    void visit_beside(const Vec2& point, double reach, const Visit& visit) const {
        outline_->line->visit_beside(line_.from(point), reach, outline_->owner, [&](double gap, const Vec2& normal) {
            visit(SurfaceDistance{gap, line_.rotation.turned(normal)});
        });
    }
    /// Calls visit(i) for the corners, of a line within `reach` [m] of a place that may touch edges, and others; of a
    /// polygon for all.
    template <class Visit>
    void visit_corners(const Vec2& place, double reach, const Visit& visit) const {
        const Polyline* const line = outline_->line.get();
        for (std::size_t i = 0; !line && i < outline_->points.size(); ++i) visit(i);
        if (!line) return;
        line->visit_points_near(line_.from(place), reach, [&](Index i) {
            if (line->is_corner(i) && line->owner_of_point(i) == outline_->owner) visit(static_cast<std::size_t>(i));
        });
    }
    /// [m] From the origin to a corner (visit_corners).
    Vec2 arm_of_corner(std::size_t i) const {
        if (!outline_->line) return rotation_.turned(outline_->points[i]);
        return line_.rotation.turned(outline_->line->point(static_cast<Index>(i))) + (line_.position - position_);
    }
    Vec2 corner(std::size_t i) const { return position_ + arm_of_corner(i); }  // [m] its place
    /// Place [m] of a point of the outline.
    Vec2 place(std::size_t i) const { return position_ + rotation_.turned(outline_->points[i]); }
    /// A side of a polygon, from point i to the next one.
    PlacedEdge side(std::size_t i) const { return placed_edge(place(i), place((i + 1) % outline_->points.size())); }
    /// The point of a disc or polygon that is furthest in a direction.
    Vec2 furthest(const Vec2& direction) const;
    /// The side of a polygon in front of which something is furthest; nearest(outward): its point that is nearest to a
    /// side.
    struct FurthestSide {
        std::size_t number;
        double gap;  // [m]
        Vec2 nearest;
    };
    FurthestSide furthest_side(const auto& nearest) const {
        FurthestSide found{0, -infinity, position_};
        for (std::size_t i = 0; i < outline_->points.size(); ++i) {
            const PlacedEdge at = side(i);
            const Vec2 x = nearest(at.outward);
            if (const double gap = at.outward.dot(x - at.start); gap > found.gap) found = {i, gap, x};
        }
        return found;
    }
    /// From corner i (visit_corners) to those before and after it; none beyond the ends of a line.
    template <class Visit>
    bool any_side_at(std::size_t i, const Visit& is_so) const {
        const std::vector<Vec2>& points = outline_->points;
        bool any = false;
        const auto look = [&](const Vec2& way, const Rotation& rotation) { any = any || is_so(rotation.turned(way)); };
        if (outline_->line)
            outline_->line->visit_sides_at(static_cast<Index>(i), [&](const Vec2& way) { look(way, line_.rotation); });
        else
            for (const std::size_t j : {i + 1, i + points.size() - 1})
                look(points[j % points.size()] - points[i], rotation_);
        return any;
    }
    /// Point i of the outline is its foremost one towards an edge with this normal: no side leaves it against the
    /// normal by more than the sine `widened` of an angle.
    bool protrudes(std::size_t i, const Vec2& outward, double widened = 0) const {
        return !any_side_at(i, [&](const Vec2& side) { return outward.dot(side) < -widened * side.norm(); });
    }
    /// A cheap test before distance_to: false only where the gap exceeds `reach` [m], or in a polyline the depth.
    bool may_reach(const Vec2& point, double reach) const;
    const Outline& outline() const { return *outline_; }
    const Vec2& position() const { return position_; }
    const Rotation& rotation() const { return rotation_; }
    /// [m] Of all points about the origin; infinite of what is not bounded.
    double radius() const { return outline_->is_bounded() ? radius_ : infinity; }

private:
    struct Frame {
        Vec2 position;  // [m]
        Rotation rotation;

        Vec2 from(const Vec2& place) const { return rotation.turned_back(place - position); }
    };

    const Outline* outline_;
    Vec2 position_;  // [m]
    Rotation rotation_;
    Frame line_;                             // of the line
    Vec2 normal_;                            // of a half plane
    double radius_;                          // [m] of all points about the origin
    Vec2 low_ = Vec2::Zero(), high_ = low_;  // [m] box of a polygon, in its frame
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

/// A part of a polyline with a law of its own.
struct SurfaceRange {
    double from, to;  // [m] x at the start
    ContactLaw law;
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
    ContactLaw contact;
    std::vector<SurfaceRange> ranges;  // ascending, apart; `contact` acts elsewhere

    bool is_free(int k) const { return drive[k].kind == Drive::Kind::free; }
    bool is_free() const { return is_free(0) || is_free(1) || is_free(2); }
    double inertia_of(int k) const { return k < 2 ? mass : inertia; }
    /// At `arm` [m] from the origin, while the obstacle is turned by an angle.
    const ContactLaw& law_at(const Vec2& arm, double angle) const;
    void for_laws(const auto& visit) {
        visit(contact);
        for (SurfaceRange& range : ranges) visit(range.law);
    }
    double largest_restitution() const;
    bool any_law(const auto& is_so) const {
        return is_so(contact) || std::ranges::any_of(ranges, is_so, &SurfaceRange::law);
    }
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
