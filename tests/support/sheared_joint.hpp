#pragma once
// A closed crack or joint in a block under pressure and shear.
#include "base/random.hpp"
#include "support/bodies.hpp"

#include <cmath>

namespace knap::tests {

constexpr double joint_E = 1e7, joint_pressure = 2e-3 * joint_E;  // [Pa]

struct ShearedJoint {
    double from = 0, to = 12;  // the edges between them at half the height are cracked
    bool rough = false;        // inner vertices are moved at random, so that the crack has kinks
    double sagitta = 0;        // its vertices lie on a parabola
    double shear = 0;          // [Pa]
    bool contact = true;       // [contact]
    bool large_rotation = true;
    CohesiveLaw law = {.sigma_c = infinity, .friction = 0.3};
};

/// A body of 12 x 8 cells of edge 1 that is pressed and sheared through its upper side, within the time 1.
inline ModelInput sheared_joint(const ShearedJoint& joint) {
    constexpr int n_x = 12, n_y = 8;
    ModelInput input;
    input.mesh = bar_mesh(n_x, n_y, n_x, n_y);
    const auto is_cracked = [&](const InteriorEdge& edge) {
        const Vec2 a = input.mesh.corner(edge.triangle[0], edge.side[0]),
                   b = input.mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
        return a.y() == 0.5 * n_y && b.y() == 0.5 * n_y && std::min(a.x(), b.x()) >= joint.from &&
               std::max(a.x(), b.x()) <= joint.to;
    };
    for (InteriorEdge& edge : input.mesh.interior_edges) edge.cracked = is_cracked(edge);
    Random random(3, "rough");
    for (Vec2& x : input.mesh.vertices) {
        const bool is_inner = x.x() > 0 && x.x() < n_x && x.y() > 0 && x.y() < n_y;
        if (joint.rough && is_inner) x += Vec2(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
        if (x.y() == 0.5 * n_y) x.y() += joint.sagitta * (1 - std::pow(2 * x.x() / n_x - 1, 2));
    }
    input.materials = {{.density = 2000, .E = joint_E, .nu = 0.2}};
    input.laws = {joint.law};
    input.law_of_pair = {{0}};
    if (joint.contact)
        input.contact_of_pair = {
            {ContactLaw{.friction = joint.law.friction, .changing = joint.law.friction_changes() ? 0 : -1}}};
    input.large_rotation = joint.large_rotation;
    const TimeFunction ramp{{0, 1}, {0, 1}};
    input.loads = {{.kind = Load::Kind::displacement, .on = {.boundary = "bottom"}, .value = {0, 0}},
                   {.kind = Load::Kind::traction,
                    .on = {.boundary = "top"},
                    .value = {joint.shear, -joint_pressure},
                    .history = ramp}};
    return input;
}

}  // namespace knap::tests
