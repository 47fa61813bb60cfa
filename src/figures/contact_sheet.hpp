#pragma once
// A page of many pictures, each with a caption, and one legend.
#include "figures/legend.hpp"

namespace knap {

struct Tile {
    std::filesystem::path picture;  // .png; the place of a missing one stays empty
    std::string caption;
};

/// Row by row; `aside` stands to the right of the title. Throws OutputError when the file cannot be written.
DrawnFigure draw_contact_sheet(const std::vector<Tile>& tiles, std::size_t n_columns, const std::string& title,
                               const std::filesystem::path& file, int pixels, const Legend& legend = {},
                               const std::string& aside = "");

}  // namespace knap
