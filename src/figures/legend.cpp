#include "figures/legend.hpp"

#include "figures/plot.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

// [unit]; a symbol is long enough for every line pattern
constexpr double symbol = 26, gap = 6, leading = 15, max_label_width = 0.3 * page_width;
constexpr double bar_height = 9, bar_arrow = 8, height_with_bar = 46, column_gap = 8;

/// `width` [unit]: of symbol and label.
std::vector<std::string> lines_of(const LegendEntry& entry, double width) {
    const double room = width - symbol - gap + 0.5;  // widths differ slightly between resolutions
    if (static_cast<double>(entry.label.size()) < room && text_width(entry.label) <= room)
        return {entry.label};  // not measured in parts: within a subscript these are wider
    return broken_lines(entry.label, type_size, room, false, 4);
}

/// Entries in columns of equal width; `part` left of them is for a colour bar or a note.
struct Columns {
    double part, width;
    std::vector<std::vector<LegendEntry>> entries;
};

Columns columns_of(const Legend& legend, double width) {
    const bool both = !legend.entries.empty() && (legend.bar || !legend.note.empty());
    const double room = both ? 0.34 * width : width;
    const double column = std::max(entries_width(legend.entries) + column_gap, both ? room : 0.25 * room);
    Columns columns{.part = width - room, .width = std::min(column, room + column_gap) - column_gap, .entries = {}};
    const auto max_columns = static_cast<std::size_t>(std::max(1., std::floor((room + column_gap) / column)));
    const std::size_t n = std::clamp<std::size_t>(legend.entries.size(), 1, max_columns),
                      n_rows = (legend.entries.size() + n - 1) / n;
    for (std::size_t i = 0; i < legend.entries.size(); ++i) {
        if (i % n_rows == 0) columns.entries.emplace_back();
        columns.entries.back().push_back(legend.entries[i]);
    }
    return columns;
}

/// At the top of `area`, with its numbers and its name below; arrows at the ends stand for values beyond the limits.
void draw_colour_bar(Canvas& canvas, const ColourScale& scale, const Area& area) {
    const Area bar{area.left + bar_arrow, area.top() - bar_height, area.width - 2 * bar_arrow, bar_height};
    constexpr int n = 256;
    for (int i = 0; i < n; ++i) {
        // a cell extends below the next one, so that no seam is left
        const double left = bar.left + i * bar.width / n, right = std::min(left + 2 * bar.width / n, bar.right());
        canvas.fill({{left, bar.bottom}, {right, bar.bottom}, {right, bar.top()}, {left, bar.top()}},
                    scale(scale.low + (scale.high - scale.low) * (i + 0.5) / n));
    }
    std::vector<Vec2> outline;
    const auto end = [&](bool arrow, double x, double out, double value) {
        const Vec2 lower(x, bar.bottom), upper(x, bar.top()), tip(x + out * bar_arrow, bar.bottom + 0.5 * bar.height);
        const Vec2 inside(0.3 * out, 0);
        if (arrow) canvas.fill({lower - inside, tip, upper - inside}, scale(value));
        const std::vector<Vec2> points = arrow ? std::vector{lower, tip, upper} : std::vector{lower, upper};
        if (out < 0) outline.insert(outline.end(), points.rbegin(), points.rend());
        else outline.insert(outline.end(), points.begin(), points.end());
    };
    end(scale.more_below, bar.left, -1, scale.low);
    end(scale.more_above, bar.right(), 1, scale.high);
    outline.push_back(Vec2(outline.front()));
    canvas.line(outline, ink, 0.5);

    const DisplayUnit unit = display_unit(std::max(std::abs(scale.low), std::abs(scale.high)), scale.unit);
    const double low = scale.low * unit.factor, high = scale.high * unit.factor;
    const Ticks ticks = fitting_ticks(low, high, bar.width, 7);
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        const Vec2 at(bar.left + bar.width * (ticks.at[i] - low) / (high - low), bar.bottom);
        canvas.line({at, at - Vec2(0, 3)}, ink, 0.6);
        canvas.text(at - Vec2(0, 4.5), ticks.labels[i], {.across = Across::centre, .along = Along::top});
    }
    canvas.text({bar.left + 0.5 * bar.width, bar.bottom - 17}, with_unit(scale.quantity, unit.unit),
                {.across = Across::centre, .along = Along::top});
}

}  // namespace

double entries_width(const std::vector<LegendEntry>& entries) {
    double widest = 0;
    for (const LegendEntry& entry : entries)
        for (const std::string& line : lines_of(entry, symbol + gap + max_label_width))
            widest = std::max(widest, text_width(line));
    return symbol + gap + widest;
}

double entries_height(const std::vector<LegendEntry>& entries, double width) {
    double height = 0;
    for (const LegendEntry& entry : entries) height += leading * static_cast<double>(lines_of(entry, width).size());
    return height;
}

void draw_entries(Canvas& canvas, const std::vector<LegendEntry>& entries, const Area& area) {
    double room = std::max(1., 1 + std::floor((area.height - type_size) / leading));  // [lines]
    double y = area.top() - 5;
    const auto label = [&](const std::string& text) {
        canvas.text({area.left + symbol + gap, y}, text, {.along = Along::middle});
        y -= leading;
    };
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const LegendEntry& entry = entries[i];
        const std::vector<std::string> lines = lines_of(entry, area.width);
        room -= static_cast<double>(lines.size());
        if (room < (i + 1 < entries.size() ? 1 : 0))
            return label("and " + std::to_string(entries.size() - i) + " more");
        const double cap = entry.dash == 0 ? 0.5 * entry.width : 0;  // solid lines have round ends
        canvas.line({{area.left + cap, y}, {area.left + symbol - cap, y}}, entry.colour, entry.width,
                    line_pattern(entry.dash, entry.width));
        canvas.marker(entry.marker, {area.left + symbol / 2, y}, entry.colour);
        for (const std::string& line : lines) label(line);
    }
}

Legend joined(Legend all, const Legend& other) {
    if (!all.bar) all.bar = other.bar;
    if (all.note.empty()) all.note = other.note;
    for (const LegendEntry& entry : other.entries)
        if (std::ranges::count(all.entries, entry.label, &LegendEntry::label) == 0) all.entries.push_back(entry);
    return all;
}

double legend_height(const Legend& legend, double width) {
    double height = legend.bar || !legend.note.empty() ? height_with_bar : 0;
    const Columns columns = columns_of(legend, width);
    for (const auto& entries : columns.entries) height = std::max(height, entries_height(entries, columns.width) + 7);
    return height;
}

void draw_legend(Canvas& canvas, const Legend& legend, const Area& area) {
    const Columns columns = columns_of(legend, area.width);
    const bool both = columns.part > 0;
    if (legend.bar)
        draw_colour_bar(
            canvas, *legend.bar,
            {area.left + (both ? 0 : 0.15 * area.width), area.bottom, (both ? 0.58 : 0.7) * area.width, area.height});
    else canvas.text({area.left, area.top() - 5}, legend.note, {.along = Along::middle});
    for (std::size_t i = 0; i < columns.entries.size(); ++i)
        draw_entries(canvas, columns.entries[i],
                     {area.left + columns.part + static_cast<double>(i) * (columns.width + column_gap), area.bottom,
                      columns.width, area.height});
}

}  // namespace knap
