// Sweeps of the fans: the impulses that they hand on are those of the body, and they end in the laws of the points.
#include "stepper/implicit/fan_sweep.hpp"
#include "stepper/implicit/augmented_lagrangian.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace fan_sweep_test {

using namespace knap;
using namespace knap::tests;

namespace {

Model clamped_bar(Index order) {
    ModelInput input;
    input.mesh = order == 1 ? bar_mesh(5, 3, 1, 0.6) : bar_mesh(3, 2, 1, 0.6);
    input.mesh.order = order;
    input.materials = {{.density = 1, .E = 1, .nu = 0.3}};
    input.laws = {{.sigma_c = 0.05, .G_c = 2e-2, .gamma = 1, .friction = 0}};
    input.law_of_pair = {{0}};
    input.loads = {load(Load::Kind::velocity, "left", 0, 0), load(Load::Kind::velocity, "left", 1, 0)};
    return make_model(std::move(input));
}

/// One implicit step of a bar whose fans are all active, and whose free end was hit.
struct BarStep {
    Model model;
    State begin;
    StepContext step;
    CornerPartition nodes;
    ImplicitBulk bulk;
    ThetaMatrix matrix;
    Iterate x;

    explicit BarStep(Index order)
        : model(clamped_bar(order)),
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

}  // namespace

TEST_CASE("a sweep hands on the impulses of the body and leaves prescribed nodes") {
    for (const Index order : {1, 2}) {
        CAPTURE(order);
        BarStep bar(order);
        FanSweep fans(bar.model, bar.matrix);
        fans.begin(bar.x.points);
        const std::vector<Vec2> first = bar.x.rate;
        std::vector<Vec2> impulse = bar.impulse(), residual = bar.residual();
        for (int i = 0; i < 3; ++i) fans.sweep(1e-6 * bar.scale(), bar.x.points, bar.x.rate, impulse, residual);
        const std::vector<Vec2> exact = bar.impulse(), missed = bar.residual();
        double largest = 0, moved = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) largest = std::max(largest, exact[i].norm());
        for (Index i = 0; i < bar.nodes.n_nodes(); ++i) {
            CHECK((impulse[i] - exact[i]).norm() <= 1e-13 * largest);
            CHECK((residual[i] - missed[i]).norm() <= 1e-12 * largest);
            moved = std::max(moved, (bar.x.rate[i] - first[i]).norm());
            for (int k = 0; k < 2; ++k)
                if (bar.nodes.prescribed[i][k]) CHECK(bar.x.rate[i][k] == first[i][k]);
        }
        CHECK(moved > 1e-3);
        for (const ActivePoint& point : bar.x.points)
            CHECK((point.rate - point.rate_at(bar.x.rate)).norm() <= 1e-13 * moved);
    }
}

TEST_CASE("sweeps alone end in the balance and the laws of all points") {
    BarStep bar(1);
    FanSweep fans(bar.model, bar.matrix);
    fans.begin(bar.x.points);
    std::vector<Vec2> impulse = bar.impulse(), residual = bar.residual();
    const double goal = 1e-9 * bar.scale();
    int n_sweeps = 0;
    Index n_open = 0;
    for (double missed = infinity; n_sweeps < 1000 && missed > 10 * goal; ++n_sweeps) {
        fans.sweep(goal, bar.x.points, bar.x.rate, impulse, residual);
        residual = bar.residual();
        std::vector<std::uint8_t> has_point(residual.size(), 0);  // corners of the bar without points keep their rates
        missed = n_open = 0;
        for (ActivePoint& point : bar.x.points) {
            point.sides.for_each_node([&](Index node, double) { has_point[node] = 1; });
            n_open += !point.response.closed;
            missed = std::max({missed, std::abs(point.response.contact - point.multipliers.contact),
                               std::abs(point.response.tangential - point.multipliers.tangential)});
            point.multipliers.contact = point.response.contact;  // of fans that rested, too
            point.multipliers.tangential = point.response.tangential;
        }
        for (std::size_t i = 0; i < residual.size(); ++i)
            for (int k = 0; k < 2; ++k)
                if (has_point[i] && !bar.nodes.prescribed[i][k]) missed = std::max(missed, std::abs(residual[i][k]));
        residual = bar.residual();  // with the new multipliers
    }
    CHECK(n_sweeps < 1000);
    CHECK(n_open > 0);
    CHECK(n_open < static_cast<Index>(bar.x.points.size()));
}

}  // namespace fan_sweep_test
