#pragma once
// What `knap check` says of an initial stress.
#include "model/model.hpp"
#include "scenario/read_scenario.hpp"

#include <string>
#include <vector>

namespace knap {

/// A line; empty without an initial stress.
std::string initial_stress_text(const Scenario& scenario, const Model& model);

/// Warnings: an initial stress that the loads at t = 0 do not balance, without a start in equilibrium.
std::vector<Diagnostic> findings_of_initial_stress(const ReadResult& read, const Model& model);

}  // namespace knap
