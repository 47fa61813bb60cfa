#pragma once
// Square plates that several tests load.
#include "mesh/triangulate.hpp"
#include "support/bodies.hpp"

namespace knap::tests {

constexpr double thickness_of_block = 0.5;  // [m]

/// A block of 1 m x 1 m with cracks that the mesh follows, under the pressure of a fluid.
inline ModelInput pressed_block(std::vector<Crack> cracks, const CrackPressure& fluid, double size = 0.1,
                                Index order = 1, const std::vector<RefinedPlace>& refine = {}) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    shape.cracks = std::move(cracks);
    ModelInput input = body_with(triangulate(shape, {.size = size, .refine = refine, .seed = 2}),
                                 {.density = 2500, .E = 30e9, .nu = 0.2}, {.sigma_c = 1e9, .G_c = 1e7, .gamma = 1});
    input.mesh.order = order;
    input.thickness = thickness_of_block;
    input.crack_pressures = {fluid};
    return input;
}

/// A plate round the origin keeps its place and turns nowhere: u_x = 0 at (0, +-L), u_y = 0 at (+-L, 0).
inline void hold_middles_of_sides(ModelInput& input, double L) {
    for (const int k : {0, 1})
        for (const double sign : {-1., 1.}) {
            const Vec2 at = sign * L * Vec2::Unit(1 - k);
            Load hold{.kind = Load::Kind::displacement, .on = {.box = Box{at.array() - 1e-6, at.array() + 1e-6}}};
            hold.value[k] = 0;
            input.loads.push_back(hold);
        }
}

}  // namespace knap::tests
