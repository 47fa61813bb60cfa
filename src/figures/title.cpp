#include "figures/title.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double smallest = 0.8, between = 14;         // part of title_size; [unit] between title and aside
constexpr double above = 19, baseline = 9, leading = 1.3;  // [unit] round one line; distance of lines over their size
constexpr double slack = 0.99;                         // widths differ a little between resolutions

}  // namespace

double Title::height() const {
    const double n = static_cast<double>(std::max<std::size_t>(lines.size(), 1)) - 1 + (aside_below ? 1 : 0);
    return above + baseline + n * leading * size;
}

std::vector<std::string> broken_lines(const std::string& text, double size, double width, bool bold, std::size_t most) {
    std::vector<std::string> lines;
    for (std::size_t from = 0; from < text.size() && lines.size() < most;) {
        const std::string rest = text.substr(from);
        std::size_t n = std::max<std::size_t>(fitting_bytes(rest, size, width, bold), 1);
        if (n < rest.size() && lines.size() + 1 == most) {
            lines.push_back(fitted_text(rest, size, width, bold));
            break;
        }
        if (const std::size_t blank = rest.rfind(' ', n); n < rest.size() && blank != std::string::npos && blank > 0) n = blank;
        lines.push_back(rest.substr(0, n));
        for (from += n; from < text.size() && text[from] == ' ';) ++from;
    }
    return lines;
}

Title fitted_title(const std::string& text, const std::string& aside, double width) {
    Title title{.aside = aside};
    // a long text is no longer measured than it could be shown
    const bool is_short = text.size() < static_cast<std::size_t>(width);
    const double needed = is_short ? text_width(text, title_size, true) : INFINITY, place = slack * width;
    const double beside = place - (aside.empty() ? 0 : text_width(aside, title_size, false) + between);
    for (const double room : {beside, place})
        for (const double size : {1., 0.9, smallest}) {
            if (size * needed > room || (room == beside && beside < place && size == smallest)) continue;
            title.size = size * title_size;
            title.lines = {text};
            title.aside_below = !aside.empty() && !text.empty() && room > beside;
            return title;
        }
    title.size = 0.9 * title_size;
    title.lines = broken_lines(text, title.size, place, true, most_title_lines);
    title.aside_below = !aside.empty() && text_width(title.lines.back(), title.size, true) > beside;
    return title;
}

void draw_title(Canvas& canvas, const Title& title, double left, double right, double bottom) {
    const double step = leading * title.size;
    double y = bottom + baseline + (static_cast<double>(title.lines.size()) - 1 + (title.aside_below ? 1 : 0)) * step;
    for (const std::string& line : title.lines) {
        canvas.text({left, y}, line, {.size = title.size, .bold = true});
        y -= step;
    }
    canvas.text({right, bottom + baseline}, title.aside, {.size = title_size, .across = Across::right});
}

}  // namespace knap
