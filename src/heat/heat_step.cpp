#include "heat/heat_step.hpp"

namespace knap {

HeatStep::HeatStep(const Model& model) : model_(model), is_constant_(!model.heat->changes()) {
    if (model.heat->conduction) conduction_.emplace(model);
}

SharedTemperatures HeatStep::after(const State& begin, double h, bool implicit_bulk) {
    if (is_constant_) return begin.temperature;
    if (!implicit_bulk && (begin.n_steps + 1) % model_.heat->every != 0) return begin.temperature;
    const double end = begin.time + h;
    if (!conduction_) {
        if (implicit_bulk) return field_at(model_, end);
        const TimeFunction& history = model_.heat->field.history;
        return field_at(model_, end, history.over_step(begin.temperature->time, end, 1));
    }
    return implicit_bulk ? conduction_->implicit_step(begin, end) : conduction_->explicit_step(begin, end);
}

}  // namespace knap
