#pragma once
#include "output/outputs.hpp"

namespace knap {

/// Rows of the list of outputs whose numbers are had elsewhere: entries of run.json, tables of studies and sweeps.
std::vector<OutputTable> run_outputs();

}  // namespace knap
