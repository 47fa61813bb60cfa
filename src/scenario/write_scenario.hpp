#pragma once
#include "scenario/read_scenario.hpp"

#include <string>

namespace knap {

/// A value as TOML, numbers with the fewest digits that read back as the same double.
std::string toml_text(const Node& value);

/// The scenario with every default in place, in SI with full precision and without other files; reading it again gives the same scenario.
std::string resolved_toml(const ReadResult& result);

/// Every key with its value and where it came from, one a line (`check --full`).
std::string full_listing(const ReadResult& result);

/// A commented scenario to start from (`knap new`).
std::string new_scenario(const std::string& name);

}  // namespace knap
