#include "analysis/breaks.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

constexpr std::array columns{
    Measure<Break>{"time", "s", "end of the step in which the last point of the interface lost its cohesion", [](const Break& b) { return b.time; }},
    Measure<Break>{"x", "m", "middle of the interface in the undeformed body", [](const Break& b) { return b.middle.x(); }},
    Measure<Break>{"y", "m", "likewise", [](const Break& b) { return b.middle.y(); }},
    Measure<Break>{"angle", "deg", "of the edge from the x axis, 0 to 180", [](const Break& b) { return b.angle; }},
    Measure<Break>{"length", "m", "of the edge", [](const Break& b) { return b.length; }},
    Measure<Break>{"shear", "", "part of sliding in the opening at which it broke: 0 opened, 1 slid; above 1/2 it counts as a shear break", [](const Break& b) { return b.shear; }},
    Measure<Break>{"energy", "J", "G_c of the interface", [](const Break& b) { return b.energy; }},
};

}  // namespace

std::span<const Measure<Break>> break_columns() { return columns; }

Breaks::Breaks(const Model& model, const State& start)
    : model_(model), settled_(model.fan_points.size(), 0), n_broken_(model.interfaces.size(), 0), shear_(model.interfaces.size(), 0.0) {
    for (std::size_t s = 0; s < start.split_fans.size(); ++s) {
        const Fan& fan = model.fans[start.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k) settled_[fan.first_point + k] = start.points[start.first_point[s] + k].cohesion <= 0;
    }
}

bool Breaks::note(const State& now, const FanPoint& point) {
    const CohesiveLaw& law = model_.laws[point.law];
    if (point.cracked || law.sigma_c <= 0) return false;
    const Index interface = model_.interface_of(point.point);
    const Vec2 jump = opening(model_, now, point.point);
    const double s = law.equivalent_opening(jump.x(), jump.y()), slid = law.gamma * std::abs(jump.y());
    shear_[interface] += point.area / (model_.interfaces[interface].length * model_.thickness) * (s > 0 ? slid / s : 0);
    return ++n_broken_[interface] == model_.points_per_interface();
}

std::vector<std::vector<double>> Breaks::found(const State& now) {
    std::vector<std::vector<double>> lines;
    for (std::size_t s = 0; s < now.split_fans.size(); ++s) {
        const Fan& fan = model_.fans[now.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k) {
            const Index at = fan.first_point + k;
            if (settled_[at] || now.points[now.first_point[s] + k].cohesion > 0) continue;
            settled_[at] = 1;
            const FanPoint& point = model_.fan_points[at];
            if (!note(now, point)) continue;
            const Index interface = model_.interface_of(point.point);
            ++(is_shear(shear_[interface]) ? n_shear_ : n_tensile_);
            lines.push_back(line(now.time, interface));
        }
    }
    return lines;
}

std::vector<double> Breaks::line(double time, Index i) const {
    const Interface& interface = model_.interfaces[i];
    const Vec2 a = model_.mesh.vertices[interface.vertex[0]], b = model_.mesh.vertices[interface.vertex[1]], middle = 0.5 * (a + b), along = b - a;
    double angle = std::atan2(along.y(), along.x()) * 180 / std::numbers::pi;
    if (angle < 0) angle += 180;
    if (angle >= 180) angle -= 180;
    const double energy = model_.laws[interface.law].G_c * interface.length * model_.thickness;
    return values_of(break_columns(), Break{time, middle, angle, interface.length, shear_[i], energy});
}

}  // namespace knap
