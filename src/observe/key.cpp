#include "observe/key.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {
constexpr double symbol = 26, gap = 6;             // [unit] a line long enough for every pattern
constexpr double widest_label = 0.3 * page_width;  // names are given by people
}

double key_width(const std::vector<KeyEntry>& entries, double size) {
    double widest = 0;
    for (const KeyEntry& entry : entries) widest = std::max(widest, text_width(fitted_text(entry.label, size, widest_label), size));
    return symbol + gap + widest;
}

void draw_key(Canvas& canvas, const std::vector<KeyEntry>& entries, const Area& area, double size) {
    const double leading = key_leading * size, room = area.width - symbol - gap + 0.5;  // widths differ a little between resolutions
    const auto n_lines = static_cast<std::size_t>(std::max(1., 1 + std::floor((area.height - size) / leading)));
    const std::size_t n_shown = entries.size() <= n_lines ? entries.size() : n_lines - 1;
    double y = area.top() - 5;
    for (std::size_t i = 0; i < n_shown; ++i, y -= leading) {
        const KeyEntry& entry = entries[i];
        const double cap = entry.dash == 0 ? 0.5 * entry.width : 0;  // round ends
        canvas.line({{area.left + cap, y}, {area.left + symbol - cap, y}}, entry.colour, entry.width, line_pattern(entry.dash, entry.width));
        draw_marker(canvas, entry.marker, {area.left + symbol / 2, y}, entry.colour);
        canvas.text({area.left + symbol + gap, y}, fitted_text(entry.label, size, room), {.size = size, .along = Along::middle});
    }
    if (n_shown < entries.size())
        canvas.text({area.left + symbol + gap, y}, "and " + std::to_string(entries.size() - n_shown) + " more", {.size = size, .along = Along::middle});
}

}  // namespace knap
