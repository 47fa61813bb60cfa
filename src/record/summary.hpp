#pragma once
// The numbers that a run comes down to: run.json's `summary`, and what [expect] bounds.
#include "record/outputs.hpp"
#include "record/recorder.hpp"

#include <string>
#include <utility>
#include <vector>

namespace knap {

/// Name and value in SI, in a fixed order; NaN for what never happened.
struct Summary {
    std::vector<std::pair<std::string, double>> values;
    std::string reaction_of;  // name of the load or obstacle whose force reaction_x and reaction_y are; empty where there is none
    /// NaN for an unknown name.
    double operator[](const std::string& name) const;
};

Summary summarise(const Model& model, const State& end, const Recorder& recorder, double rayleigh_speed);

/// All numbers that a summary may have, in order; the last ones, "*_force_x", of every load and obstacle that drives.
std::vector<Output> summary_outputs();

}  // namespace knap
