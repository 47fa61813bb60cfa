#include "figures/key.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

constexpr double symbol = 26, gap = 6;             // [unit] a line long enough for every pattern
constexpr double widest_label = 0.3 * page_width;  // names are given by people
constexpr std::size_t most_lines = 4;              // of a label

/// `width` [unit] of the whole key.
std::vector<std::string> lines_of(const KeyEntry& entry, double size, double width) {
    const double room = width - symbol - gap + 0.5;  // widths differ a little between resolutions
    if (static_cast<double>(entry.label.size()) < room && text_width(entry.label, size) <= room) return {entry.label};  // a part of a subscript would be wider
    return broken_lines(entry.label, size, room, false, most_lines);
}

}  // namespace

double key_width(const std::vector<KeyEntry>& entries, double size) {
    double widest = 0;
    for (const KeyEntry& entry : entries)
        for (const std::string& line : lines_of(entry, size, symbol + gap + widest_label)) widest = std::max(widest, text_width(line, size));
    return symbol + gap + widest;
}

double key_height(const std::vector<KeyEntry>& entries, double width, double size) {
    std::size_t n = 0;
    for (const KeyEntry& entry : entries) n += lines_of(entry, size, width).size();
    return static_cast<double>(n) * key_leading * size;
}

void draw_key(Canvas& canvas, const std::vector<KeyEntry>& entries, const Area& area, double size) {
    const double leading = key_leading * size;
    auto room = static_cast<std::ptrdiff_t>(std::max(1., 1 + std::floor((area.height - size) / leading)));  // lines
    double y = area.top() - 5;
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const KeyEntry& entry = entries[i];
        const std::vector<std::string> lines = lines_of(entry, size, area.width);
        room -= static_cast<std::ptrdiff_t>(lines.size());
        if (room < (i + 1 < entries.size() ? 1 : 0)) {
            canvas.text({area.left + symbol + gap, y}, "and " + std::to_string(entries.size() - i) + " more", {.size = size, .along = Along::middle});
            return;
        }
        const double cap = entry.dash == 0 ? 0.5 * entry.width : 0;  // round ends
        canvas.line({{area.left + cap, y}, {area.left + symbol - cap, y}}, entry.colour, entry.width, line_pattern(entry.dash, entry.width));
        draw_marker(canvas, entry.marker, {area.left + symbol / 2, y}, entry.colour);
        for (const std::string& line : lines) {
            canvas.text({area.left + symbol + gap, y}, line, {.size = size, .along = Along::middle});
            y -= leading;
        }
    }
}

}  // namespace knap
