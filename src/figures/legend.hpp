#pragma once
// What colours and lines of a picture stand for, below it: a colour bar, a key, or both.
#include "figures/colour_bar.hpp"
#include "figures/key.hpp"

#include <optional>

namespace knap {

struct Legend {
    std::optional<ColourScale> bar;
    std::vector<KeyEntry> key;
    std::string note;  // in the place of a bar
};

/// One for pictures of which each has its own: all entries, each once.
void join(Legend& all, const Legend& other);

/// [unit] below a picture of this width.
double legend_height(const Legend& legend, double width);
void draw_legend(Canvas& canvas, const Legend& legend, const Area& area);

}  // namespace knap
