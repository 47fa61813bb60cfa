#pragma once
// Fragments: the largest sets of triangles that unbroken interfaces hold together.
#include "base/vec.hpp"

#include <array>
#include <iosfwd>
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
};

struct Fragment {
    Index first_triangle;  // the lowest; names the fragment
    Index n_triangles;
    double area;    // [m2]
    double mass;    // [kg]
    Vec2 velocity;  // [m/s] of the centre of mass
    Vec2 centre;    // [m] centre of mass
};

struct Fragments {
    std::vector<Fragment> pieces;          // the heaviest first, then by first triangle
    std::vector<Index> piece_of_triangle;  // into `pieces`
};

/// `joined`: pairs of triangles with an unbroken interface between them.
Fragments find_fragments(std::span<const TriangleContent> triangles, std::span<const std::array<Index, 2>> joined);

/// An interface holds as long as one of its points has cohesion left. Positions are current ones.
Fragments find_fragments(const Model& model, const State& state);

/// fragments.csv: one line a fragment, heaviest first.
void write_fragments(std::ostream& out, const Fragments& fragments);

}  // namespace knap
