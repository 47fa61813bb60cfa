#include "stepper/common/elastic_energy.hpp"

#include "element/elastic_forces.hpp"

namespace knap {

double elastic_energy(const Model& model, const State& state, std::vector<Vec2>& force) {
    const ElasticForces elastic(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation);
    force.resize(model.mesh.n_corners());
    std::vector<std::uint8_t> unused;
    double energy =
        elastic.evaluate(0, model.mesh.n_triangles(), state.displacement, state.node_of_corner, force.data(), unused);
    for (Index c = 0; c < model.mesh.n_corners() && !model.large_rotation; ++c)
        energy -= 0.5 * force[c].dot(state.displacement[state.node_of_corner[c]]);
    return energy;
}

}  // namespace knap
