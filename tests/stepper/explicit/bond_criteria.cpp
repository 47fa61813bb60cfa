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

TEST_CASE("a fan that was bonded stays so while its forces differ by less than the margin of the proof") {
    const auto over_pressure = [](CohesiveLaw law) {
        law.over_pressure = std::make_shared<FrictionOverPressure>(std::vector<Vec2>{{0, 0}, {1, 0.8}, {4, 1.4}});
        return law;
    };
    for (const CohesiveLaw& law :
         {CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 1},
          CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 0.4, .friction = 0.5},
          CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 0.5, .friction = 0.7, .coupling = Coupling::norm},
          CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 2, .friction = 0.3, .coupling = Coupling::norm},
          over_pressure({.sigma_c = 1, .G_c = 1, .gamma = 1})}) {
        const Model model = make_model(plate(1, law));
        BondCheck exact(model);
        BondProofs proofs(model);
        const State start = initial_state(model);
        std::mt19937 random(11);
        std::uniform_real_distribution<double> part(-1, 1);
        int n_proven = 0, n_held = 0, n_wrong = 0, n_beyond = 0;
        for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) {
            const Fan& fan = model.fans[f];
            if (fan.n_points == 0 || model.motion_of(model.corners(fan)[0])) continue;
            std::vector<Vec2> force(fan.n_corners), moved(fan.n_corners);
            const auto is_bonded = [&](const std::vector<Vec2>& forces) {
                Vec2 total = Vec2::Zero();
                for (const Vec2& on_corner : forces) total += on_corner;
                std::vector<Vec2> required;
                for (Index i = 0; i < fan.n_corners; ++i)
                    required.push_back(model.corner_mass[model.corners(fan)[i]] / fan.mass * total - forces[i]);
                return exact.is_bonded(f, start, required, 1);
            };
            double size = 0;
            for (const FanPoint& point : model.points(fan)) size = std::max(size, point.area);
            for (int trial = 0; trial < 8; ++trial) {
                for (Vec2& on_corner : force) on_corner = 0.8 * size * Vec2(part(random), part(random));
                if (!is_bonded(force)) continue;
                const double margin = exact.margin(f, start, 1);
                proofs.keep(
                    f, [&](Index i) { return force[i]; }, margin);
                ++n_proven;
                for (const double away : {0.9, 0.999, 20.0}) {  // [-] of the margin
                    double length = 0;
                    for (Index i = 0; i < fan.n_corners; ++i)
                        moved[i] = Vec2(part(random), part(random)), length += moved[i].lpNorm<1>();
                    for (Index i = 0; i < fan.n_corners; ++i) moved[i] = force[i] + away * margin / length * moved[i];
                    const bool holds = proofs.hold(f, [&](Index i) { return moved[i]; }), bonded = is_bonded(moved);
                    n_held += holds, n_wrong += holds && !bonded, n_beyond += away > 1 && !bonded;
                }
            }
        }
        CAPTURE(law.gamma);
        CAPTURE(law.friction);
        CHECK(n_proven > 500);
        CHECK(n_wrong == 0);
        CHECK(n_held >
              (law.coupling == Coupling::sum ? 1.9 : 0.8) * n_proven);  // the norm: in the convex part that is tested
        CHECK(n_beyond > 0.1 * n_proven);  // the margin is no more than some multiple too small
    }
}

}  // namespace bond_criteria_test
