#include "model/time_tables.hpp"

namespace knap {

double step_to_corner(const Model& model, double begin, double h) {
    double end = begin + h;
    const double shortest = nearest_corner * h;
    bool is_shortened = false, again = true;
    const auto look_at = [&](const TimeFunction& history) {
        for (double corner = history.corner(begin, end, shortest); corner < end;
             corner = history.corner(begin, end, shortest))
            end = corner, is_shortened = again = true;
    };
    while (again) {  // a shorter step may pass over what the longer one did not
        again = false;
        for (const TimeFunction& history : model.histories) look_at(history);
        for (const Obstacle& obstacle : model.obstacles) {
            for (const Drive& drive : obstacle.drive) look_at(drive.history);
            for (const ObstacleForce& force : obstacle.forces) look_at(force.history);
        }
        if (!model.heat) continue;
        const TemperatureField& field = model.heat->field;
        if (!model.heat->conduction) look_at(field.history);
        if (const double corner = field.grid && !model.heat->conduction
                                      ? field.grid->corner(begin, end, shortest, TimeFunction::corner_tolerance)
                                      : end;
            corner < end)
            end = corner, is_shortened = again = true;
        for (const HeatExchange& exchange : model.heat->exchanges)
            if (exchange.kind == HeatExchange::Kind::temperature || exchange.kind == HeatExchange::Kind::convection)
                look_at(exchange.history);
    }
    return is_shortened ? end - begin : h;
}

}  // namespace knap
