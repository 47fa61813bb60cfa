#pragma once
// From the tree of a scenario file to values: the overrides of the command line, then the key table.
#include "scenario/findings.hpp"
#include "scenario/values.hpp"

#include <string>
#include <vector>

namespace knap {

/// Writes KEY=VALUE of the command line's --set into the tree. KEY is a path such as mesh.size, material.glass.E or
/// load[0].traction; VALUE is TOML, or a bare text ("0.25 mm", plane stress); an empty one leaves the key out.
void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings);

/// Holds the tree against the key table: unknown and missing keys, types, units, ranges, words, defaults. Everything
/// that is wrong goes to `findings`; what is right is in the values, so that later checks can go on.
Values resolve(const Node& root, Findings& findings);

}  // namespace knap
