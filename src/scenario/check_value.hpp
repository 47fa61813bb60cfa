#pragma once
// One value of a scenario file held against its key: type, form, unit, range, words.
#include "scenario/findings.hpp"
#include "scenario/keys.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace knap {

/// The value in SI; nothing, and findings, where it is wrong. `unit` is that of plain numbers (a key's own may depend
/// on other keys).
std::optional<Node> check_value(Findings& findings, const Key& key, const Node& node, const std::string& path,
                                std::string_view unit);

/// What a node is, for messages: "the number 3", "a list of 2".
std::string type_name(const Node& node);

/// A text in quotes, for messages.
inline std::string quoted(const std::string& text) { return "\"" + text + "\""; }

/// What a key's value looks like: "a length [m]", "two values [a, b], each a pressure [Pa]".
std::string describe(const Key& key);

}  // namespace knap
