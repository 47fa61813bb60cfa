#pragma once
// What cracks are read from: the graph of all interfaces of a body and how far each has gone. src/README.md defines tip, arm, branching and length.
#include "base/vec.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace knap {

enum class InterfaceStatus : std::uint8_t {
    intact,   // cohesion 1 at both points
    damaged,  // below 1 at a point, not yet zero at both
    broken,   // zero at both
    precrack  // no cohesion from the start
};

/// What does not change in a run: all interfaces of a body.
struct InterfaceGraph {
    std::vector<Vec2> vertices;              // [m]
    std::vector<std::uint8_t> on_boundary;   // per vertex: a crack that gets here has reached the free boundary
    std::vector<std::array<Index, 2>> ends;  // per interface: its two vertices
    std::vector<double> length;              // [m] per interface
};

/// Sizes in edges are local: they mean the edges of the way or stretch itself, whatever the mesh is elsewhere.
struct CrackOptions {
    Index arm_edges = 10;         // a way on counts as an arm from so many edges on; shorter ones are twigs
    Index short_arm_edges = 10;   // or from so many on,
    double short_arm_length = 0;  // [m] when it is this long
    Index gap_edges = 0;          // damaged interfaces between two broken stretches count with them up to so many
    Index chord_edges = 1;        // lengths of paths are measured along chords of so many edges, not along the zigzag
    Index speed_edges = 20;       // growth over which a tip speed is fitted,
    double speed_length = 0;      // [m] and at least so long
    Index start_edges = 5;        // growth from which a tip speed is known, and most that may break at once where a tip runs
    double fastest = std::numeric_limits<double>::infinity();  // [m/s] no tip is: the largest dilatational wave speed

    bool is_arm(Index n_edges, double length) const { return n_edges >= arm_edges || (n_edges >= short_arm_edges && length >= short_arm_length); }
};

/// What suits a random mesh whose sides are `edges_per_side` interfaces: arms of ten sides, or of five that are a twentieth of the body's extent [m], as much as
/// one sees as a fork in its picture. Interfaces break in bursts within a process zone [m]; so a speed is fitted over one and a half at least.
CrackOptions crack_options(double extent, double process_zone, double fastest, Index edges_per_side);

enum class CrackStart : std::uint8_t { none, precrack, boundary, inside };

}  // namespace knap
