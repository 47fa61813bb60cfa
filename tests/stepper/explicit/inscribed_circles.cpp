// The sufficient criteria for fans in one piece against the exact test: what they clear surely holds.
#include "interface/self_stress.hpp"
#include "mesh/triangulate.hpp"
#include "stepper/explicit/inscribed_circles.hpp"
#include "support/bodies.hpp"

#include <doctest/doctest.h>

#include <random>

using namespace knap;
using namespace knap::tests;

namespace {

ModelInput plate(Index order, const CohesiveLaw& law) {
    Shape shape;
    shape.outer = {.points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, .boundary = {0, 1, 2, 3}};
    shape.boundary_names = {"bottom", "right", "top", "left"};
    ModelInput input;
    input.mesh = triangulate(shape, {.size = 0.06});
    input.mesh.order = order;
    input.materials = {{.density = 1, .E = 1, .nu = 0.2}};
    input.laws = {law};
    input.law_of_pair = {{0}};
    input.loads = {load(Load::Kind::traction, "top", 0.0, 1.0), load(Load::Kind::velocity, "left", 0.0, {})};
    return input;
}

/// By the best self-stress there is.
bool holds(const Model& model, const Fan& fan, const std::vector<Vec2>& force) {
    Vec2 total = Vec2::Zero();
    for (const Vec2& f : force) total += f;
    std::vector<HalfPlane> planes;
    const auto taken = [&](Index i) -> Vec2 { return model.corner_mass[model.fan_corners[fan.first_corner + i]] / fan.mass * total - force[i]; };
    walk_chain(fan.n_points, fan.closed, Vec2::Zero(), taken, [&](Index j, const Vec2& P) {
        const FanPoint& point = model.fan_points[fan.first_point + j];
        const CohesiveLaw& law = model.laws[point.law];
        StrengthPolygon::at_rest(law, point.normal, law.sigma_c * point.area).add_half_planes(j, P, fan.closed ? Vec2::Ones() : Vec2::Zero(), planes);
        return true;
    });
    return planes.empty() || find_self_stress(planes, Vec2::Zero()).slack >= 0;
}

}  // namespace

TEST_CASE("what the strength circles clear the exact test does too and they clear most of it") {
    for (const CohesiveLaw& law : {CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 1}, CohesiveLaw{.sigma_c = 1, .G_c = 1, .gamma = 0.4, .friction = 0.5}})
        for (const Index order : {1, 2}) {
            const Model model = make_model(plate(order, law));
            const MeshBlocks blocks(model);
            const InscribedCircles circles(model, blocks);
            std::mt19937 random(7);
            std::uniform_real_distribution<double> stress(-1, 1);
            int n_held = 0, n_cleared = 0, n_wrong = 0, n_driven = 0;
            const auto judge = [&](const MeshBlocks::BlockFan& of, const InscribedCircles::Place* place) {
                const Fan& fan = model.fans[of.fan];
                if (fan.n_points == 0) return;
                double size = 0;
                for (Index j = 0; j < fan.n_points; ++j) size = std::max(size, model.fan_points[fan.first_point + j].area);
                for (const double load : {0.1, 0.3, 0.6, 1.0}) {
                    std::vector<Vec2> force;
                    for (Index i = 0; i < fan.n_corners; ++i) force.push_back(load * size * Vec2(stress(random), stress(random)));
                    Vec2 total = Vec2::Zero();
                    for (const Vec2& f : force) total += f;
                    const bool cleared = InscribedCircles::hold(place, of.n_corners, [&](Index i) { return force[i]; }, total);
                    const bool driven = model.prescribed_of_corner[model.fan_corners[fan.first_corner]] >= 0;
                    if (driven) n_driven += cleared;
                    else if (holds(model, fan, force)) ++n_held, n_cleared += cleared;
                    else n_wrong += cleared;
                }
            };
            for (const MeshBlocks::Block& block : blocks.blocks()) {
                const MeshBlocks::Corner* corner = blocks.corners(block);
                for (const MeshBlocks::BlockFan& fan : blocks.inner(block)) judge(fan, circles.of_inner(corner)), corner += fan.n_corners;
                const Index* bordering = blocks.bordering_corners(block);
                for (const MeshBlocks::BlockFan& fan : blocks.bordering(block)) judge(fan, circles.of_bordering(bordering)), bordering += fan.n_corners;
            }
            CAPTURE(order);
            CAPTURE(law.gamma);
            CHECK(n_wrong == 0);
            CHECK(n_driven == 0);  // the motion of these is not their own
            CHECK(n_held > 500);
            CHECK(n_cleared > 0.7 * n_held);
        }
}
