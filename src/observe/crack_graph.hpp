#pragma once
// What cracks are read from: the graph of all interfaces of a body and how far each has gone. src/README.md defines tip, arm, branching and length.
#include "base/vec.hpp"

#include <array>
#include <cstdint>
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

struct CrackOptions {
    double pruning_length = 0;  // [m] a way on counts as an arm from this length on; shorter ones are twigs
    double gap_length = 0;      // [m] damaged interfaces between two broken stretches count with them up to this length
    double chord_length = 0;    // [m] lengths of paths are measured along chords of about this length, not along the zigzag; 0: edges
    double speed_window = 0;    // [m] growth over which a tip speed is fitted
};

/// What suits a random mesh: 10 mean edges to prune, 2 for a gap, 10 for a chord; for a speed 20, since broken stretches of two or three edges
/// ahead of a tip join it at once, and 1.5 process zones [m], within which interfaces break in bursts.
CrackOptions crack_options(double mean_edge, double process_zone = 0);

enum class CrackStart : std::uint8_t { none, precrack, boundary, inside };

}  // namespace knap
