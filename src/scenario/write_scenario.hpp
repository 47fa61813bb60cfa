#pragma once
#include "scenario/read_scenario.hpp"

#include <string>

namespace knap {

/// The scenario with every default in place, in SI with full precision. Reading it again gives the same scenario.
/// Tables of numbers are written out; mesh and pictures are still named.
std::string resolved_toml(const ReadResult& result);

/// Every key with its value and the origin of the value, one a line (`check --full`).
std::string full_listing(const ReadResult& result);

/// A commented scenario to start from (`knap new`).
std::string new_scenario(const std::string& name);

}  // namespace knap
