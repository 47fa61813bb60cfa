#pragma once
// Scenarios as text: resolved, as a list of keys, and new ones to start from.
#include "scenario/read_scenario.hpp"

namespace knap {

/// The scenario as TOML with all defaults, in SI with full precision. Reading it again gives the same scenario. Tables
/// of numbers are written out; mesh and picture files remain references.
std::string resolved_toml(const ReadResult& result);

/// Every key with its value and the origin of the value, one a line (`check --full`).
std::string full_listing(const ReadResult& result);

/// A commented scenario to start from (`knap new`).
std::string new_scenario(const std::string& name);
/// A built-in scenario under another name, with its comments.
std::string renamed(const BuiltIn& scenario, const std::string& name);
/// The question in the first line of a built-in scenario.
std::string question(const BuiltIn& scenario);

}  // namespace knap
