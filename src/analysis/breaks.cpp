#include "analysis/breaks.hpp"

#include <cmath>
#include <numbers>

namespace knap {

std::span<const Measure<Break>> break_columns() {
    using B = Break;
    static constexpr Measure<B> columns[] = {
        {"time", "s", "end of the step in which the last point of the interface lost its cohesion",
         [](const B& b) { return b.time; }},
        {"x", "m", "x of the middle of the interface in the undeformed body", [](const B& b) { return b.middle.x(); }},
        {"y", "m", "y of the middle of the interface", [](const B& b) { return b.middle.y(); }},
        {"angle", "deg", "angle of the interface to the x axis, 0 to 180", [](const B& b) { return b.angle; }},
        {"length", "m", "length of the interface", [](const B& b) { return b.length; }},
        {"shear", "",
         "part of sliding in the opening at which the interface broke: 0 opened, 1 slid; above 1/2 it counts as a "
         "shear break",
         [](const B& b) { return b.shear; }},
        {"energy", "J",
         "fracture energy of the interface: G_c (at the temperature of the moment; with a G_II that of its mode mix) "
         "times its area",
         [](const B& b) { return b.energy; }},
        {"opening", "m", "mean opening of the interface at this time", [](const B& b) { return b.jump.x(); }},
        {"slip", "m",
         "mean slip of the interface at this time: of its left side, seen along `angle`, over the right one; positive: "
         "dextral",
         [](const B& b) { return b.jump.y(); }}};
    return columns;
}

Breaks::Breaks(const Model& model, const State& start)
    : model_(model),
      settled_(model.n_points(), 0),
      n_broken_(model.interfaces.size(), 0),
      shear_(model.interfaces.size(), 0.0) {
    settle(start);
}

/// What has no cohesion breaks no more.
void Breaks::settle(const State& start) {
    for (std::size_t s = 0; s < start.split_fans.size(); ++s) {
        const Fan& fan = model_.fans[start.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k)
            settled_[model_.fan_points[fan.first_point + k].point] =
                start.points[start.first_point[s] + k].cohesion <= 0;
    }
}

void Breaks::renumber(const State& now, const Renumbering& numbers) {
    settled_.assign(model_.n_points(), 0);
    settle(now);
    std::vector<std::uint8_t> n_broken(model_.interfaces.size(), 0);
    std::vector<double> shear(model_.interfaces.size(), 0.0);
    for (std::size_t i = 0; i < n_broken_.size(); ++i)
        if (const Index next = numbers.interface[i]; next >= 0) n_broken[next] = n_broken_[i], shear[next] = shear_[i];
    n_broken_ = std::move(n_broken), shear_ = std::move(shear);
}

std::vector<std::vector<double>> Breaks::found(const State& now) {
    std::vector<std::vector<double>> lines;
    for (std::size_t s = 0; s < now.split_fans.size(); ++s) {
        const Fan& fan = model_.fans[now.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k) {
            const FanPoint& point = model_.fan_points[fan.first_point + k];
            std::uint8_t& settled = settled_[point.point];
            if (settled || now.points[now.first_point[s] + k].cohesion > 0) continue;
            settled = 1;
            const CohesiveLaw& law = law_of(model_, now, point);
            if (point.cracked || law.sigma_c <= 0) continue;
            const Index i = model_.interface_of(point.point);
            const Interface& interface = model_.interfaces[i];
            const Vec2 jump = opening(model_, now, point.point);
            const double slid = law.slip_part(jump.x(), jump.y());
            shear_[i] += point.area / (interface.length * model_.thickness) * slid;
            if (++n_broken_[i] < model_.points_per_interface()) continue;
            ++(is_shear(shear_[i]) ? n_shear_ : n_tensile_);
            const Vec2 a = model_.mesh.vertices[interface.vertex[0]], b = model_.mesh.vertices[interface.vertex[1]];
            double angle = std::atan2(b.y() - a.y(), b.x() - a.x()) * 180 / std::numbers::pi;
            if (angle < 0) angle += 180;
            if (angle >= 180) angle -= 180;
            double factor = 1;  // of incubated strengths, by area
            Vec2 mean(0, 0);    // [m] (u_N, u_T)
            for (Index p = 0; p < model_.points_per_interface(); ++p) {
                const Index number = model_.points_per_interface() * i + p;
                const FanPoint& at = model_.fan_points[model_.fan_point_of[number]];
                const double part = at.area / (interface.length * model_.thickness);
                mean += part * opening(model_, now, number);
                if (!now.incubation.empty())
                    factor += part * (now.strength_factor(model_.fan_of_corner[at.corner()]) - 1);
            }
            const double energy =
                factor * law.G_c * law.energy_factor(mean.x(), mean.y()) * interface.length * model_.thickness;
            // T is N, from side A to side B, turned to the left: A lies to the left of T
            const Break broken{now.time, 0.5 * (a + b),        angle, interface.length, shear_[i],
                               energy,   {mean.x(), -mean.y()}};
            lines.push_back(values_of(break_columns(), broken));
        }
    }
    return lines;
}

}  // namespace knap
