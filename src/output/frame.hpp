#pragma once
// One moment of a run as files and figures need it: plain arrays, made from (model, state) or read back from a run
// directory.
#include "base/vec.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace knap {

struct Model;
struct State;

/// Status of a point, and of an interface (of second order: of half of one) by its two points.
enum class InterfaceStatus : std::uint8_t {
    intact = 0,   // cohesion 1
    damaged = 1,  // between them
    broken = 2,   // cohesion 0
    precrack = 3  // no cohesion from the start
};
constexpr InterfaceStatus status_of(double cohesion) {
    return cohesion >= 1 ? InterfaceStatus::intact : cohesion > 0 ? InterfaceStatus::damaged : InterfaceStatus::broken;
}
/// Broken where both points are, damaged where at least one is no longer intact.
constexpr InterfaceStatus status_of(InterfaceStatus a, InterfaceStatus b) {
    if (a == InterfaceStatus::precrack || b == InterfaceStatus::precrack) return InterfaceStatus::precrack;
    return a == b ? a : InterfaceStatus::damaged;
}

inline constexpr Index n_outline_points = 96;  // per obstacle, or more if one has more corners

struct Frame {
    double time = 0;          // [s]
    double length_scale = 1;  // [m] diagonal of the reference body

    // bulk: triangle t owns the corners 3t, 3t+1, 3t+2; a triangle of second order is drawn as six of these
    std::vector<Vec2> position;             // [m] per corner, reference
    std::vector<Vec2> displacement;         // [m] per corner
    std::vector<Vec2> velocity;             // [m/s] per corner
    std::vector<Index> node;                // per corner: those with one number have all values of corners in common,
                                            // and first corners have 0, 1, ...; empty: none have
    std::vector<Eigen::Vector3d> stress;    // [Pa] per triangle: xx, yy, xy
    std::vector<double> stress_zz;          // [Pa] per triangle; empty in frames of versions that did not store it
    std::vector<double> temperature;        // [K] per corner; empty without heat
    bool celsius = false;                   // temperatures are in degrees Celsius
    std::vector<std::int32_t> region;       // per triangle
    std::vector<std::int32_t> grain;        // per triangle, -1: in none; empty where the body has no grains
    std::vector<double> layer_angle;        // [deg] per triangle; empty where no layers have angles by place
    std::vector<std::int32_t> piece_state;  // per triangle, PieceState; empty without [rigid]
    std::vector<std::int32_t> fragment;     // per triangle, 0 the heaviest; empty where it is not known

    // interfaces: interface i owns the points 2i, 2i+1 (its two ends); one of second order is drawn as two halves
    std::vector<std::array<Index, 2>> side_a;  // per interface: the corner of side A at each end, -1: support
    std::vector<std::array<Index, 2>> side_b;
    std::vector<Vec2> end_position;       // [m] per point, reference
    std::vector<double> cohesion;         // per point
    std::vector<double> opening, slip;    // [m] per point
    std::vector<Vec2> traction;           // [Pa] per point (N, T)
    std::vector<InterfaceStatus> status;  // per point
    std::vector<double> fluid;            // [Pa] per point, pressure on its faces; empty without [[pressure]]

    // obstacles: n_outline() points per obstacle, a closed polygon; of a half plane and a polyline a strip is drawn
    std::vector<Vec2> obstacle_position;      // [m] reference
    std::vector<Vec2> obstacle_displacement;  // [m]
    std::vector<std::uint8_t> half_plane;     // per obstacle: 1 = a strip (points 0, 1 on its surface, 2 below 1)

    InterfaceStatus status_of_interface(Index i) const { return status_of(status[2 * i], status[2 * i + 1]); }
    bool on_support(Index interface) const { return side_a[interface][0] < 0 || side_b[interface][0] < 0; }
    bool is_half_plane(Index obstacle) const { return !half_plane.empty() && half_plane[obstacle] != 0; }
    Index n_obstacles() const { return static_cast<Index>(obstacle_position.size()) / n_outline(); }
    Index n_outline() const {
        return half_plane.empty() ? n_outline_points : static_cast<Index>(obstacle_position.size() / half_plane.size());
    }
    Index n_triangles() const { return static_cast<Index>(region.size()); }
    Index n_interfaces() const { return static_cast<Index>(side_a.size()); }
};

/// `all`: with the interfaces between bonded fans, too, which are neither written nor drawn.
Frame make_frame(const Model& model, const State& state, bool all = true);

/// Next corner of the same triangle, counterclockwise.
constexpr Index next_corner(Index corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
/// The edges that belong to one triangle only, each by its first corner.
std::vector<Index> single_edges(const Frame& frame);

/// Diagonal [m] of the bounding box of points; 0 of none.
double diagonal(const std::vector<Vec2>& points);

/// Largest principal stress [Pa] of (xx, yy, xy).
double largest_principal(const Eigen::Vector3d& stress);
/// [Pa] of a triangle: von Mises' stress, and half the difference of the largest and the smallest of the three
/// principal stresses. Throw UserError where the frame has no stress zz.
double von_mises(const Frame& frame, Index triangle);
double max_shear(const Frame& frame, Index triangle);

}  // namespace knap
