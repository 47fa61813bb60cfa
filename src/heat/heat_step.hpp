#pragma once
// The temperatures at the end of a mechanical step. The heat goes first, with the openings of the begin; then the
// motion
// has the thermal strains of both ends.
#include "heat/conduction.hpp"

#include <optional>

namespace knap {

class HeatStep {
public:
    explicit HeatStep(const Model& model);

    /// Temperatures after a step; those of `begin` themselves where nothing changes: with the explicit bulk all but
    /// every N-th step.
    SharedTemperatures after(const State& begin, double h, bool implicit_bulk);

private:
    const Model& model_;
    bool is_constant_;
    std::optional<Conduction> conduction_;
};

}  // namespace knap
