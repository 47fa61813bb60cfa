#include "figures/legend.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double bar_room = 46, column_gap = 8, below_key = 7;  // [unit]
constexpr double bar_part = 0.58, key_from = 0.66;              // of the width, where there are both

bool both(const Legend& legend) { return !legend.key.empty() && (legend.bar || !legend.note.empty()); }

struct Columns {
    double left, width;  // [unit] of the first; of each, with the gap behind it
    std::vector<std::vector<KeyEntry>> entries;
    double key_width(double right, std::size_t i) const { return std::min(width - column_gap, right - left - static_cast<double>(i) * width); }
};

Columns columns_of(const Legend& legend, double left, double width) {
    const double room = both(legend) ? (1 - key_from) * width : width;
    const double column = std::max(key_width(legend.key) + column_gap, both(legend) ? room : 0.25 * room);
    const double most = std::max(1., std::floor((room + column_gap) / column));
    const std::size_t n = std::min(legend.key.size(), static_cast<std::size_t>(most)), n_rows = n == 0 ? 0 : (legend.key.size() + n - 1) / n;
    Columns columns{left + width - room, column, {}};
    for (std::size_t i = 0; i < legend.key.size(); ++i) {
        if (i % n_rows == 0) columns.entries.emplace_back();
        columns.entries.back().push_back(legend.key[i]);
    }
    return columns;
}

}  // namespace

void join(Legend& all, const Legend& other) {
    if (!all.bar) all.bar = other.bar;
    for (const KeyEntry& entry : other.key)
        if (std::none_of(all.key.begin(), all.key.end(), [&](const KeyEntry& e) { return e.label == entry.label; })) all.key.push_back(entry);
    if (all.note.empty()) all.note = other.note;
}

double legend_height(const Legend& legend, double width) {
    double height = legend.bar || !legend.note.empty() ? bar_room : 0;
    const Columns columns = columns_of(legend, 0, width);
    for (std::size_t i = 0; i < columns.entries.size(); ++i) height = std::max(height, key_height(columns.entries[i], columns.key_width(width, i)) + below_key);
    return height;
}

void draw_legend(Canvas& canvas, const Legend& legend, const Area& area) {
    const double bar_width = both(legend) ? bar_part * area.width : 0.7 * area.width;
    if (legend.bar) draw_colour_bar(canvas, *legend.bar, {both(legend) ? area.left : area.left + 0.15 * area.width, area.bottom, bar_width, area.height});
    else canvas.text({area.left, area.top() - 5}, legend.note, {.size = type_size, .along = Along::middle});
    const Columns columns = columns_of(legend, area.left, area.width);
    for (std::size_t i = 0; i < columns.entries.size(); ++i)
        draw_key(canvas, columns.entries[i], {columns.left + static_cast<double>(i) * columns.width, area.bottom, columns.key_width(area.right(), i), area.height});
}

}  // namespace knap
