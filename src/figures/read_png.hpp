#pragma once
// Pictures as input.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace knap {

struct Picture {
    int width = 0, height = 0;      // [pixel]
    std::vector<std::uint8_t> rgb;  // three per pixel, rows from the top
};

/// Nothing when the bytes are no PNG file that can be read, for a `problem` such as "is no PNG picture with colours". Grey becomes colour; what is
/// transparent is drawn on white.
std::optional<Picture> read_png(const std::string& bytes, std::string& problem);

}  // namespace knap
