#pragma once
// The numbers that summarise a run: `summary` of run.json, and what [expect] bounds.
#include "record/outputs.hpp"
#include "record/recorder.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace knap {

/// Names and values in SI, in a fixed order; NaN for an event that never happened.
struct Summary {
    std::vector<std::pair<std::string, double>> values;
    std::string reaction_of;  // name of the load or obstacle of reaction_x and reaction_y; empty where there is none
    /// NaN for an unknown name.
    double operator[](const std::string& name) const;
};

Summary summarise(const Model& model, const State& end, const Recorder& recorder);

/// All numbers that a summary may contain, in order; the last ones, "*_force_x", of every load and obstacle that
/// drives, and "*_passages" of every collector.
std::vector<Output> summary_outputs();

/// A bound of [expect] on a number of the summary.
struct Expectation {
    std::string key;
    std::optional<double> below, above, at_least, at_most, value;
    double within = 0;  // with `value`: allowed deviation, absolute, or relative where `relative`
    bool relative = false;
    std::string unit;  // "" = SI; "cR" = multiples of the Rayleigh speed
};

struct ExpectResult {
    std::string name, limit;               // "first_growth_time", "below 1.8e-05 s"
    double value;                          // SI; NaN: never happened, which fails every bound
    std::string shown_value, shown_limit;  // in the unit in which the bound reads well: "15.4 µs", "below 18 µs"
    bool pass;
};
std::vector<ExpectResult> judge_expectations(const std::vector<Expectation>& expectations, const Summary& summary,
                                             double rayleigh_speed);

}  // namespace knap
