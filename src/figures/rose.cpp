// The rose diagram of broken interfaces.
#include "analysis/breaks.hpp"
#include "figures/key.hpp"
#include "figures/rock_figures.hpp"
#include "figures/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr double plot_top = 376, degree = std::numbers::pi / 180, petal_width = 180. / n_petals;  // [unit], [deg]
constexpr Colour ring_colour{0.8, 0.8, 0.8};

Vec2 direction(double angle) { return {std::cos(angle * degree), std::sin(angle * degree)}; }

/// From angle to angle [deg], counterclockwise, about `centre`.
std::vector<Vec2> arc(const Vec2& centre, double radius, double from, double to) {
    const int n = std::max(2, static_cast<int>(std::ceil((to - from) / 2)));
    std::vector<Vec2> points;
    for (int i = 0; i <= n; ++i) points.push_back(centre + radius * direction(from + (to - from) * i / n));
    return points;
}

/// Between two radii.
std::vector<Vec2> sector(const Vec2& centre, double inner, double outer, double from, double to) {
    std::vector<Vec2> outline = arc(centre, outer, from, to), back = arc(centre, inner, from, to);
    outline.insert(outline.end(), back.rbegin(), back.rend());
    return outline;
}

/// Of the rings, below the rose where no petal is, from its middle to the right.
void draw_scale(Canvas& canvas, const Vec2& begin, double length, const std::vector<double>& radii, const std::vector<std::string>& labels) {
    canvas.line({begin, begin + Vec2(length, 0)}, ink, 0.6);
    canvas.text(begin + Vec2(length + 6, 0), "%", {.size = 9, .along = Along::middle});
    double taken = 0;  // by labels
    for (std::size_t i = 0; i < radii.size(); ++i) {
        const Vec2 at = begin + Vec2(radii[i], 0);
        canvas.line({at, at - Vec2(0, 3)}, ink, 0.6);
        const double half = 0.5 * text_width(labels[i], 9);
        if (at.x() - half < taken + 4) continue;
        canvas.text(at - Vec2(0, 5), labels[i], {.size = 9, .across = Across::centre, .along = Along::top});
        taken = at.x() + half;
    }
}

}  // namespace

std::vector<Petal> petals(const History& breaks) {
    std::vector<Petal> found(n_petals);
    const std::vector<double> angle = breaks.column("angle"), length = breaks.column("length"), shear = breaks.column("shear");
    for (std::size_t i = 0; i < angle.size(); ++i) {
        Petal& petal = found[std::clamp(static_cast<int>(angle[i] / petal_width), 0, n_petals - 1)];
        (is_shear(shear[i]) ? petal.shear : petal.tensile) += length[i];
    }
    return found;
}

DrawnFigure draw_rose(const History& breaks, const std::string& title, const std::filesystem::path& file, int pixels) {
    const Title heading = fitted_title(title, "", page_width - 60);
    Canvas canvas(file, plot_top + heading.height(), pixels);
    const Vec2 centre(200, 196);
    constexpr double radius = 138;
    const std::vector<Petal> all = petals(breaks);
    double total = 0, longest = 0;
    for (const Petal& petal : all) total += petal.length(), longest = std::max(longest, petal.length());
    // the area of a petal is its part of the length: radii go with the square root
    const Ticks rings = round_ticks(0, 100 * (total > 0 ? longest / total : 1), 4);
    const double largest = std::max(rings.at.back(), 100 * (total > 0 ? longest / total : 1));
    const auto radius_of = [&](double part) { return radius * std::sqrt(100 * part / largest); };
    for (std::size_t i = 0; i < all.size() && total > 0; ++i)
        for (const double turned : {0., 180.}) {
            const double from = turned + petal_width * static_cast<double>(i), to = from + petal_width;
            const double inner = radius_of(all[i].tensile / total), outer = radius_of(all[i].length() / total);
            if (inner > 0) canvas.fill(sector(centre, 0, inner, from, to), curve_colour(0));
            if (outer > inner) canvas.fill(sector(centre, inner, outer, from, to), curve_colour(1));
            if (outer > 0) canvas.line(sector(centre, 0, outer, from, to), white, 0.7);
        }
    for (std::size_t i = 0; i < rings.at.size(); ++i) {
        if (rings.at[i] <= 0) continue;
        const double r = radius_of(rings.at[i] / 100);
        canvas.line(arc(centre, r, 0, 360), ring_colour, 0.6);
    }
    std::vector<double> radii;
    for (const double ring : rings.at) radii.push_back(radius_of(ring / 100));
    draw_scale(canvas, centre - Vec2(0, radius + 30), radius, radii, rings.labels);
    canvas.line(arc(centre, radius, 0, 360), ink, 0.8);
    for (int angle = 0; angle < 360; angle += 30) {
        const Vec2 out = direction(angle);
        canvas.line({centre + radius * out, centre + (radius + 4) * out}, ink, 0.8);
        const Across across = out.x() > 0.3 ? Across::left : out.x() < -0.3 ? Across::right : Across::centre;
        canvas.text(centre + (radius + 8) * out, std::to_string(angle % 180) + "°", {.size = type_size, .across = across, .along = Along::middle});
    }
    draw_title(canvas, heading, centre.x() - radius - 30, page_width - 30, plot_top);
    const double beside = centre.x() + radius + 52;
    draw_key(canvas, {{"tension", curve_colour(0), 9}, {"shear", curve_colour(1), 9}}, {beside, 0, page_width - beside, 324});
    canvas.text({beside, 276}, "area: part of the", {.size = type_size});
    canvas.text({beside, 262}, "broken length", {.size = type_size});
    canvas.text({beside, 240}, std::to_string(breaks.rows.size()) + " interfaces", {.size = type_size});
    const DisplayUnit unit = display_unit(total, "m");
    canvas.text({beside, 226}, short_number(total * unit.factor) + " " + unit.unit, {.size = type_size});
    canvas.finish();
    return {file, canvas.height(), canvas.texts()};
}

}  // namespace knap
