#pragma once
// Square plates that several tests load.
#include "mesh/triangulate.hpp"
#include "support/bodies.hpp"

#include <cmath>
#include <numbers>

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

/// A plate of 2 L x 2 L, boundary `rim`, round a hole of radius 1 at the origin, boundary `wall`.
inline Mesh plate_with_hole(double L, double size) {
    Shape shape;
    shape.outer.points = {{-L, -L}, {0, -L}, {L, -L}, {L, 0}, {L, L}, {0, L}, {-L, L}, {-L, 0}};
    shape.outer.boundary.assign(8, 0), shape.boundary_names = {"rim", "wall"};
    const int n = 4 * static_cast<int>(std::lround(0.5 * std::numbers::pi / size));
    Ring hole;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        hole.points.emplace_back(std::cos(angle), std::sin(angle)), hole.boundary.push_back(1);
    }
    shape.holes = {hole};
    return triangulate(shape, {.size = size});
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
