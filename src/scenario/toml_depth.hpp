#pragma once
#include "scenario/node.hpp"

#include <optional>
#include <string_view>

namespace knap {

/// Tables and lists in each other. What walks over the tree of a text, or ends its life, calls itself once a level.
inline constexpr int deepest_nesting = 256;

/// Where a TOML text goes deeper: by brackets, by dotted keys (a.b.c = 1), by the names of tables ([a.b.c]), or by all of them together.
std::optional<Place> too_deep(std::string_view text);

}  // namespace knap
