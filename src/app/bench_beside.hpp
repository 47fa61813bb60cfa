#pragma once
// What a run does beside its explicit steps, and implicit steps: processor times of this machine.
#include "model/state.hpp"

namespace knap {

struct OutputTimes {
    double frame;   // [s] to gather the fields and to write them
    double figure;  // [s] of the cracks
};

/// The best of some, written into a directory of their own that is taken away again. Throws OutputError.
OutputTimes time_output(const Model& model, const State& state);

/// The block at 1 mm with both schemes implicit and steps of ten times the stable one of the explicit bulk, to 40 us.
struct ImplicitWork {
    std::int64_t steps = 0, linear_solves = 0, factorisations = 0, unknowns = 0, entries = 0;  // entries of the triangular factor
    double seconds = 0;
};
ImplicitWork implicit_work();

}  // namespace knap
