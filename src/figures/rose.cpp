// The rose diagram of broken interfaces.
#include "analysis/breaks.hpp"
#include "figures/curve_figures.hpp"
#include "figures/plot.hpp"

#include <algorithm>
#include <numbers>

namespace knap {
namespace {

constexpr double petal_angle = 180. / n_petals;  // petal_angle [degree]
constexpr double radius = 138, plot_top = 376;   // [unit]
const Vec2 centre(200, 196);                     // [unit]

Vec2 direction(double angle) { return {std::cos(angle * degree), std::sin(angle * degree)}; }

/// Between two angles [degree], counterclockwise.
std::vector<Vec2> arc(double r, double from, double to) {
    const int n = std::max(2, static_cast<int>(std::ceil((to - from) / 2)));
    std::vector<Vec2> points;
    for (int i = 0; i <= n; ++i) points.push_back(centre + r * direction(from + (to - from) * i / n));
    return points;
}

std::vector<Vec2> sector(double inner, double outer, double from, double to) {
    std::vector<Vec2> outline = arc(outer, from, to);
    const std::vector<Vec2> back = arc(inner, from, to);
    outline.insert(outline.end(), back.rbegin(), back.rend());
    return outline;
}

}  // namespace

std::vector<Petal> petals(const History& breaks) {
    std::vector<Petal> found(n_petals);
    const std::vector<double> angle = breaks.column("angle"), length = breaks.column("length"),
                              shear = breaks.column("shear");
    for (std::size_t i = 0; i < angle.size(); ++i) {
        Petal& petal = found[std::clamp(static_cast<int>(angle[i] / petal_angle), 0, n_petals - 1)];
        (is_shear(shear[i]) ? petal.shear : petal.tensile) += length[i];
    }
    return found;
}

DrawnFigure draw_rose(const History& breaks, const std::string& title, const std::filesystem::path& file, int pixels,
                      const Page& page) {
    const Title heading = fitted_title(title, "", page_width - 60);
    Canvas canvas(file, plot_top + heading.height(), pixels, page);
    const std::vector<Petal> all = petals(breaks);
    double total = 0, longest = 0;
    for (const Petal& petal : all) total += petal.length(), longest = std::max(longest, petal.length());
    const double max_percent = total > 0 ? 100 * longest / total : 100;
    const Ticks rings = round_ticks(0, max_percent, 4);
    // the area of a petal is its share of the length
    const auto radius_of = [&](double percent) {
        return radius * std::sqrt(percent / std::max(rings.at.back(), max_percent));
    };
    for (std::size_t i = 0; i < all.size() && total > 0; ++i)
        for (const double turn : {0., 180.}) {
            const double from = turn + petal_angle * static_cast<double>(i), to = from + petal_angle;
            const double inner = radius_of(100 * all[i].tensile / total),
                         outer = radius_of(100 * all[i].length() / total);
            if (inner > 0) canvas.fill(sector(0, inner, from, to), curve_colour(0));
            if (outer > inner) canvas.fill(sector(inner, outer, from, to), curve_colour(1));
            if (outer > 0) canvas.line(sector(0, outer, from, to), white, 0.7);
        }
    // rings, and their scale below the petals
    const Vec2 start = centre - Vec2(0, radius + 30);
    canvas.line({start, start + Vec2(radius, 0)}, ink, 0.6);
    canvas.text(start + Vec2(radius + 6, 0), "%", {.size = 9, .along = Along::middle});
    double label_end = 0;
    for (std::size_t i = 0; i < rings.at.size(); ++i) {
        const double r = radius_of(rings.at[i]), half_width = 0.5 * text_width(rings.labels[i], 9);
        if (r > 0) canvas.line(arc(r, 0, 360), {0.8, 0.8, 0.8}, 0.6);
        const Vec2 at = start + Vec2(r, 0);
        canvas.line({at, at - Vec2(0, 3)}, ink, 0.6);
        if (at.x() - half_width < label_end + 4) continue;
        canvas.text(at - Vec2(0, 5), rings.labels[i], {.size = 9, .across = Across::centre, .along = Along::top});
        label_end = at.x() + half_width;
    }
    canvas.line(arc(radius, 0, 360), ink, 0.8);
    for (int angle = 0; angle < 360; angle += 30) {
        const Vec2 out = direction(angle);
        canvas.line({centre + radius * out, centre + (radius + 4) * out}, ink, 0.8);
        const Across across = out.x() > 0.3 ? Across::left : out.x() < -0.3 ? Across::right : Across::centre;
        canvas.text(centre + (radius + 8) * out, std::to_string(angle % 180) + "°",
                    {.across = across, .along = Along::middle});
    }
    draw_title(canvas, heading, centre.x() - radius - 30, page_width - 30, plot_top);
    const double right = centre.x() + radius + 52;
    draw_entries(canvas, {{"tension", curve_colour(0), 9}, {"shear", curve_colour(1), 9}},
                 {right, 0, page_width - right, 324});
    const DisplayUnit unit = display_unit(total, "m");
    canvas.text({right, 276}, "area: fraction of", {});
    canvas.text({right, 262}, "the broken length", {});
    canvas.text({right, 240}, std::to_string(breaks.rows.size()) + " interfaces", {});
    canvas.text({right, 226}, short_number(total * unit.factor) + " " + unit.unit, {});
    return canvas.finish();
}

}  // namespace knap
