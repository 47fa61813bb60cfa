#pragma once
// Many pictures on one page, with a line of text below each and one legend for all.
#include "figures/chart.hpp"
#include "figures/legend.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace knap {

struct Tile {
    std::filesystem::path picture;  // .png; one that is not there leaves its place empty
    std::string caption;
};

/// Row by row, `n_columns` in a row; `aside` is of all pictures. Throws SimulationError when the file cannot be written.
DrawnFigure draw_contact_sheet(const std::vector<Tile>& tiles, std::size_t n_columns, const std::string& title, const std::filesystem::path& file, int pixels,
                               const Legend& legend = {}, const std::string& aside = "");

}  // namespace knap
