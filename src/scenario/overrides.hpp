#pragma once
// KEY=VALUE of the command line's --set, written into the tree of a scenario file.
#include "scenario/findings.hpp"

namespace knap {

/// KEY is a path such as mesh.size, material.glass.E or load[0].traction; VALUE is TOML, or a bare text ("0.25 mm", plane stress);
/// an empty one leaves the key out.
void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings);

}  // namespace knap
