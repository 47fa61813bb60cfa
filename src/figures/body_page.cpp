#include "figures/body_page.hpp"

#include <map>

namespace knap {
namespace {

constexpr Colour obstacle_colour{0.70, 0.72, 0.76};
constexpr double seen_apart = 0.4;  // [unit] between two faces
constexpr double panel_lines = 1.8;  // a panel is shown smaller: its lines over those of a figure by itself

std::string moment_of(const Frame& frame, const FigureOptions& options) {
    const std::string moment = "t = " + time_text(frame.time);
    const std::string magnified = magnification(options, frame.n_obstacles() > 0);
    return moment + (magnified.empty() ? "" : ", ") + magnified;
}

}  // namespace

BodyPage::BodyPage(const FigureOptions& options, const Frame& frame, const Box& seen, const std::string& title, Legend legend, const std::filesystem::path& file)
    : options_(options),
      frame_(frame),
      file_(file),
      legend_(std::move(legend)),
      view_(seen, options, title, moment_of(frame, options), legend_height(legend_, page_width - 68)),
      canvas_(file, view_.page_height(), options.width) {}

void BodyPage::draw_interfaces(const std::vector<Index>& interfaces, const Colour& colour, double width) {
    std::vector<Vec2> ends;
    for (const Index i : interfaces)
        for (const auto& side : {frame_.side_a[i], frame_.side_b[i]})
            if (side[0] >= 0) ends.insert(ends.end(), {corner(side[0]), corner(side[1])});
    canvas_.segments(ends, colour, options_.panel ? panel_lines * width : width);
}

void BodyPage::draw_open_faces(const std::vector<Index>& interfaces) {
    std::vector<Index> open;
    for (const Index i : interfaces) {
        const auto &a = frame_.side_a[i], &b = frame_.side_b[i];
        if (a[0] >= 0 && b[0] >= 0 && std::max((corner(a[0]) - corner(b[0])).norm(), (corner(a[1]) - corner(b[1])).norm()) > seen_apart) open.push_back(i);
    }
    draw_interfaces(open, outline_colour, outline_width);
}

/// Its outline on the page; of a half plane as much as is seen.
std::vector<Vec2> BodyPage::obstacle(Index o) const {
    std::vector<Vec2> points;
    for (Index i = o * n_outline_points; i < (o + 1) * n_outline_points; ++i) points.push_back(frame_.obstacle_position[i] + options_.deform * frame_.obstacle_displacement[i]);
    if (frame_.is_half_plane(o)) {
        const Vec2 along = (points[0] - points[1]).normalized(), inwards = (points[2] - points[1]).normalized();
        const Vec2 middle = 0.5 * (view_.seen().low + view_.seen().high), foot = points[0] + along.dot(middle - points[0]) * along;
        const double far = (view_.seen().high - view_.seen().low).norm(), deep = far + (middle - foot).norm();
        points = {foot + far * along, foot - far * along, foot - far * along + deep * inwards, foot + far * along + deep * inwards};
    }
    for (Vec2& x : points) x = view_.on_page(x);
    return points;
}

void BodyPage::fill_obstacles() {
    for (Index o = 0; o < frame_.n_obstacles(); ++o) {
        std::vector<Vec2> outline = obstacle(o);
        canvas_.fill(outline, obstacle_colour);
        outline.push_back(Vec2(outline.front()));
        canvas_.line(outline, outline_colour, outline_width);
    }
}

void BodyPage::draw_outline() {
    using Place = std::pair<double, double>;
    std::map<std::pair<Place, Place>, std::pair<Index, Index>> lonely;
    const auto place = [&](Index c) { return Place(frame_.position[c].x(), frame_.position[c].y()); };
    for (Index c = 0; c < 3 * frame_.n_triangles(); ++c) {
        const Index next = c % 3 == 2 ? c - 2 : c + 1;
        if (lonely.erase({place(next), place(c)}) == 0) lonely[{place(c), place(next)}] = {c, next};
    }
    std::vector<Vec2> ends;
    for (const auto& [places, corners] : lonely) ends.insert(ends.end(), {corner(corners.first), corner(corners.second)});
    canvas_.segments(ends, outline_colour, outline_width);
}

DrawnFigure BodyPage::finished() {
    view_.draw_frame(canvas_);
    if (!options_.panel) draw_legend(canvas_, legend_, view_.below());
    canvas_.finish();
    return {file_, canvas_.height(), canvas_.texts()};
}

}  // namespace knap
