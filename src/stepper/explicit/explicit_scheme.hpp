#pragma once
// The explicit lumped bulk with a problem of its own for every vertex: central differences, velocities at the middle of the steps.
//
//     M (v+ - v) = k (F - K u) + H' P,     u+ = u + h v+,     k = (previous h + h)/2
#include "stepper/common/step_scheme.hpp"
#include "stepper/explicit/explicit_bulk.hpp"
#include "stepper/explicit/vertex_scheme.hpp"

namespace knap {

class ExplicitScheme : public StepScheme {
public:
    ExplicitScheme(const Model& model, const SchemeOptions& options) : bulk_(model), interfaces_(model, options) {}

    StepReport step(const State& begin, double h, State& end) override {
        bulk_.begin_step(begin, h, free_);
        return interfaces_.advance(begin, bulk_, free_, end);  // forces, who is bonded, who touches, who slides; velocities, openings, cohesion
    }
    double stable_step() const override { return bulk_.stable_step(); }

private:
    ExplicitBulk bulk_;
    VertexScheme interfaces_;
    FreeMotion free_;
};

}  // namespace knap
