#pragma once
// Large rotations: the frame of an interface point over an implicit step.
//
// It turns by the angle a of its fan (fan_frame), and the impulses of the point have the directions of its middle,
// n = R(a/2) R_point N. An opening u that turns with the frame has the rate
//
//     [u+ - u]/h = tan(a/2)/h turned_left([u+] + [u])
//
// in it, so the rate of the opening along (N, T) is that of the sides less this one: where a body turns as a whole its
// openings stay. All points of a fan have one angle, since closed points round a vertex would contradict each other
// otherwise; the openings of a point that turns otherwise, between pieces, follow its own.
//
// An impulse P acts on both sides where these are, so it has a moment about the point where they are apart along T; its
// work P . tan(a/2) turned_left([u+] + [u]) is the defect of rotation.
#include "stepper/implicit/piece_frames.hpp"

namespace knap {

/// Of a point.
struct PointTurn {
    Rotation middle = {};           // from its frame in the undeformed body to that in the middle of the step
    Vec2 convected = Vec2::Zero();  // [m/s] (N, T): rate of an opening that turns with it
};

class TurnedPoints {
public:
    explicit TurnedPoints(const Model& model) : model_(model) {}

    /// A step of h [s] with these rates [m/s] per corner.
    void set(const State& begin, double h, const std::vector<Vec2>& corner_rate);
    PointTurn of(Index fan, const FanPoint& point) const;
    /// From the undeformed body to the middle of the step.
    Rotation of_fan(Index fan) const {
        return composed(half_of(turn(fan)), fan_frame(model_, *begin_, model_.fans[fan]));
    }

private:
    Rotation turn(Index fan) const {
        return from_to(fan_frame(model_, *begin_, model_.fans[fan]), fan_frame(model_, end_, model_.fans[fan]));
    }

    const Model& model_;
    const State* begin_ = nullptr;
    double h_ = 0;
    State end_;  // displacements, a node per corner
};

}  // namespace knap
