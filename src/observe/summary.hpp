#pragma once
// The numbers that a run comes down to: run.json's `summary`, and what [expect] bounds.
#include "observe/recorder.hpp"

#include <string>
#include <utility>
#include <vector>

namespace knap {

/// Name and value in SI, in a fixed order; NaN for what never happened.
struct Summary {
    std::vector<std::pair<std::string, double>> values;
    /// NaN for an unknown name.
    double operator[](const std::string& name) const;
};

Summary summarise(const Model& model, const State& end, const Recorder& recorder, double rayleigh_speed);

}  // namespace knap
