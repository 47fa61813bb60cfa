#pragma once
// One implicit step of a bar whose fans are all active, for tests of what works on its points.
#include "model/make_model.hpp"
#include "stepper/implicit/augmented_lagrangian.hpp"
#include "support/bodies.hpp"

namespace knap::tests {

inline Model clamped_bar(Index order, Coupling coupling = Coupling::sum) {
    ModelInput input =
        body_with(order == 1 ? bar_mesh(5, 3, 1, 0.6) : bar_mesh(3, 2, 1, 0.6), {.density = 1, .E = 1, .nu = 0.3},
                  {.sigma_c = 0.05, .G_c = 2e-2, .gamma = 1, .friction = 0, .coupling = coupling});
    input.mesh.order = order;
    input.loads = {load(Load::Kind::velocity, "left", 0, 0), load(Load::Kind::velocity, "left", 1, 0)};
    return make_model(std::move(input));
}

/// The bar is clamped at its left end; its free end was hit.
struct BarStep {
    Model model;
    State begin;
    StepContext step;
    CornerPartition nodes;
    ImplicitBulk bulk;
    ThetaMatrix matrix;
    Iterate x;

    explicit BarStep(Index order, Coupling coupling = Coupling::sum)
        : model(clamped_bar(order, coupling)),
          begin(initial_state(model)),
          bulk(model, MassMatrix::lumped),
          matrix(model, MassMatrix::lumped) {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            begin.velocity[begin.node_of_corner[c]] = {0.3 * model.mesh.corner(c).x() * model.mesh.corner(c).x(), 0};
        step.h = 0.2, step.theta = 0.5, step.implicit_beta = true, step.begin = &begin;
        bulk.begin_step(step);
        partition_corners(model, std::vector<std::uint8_t>(model.fans.size(), 1), nodes);
        std::vector<Vec2> corner_rate;
        for (const Index node : begin.node_of_corner) corner_rate.push_back(Vec2(begin.velocity[node]));
        bulk.set_nodes(nodes, corner_rate, x.rate);
        matrix.set(nodes, step.stiffness_factor());
        for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f)
            for (Index i = model.fans[f].first_point; i < model.fans[f].first_point + model.fans[f].n_points; ++i) {
                ActivePoint& made = x.points.emplace_back(interface_point(model, step, nodes, f, i));
                made.mass = 0.5 * bulk.corner_inertia(model.fan_points[i].after);
                made.multipliers.contact = made.law.strength;
                made.multipliers.rho_N = made.multipliers.rho_T = 10 * made.mass;
                made.rate = made.rate_at(x.rate);
            }
    }

    double scale() const { return x.points[0].law.strength; }
    std::vector<Vec2> impulse() const {
        std::vector<Vec2> of_corner, of_node;
        bulk.impulse(x.rate, of_corner);
        bulk.sum_to_nodes(of_corner, of_node);
        return of_node;
    }
    /// And the responses of the points.
    std::vector<Vec2> residual() {
        std::vector<Vec2> missed = impulse();
        for (ActivePoint& point : x.points) {
            point.response = respond(point.law, point.multipliers, point.rate.x(), point.rate.y());
            point.sides.add_force(-point.impulse(), missed);
        }
        return missed;
    }
};

}  // namespace knap::tests
