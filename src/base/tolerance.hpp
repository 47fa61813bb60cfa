#pragma once
// Tolerances of all solvers and searches. One that means something else has its own name where it is used.

namespace knap {

inline constexpr double relative_tolerance = 1e-12;    // [-] what the operations of a step may take from a number
inline constexpr double max_residual = 1e-10;          // [-] of a solution, scaled; the gate of every run
inline constexpr double geometric_rounding = 1e-9;     // [-] of lengths and directions that are the same
inline constexpr double pivot_tolerance = 1e-11;       // [-] of the largest pivot: a smaller one is rounding
inline constexpr double part_of_longest_step = 0.995;  // [-] that a method of interior points takes to the first bound
inline constexpr int max_iterations = 100;             // of a loop that takes tens where it converges

}  // namespace knap
