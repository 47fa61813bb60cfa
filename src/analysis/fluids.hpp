#pragma once
// Fluids in cracks over a run: pressure, volume, length and aperture of what each of them fills.
#include "output/outputs.hpp"
#include "stepper/common/crack_forces.hpp"

namespace knap {

/// A fluid at a moment of a run.
struct FluidOfRun {
    FluidMoment now;
    double largest_pressure;  // [Pa] of an injected fluid over all steps, else of this moment
};

/// Columns of fluids.csv, and numbers of the summary, after the name of the fluid.
std::span<const Measure<FluidMoment>> fluid_columns();
std::span<const Measure<FluidOfRun>> fluid_numbers();

class Fluids {
public:
    explicit Fluids(const Model& model);

    bool empty() const { return model_.crack_fluids.empty(); }
    void renew() { forces_.emplace(model_); }  // after the model has changed
    /// After every step, for the largest pressures.
    void after_step(const State& state);

    std::vector<std::string> names() const;  // in the order of Model::crack_fluids
    std::vector<FluidOfRun> at(const State& state) const;
    std::vector<std::string> columns() const;
    std::vector<double> line(const State& state) const;

    void serialize(auto& archive) { archive(largest_); }

private:
    const Model& model_;
    mutable std::optional<CrackForces> forces_;  // what it has found grows with the state
    std::vector<double> largest_;                // [Pa]
};

}  // namespace knap
