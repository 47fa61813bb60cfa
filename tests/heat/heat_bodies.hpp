#pragma once
// Bodies with temperatures.
#include "model/make_model.hpp"
#include "support/bodies.hpp"

namespace knap::tests {

constexpr Elastic unit{.density = 1, .E = 1, .nu = 0.3};
constexpr Elastic layered{
    .density = 1, .E = 1, .nu = 0.3, .bedding = Bedding{.E = 0.4, .nu = 0.2, .G = 0.15, .angle = 0.5}};
constexpr double a = 1e-5;  // [1/K] of expansion
/// Cohesion everywhere, so that temperatures tear a body of `unit` apart.
inline const CohesiveLaw weak{.sigma_c = 4e-4, .G_c = 3e-7, .gamma = 1, .friction = 0.3};

inline Heat field(const std::string& formula, std::vector<double> expansion, TimeFunction history = {}) {
    Heat heat;
    heat.field = {Expression(formula), std::move(history)};
    for (const double a : expansion) heat.materials.push_back({.expansion = {.coefficient = a}});
    return heat;
}

inline ModelInput heated(Mesh mesh, const Heat& heat, const Elastic& elastic,
                         const CohesiveLaw& law = CohesiveLaw::unbreakable(), PlaneModel plane = PlaneModel::stress) {
    ModelInput input;
    input.plane = plane;
    input.mesh = std::move(mesh);
    input.materials.assign(heat.materials.size(), elastic);
    input.laws = {law};
    input.law_of_pair.assign(heat.materials.size(), std::vector<Index>(heat.materials.size(), 0));
    input.heat = std::make_shared<Heat>(heat);
    return input;
}

/// Prescribed motion zero in a small box round a place.
inline Load pin(const Vec2& at, bool x, bool y, double reach = 1e-9) {
    Load held{.kind = Load::Kind::displacement, .on = {.box = Box{at - Vec2(reach, reach), at + Vec2(reach, reach)}}};
    if (x) held.value[0] = 0;
    if (y) held.value[1] = 0;
    return held;
}

/// Statically determinate supports of a rectangle of this length.
inline std::vector<Load> pins(double length) { return {pin({0, 0}, true, true), pin({length, 0}, false, true)}; }

struct Still {
    explicit Still(ModelInput input, const SchemeOptions& options = {.bulk = BulkScheme::implicit_theta})
        : model(make_model(std::move(input))), stepper(model, options), now(initial_state(model)) {
        stepper.start_in_equilibrium(now);
    }
    Still(const Still&) = delete;  // the stepper refers to the model

    Eigen::Vector3d stress(Index triangle) const { return knap::stress(model, now, triangle); }
    double largest_stress() const {
        double largest = 0;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t)
            for (Index k = 0; k < 3; ++k)
                largest =
                    std::max(largest, knap::stress(model, now, t, coordinates(model.mesh, k)).cwiseAbs().maxCoeff());
        return largest;
    }
    double strain_energy() const { return EnergyLedger(model, now).row().strain; }

    Model model;
    MoreauJean stepper;
    State now;
};

}  // namespace knap::tests
