#pragma once
// Rigid obstacles next to the explicit bulk: their motion without the body and the contacts that may close at the start
// of a step, their motion, energies and works at its end.
#include "stepper/explicit/vertex_contacts.hpp"

namespace knap {

class VertexObstacles {
public:
    VertexObstacles(const Model& model, ObstacleStep& obstacles) : model_(model), now_(obstacles) {}

    void begin(const ExplicitStep& step);
    /// The obstacles at the end of the step. `contacts`: those beyond a fan.
    void finish(const ExplicitStep& step, const VertexContacts* contacts, StepReport& report);

private:
    const Model& model_;
    ObstacleStep& now_;
    std::vector<Vec3> wrench_;  // [N s, N s, N m s] per obstacle
};

}  // namespace knap
