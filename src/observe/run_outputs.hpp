#pragma once
#include "observe/outputs.hpp"

namespace knap {

/// Rows of the list of outputs whose numbers are had elsewhere: arrays of frames, entries of run.json, tables of studies and sweeps.
std::vector<OutputTable> run_outputs();

}  // namespace knap
