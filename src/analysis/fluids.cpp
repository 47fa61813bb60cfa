#include "analysis/fluids.hpp"

#include <algorithm>

namespace knap {

Fluids::Fluids(const Model& model) : model_(model), largest_(model.crack_fluids.size(), 0.0) {
    if (!empty()) renew();
}

void Fluids::after_step(const State& state) {
    for (std::size_t f = 0; f < state.fluid_pressure.size(); ++f)
        largest_[f] = std::max(largest_[f], state.fluid_pressure[f]);
}

std::vector<std::string> Fluids::names() const {
    std::vector<std::string> names;
    for (const CrackFluid& fluid : model_.crack_fluids) names.push_back(model_.load_names[fluid.history]);
    return names;
}

std::vector<FluidOfRun> Fluids::at(const State& state) const {
    std::vector<FluidOfRun> found;
    if (empty()) return found;
    for (const FluidMoment& moment : forces_->moments(state))
        found.push_back({moment, std::max(largest_[found.size()], moment.pressure)});
    return found;
}

std::vector<std::string> Fluids::columns() const {
    std::vector<std::string> all{"time"};
    for (const std::string& name : names())
        for (const std::string& column : names_of(fluid_columns(), name)) all.push_back(column);
    return all;
}

std::vector<double> Fluids::line(const State& state) const {
    std::vector<double> row{state.time};
    for (const FluidOfRun& fluid : at(state)) add_values(fluid_columns(), fluid.now, row);
    return row;
}

std::span<const Measure<FluidMoment>> fluid_columns() {
    using M = FluidMoment;
    static constexpr Measure<M> columns[] = {
        {"_pressure", "Pa",
         "pressure of a fluid in cracks: its mean over the length that it fills; of an injected one that of the last "
         "step, without its gradient",
         [](const M& m) { return m.pressure; }},
        {"_volume", "m3", "volume of the cracks that the fluid fills, over the thickness of the body",
         [](const M& m) { return m.volume; }},
        {"_injected", "m3", "volume that has entered since the start; 0 of a fluid whose pressure is given",
         [](const M& m) { return m.injected; }},
        {"_length", "m", "length of the cracks and joints that it fills", [](const M& m) { return m.length; }},
        {"_sharp_crack", "m",
         "length of the cracks that it has entered, as a sharp crack has it, which takes G_c times its growth: every "
         "interface counts by the part of its fracture energy that it has taken, also in the process zone, wet or not; "
         "a crack with which the run begins as a whole",
         [](const M& m) { return m.sharp_crack; }},
        {"_aperture", "m", "largest opening there", [](const M& m) { return m.aperture; }}};
    return columns;
}

std::span<const Measure<FluidOfRun>> fluid_numbers() {
    using R = FluidOfRun;
    static constexpr Measure<R> numbers[] = {
        {"*_pressure", "Pa",
         "pressure of a fluid in cracks at the end, by the name of the [[pressure]], as in fluids.csv",
         [](const R& r) { return r.now.pressure; }},
        {"*_largest_pressure", "Pa", "that of an injected fluid, the largest over all steps; else as before",
         [](const R& r) { return r.largest_pressure; }},
        {"*_volume", "m3", "volume of the cracks that it fills at the end", [](const R& r) { return r.now.volume; }},
        {"*_length", "m", "their length", [](const R& r) { return r.now.length; }},
        {"*_sharp_crack", "m", "that of sharp cracks, as in fluids.csv", [](const R& r) { return r.now.sharp_crack; }},
        {"*_aperture", "m", "largest opening of the cracks that it fills", [](const R& r) { return r.now.aperture; }}};
    return numbers;
}

}  // namespace knap
