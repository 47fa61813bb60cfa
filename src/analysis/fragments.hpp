#pragma once
// Fragments: the largest sets of triangles that unbroken interfaces connect.
#include "output/history_csv.hpp"
#include "output/outputs.hpp"

#include "base/vec.hpp"

#include <array>

namespace knap {

struct Model;
struct State;

/// What one triangle contributes to its fragment.
struct TriangleContent {
    double area;                                       // [m2]
    double mass;                                       // [kg]
    Vec2 momentum = Vec2::Zero();                      // [kg m/s]
    Vec2 centroid = Vec2::Zero();                      // [m]
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // [kg m2] sum of m x x' about the centroid
    double spin = 0;                                   // [kg m2/s] angular momentum about the centroid
    double kinetic_energy = 0;                         // [J]
    Vec2 start = Vec2::Zero();                         // [m] centroid of the undeformed triangle
    Vec2 turn = Vec2::Zero();  // [kg m2] sum of m (X . x, X x x), X and x the arms from both centroids
};

struct Fragment {
    Index first_triangle;  // its lowest triangle
    Index n_triangles = 0;
    double area = 0;                                   // [m2]
    double mass = 0;                                   // [kg]
    Vec2 velocity = Vec2::Zero();                      // [m/s] of the centre of mass
    Vec2 centre = Vec2::Zero();                        // [m] of mass
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // [kg m2] sum of m x x' about the centre
    double angular_momentum = 0;                       // [kg m2/s] about the centre
    double kinetic_energy = 0;                         // [J]
    Vec2 start = Vec2::Zero();                         // [m] centre of mass in the undeformed body
    Vec2 turn = Vec2::Zero();                          // [kg m2] sum of m (X . x, X x x) about both centres
    double near = 0;  // [deg] angle by which a triangle of it has turned, with its full turns

    /// [deg] Of the polar decomposition R U of the sum of m x (x) X, with the full turns that come nearest to `near`.
    double rotation() const;
    double diameter() const;                                           // [m] of the circle of the same area
    double spin() const { return angular_momentum / spread.trace(); }  // [rad/s]
    double energy_of_translation() const { return 0.5 * mass * velocity.squaredNorm(); }  // [J]
    double energy_of_rotation() const {                                                   // [J]
        return angular_momentum == 0 ? 0 : 0.5 * angular_momentum * spin();
    }
    double elongation() const;  // [-] longest over shortest axis of the ellipse with the same moments
    double angle() const;       // [deg] of the longest axis to the x axis, 0 to 180
};

struct Fragments {
    std::vector<Fragment> pieces;          // the heaviest first, then by first triangle
    std::vector<Index> piece_of_triangle;  // into `pieces`; -1: the triangle was excavated
    bool turn = false;                     // far: large rotations
};

/// `joined`: pairs of triangles with an unbroken interface between them.
Fragments find_fragments(std::span<const TriangleContent> triangles, std::span<const std::array<Index, 2>> joined);

/// An interface is unbroken while one of its points has cohesion. Positions are current ones.
Fragments find_fragments(const Model& model, const State& state);
/// Its piece_of_triangle alone, in less time.
std::vector<Index> fragment_of_triangles(const Model& model, const State& state);

/// One line of fragments.csv.
struct FragmentLine {
    std::size_t number;
    const Fragment& fragment;
    double mass_part, passing;  // [-]
};
/// `turn`: with the columns of large rotations.
std::span<const Measure<FragmentLine>> fragment_columns(bool turn = true);

/// fragments.csv: one line per fragment, the heaviest first.
History fragment_table(const Fragments& fragments);

/// One line of fragment_history.csv.
struct FragmentMoment {
    double time;  // [s]
    const Fragments& fragments;
    const History& table;  // of these fragments
};
std::span<const Measure<FragmentMoment>> fragment_moment_columns();

/// fragment_paths.csv at one time: the lines of a fragment table behind `time` and `label`, of the heaviest fragments.
/// The label is the lowest triangle of a fragment: the part that has it keeps the label when a fragment breaks.
std::vector<Output> fragment_path_columns(bool turn = true);
std::vector<std::vector<double>> fragment_path_lines(double time, const Fragments& fragments, const History& table);

/// Smallest diameter [m] of a fragment such that fragments up to it have this part of the mass.
double diameter_passing(const History& fragment_table, double part);

}  // namespace knap
