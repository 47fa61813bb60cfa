#pragma once
// The title of a figure: on one line, smaller, or on several lines, but never cut (what is longer than most_title_lines lines ends with an ellipsis).
#include "figures/canvas.hpp"

#include <string>
#include <vector>

namespace knap {

inline constexpr double title_size = 12.5;  // [unit] of all figures
inline constexpr std::size_t most_title_lines = 8;

struct Title {
    std::vector<std::string> lines;
    std::string aside;         // what stands on the right
    bool aside_below = false;  // on a line of its own
    double size = title_size;  // [unit]

    double height() const;  // [unit] room above a plot
};

/// Broken at blanks into lines of at most `width` [unit], words that are longer anywhere; at most `most` lines, the last with an ellipsis where there is more.
std::vector<std::string> broken_lines(const std::string& text, double size, double width, bool bold, std::size_t most);

/// `aside` stands at the right of the title where both fit, else below it. `width` [unit] is that of the place.
Title fitted_title(const std::string& text, const std::string& aside, double width);

/// Above `bottom`, between `left` and `right` [unit].
void draw_title(Canvas& canvas, const Title& title, double left, double right, double bottom);

}  // namespace knap
