// The sufficient criteria for bonded fans against the exact test: a fan that they clear is bonded.
#include "mesh/triangulate.hpp"
#include "model/make_model.hpp"
#include "stepper/common/bond_check.hpp"
#include "stepper/explicit/mesh_blocks.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <random>

namespace bond_criteria_test {

using namespace knap;
using namespace knap::tests;

namespace {

ModelInput plate(Index order, const CohesiveLaw& law) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    ModelInput input = body_with(triangulate(shape, {.size = 0.06}), {.density = 1, .E = 1, .nu = 0.2}, law);
    input.mesh.order = order;
    input.loads = {load(Load::Kind::traction, "top", 0.0, 1.0), load(Load::Kind::velocity, "left", 0.0, {})};
    return input;
}

}  // namespace

TEST_CASE("fans cleared by the inscribed circles are bonded and most bonded fans are cleared") {
    for (const CohesiveLaw& law : {CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 1},
                                   CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 0.4, .friction = 0.5}})
        for (const Index order : {1, 2}) {
            const Model model = make_model(plate(order, law));
            BondCheck exact(model);
            const State now = initial_state(model);
            std::mt19937 random(7);
            std::uniform_real_distribution<double> stress(-1, 1);
            const State start = initial_state(model);
            int n_held = 0, n_cleared = 0, n_wrong = 0, n_driven = 0;
            for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
                const Fan& fan = model.fans[f];
                if (fan.n_points == 0) continue;
                std::vector<InscribedCircle> circles;
                add_inscribed_circles(model, fan, circles);
                double size = 0;
                for (const FanPoint& point : model.points(fan)) size = std::max(size, point.area);
                for (const double load : {0.1, 0.3, 0.6, 1.0}) {
                    std::vector<Vec2> force, required;
                    Vec2 total = Vec2::Zero();
                    for (Index i = 0; i < fan.n_corners; ++i) {
                        force.push_back(load * size * Vec2(stress(random), stress(random)));
                        total += force.back();
                    }
                    for (Index i = 0; i < fan.n_corners; ++i)
                        required.push_back(model.corner_mass[model.corners(fan)[i]] / fan.mass * total - force[i]);
                    const bool cleared = within_inscribed_circles(
                        circles.data(), fan.n_corners, [&](Index i) { return force[i]; }, total);
                    if (model.motion_of(model.corners(fan)[0])) n_driven += cleared;
                    else if (exact.is_bonded(f, start, required, 1)) ++n_held, n_cleared += cleared;
                    else n_wrong += cleared;
                }
            }
            CAPTURE(order);
            CAPTURE(law.gamma);
            CHECK(n_wrong == 0);
            CHECK(n_driven == 0);  // the motion of these is not their own
            CHECK(n_held > 500);
            CHECK(n_cleared > 0.7 * n_held);
        }
}

}  // namespace bond_criteria_test
