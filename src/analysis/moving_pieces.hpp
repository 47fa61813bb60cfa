#pragma once
// The pieces of a scene that move: fragments of the body and free obstacles, with their motion and their height above
// the ground. Trajectories and collectors follow them.
#include "analysis/fragments.hpp"

namespace knap {

struct MovingPiece {
    Index label, n_triangles;            // lowest triangle of a fragment; -1 - number of an obstacle
    double mass, area, inertia, radius;  // [kg], [m2], [kg m2], [m] no point of it is farther from its centre
    Vec2 centre, velocity, start;        // [m], [m/s], [m] centre in the undeformed body
    double spin;                         // [rad/s]

    double diameter() const;                                                   // [m] of the circle of the same area
    double energy_of_rotation() const { return 0.5 * inertia * spin * spin; }  // [J]
    double energy() const { return 0.5 * mass * velocity.squaredNorm() + energy_of_rotation(); }  // [J]
    /// NaN of the other kind.
    double label_of_fragment() const;
    double number_of_obstacle() const;
};

struct MovingPieces {
    std::vector<MovingPiece> pieces;       // free obstacles, then fragments, the heaviest first
    std::vector<Index> piece_of_triangle;  // -1: the triangle was excavated
};
MovingPieces find_moving_pieces(const Model& model, const State& state);

/// [m] The highest surface of an obstacle that does not move freely, at x and not above y; NaN where there is none.
double ground_below(const Model& model, const State& state, const Vec2& place);

/// A line of trajectories.csv.
struct TrajectoryPoint {
    double time;  // [s]
    const MovingPiece& piece;
    double height;  // [m]
};
std::span<const Measure<TrajectoryPoint>> trajectory_columns();
/// Of the hundred heaviest fragments and as many free obstacles.
std::vector<std::vector<double>> trajectory_lines(const Model& model, const State& state);

}  // namespace knap
