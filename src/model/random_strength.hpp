#pragma once
// Interfaces with laws of their own: strength and fracture energy drawn from the scatter of the law that they have.
#include "model/model.hpp"

namespace knap {

/// A law of its own, behind the others in model.laws, for every interface (with cohesion) whose law scatters. `input` says how.
void scatter_strength(const ModelInput& input, Model& model);

}  // namespace knap
