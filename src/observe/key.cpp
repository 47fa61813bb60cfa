#include "observe/key.hpp"

#include <algorithm>

namespace knap {

namespace {
constexpr double symbol = 20, gap = 6, leading = 15;  // [unit]
constexpr double widest_label = 0.3 * page_width;     // names are given by people
}

double key_width(const Canvas& canvas, const std::vector<KeyEntry>& entries) {
    double widest = 0;
    for (const KeyEntry& entry : entries) widest = std::max(widest, canvas.text_width(canvas.fitted(entry.label, type_size, widest_label), type_size));
    return symbol + gap + widest;
}

void draw_key(Canvas& canvas, const std::vector<KeyEntry>& entries, const Area& area) {
    double y = area.top() - 5;
    for (const KeyEntry& entry : entries) {
        const std::vector<double> dashes = entry.dashed ? std::vector<double>{4 * entry.width, 2.5 * entry.width} : std::vector<double>{};
        canvas.line({{area.left, y}, {area.left + symbol, y}}, entry.colour, entry.width, dashes);
        draw_marker(canvas, entry.marker, {area.left + symbol / 2, y}, entry.colour);
        const double room = area.width - symbol - gap + 1e-6;  // of which key_width is the sum, to rounding
        canvas.text({area.left + symbol + gap, y}, canvas.fitted(entry.label, type_size, room), {.size = type_size, .along = Along::middle});
        y -= leading;
    }
}

}  // namespace knap
