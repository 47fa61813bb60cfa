#include "figures/plot.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr Colour grid_colour{0.88, 0.88, 0.88};
constexpr double line_width = 0.7, tick_length = 3.5;  // [unit]
constexpr double above = 19, baseline = 9, title_leading = 1.3,
                 aside_gap = 14;  // [unit] of titles; leading: of their size

}  // namespace

Ticks fitting_ticks(double low, double high, double length, int max_ticks, bool upright, double size) {
    for (int n = max_ticks;; --n) {
        Ticks ticks = round_ticks(low, high, n);
        double widest = upright ? size : 0;
        for (const std::string& label : ticks.labels) widest = std::max(widest, upright ? 0 : text_width(label, size));
        if (n <= 2 || widest + 0.6 * size < ticks.step / (high - low) * length) return ticks;
    }
}

double Axis::shown(double value) const {
    const double scaled = value * unit.factor;
    return !logarithmic ? scaled : scaled > 0 ? std::log10(scaled) : NAN;
}

Axis fitted_axis(const std::string& quantity, const std::string& unit, bool logarithmic, Limits values, bool round) {
    if (logarithmic && !(values.low <= values.high)) values = {1, 1};
    if (!logarithmic && values.low == values.high) values.high = 1;
    Axis axis{.unit = display_unit(std::max(-values.low, values.high), unit), .logarithmic = logarithmic};
    axis.title = with_unit(quantity, axis.unit.unit);
    axis.low = axis.shown(values.low), axis.high = axis.shown(values.high);
    if (logarithmic) {
        const Limits limits = logarithmic_range(axis.low, axis.high);
        axis.low = limits.low, axis.high = limits.high;
    } else if (round) {
        // values a little below zero get a little room below zero, not a whole step
        const bool little_below = axis.low < 0 && -axis.low < 0.05 * axis.high;
        const Limits limits = round_range(little_below ? 0 : axis.low, axis.high, 8);
        axis.low = little_below ? 1.5 * axis.low : limits.low, axis.high = limits.high;
    } else if (const double end = round_range(axis.low, axis.high, 9).high;
               end - axis.high < 0.02 * (axis.high - axis.low)) {
        axis.high = end;  // the last step of a run may end just before a round time
    }
    return axis;
}

Vec2 Plot::on_page(const Vec2& value) const {
    return {area.left + area.width * x.fraction(value.x()), area.bottom + area.height * y.fraction(value.y())};
}

void Plot::fit_ticks(int max_x, int max_y) {
    const auto fit = [&](Axis& axis, double length, int max_ticks, bool upright) {
        axis.ticks = axis.logarithmic ? logarithmic_ticks(axis.low, axis.high)
                                      : fitting_ticks(axis.low, axis.high, length, max_ticks, upright, size);
    };
    fit(x, area.width, max_x, false);
    fit(y, area.height, max_y, true);
}

double Plot::y_label_width() const {
    double widest = 0;
    for (const std::string& label : y.ticks.labels) widest = std::max(widest, text_width(label, size));
    return widest;
}

void Plot::draw_axes(Canvas& canvas, bool grid) const {
    const auto draw = [&](const Axis& axis, const Vec2& along, const Vec2& across, auto label) {
        const Vec2 origin(area.left, area.bottom);
        const auto place = [&](double shown) {
            return Vec2(origin + (shown - axis.low) / (axis.high - axis.low) * along);
        };
        for (const double at : axis.ticks.at)
            if (grid) canvas.line({place(at), place(at) + across}, grid_colour, 0.5);
        for (std::size_t i = 0; i < axis.ticks.at.size(); ++i) {
            const Vec2 at = place(axis.ticks.at[i]), out = tick_length * across.normalized();
            canvas.line({at, at - out}, ink, line_width);
            label(at - out, axis.ticks.labels[i]);
        }
        if (!axis.logarithmic) return;
        for (double exponent = std::floor(axis.low); exponent < axis.high; ++exponent)
            for (int digit = 2; digit <= 9; ++digit)
                if (const double at = exponent + std::log10(digit); at > axis.low && at < axis.high)
                    canvas.line({place(at), place(at) + 3 * across.normalized()}, ink, 0.6);
    };
    draw(x, {area.width, 0}, {0, area.height}, [&](const Vec2& at, const std::string& label) {
        canvas.text(at - Vec2(0, 2), label, {.size = size, .across = Across::centre, .along = Along::top});
    });
    draw(y, {0, area.height}, {area.width, 0}, [&](const Vec2& at, const std::string& label) {
        canvas.text(at - Vec2(2.5, 0), label, {.size = size, .across = Across::right, .along = Along::middle});
    });
    const Vec2 low(area.left, area.bottom), high(area.right(), area.top()), upper_left(low.x(), high.y()),
        lower_right(high.x(), low.y());
    canvas.line({upper_left, low, lower_right}, ink, line_width);
    if (!grid) canvas.line({lower_right, high, upper_left}, ink, line_width);
    canvas.text({area.left + 0.5 * area.width, area.bottom - tick_length - 4 - size}, x.title,
                {.size = size, .across = Across::centre, .along = Along::top});
    // the title of a low plot is longer than its axis: it may start below it, but on the page
    const double middle = std::max(area.bottom + 0.5 * area.height, 0.5 * text_width(y.title, size) + 3);
    canvas.text({area.left - tick_length - 8 - y_label_width(), middle}, y.title,
                {.size = size, .across = Across::centre, .along = Along::bottom, .angle = 90});
}

double Title::height() const {
    const double n = static_cast<double>(std::max<std::size_t>(lines.size(), 1)) - 1 + (aside_below ? 1 : 0);
    return above + baseline + n * title_leading * size;
}

Title fitted_title(const std::string& text, const std::string& aside, double width) {
    const double place = 0.99 * width;  // widths differ slightly between resolutions
    const double next_to_aside = place - (aside.empty() ? 0 : text_width(aside, title_size) + aside_gap);
    // a text of more characters than units does not fit and may be too long to be measured
    const double needed = static_cast<double>(text.size()) < width ? text_width(text, title_size, true) : INFINITY;
    for (const double room : {next_to_aside, place})
        for (const double factor : {1., 0.9, 0.8})
            if (factor * needed <= room && (factor > 0.8 || room == place))
                return {.lines = {text},
                        .aside = aside,
                        .aside_below = !aside.empty() && !text.empty() && room > next_to_aside,
                        .size = factor * title_size};
    Title title{.aside = aside, .size = 0.9 * title_size};
    title.lines = broken_lines(text, title.size, place, true, 8);
    title.aside_below = !aside.empty() && text_width(title.lines.back(), title.size, true) > next_to_aside;
    return title;
}

void draw_title(Canvas& canvas, const Title& title, double left, double right, double bottom) {
    double y = bottom + title.height() - above;
    for (const std::string& line : title.lines) {
        canvas.text({left, y}, line, {.size = title.size, .bold = true});
        y -= title_leading * title.size;
    }
    canvas.text({right, bottom + baseline}, title.aside, {.size = title_size, .across = Across::right});
}

}  // namespace knap
