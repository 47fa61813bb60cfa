#include "model/time_tables.hpp"

#include <algorithm>

namespace knap {

double step_to_corner(const Model& model, double begin, double h) {
    double end = begin + h;
    const double shortest = nearest_corner * h;
    bool again = true;
    const auto end_at = [&](double corner) {
        if (!(corner < end)) return false;
        end = corner, again = true;
        return true;
    };
    const auto look_at = [&](const TimeFunction& history) {
        while (end_at(history.corner(begin, end, shortest))) {
        }
    };
    while (again) {  // a shorter step may pass over what the longer one did not
        again = false;
        for (const TimeFunction& history : model.histories) look_at(history);
        for (const Obstacle& obstacle : model.obstacles) {
            for (const Drive& drive : obstacle.drive) look_at(drive.history);
            for (const ObstacleForce& force : obstacle.forces) look_at(force.history);
        }
        if (!model.heat) continue;
        if (!model.heat->conduction) {
            const TemperatureField& field = model.heat->field;
            look_at(field.history);
            if (field.grid) end_at(field.grid->corner(begin, end, shortest));
        }
        for (const HeatExchange& exchange : model.heat->exchanges)
            if (exchange.kind == HeatExchange::Kind::temperature || exchange.kind == HeatExchange::Kind::convection)
                look_at(exchange.history);
    }
    return end < begin + h ? end - begin : h;
}

Rise largest_rise(const TimeFunction& history, double first, double window, double end) {
    Rise rise;
    const auto value = [&](double t) { return t < 0 ? first : history(t); };
    const auto look_at = [&](double t) {
        if (t < 0 || t >= end) return;
        rise.include(history(t) - value(t - window), std::max(0.0, t - window));
        rise.include(history(t + window) - history(t), t);
    };
    rise.include(history(0) - first, 0);
    std::ranges::for_each(history.time, look_at);
    return rise;
}

}  // namespace knap
