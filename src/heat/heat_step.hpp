#pragma once
// The temperatures at the end of a mechanical step. The heat goes first, with the openings of the begin; then the
// motion
// has the thermal strains of both ends.
#include "heat/conduction.hpp"

#include <optional>

namespace knap {

class HeatStep {
public:
    HeatStep(const Model& model, bool implicit_bulk);

    /// Those of `begin` themselves where nothing changes: with the explicit bulk all but every N-th step.
    SharedTemperatures after(const State& begin, double h);

private:
    const Model& model_;
    bool implicit_, is_constant_;
    std::optional<Conduction> conduction_;
};

}  // namespace knap
