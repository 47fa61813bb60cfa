#include "figures/colour_bar.hpp"

#include "figures/key.hpp"
#include "figures/ticks.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {
constexpr int n_ticks = 7;
constexpr double bar_height = 9, tick = 3, point = 8;  // [unit]

/// Labels of ticks so far apart [unit] do not touch.
bool have_room(const Ticks& ticks, double apart) {
    return std::all_of(ticks.labels.begin(), ticks.labels.end(), [&](const std::string& label) { return text_width(label, type_size) + 0.6 * type_size < apart; });
}
}

Colour ColourScale::operator()(double value) const {
    const double shown = std::clamp(value, low, high);
    return map(about_zero ? 0.5 + 0.5 * shown / std::max(std::abs(low), std::abs(high)) : (shown - low) / (high - low));
}

ColourRange round_limits(double low, double high, bool is_signed) {
    constexpr double far = 0.25;  // of the other sign
    if (!(low <= high)) return {};
    if (is_signed) {
        low = std::min(low, 0.0), high = std::max(high, 0.0);
        if (-low > far * high && high > far * -low) high = std::max(-low, high), low = -high;
    }
    if (high - low <= 1e-9 * std::max(std::abs(high), std::abs(low))) {
        const double room = high == 0 ? 1 : 0.1 * std::abs(high);
        return {low - (low == 0 && !is_signed ? 0 : room), high + room};
    }
    const auto round = round_range(low, high, n_ticks);
    return {round[0], round[1]};
}

void draw_colour_bar(Canvas& canvas, const ColourScale& scale, const Area& area) {
    const Area bar{area.left + point, area.top() - bar_height, area.width - 2 * point, bar_height};
    constexpr int n = 256;
    const double cell = bar.width / n;
    for (int i = 0; i < n; ++i) {
        // each cell reaches under the next one: no seams
        const double left = bar.left + i * cell, right = std::min(left + 2 * cell, bar.right());
        canvas.fill({{left, bar.bottom}, {right, bar.bottom}, {right, bar.top()}, {left, bar.top()}}, scale(scale.low + (scale.high - scale.low) * (i + 0.5) / n));
    }
    const double middle = bar.bottom + 0.5 * bar.height;
    std::vector<Vec2> outline{{bar.left, bar.top()}, {bar.right(), bar.top()}};
    if (scale.more_above) {
        canvas.fill({{bar.right() - 0.3, bar.bottom}, {bar.right() + point, middle}, {bar.right() - 0.3, bar.top()}}, scale(scale.high));
        outline.push_back({bar.right() + point, middle});
    }
    outline.push_back({bar.right(), bar.bottom});
    outline.push_back({bar.left, bar.bottom});
    if (scale.more_below) {
        canvas.fill({{bar.left + 0.3, bar.bottom}, {bar.left - point, middle}, {bar.left + 0.3, bar.top()}}, scale(scale.low));
        outline.push_back({bar.left - point, middle});
    }
    outline.push_back(outline.front());
    canvas.line(outline, ink, 0.5);

    const DisplayUnit unit = display_unit(std::max(std::abs(scale.low), std::abs(scale.high)), scale.unit);
    Ticks ticks = round_ticks(scale.low * unit.factor, scale.high * unit.factor, n_ticks);
    for (int n = n_ticks - 1; n >= 2 && !have_room(ticks, ticks.step / ((scale.high - scale.low) * unit.factor) * bar.width); --n)
        ticks = round_ticks(scale.low * unit.factor, scale.high * unit.factor, n);
    for (std::size_t i = 0; i < ticks.at.size(); ++i) {
        const double x = bar.left + bar.width * (ticks.at[i] / unit.factor - scale.low) / (scale.high - scale.low);
        canvas.line({{x, bar.bottom}, {x, bar.bottom - tick}}, ink, 0.6);
        canvas.text({x, bar.bottom - tick - 1.5}, ticks.labels[i], {.size = type_size, .across = Across::centre, .along = Along::top});
    }
    canvas.text({bar.left + 0.5 * bar.width, bar.bottom - tick - 14}, with_unit(scale.quantity, unit.unit),
                {.size = type_size, .across = Across::centre, .along = Along::top});
}

}  // namespace knap
