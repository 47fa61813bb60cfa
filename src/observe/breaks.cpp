#include "observe/breaks.hpp"

#include <cmath>
#include <numbers>

namespace knap {

Breaks::Breaks(const Model& model, const State& start)
    : model_(model), settled_(model.fan_points.size(), 0), n_broken_(model.interfaces.size(), 0), shear_(model.interfaces.size(), 0.0) {
    for (std::size_t s = 0; s < start.split_fans.size(); ++s) {
        const Fan& fan = model.fans[start.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k) settled_[fan.first_point + k] = start.points[start.first_point[s] + k].cohesion <= 0;
    }
}

std::vector<std::string> Breaks::columns() { return {"time", "x", "y", "angle_deg", "length", "shear", "energy"}; }

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
    return {time, middle.x(), middle.y(), angle, interface.length, shear_[i], model_.laws[interface.law].G_c * interface.length * model_.thickness};
}

}  // namespace knap
