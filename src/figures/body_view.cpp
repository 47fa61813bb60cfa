#include "figures/body_view.hpp"

#include "figures/key.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

constexpr double room_left = 52, room_right = 16, room_for_axis = 36;  // [unit] round the plot
constexpr double highest = 620, narrowest = 60, panel_margin = 4;
constexpr double tick = 3.5, label_gap = 10, frame_width = 0.7;

/// The surface of a half plane below the middle of the body and a strip of it, where it is not far away.
void include_support(const Frame& frame, Index obstacle, double exaggeration, const Box& near, double size, Box& box) {
    const auto place = [&](Index k) { return Vec2(frame.obstacle_position[k] + exaggeration * frame.obstacle_displacement[k]); };
    const Index first = obstacle * n_outline_points;
    const Vec2 a = place(first), along = (place(first + 1) - a).normalized(), middle = 0.5 * (near.low + near.high);
    const Vec2 foot = a + along.dot(middle - a) * along, inwards = (place(first + 2) - place(first + 1)).normalized();
    if (!near.contains(foot)) return;
    for (const Vec2& x : {foot, Vec2(foot + 0.05 * size * inwards)}) {
        box.low = box.low.cwiseMin(x);
        box.high = box.high.cwiseMax(x);
    }
}

/// How much larger x and y are drawn beside each other.
Vec2 stretch_of(const Box& seen, double aspect) {
    const Vec2 size = seen.high - seen.low;
    return size.x() < size.y() ? Vec2(aspect, 1) : Vec2(1, aspect);
}

/// The deformed body and a margin of 2 % round it.
Box bounds(const Frame& frame, double exaggeration, double aspect) {
    if (frame.position.empty()) return {{0, 0}, {1, 1}};
    Box box{deformed(frame, 0, exaggeration), deformed(frame, 0, exaggeration)};
    const auto include = [&](const Vec2& x) {
        box.low = box.low.cwiseMin(x);
        box.high = box.high.cwiseMax(x);
    };
    for (Index c = 1; c < 3 * frame.n_triangles(); ++c) include(deformed(frame, c, exaggeration));
    // obstacles, too, where they are not far away
    const double size = (box.high - box.low).maxCoeff();
    const Box near{box.low.array() - 0.75 * size, box.high.array() + 0.75 * size};
    for (Index o = 0; o < frame.n_obstacles(); ++o) {
        if (frame.is_half_plane(o)) {
            include_support(frame, o, exaggeration, near, size, box);
            continue;
        }
        for (Index k = o * n_outline_points; k < (o + 1) * n_outline_points; ++k)
            if (const Vec2 x = frame.obstacle_position[k] + exaggeration * frame.obstacle_displacement[k]; near.contains(x)) include(x);
    }
    const Vec2 stretch = stretch_of(box, aspect);
    const Vec2 margin = std::max(0.02 * stretch.cwiseProduct(box.high - box.low).maxCoeff(), 1e-12) * stretch.cwiseInverse();
    return {box.low - margin, box.high + margin};
}

/// As many round ticks as have room beside each other.
Ticks fitting_ticks(double low, double high, double length, double each, bool upright) {
    for (int n = std::clamp(static_cast<int>(length / each), 3, 11);; --n) {
        Ticks ticks = round_ticks(low, high, n);
        double widest = 0;
        for (const std::string& label : ticks.labels) widest = std::max(widest, upright ? type_size : text_width(label, type_size));
        if (n <= 2 || widest + 0.6 * type_size < ticks.step / (high - low) * length) return ticks;
    }
}

}  // namespace

Box seen_part(const FigureOptions& options, const Frame& frame) { return options.box ? *options.box : bounds(frame, options.deform, options.aspect); }

BodyView::BodyView(const Box& seen, const FigureOptions& options, const std::string& title, const std::string& moment, double room_below)
    : seen_(seen), stretch_(stretch_of(seen, options.aspect)), panel_(options.panel), room_below_(room_below) {
    place(panel_ ? panel_margin : room_left);
    // long labels need more room
    if (const double needed = tick + label_gap + widest_label() + type_size + 4; !panel_ && needed > room_left) {
        seen_ = seen;
        place(needed);
    }
    if (!panel_) title_ = fitted_title(title, moment, plot_.width < 0.6 * (page_width - room_left - room_right) ? page_width - room_left - room_right : plot_.width);
    page_height_ = plot_.top() + (panel_ ? panel_margin : title_.height());
}

void BodyView::place(double left) {
    const double right = panel_ ? panel_margin : room_right, widest = page_width - left - right;
    Vec2 size = stretch_.cwiseProduct(seen_.high - seen_.low);
    // a slender body gets some white on both sides, so that the axis has room for its labels
    const Vec2 least(size.y() * narrowest / highest, size.x() * (panel_ ? 0.3 : 1) * narrowest / widest);
    const Vec2 missing = (least - size).cwiseMax(0);
    seen_.low -= 0.5 * missing.cwiseQuotient(stretch_);
    seen_.high += 0.5 * missing.cwiseQuotient(stretch_);
    size += missing;
    const double scale = std::min(widest / size.x(), highest / size.y());
    scale_ = scale * stretch_;
    plot_.width = scale * size.x();
    plot_.height = scale * size.y();
    plot_.left = left + 0.5 * (widest - plot_.width);
    plot_.bottom = panel_ ? panel_margin : room_below_ + room_for_axis;

    unit_ = display_unit(std::max(seen_.high.cwiseAbs().maxCoeff(), seen_.low.cwiseAbs().maxCoeff()), "m");
    x_ticks_ = fitting_ticks(seen_.low.x() * unit_.factor, seen_.high.x() * unit_.factor, plot_.width, 45, false);
    y_ticks_ = fitting_ticks(seen_.low.y() * unit_.factor, seen_.high.y() * unit_.factor, plot_.height, 28, true);
}

double BodyView::widest_label() const {
    double widest = 0;
    for (const std::string& label : y_ticks_.labels) widest = std::max(widest, text_width(label, type_size));
    return widest;
}

Area BodyView::below() const { return {room_left, 0, page_width - room_left - room_right, room_below_}; }

void BodyView::draw_axes(Canvas& canvas) const {
    const Area& p = plot_;
    canvas.rectangle(p, ink, frame_width);
    for (std::size_t i = 0; i < x_ticks_.at.size(); ++i) {
        const double x = on_page({x_ticks_.at[i] / unit_.factor, 0}).x();
        canvas.line({{x, p.bottom}, {x, p.bottom - tick}}, ink, frame_width);
        canvas.text({x, p.bottom - tick - 2}, x_ticks_.labels[i], {.size = type_size, .across = Across::centre, .along = Along::top});
    }
    for (std::size_t i = 0; i < y_ticks_.at.size(); ++i) {
        const double y = on_page({0, y_ticks_.at[i] / unit_.factor}).y();
        canvas.line({{p.left, y}, {p.left - tick, y}}, ink, frame_width);
        canvas.text({p.left - tick - 2.5, y}, y_ticks_.labels[i], {.size = type_size, .across = Across::right, .along = Along::middle});
    }
    const auto name = [&](const char* axis, double stretch) { return with_unit(axis, unit_.unit) + (stretch == 1 ? "" : ", × " + short_number(stretch)); };
    const std::string y_name = name("y", stretch_[1]);
    canvas.text({p.left + 0.5 * p.width, p.bottom - tick - 15}, name("x", stretch_[0]), {.size = type_size, .across = Across::centre, .along = Along::top});
    // along a low plot it may begin below it
    const double middle = std::max(p.bottom + 0.5 * p.height, 0.5 * text_width(y_name, type_size) + 3);
    canvas.text({p.left - tick - label_gap + 2 - widest_label(), middle}, y_name, {.size = type_size, .across = Across::centre, .along = Along::bottom, .angle = 90});
}

void BodyView::draw_frame(Canvas& canvas) const {
    if (panel_) return;
    draw_axes(canvas);
    // a narrow plot has its title over the whole page
    const bool narrow = plot_.width < 0.6 * (page_width - room_left - room_right);
    draw_title(canvas, title_, narrow ? room_left : plot_.left, narrow ? page_width - room_right : plot_.right(), plot_.top());
}

}  // namespace knap
