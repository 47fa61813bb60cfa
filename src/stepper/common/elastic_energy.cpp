#include "stepper/common/elastic_energy.hpp"

#include "element/elastic_forces.hpp"
#include "element/thermal_stress.hpp"

namespace knap {

double elastic_energy(const Model& model, const State& state, std::vector<Vec2>& force) {
    const ElasticForces elastic(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation);
    force.resize(model.mesh.n_corners());
    std::vector<std::uint8_t> unused;
    double energy =
        elastic.evaluate(0, model.mesh.n_triangles(), state.displacement, state.node_of_corner, force.data(), unused);
    if (state.temperature) {  // 1/2 int sigma : (eps - e)
        const ThermalStress thermal(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation);
        const std::vector<double>& strain = state.temperature->strain;
        if (model.large_rotation) {
            const Index n = model.mesh.n_triangles();
            energy += thermal.energy(0, n, state.displacement, state.node_of_corner, strain);
            thermal.evaluate(0, n, state.displacement, state.node_of_corner, strain, strain, force.data(), unused);
        } else {
            thermal.add_forces(strain, 1, force);
            energy -= 0.5 * thermal.product(state.displacement, state.node_of_corner, strain, strain);
        }
    }
    for (Index c = 0; c < model.mesh.n_corners() && !model.large_rotation; ++c)
        energy -= 0.5 * force[c].dot(state.displacement[state.node_of_corner[c]]);
    return energy;
}

LeapfrogEnergies leapfrog_energies(const Model& model, const State& state) {
    State before = state;
    for (std::size_t n = 0; n < before.displacement.size(); ++n)
        before.displacement[n] -= state.last_step * before.velocity[n];
    if (state.last_step > 0) before.temperature = state.temperature_before;
    std::vector<Vec2> force;
    LeapfrogEnergies energies{.elastic = elastic_energy(model, before, force)};
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Vec2& velocity = before.velocity[before.node_of_corner[c]];
        energies.work += state.last_step * force[c].dot(velocity);
        energies.kinetic += 0.5 * model.corner_mass[c] * velocity.squaredNorm();
    }
    if (before.temperature != state.temperature) {
        const ThermalStress thermal(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation);
        const std::vector<double>& e = before.temperature->strain;
        std::vector<double> change = state.temperature->strain;
        for (std::size_t i = 0; i < e.size(); ++i) change[i] -= e[i];
        energies.work += thermal.product(before.displacement, before.node_of_corner, e, change);
    }
    energies.strain = energies.elastic - 0.5 * energies.work;
    return energies;
}

}  // namespace knap
