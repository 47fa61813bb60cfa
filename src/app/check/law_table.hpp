#pragma once
// The laws of a scenario as `knap check` lists them: where they act, and all that they can do.
#include "model/model.hpp"
#include "scenario/read_scenario.hpp"

#include <string>

namespace knap {

/// A line for each law, then one for each pressure in cracks and for each material with latent heat.
std::string laws_text(const ReadResult& read, const Model& model);

}  // namespace knap
