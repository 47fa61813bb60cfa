#pragma once
// What was built: for `knap --version` and run.json.
#include <string>
#include <utility>
#include <vector>

namespace knap {

std::string version();   // "0.1.0"
std::string git_hash();  // short, or "unknown" outside a checkout
bool git_dirty();        // the checkout had uncommitted changes when it was configured
std::string compiler();  // "GNU 12.2.0, Release"
std::vector<std::pair<std::string, std::string>> libraries();  // name, version

}  // namespace knap
