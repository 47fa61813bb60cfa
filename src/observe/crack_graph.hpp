#pragma once
// Cracks, tips and branchings from the graph of broken interfaces.
//
// Nodes are mesh vertices (all vertices of one pre-crack are one node), links are the newly broken interfaces. In a random mesh this
// graph is noisy: stubs of an edge or two beside the path, small loops, isolated broken edges ahead of the tip. So each connected
// piece is reduced to the tree of shortest paths from where it starts, and the tree is read as arms: at every node the longest way
// on continues the arm that came in, every other way starts an arm of its own. An arm counts
//   1. when it is at least `pruning_length` long, or
//   2. when it is the longest one at an end of a pre-crack (a crack counts from its first edge), or
//   3. when no arm of the whole body counts and this is the longest one.
// All else is a twig. A branching is a vertex that two or more counted arms leave: both are then at least `pruning_length` long, so
// a stub that stopped is none. A piece starts at its pre-crack; without one at the body's boundary; without either in the middle of
// its longest path, so that each of its two tips moves away from the start.
#include "base/vec.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
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
    double pruning_length = 0;  // [m] shorter arms are twigs
    double chord_length = 0;    // [m] the main path is measured along chords of about this length, not along the zigzag; 0: edges
    double speed_window = 0;  // [m] growth over which a tip speed is fitted
};

/// What suits a random mesh: 10 mean edges to prune, 10 for a chord; for a speed 20, since broken stretches of two or three edges ahead of
/// a tip join it at once, and 1.5 process zones [m], within which interfaces break in bursts.
CrackOptions crack_options(double mean_edge, double process_zone = 0);

enum class CrackStart : std::uint8_t { none, precrack, boundary, inside };

/// The far end of a counted arm.
struct CrackEnd {
    Vec2 position;  // [m]
    Index vertex;
    double path_length;  // [m] from the start of the crack, along edges
    bool arrived;        // at the boundary, at a pre-crack or (round a loop) at another arm: not a tip any more

    template <class Archive>
    void serialize(Archive& archive) { archive(position, vertex, path_length, arrived); }
};

struct Branching {
    Vec2 position;  // [m]
    Index vertex;
    Index n_arms;           // counted arms that leave, at least 2
    double shorter_arm;     // [m] length of the second longest of them
    Index first_interface;  // of that arm

    template <class Archive>
    void serialize(Archive& archive) { archive(position, vertex, n_arms, shorter_arm, first_interface); }
};

/// One interface of the main path.
struct PathStep {
    Index interface;
    double position;  // [m] of its far end, from the start of the crack along chords

    template <class Archive>
    void serialize(Archive& archive) { archive(interface, position); }
};

struct CrackPattern {
    double broken_length = 0;   // [m] of all new broken interfaces, twigs and isolated ones included
    double damaged_length = 0;  // [m] of all interfaces damaged but not broken
    Index n_broken = 0, n_damaged = 0;
    double crack_length = 0;  // [m] of all counted arms, along edges
    double main_length = 0;   // [m] from the start of the main crack to its main end, along chords
    std::vector<PathStep> main_path;  // from the start to the main end
    Index n_cracks = 0;       // places where a counted crack starts
    CrackStart main_start = CrackStart::none;
    std::optional<CrackEnd> main_end;  // the counted end with the longest path; none before anything broke
    std::vector<CrackEnd> tips;        // ends that have not arrived
    std::vector<Branching> branchings;
    std::vector<Index> counted;  // interfaces of counted arms

    Index n_branches() const;  // one for a fork into two, two for a fork into three

    template <class Archive>
    void serialize(Archive& archive) {
        archive(broken_length, damaged_length, n_broken, n_damaged, crack_length, main_length, main_path, n_cracks, main_start, main_end, tips, branchings,
                counted);
    }
};

/// `status`: one per interface. Cost: a pass over `status`, and n log n in the broken ones.
CrackPattern find_cracks(const InterfaceGraph& graph, std::span<const InterfaceStatus> status, const CrackOptions& options);

}  // namespace knap
