#pragma once
// Split fans that move in parts which keep their points: where cohesion fell a little beside the crack and the points
// closed again (two thirds of the split fans in the edge-cracked block), or where the crack went through and its faces
// move freely (half of the others). Every point is either held (closed, at the kink of its friction and of its cohesion
// at once) or open without cohesion. Then the one linear system of nonsmooth/fan_solver is: one velocity per part, the
// impulses by walking round the vertex from an open point; where no point is open, with the self-stress of least norm.
//
//     V = sum m_i v_i_free / sum m_i,     P_after = P_before - m_i (V - v_i_free),     P = 0 at open points
//
// The operations have the order of the solver, so the results are bitwise equal.
#include "stepper/explicit/explicit_step.hpp"

#include <cstdint>
#include <vector>

namespace knap {

/// For one fan at a time; one per thread.
struct StationaryWorkspace {
    std::vector<Index> node, part;        // per corner
    std::vector<std::uint8_t> is_open;    // per point
    std::vector<double> bound;            // [m/s] per point, if open: the sides touch below it
    std::vector<double> strength;         // [N s] per point, if held
    std::vector<Vec2> normal;             // per point: N, turned with the fan
    Index first_open, n_parts;            // point, or -1; the last part may be empty
    std::vector<Vec2> velocity;           // [m/s] per part
    std::vector<double> mass;             // [kg] per part
    std::vector<Vec2> required, impulse;  // [N s] per corner, per point
};

/// False: a split fan is not stationary in this step, whatever the impulses on it.
bool may_be_stationary(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work);

/// Whether a split fan is stationary in this step, under these impulses; then `work` has its motion.
bool is_stationary(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work);

/// Advances a split fan without contacts with obstacles; explicit beta only. False: the fan is not stationary, or these
/// impulses are not admissible, or an open point closes; then nothing is written.
bool advance_stationary(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work,
                        StepReport& report);

}  // namespace knap
