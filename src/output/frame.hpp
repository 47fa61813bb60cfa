#pragma once
// One moment of a run as the writers and figures see it: plain arrays, made from (model, state) or read back from a run directory.
#include "base/vec.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace knap {

struct Model;
struct State;

enum class PointStatus : std::uint8_t {
    intact = 0,    // cohesion 1
    damaged = 1,   // 0 < cohesion < 1
    broken = 2,    // cohesion 0
    precrack = 3   // no cohesion from the start
};

inline constexpr Index n_outline_points = 96;

struct Frame {
    double time = 0;  // [s]
    double length_scale = 1;  // [m] diagonal of the reference body

    // bulk: triangle t owns corners 3t, 3t+1, 3t+2; one of second order is six of these
    std::vector<Vec2> position;      // [m] per corner, reference
    std::vector<Vec2> displacement;  // [m] per corner
    std::vector<Vec2> velocity;      // [m/s] per corner
    std::vector<Eigen::Vector3d> stress;  // [Pa] per triangle: xx, yy, xy
    std::vector<std::int32_t> region;     // per triangle
    std::vector<std::int32_t> grain;      // per triangle, -1 = in none; empty = there are none

    // interfaces: interface i owns points 2i, 2i+1 (its two ends); of second order each half is one
    std::vector<std::array<Index, 2>> side_a, side_b;  // per interface: the corner on each side at each end, -1 = support
    std::vector<Vec2> end_position;                    // [m] per point, reference
    std::vector<double> cohesion;                      // per point
    std::vector<double> opening, slip;                 // [m] per point
    std::vector<Vec2> traction;                        // [Pa] per point (N, T)
    std::vector<PointStatus> status;                   // per point

    // obstacles: the outline of each as a polygon, n_outline_points one after the other (half planes as a strip)
    std::vector<Vec2> obstacle_position;      // [m] reference
    std::vector<Vec2> obstacle_displacement;  // [m]
    std::vector<std::uint8_t> half_plane;     // per obstacle: 1 = the strip is the upper part of a half plane (points 0 and 1 are on its surface, 2 is below 1)

    bool is_half_plane(Index obstacle) const { return !half_plane.empty() && half_plane[obstacle] != 0; }
    Index n_obstacles() const { return static_cast<Index>(obstacle_position.size()) / n_outline_points; }
    Index n_triangles() const { return static_cast<Index>(region.size()); }
    Index n_interfaces() const { return static_cast<Index>(side_a.size()); }
};

/// `all`: also the interfaces between fans in one piece, of which nothing is written or drawn.
Frame make_frame(const Model& model, const State& state, bool all = true);

/// Diagonal [m] of the box round some points.
double diagonal(const std::vector<Vec2>& points);

/// Largest principal stress [Pa] of (xx, yy, xy).
double largest_principal(const Eigen::Vector3d& stress);

/// A table of numbers with named columns (energy.csv, cracks.csv): what the curves are drawn from.
struct History {
    std::vector<std::string> columns;
    std::vector<std::vector<double>> rows;
    std::string file = {};  // that it was read from; empty for one that is being made
    /// Throws UserError for an unknown name.
    std::vector<double> column(const std::string& name) const;
    bool has(const std::string& name) const;

    template <class Archive>
    void serialize(Archive& archive) { archive(columns, rows); }
};

/// All of a run; those that it does not have are empty.
struct Histories {
    History energy, cracks;  // energy.csv, cracks.csv
    History reactions;       // reactions.csv: where motion is prescribed
    History probes;          // probes.csv: where the scenario has probes
    History breaks;          // breaks.csv: interfaces as they broke, where that is asked for
    History stress_strain;   // stress_strain.csv: where the scenario has a specimen
    History fragments;       // fragments.csv: at the end

    template <class Archive>
    void serialize(Archive& archive) { archive(energy, cracks, reactions, probes, breaks, stress_strain, fragments); }
};

}  // namespace knap
