#include "observe/energy_ledger.hpp"

#include "bulk/elastic_forces.hpp"
#include "bulk/triangle_matrices.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {

namespace {

/// 1/2 u' K u of a state at rest [J].
double strain_energy(const Model& model, const State& state) {
    const ElasticForces elastic(model.mesh, model.materials, model.plane, model.thickness);
    std::vector<Vec2> force(model.mesh.n_corners());
    std::vector<std::uint8_t> unused;
    elastic.evaluate(state.displacement, state.node_of_corner, force, unused);
    double energy = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) energy -= 0.5 * force[c].dot(state.displacement[state.node_of_corner[c]]);
    return energy;
}

/// 1/2 v' M v [J]
double kinetic_energy(const Model& model, const State& state, MassMatrix mass) {
    const auto velocity = [&](Index corner) -> const Vec2& { return state.velocity[state.node_of_corner[corner]]; };
    double energy = 0;
    if (mass == MassMatrix::lumped) {
        for (Index c = 0; c < model.mesh.n_corners(); ++c) energy += 0.5 * model.corner_mass[c] * velocity(c).squaredNorm();
        return energy;
    }
    const ElementMatrix& parts = mass_matrix(model.mesh.order, mass);
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) energy += 0.5 * parts(i, j) * model.triangle_mass(t) * velocity(n * t + i).dot(velocity(n * t + j));
    return energy;
}

}  // namespace

EnergyLedger::EnergyLedger(const Model& model, const State& start, MassMatrix mass) {
    row_.kinetic = kinetic_energy(model, start, mass);
    row_.strain = strain_energy(model, start);
    for (std::size_t o = 0; o < model.obstacles.size(); ++o) row_.kinetic += kinetic_energy(model.obstacles[o], start.obstacles[o].velocity);
    row_.time = start.time;
    start_energy_ = largest_energy_ = row_.kinetic + row_.strain;
    mass_ = std::accumulate(model.corner_mass.begin(), model.corner_mass.end(), 0.0);
}

void EnergyLedger::add(const State& end, const StepReport& report) {
    row_.time = end.time;
    row_.kinetic = report.kinetic;
    row_.strain = report.strain;
    row_.surface = report.surface;
    row_.external_work += report.external_work;
    row_.cohesive_work += report.cohesive_work;
    row_.friction_work += report.friction_work;
    row_.impact_work += report.impact_work;
    row_.step_change_work += report.step_change_work;
    row_.scheme_dissipation += report.scheme_dissipation;
    const double given = row_.external_work - row_.cohesive_work + row_.friction_work + row_.impact_work + row_.step_change_work - row_.scheme_dissipation;
    row_.residual = row_.kinetic + row_.strain - start_energy_ - given;
    row_.crossing_loss += report.crossing_loss;
    row_.law_lag = row_.cohesive_work - row_.crossing_loss - row_.surface;
    largest_energy_ = std::max({largest_energy_, row_.kinetic, row_.strain, std::abs(row_.external_work), row_.surface});
    if (!(std::abs(row_.residual) <= largest_residual_)) largest_residual_ = std::abs(row_.residual);  // what is no number is the worst of all
    largest_law_lag_ = std::max(largest_law_lag_, std::abs(row_.law_lag));

    StepReport extremes = report;
    extremes.largest_speed = std::max(worst_.largest_speed, report.largest_speed);
    worst_ += extremes;
}

Gates EnergyLedger::gates(double largest_delta_c, double length) const {
    const double scale = largest_energy_ > 0 ? largest_energy_ : 1;
    const auto at_most = [](const char* name, double value, double limit, const char* meaning) { return Gate{name, value, limit, value <= limit, meaning}; };
    // Rates are exact to what the solvers leave, which is rounding times the condition of what they solve. Usual is 1e-16; of 20 000 random runs with
    // friction up to 1000, solved vertex by vertex, three were above 1e-14, the worst had 4.5e-14.
    const double sign = 1e-12;
    // no point can be faster than if all energy that ever was in the body sat in a mass as small as its parts allow; the mean is the scale
    const double speed = std::sqrt(2 * scale / mass_);
    return {at_most("energy_residual", largest_residual_ / scale, 1e-10, "error of the discrete energy identity over the largest energy"),
            at_most("impact_work", worst_.worst_impact_work / scale, sign,
                    "largest work of one impact in one step over the largest energy; a positive one injects energy"),
            at_most("friction_work", worst_.worst_friction_work / scale, sign,
                    "largest work of one sliding point in one step over the largest energy; a positive one injects energy"),
            at_most("cohesion_growth", worst_.largest_beta_growth, 0, "largest growth of the cohesion; it never heals"),
            at_most("interface_residual", worst_.residual, most_residual, "worst violation of the interface laws, scaled"),
            at_most("largest_speed", worst_.largest_speed, 100 * speed, "[m/s] against 100 times the speed that all energy gives the whole mass"),
            at_most("penetration", worst_.penetration, std::max(largest_delta_c, 1e-3 * length), "[m] against the critical opening, or a thousandth of the body")};
}

}  // namespace knap
