#pragma once
// Reads a picture, as the map of materials of a microstructure.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace knap {

struct Picture {
    int width = 0, height = 0;      // [pixel]
    std::vector<std::uint8_t> rgb;  // three per pixel, rows from the top
};

/// The bytes of a PNG file; grey becomes RGB, transparent pixels are drawn on white. Without a result `problem` says
/// why: "is not a PNG picture with colours".
std::optional<Picture> read_png(const std::string& bytes, std::string& problem);

}  // namespace knap
