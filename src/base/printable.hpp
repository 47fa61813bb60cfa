#pragma once
#include <string>

namespace knap {

/// A message as a terminal may show it: what would steer it, as escapes in a damaged file do, becomes ?. Lines and tabs stay, and so do columns.
std::string printable(const std::string& message);

}  // namespace knap
