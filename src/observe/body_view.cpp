#include "observe/body_view.hpp"

#include "observe/key.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

namespace {

constexpr double room_left = 52, room_right = 16, room_above = 28;   // [unit] round the plot
constexpr double room_for_axis = 36, room_below = 46;                // [unit] x axis; colour bar and key
constexpr double widest = page_width - room_left - room_right, highest = 620, narrowest = 60;
constexpr double tick = 3.5, frame_width = 0.7;

/// The deformed body and a margin of 2 % round it.
Box bounds(const Frame& frame, double exaggeration) {
    if (frame.position.empty()) return {{0, 0}, {1, 1}};
    Box box{deformed(frame, 0, exaggeration), deformed(frame, 0, exaggeration)};
    for (Index c = 1; c < 3 * frame.n_triangles(); ++c) {
        const Vec2 x = deformed(frame, c, exaggeration);
        box.low = box.low.cwiseMin(x);
        box.high = box.high.cwiseMax(x);
    }
    // obstacles, too, where they are not far away
    const Box near{box.low.array() - 0.75 * (box.high - box.low).maxCoeff(), box.high.array() + 0.75 * (box.high - box.low).maxCoeff()};
    for (std::size_t i = 0; i < frame.obstacle_position.size(); ++i) {
        const Vec2 x = frame.obstacle_position[i] + exaggeration * frame.obstacle_displacement[i];
        if (!near.contains(x)) continue;
        box.low = box.low.cwiseMin(x);
        box.high = box.high.cwiseMax(x);
    }
    const double margin = std::max(0.02 * (box.high - box.low).maxCoeff(), 1e-12);
    return {box.low.array() - margin, box.high.array() + margin};
}

}  // namespace

BodyView::BodyView(const Frame& frame, const FigureOptions& options) : seen_(options.box ? *options.box : bounds(frame, options.deform)) {
    Vec2 size = seen_.high - seen_.low;
    // a slender body gets some white on both sides, so that the axis has room for its labels
    const Vec2 least(size.y() * narrowest / highest, size.x() * narrowest / widest);
    const Vec2 missing = (least - size).cwiseMax(0);
    seen_.low -= 0.5 * missing;
    seen_.high += 0.5 * missing;
    size += missing;
    scale_ = std::min(widest / size.x(), highest / size.y());
    plot_.width = scale_ * size.x();
    plot_.height = scale_ * size.y();
    plot_.left = room_left + 0.5 * (widest - plot_.width);
    plot_.bottom = room_below + room_for_axis;
    page_height_ = plot_.top() + room_above;

    unit_ = display_unit(std::max(seen_.high.cwiseAbs().maxCoeff(), seen_.low.cwiseAbs().maxCoeff()), "m");
    const auto n_ticks = [](double length, double each) { return std::clamp(static_cast<int>(length / each), 3, 11); };
    x_ticks_ = round_ticks(seen_.low.x() * unit_.factor, seen_.high.x() * unit_.factor, n_ticks(plot_.width, 45));
    y_ticks_ = round_ticks(seen_.low.y() * unit_.factor, seen_.high.y() * unit_.factor, n_ticks(plot_.height, 28));
}

Area BodyView::below() const { return {room_left, 0, widest, room_below}; }

void BodyView::draw_axes(Canvas& canvas) const {
    const Area& p = plot_;
    canvas.rectangle(p, ink, frame_width);
    double widest_label = 0;
    for (std::size_t i = 0; i < x_ticks_.at.size(); ++i) {
        const double x = on_page({x_ticks_.at[i] / unit_.factor, 0}).x();
        canvas.line({{x, p.bottom}, {x, p.bottom - tick}}, ink, frame_width);
        canvas.text({x, p.bottom - tick - 2}, x_ticks_.labels[i], {.size = type_size, .across = Across::centre, .along = Along::top});
    }
    for (std::size_t i = 0; i < y_ticks_.at.size(); ++i) {
        const double y = on_page({0, y_ticks_.at[i] / unit_.factor}).y();
        canvas.line({{p.left, y}, {p.left - tick, y}}, ink, frame_width);
        canvas.text({p.left - tick - 2.5, y}, y_ticks_.labels[i], {.size = type_size, .across = Across::right, .along = Along::middle});
        widest_label = std::max(widest_label, canvas.text_width(y_ticks_.labels[i], type_size));
    }
    canvas.text({p.left + 0.5 * p.width, p.bottom - tick - 15}, with_unit("x", unit_.unit),
                {.size = type_size, .across = Across::centre, .along = Along::top});
    canvas.text({p.left - tick - 8 - widest_label, p.bottom + 0.5 * p.height}, with_unit("y", unit_.unit),
                {.size = type_size, .across = Across::centre, .along = Along::bottom, .angle = 90});
}

void BodyView::draw_title(Canvas& canvas, const std::string& title, const std::string& moment) const {
    // a narrow plot has its title over the whole page
    const bool narrow = plot_.width < 0.6 * widest;
    const double left = narrow ? room_left : plot_.left, right = narrow ? page_width - room_right : plot_.right();
    const double y = plot_.top() + 9, moment_width = canvas.text_width(moment, title_size);
    canvas.text({left, y}, canvas.fitted(title, title_size, right - left - moment_width - 14, true), {.size = title_size, .bold = true});
    canvas.text({right, y}, moment, {.size = title_size, .across = Across::right});
}

}  // namespace knap
