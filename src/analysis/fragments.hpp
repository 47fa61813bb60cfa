#pragma once
// Fragments: the largest sets of triangles that unbroken interfaces hold together.
#include "output/frame.hpp"
#include "output/outputs.hpp"

#include <array>
#include <span>
#include <vector>

namespace knap {

struct Model;
struct State;

/// What one triangle adds to its fragment.
struct TriangleContent {
    double area;    // [m2]
    double mass;    // [kg]
    Vec2 momentum;  // [kg m/s]
    Vec2 centroid;  // [m]
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // [kg m2] sum of m x x' about the centroid
    double spin = 0;            // [kg m2/s] angular momentum about the centroid
    double kinetic_energy = 0;  // [J]
};

struct Fragment {
    Index first_triangle;  // the lowest; names the fragment
    Index n_triangles;
    double area;    // [m2]
    double mass;    // [kg]
    Vec2 velocity;  // [m/s] of the centre of mass
    Vec2 centre;    // [m] centre of mass
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();  // [kg m2] sum of m x x' about the centre of mass
    double angular_momentum = 0;                       // [kg m2/s] about the centre of mass
    double kinetic_energy = 0;                         // [J]

    double diameter() const;                                             // [m] of the circle of the same area
    double spin() const { return angular_momentum / spread.trace(); }    // [rad/s]
    double elongation() const;                                           // [-] longest over shortest axis of the ellipse with these moments
    double angle() const;                                                // [deg] of the longest axis, from the x axis, 0 to 180
};

struct Fragments {
    std::vector<Fragment> pieces;          // the heaviest first, then by first triangle
    std::vector<Index> piece_of_triangle;  // into `pieces`
};

/// `joined`: pairs of triangles with an unbroken interface between them.
Fragments find_fragments(std::span<const TriangleContent> triangles, std::span<const std::array<Index, 2>> joined);

/// An interface holds as long as one of its points has cohesion left. Positions are current ones.
Fragments find_fragments(const Model& model, const State& state);

/// What a line of fragments.csv is about.
struct FragmentLine {
    std::size_t number;  // the heaviest is 0
    const Fragment& fragment;
    double mass_part, passing;  // [-]
};
std::span<const Measure<FragmentLine>> fragment_columns();

/// fragments.csv: one line a fragment, heaviest first.
History fragment_table(const Fragments& fragments);

/// Diameter [m] that this part of the mass does not exceed: the smallest one of a fragment that as much passes.
double diameter_passing(const History& fragment_table, double part);

}  // namespace knap
