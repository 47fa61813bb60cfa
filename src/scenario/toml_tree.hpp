#pragma once
#include "scenario/node.hpp"

#include <optional>
#include <string>

namespace knap {

struct TomlError {
    std::string message;
    Place place;
};

/// Parses TOML text into `root`; what is wrong otherwise.
std::optional<TomlError> parse_toml(const std::string& text, Node& root);

}  // namespace knap
