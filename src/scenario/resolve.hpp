#pragma once
// Holds the tree of a scenario file against the key table: unknown and missing keys, types, units, ranges, words, defaults.
#include "scenario/findings.hpp"
#include "scenario/values.hpp"

namespace knap {

/// Everything that is wrong goes to `findings`; what is right is in the values, so that later checks can go on.
Values resolve(const Node& root, Findings& findings);

}  // namespace knap
