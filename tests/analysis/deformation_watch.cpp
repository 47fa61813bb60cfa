// How far a run is from small rotations, small strains and small slips: exact fields, exact answers.
#include "analysis/deformation_watch.hpp"
#include "analysis/gates.hpp"

#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace deformation_watch_test {

using namespace knap;
using namespace knap::tests;

namespace {

const CohesiveLaw tough{.sigma_c = 1, .G_c = 1};

ModelInput plate(Index order = 1) {
    ModelInput input;
    input.mesh = bar_mesh(4, 2, 4, 2);
    input.mesh.order = order;
    input.materials = {{.density = 1, .E = 1, .nu = 0}};
    input.laws = {tough};
    input.law_of_pair = {{0}};
    return input;
}

/// Displacements u = gradient x at all corners.
State stretched(const Model& model, const Eigen::Matrix2d& gradient) {
    State state = initial_state(model);
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        state.displacement[state.node_of_corner[c]] = gradient * model.mesh.corner(c);
    return state;
}

/// Two cells over two, cracked along y = 1, the upper half moved by `slip` along the crack; every point of the crack
/// pressed or not.
struct Slid {
    Slid(double slip, bool pressed) : model(cracked()), state(initial_state(model)) {
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            if (above(model.mesh.triangle_of(c))) state.displacement[state.node_of_corner[c]].x() = slip;
        for (PointState& point : state.points) point.traction.x() = pressed ? 1 : 0;
    }
    bool above(Index t) const {
        return model.mesh.corner(t, 0).y() + model.mesh.corner(t, 1).y() + model.mesh.corner(t, 2).y() > 3;
    }
    static Model cracked() {
        ModelInput input = plate();
        for (InteriorEdge& edge : input.mesh.interior_edges) {
            const Index t = edge.triangle[0], k = edge.side[0];
            edge.cracked = input.mesh.corner(t, k).y() == 1 && input.mesh.corner(t, (k + 1) % 3).y() == 1;
        }
        return make_model(input);
    }
    Model model;
    State state;
};

}  // namespace

TEST_CASE("deformation: a rigid rotation is found as its angle and leaves areas as they are") {
    for (const Index order : {1, 2})
        for (const double angle : {1e-3, 0.1, -0.6, 2.0, -3.0}) {
            CAPTURE(order);
            CAPTURE(angle);
            const Model model = make_model(plate(order));
            DeformationWatch watch(model);
            watch.look_at(stretched(model, Eigen::Rotation2Dd(angle).toRotationMatrix() - Eigen::Matrix2d::Identity()));
            CHECK(watch.rotation().value == relative(std::abs(angle) * 180 / M_PI, 1e-12));
            CHECK(watch.area_change().value <= 1e-14);
        }
}

TEST_CASE("deformation: linear kinematics turns a rotation into a smaller angle and a larger area") {
    const Model model = make_model(plate());
    DeformationWatch watch(model);
    const Eigen::Matrix2d turn{{0, -0.5}, {0.5, 0}};
    watch.look_at(stretched(model, turn));
    CHECK(watch.rotation().value == relative(std::atan(0.5) * 180 / M_PI, 1e-12));
    CHECK(watch.area_change().value == relative(0.25, 1e-13));
    watch.look_at(stretched(model, 0.1 * turn));  // the largest stays
    CHECK(watch.rotation().value == relative(std::atan(0.5) * 180 / M_PI, 1e-12));
    const Eigen::Matrix2d stretch{{0.25, 0.5}, {0.5, -0.5}};  // symmetric: no rotation
    DeformationWatch other(model);
    other.look_at(stretched(model, stretch));
    CHECK(other.rotation().value <= 1e-13);
    CHECK(other.area_change().value == relative(std::abs(1.25 * 0.5 - 0.25 - 1), 1e-13));
}

TEST_CASE("deformation: the gates warn of a rotation beyond 5 degrees and are violated beyond 30") {
    const Model model = make_model(plate());
    const State start = initial_state(model);
    const EnergyLedger ledger(model, start);
    const auto level = [&](double degrees, const std::vector<AllowedLimit>& allowed = {}) {
        DeformationWatch watch(model);
        watch.look_at(stretched(
            model, Eigen::Rotation2Dd(degrees * M_PI / 180).toRotationMatrix() - Eigen::Matrix2d::Identity()));
        Gates gates;
        judge({ledger, 1, 1, false, &watch}, allowed, gates);
        return std::find_if(gates.begin(), gates.end(), [](const Gate& gate) { return gate.name == "rotation"; })
            ->level;
    };
    CHECK(level(4.99) == GateLevel::ok);
    CHECK(level(5.01) == GateLevel::warning);
    CHECK(level(29.9) == GateLevel::warning);
    CHECK(level(30.1) == GateLevel::violated);
    CHECK(level(59, {{"rotation", 60}}) == GateLevel::warning);
    CHECK(level(61, {{"rotation", 60}}) == GateLevel::violated);
    CHECK(level(2, {{"rotation", 1}}) == GateLevel::violated);  // a limit may be stricter
    CHECK(level(std::nan("")) == GateLevel::violated);
}

TEST_CASE("deformation: the slip of points under pressure is measured in edges") {
    const auto slip = [](double length, bool pressed) {
        const Slid slid(length, pressed);
        DeformationWatch watch(slid.model);
        watch.look_at(slid.state);
        return watch.slip().value;
    };
    CHECK(slip(0.75, true) == relative(0.75, 1e-14));  // edges of length 1
    CHECK(slip(-2.5, true) == relative(2.5, 1e-14));
    CHECK(slip(2.5, false) == 0);
}

TEST_CASE("deformation: faces that slid overlap only when one is driven into the other") {
    const Slid slid(0.75, true);
    DeformationWatch watch(slid.model);
    watch.look_for_overlap(slid.state);
    CHECK(watch.overlap().value == 0);
    State deep = slid.state;
    for (Index c = 0; c < slid.model.mesh.n_corners(); ++c)
        if (slid.above(slid.model.mesh.triangle_of(c))) deep.displacement[deep.node_of_corner[c]] = {0, -0.5};
    watch.look_for_overlap(deep);
    CHECK(watch.overlap().value == relative(4 * 0.5, 1e-13));
    CHECK(watch.overlap().place.y() > 0.5);
    CHECK(watch.overlap().place.y() < 1);
}

TEST_CASE("deformation: sliding along a straight support is no slip and sliding past its last edge towards a wall is") {
    ModelInput input = plate();
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 0, .glued = false}};
    const auto slip = [&](double length) {
        const Model model = make_model(input);
        State state = initial_state(model);
        for (Vec2& u : state.displacement) u.x() = length;
        for (PointState& point : state.points) point.traction.x() = 1;
        DeformationWatch watch(model);
        watch.look_at(state);
        return watch.slip().value;
    };
    CHECK(slip(10) == 0);
    CHECK(slip(-10) == 0);
    input.supports.push_back({.on = {.boundary = "right", .box = {}}, .law = 0, .glued = false});
    CHECK(slip(-10) == 0);                   // away from the wall along the floor; the wall is not felt sideways
    CHECK(slip(10) == relative(10, 1e-14));  // the last edge of the floor ends at the wall
}

}  // namespace deformation_watch_test
