#pragma once
// One rule for all names that a scenario gives: materials, interfaces, boundaries, loads, probes, obstacles. (The scenario's own name and the names
// of files are parts of paths and have narrower rules.)
#include <string_view>

namespace knap {

/// Letters of any script, digits, blanks, _ and -; no blank at an end.
bool is_name(std::string_view text);

inline constexpr const char* rule_for_names = "a name has letters, digits, blanks, _ and -, and no blank at its ends";

}  // namespace knap
