#pragma once
// What only a mesh can say of a scenario, before a run begins.
#include "app/run/cost.hpp"
#include "model/model.hpp"
#include "scenario/read_scenario.hpp"

#include <string>
#include <vector>

namespace knap {

/// Throws UserError: pairs of loads that cannot both hold, each named with its line.
void refuse_contradictions(const ReadResult& read, const Model& model);

/// Throws UserError: `start = "equilibrium"` of a body that nothing holds against its loads.
void refuse_unheld_body(const ReadResult& read, const Model& model);

/// Warnings: displacements that jump.
std::vector<Diagnostic> findings_of_loads(const ReadResult& read, const Model& model, const StepPlan& plan);

/// Warnings: probes, regions and boxes outside the body.
std::vector<Diagnostic> findings_of_places(const ReadResult& read, const Model& model);

/// Warnings: details that cut the stable step, and numbers of steps, frames, lines and pictures that nobody can mean.
/// `cost`, where it is known; else it is estimated where a run may be long.
std::vector<Diagnostic> findings_of_steps(const ReadResult& read, const Model& model, const StepPlan& plan, const Cost* cost);

/// All of them, and those about the resolution of the process zone.
std::vector<Diagnostic> findings_of_model(const ReadResult& read, const Model& model, const StepPlan& plan, const Cost* cost = nullptr);

/// A warning at the place of a key.
Diagnostic warning_at(const ReadResult& read, const std::string& key, const std::string& code, const std::string& message, const std::string& note);

/// "1.5e-06 m": six digits at most.
std::string with_unit(double value, const char* unit);
/// "(0.1, 0.04) m"
std::string place_text(const Vec2& x);

}  // namespace knap
