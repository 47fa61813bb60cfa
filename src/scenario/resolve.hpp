#pragma once
// From the tree of a scenario file to values: the overrides of the command line, then the key table.
#include "scenario/findings.hpp"
#include "scenario/values.hpp"

namespace knap {

/// Writes KEY=VALUE of the command line's --set into the tree. KEY is a path such as mesh.size, material.glass.E or
/// load[0].traction; VALUE is TOML, or a bare text ("0.25 mm", plane stress); an empty one removes the key.
void apply_overrides(Node& root, const std::vector<std::string>& overrides, Findings& findings);

/// Checks the tree against the key table: unknown and missing keys, types, units, ranges, words; adds defaults. Reports
/// every mistake to `findings`. Keys with a mistake are invalid in the result, so that later checks can continue.
Values resolve(const Node& root, Findings& findings);

}  // namespace knap
