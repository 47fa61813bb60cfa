#pragma once
// Runs of the stepper on small bodies.
#include "analysis/energy_ledger.hpp"
#include "model/make_model.hpp"
#include "model/state.hpp"
#include "stepper/moreau_jean.hpp"
#include "support/meshes.hpp"

#include <omp.h>

#include <cstring>
#include <functional>

namespace knap::tests {

/// The bodies are small and the tests run side by side: one thread, unless a test asks for more.
inline const bool one_thread = (omp_set_num_threads(1), true);

inline Load load(Load::Kind kind, const std::string& boundary, std::optional<double> x, std::optional<double> y,
                 TimeFunction history = {}) {
    return {.kind = kind, .on = {.boundary = boundary, .box = {}}, .value = {x, y}, .history = std::move(history)};
}

/// Of one material and one law.
inline ModelInput body_with(Mesh mesh, const Elastic& material, const CohesiveLaw& law) {
    ModelInput input;
    input.mesh = std::move(mesh);
    input.materials = {material};
    input.laws = {law};
    input.law_of_pair = {{0}};
    return input;
}
/// The same with large rotations.
inline ModelInput turning_body(Mesh mesh, const Elastic& material, const CohesiveLaw& law) {
    ModelInput input = body_with(std::move(mesh), material, law);
    input.large_rotation = true;
    return input;
}

/// One triangle with its first edge, along x, on a support: corners 0 and 1 have a point each, of area 1; every corner has mass 1.
inline ModelInput point_masses(const CohesiveLaw& law, bool glued) {
    ModelInput input;
    input.mesh.vertices = {{0, 0}, {2, 0}, {1, 1}};  // the edge has length 2: each of its points has area 1
    input.mesh.triangles = {{0, 1, 2}};
    input.mesh.region = {0};
    input.mesh.boundary_names = {"base", "free"};
    find_edges(input.mesh);
    for (BoundaryEdge& edge : input.mesh.boundary_edges) edge.boundary = edge.side == 0 ? 0 : 1;
    input.materials = {{.density = 3, .E = 0, .nu = 0}};
    input.laws = {law};
    input.law_of_pair = {{0}};
    input.supports = {{.on = {.boundary = "base", .box = {}}, .law = 0, .glued = glued}};
    return input;
}

/// A model with its stepper, its state and its energy ledger.
class Run {
public:
    explicit Run(ModelInput input, const SchemeOptions& scheme = {}) : Run(make_model(std::move(input)), scheme) {}
    explicit Run(Model made, const SchemeOptions& scheme = {})
        : model(std::move(made)), stepper(model, scheme), now(initial_state(model)), ledger(model, now) {}
    Run(const Run&) = delete;  // the stepper refers to the model

    const StepReport& step(double h) {
        last = stepper.step(now, h, next_);
        std::swap(now, next_);
        ledger.add(now, last);
        return last;
    }

    /// False: the step was refused, and nothing has changed.
    bool step_if_taken(double h) {
        last = stepper.step(now, h, next_);
        if (last.rejection != Rejection::none) return false;
        std::swap(now, next_);
        ledger.add(now, last);
        return true;
    }

    /// Displacement and velocity of the corner of `triangle` at its vertex k.
    Vec2 u(Index triangle, Index k) const {
        return now.displacement[now.node_of_corner[model.mesh.corners_per_triangle() * triangle + k]];
    }
    Vec2 v(Index triangle, Index k) const {
        return now.velocity[now.node_of_corner[model.mesh.corners_per_triangle() * triangle + k]];
    }

    /// Mass-weighted mean velocity of all triangles that `chosen` accepts.
    Vec2 mean_velocity(const std::function<bool(Index)>& chosen) const {
        Vec2 momentum = Vec2::Zero();
        double mass = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c) {
            if (!chosen(model.mesh.triangle_of(c))) continue;
            momentum += model.corner_mass[c] * now.velocity[now.node_of_corner[c]];
            mass += model.corner_mass[c];
        }
        return momentum / mass;
    }

    Model model;
    MoreauJean stepper;
    State now;
    EnergyLedger ledger;
    StepReport last;

private:
    State next_;
};

inline bool same_bits(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec2)) == 0;
}

inline bool same_bits(const State& a, const State& b) {
    if (!same_bits(a.displacement, b.displacement) || !same_bits(a.velocity, b.velocity) ||
        a.split_fans != b.split_fans)
        return false;
    for (std::size_t i = 0; i < a.points.size(); ++i)
        if (a.points[i].cohesion != b.points[i].cohesion) return false;
    return true;
}

/// [J] that breaking every interface takes.
inline double energy_of_all_interfaces(const Model& model) {
    double energy = 0;
    for (const Interface& interface : model.interfaces)
        if (!interface.cracked) energy += interface.length * model.thickness * model.laws[interface.law].G_c;
    return energy;
}

}  // namespace knap::tests
