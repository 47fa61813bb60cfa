// A frame made from a model and a state whose answer is known: a bar with a pre-crack, stretched evenly, and torn at
// one place.
#include "output/frame.hpp"

#include "base/error.hpp"
#include "model/make_model.hpp"
#include "model/state.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace frame_test {

using namespace knap;
using knap::tests::relative;

namespace {

const Elastic steel{.density = 1000, .E = 1e9, .nu = 0.25};

Model bar(Index order = 1) {
    Mesh mesh = tests::bar_mesh(8, 2, 4, 1);
    mesh.order = order;
    for (InteriorEdge& edge : mesh.interior_edges) {
        const Vec2 a = mesh.corner(edge.triangle[0], edge.side[0]),
                   b = mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
        edge.cracked = a.x() == 2 && b.x() == 2;
    }
    return make_model(
        {.mesh = mesh, .materials = {steel}, .laws = {{.sigma_c = 1e12, .G_c = 1e9}}, .law_of_pair = {{0}}});
}

/// u = (1e-3 x, -2e-4 y + 5e-4 x) at every node.
State stretched(const Model& model) {
    State state = initial_state(model);
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Vec2 x = model.mesh.corner(c);
        state.displacement[state.node_of_corner[c]] = {1e-3 * x.x(), -2e-4 * x.y() + 5e-4 * x.x()};
        state.velocity[state.node_of_corner[c]] = {x.y(), -x.x()};
    }
    state.time = 3e-6;
    return state;
}

}  // namespace

TEST_CASE("frame: the bulk of an evenly stretched bar") {
    const Model model = bar();
    const Frame frame = make_frame(model, stretched(model));
    CHECK(frame.time == 3e-6);
    CHECK(frame.length_scale == relative(std::hypot(4, 1)));
    REQUIRE(frame.n_triangles() == model.mesh.n_triangles());
    REQUIRE(frame.position.size() == 3 * frame.region.size());
    const Eigen::Vector3d expected = steel.stiffness(PlaneModel::strain) * Eigen::Vector3d(1e-3, -2e-4, 5e-4);
    for (Index t = 0; t < frame.n_triangles(); ++t) {
        CHECK((frame.stress[t] - expected).norm() <= 1e-12 * expected.norm());
        for (Index c = 3 * t; c < 3 * t + 3; ++c) {
            const Vec2 x = frame.position[c];
            CHECK(x == model.mesh.corner(t, c % 3));
            CHECK(frame.displacement[c] == Vec2(1e-3 * x.x(), -2e-4 * x.y() + 5e-4 * x.x()));
            CHECK(frame.velocity[c] == Vec2(x.y(), -x.x()));
        }
    }
}

TEST_CASE("frame: corners have one number where their node and their temperature are one") {
    const Model model = bar();
    State state = stretched(model);
    const Frame cold = make_frame(model, state);
    REQUIRE(cold.node.size() == cold.position.size());
    for (std::size_t a = 0; a < cold.node.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            CHECK((cold.node[a] == cold.node[b]) == (state.node_of_corner[a] == state.node_of_corner[b]));
    const Index most = std::ranges::max(cold.node), n_vertices = static_cast<Index>(model.mesh.vertices.size());
    CHECK(most + 1 > n_vertices);  // the pre-crack has two sides
    CHECK(most + 1 < model.mesh.n_corners());

    Temperatures warm;
    warm.strain.assign(model.mesh.n_triangles(), 0);
    warm.of_corner.assign(model.mesh.n_corners(), 300);
    const auto shared = std::ranges::find(cold.node, cold.node.back());  // of an earlier triangle
    REQUIRE(shared != cold.node.end() - 1);
    warm.of_corner.back() = 301;
    state.temperature = state.temperature_before = std::make_shared<Temperatures>(warm);
    const Frame frame = make_frame(model, state);
    CHECK(frame.node.back() == most + 1);
    CHECK(std::equal(cold.node.begin(), cold.node.end() - 1, frame.node.begin()));
}

TEST_CASE("frame: stress across the plane and von Mises stress and maximum shear") {
    Model model = bar();
    for (const PlaneModel plane : {PlaneModel::strain, PlaneModel::stress}) {
        model.plane = plane;
        const Frame frame = make_frame(model, stretched(model));
        const Eigen::Vector3d s = frame.stress[0];
        const double zz = plane == PlaneModel::strain ? steel.first_lame(plane) * 8e-4 : 0;  // eps_zz = 0
        CHECK(frame.stress_zz[0] == relative(zz));
        // invariants of the tensor
        Eigen::Matrix3d tensor;
        tensor << s[0], s[2], 0, s[2], s[1], 0, 0, 0, zz;
        const Eigen::Matrix3d deviator = tensor - tensor.trace() / 3 * Eigen::Matrix3d::Identity();
        CHECK(von_mises(frame, 0) == relative(std::sqrt(1.5 * deviator.squaredNorm())));
        const Eigen::Vector3d principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor).eigenvalues();
        CHECK(max_shear(frame, 0) == relative(0.5 * (principal[2] - principal[0])));
    }
    Frame old = make_frame(model, stretched(model));
    old.stress_zz.clear();
    CHECK_THROWS_WITH_AS(von_mises(old, 0), doctest::Contains("earlier version"), UserError);
}

TEST_CASE("frame: a body that cannot expand is under equal stress in all directions when it warms") {
    Model model = bar();
    State state = initial_state(model);
    const double expansion = 1e-3;  // a dT
    Temperatures warm;
    warm.strain.assign(model.mesh.n_triangles(), (1 + steel.nu) * expansion);
    warm.of_corner.assign(model.mesh.n_corners(), 0);
    state.temperature = state.temperature_before = std::make_shared<Temperatures>(warm);
    const Frame frame = make_frame(model, state);
    const double pressure = steel.E * expansion / (1 - 2 * steel.nu);
    for (const double s : {frame.stress[0][0], frame.stress[0][1], frame.stress_zz[0]}) CHECK(s == relative(-pressure));
    CHECK(von_mises(frame, 0) <= 1e-9 * pressure);
}

TEST_CASE("frame: both sides of an interface lie on its points") {
    const Model model = bar();
    const Frame frame = make_frame(model, stretched(model));
    REQUIRE(frame.n_interfaces() == static_cast<Index>(model.interfaces.size()));
    REQUIRE(frame.n_interfaces() > 0);
    int n_precracked = 0;
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        for (Index end = 0; end < 2; ++end) {
            const Index a = frame.side_a[i][end], b = frame.side_b[i][end];
            CHECK(a / 3 == model.interfaces[i].triangle[0]);
            CHECK(b / 3 == model.interfaces[i].triangle[1]);
            CHECK(frame.position[a] == frame.end_position[2 * i + end]);
            CHECK(frame.position[b] == frame.end_position[2 * i + end]);
            CHECK(frame.opening[2 * i + end] == 0);
        }
        const bool at_crack = frame.end_position[2 * i].x() == 2 && frame.end_position[2 * i + 1].x() == 2;
        CHECK(frame.status[2 * i] == (at_crack ? InterfaceStatus::precrack : InterfaceStatus::intact));
        n_precracked += at_crack;
    }
    CHECK(n_precracked == 2);
}

TEST_CASE("frame: status and opening of a point that is torn by hand") {
    const Model model = bar();
    State state = stretched(model);
    const auto torn =
        std::find_if(model.interfaces.begin(), model.interfaces.end(), [](const Interface& i) { return !i.cracked; });
    const auto point = static_cast<Index>(2 * (torn - model.interfaces.begin()));
    const FanPoint& at = model.fan_points[model.fan_point_of[point]];
    const Index fan = model.fan_of_corner[at.after];
    if (state.split_rank[fan] < 0) split(model, fan, state);
    const Index in_fan = model.fan_point_of[point] - model.fans[fan].first_point;
    PointState& torn_point = state.points[state.first_point[state.split_rank[fan]] + in_fan];
    for (const auto& [cohesion, status] :
         {std::pair(0.25, InterfaceStatus::damaged), std::pair(0.0, InterfaceStatus::broken)}) {
        torn_point.cohesion = cohesion;
        CHECK(make_frame(model, state).status[point] == status);
        CHECK(make_frame(model, state).cohesion[point] == cohesion);
    }
    const Frame before = make_frame(model, state);
    const Vec2 normal = torn->normal;
    state.displacement[state.node_of_corner[before.side_b[point / 2][0]]] += 3e-4 * normal - 1e-4 * turned_left(normal);
    const Frame after = make_frame(model, state);
    CHECK(after.opening[point] - before.opening[point] == tests::relative(3e-4));
    CHECK(after.slip[point] - before.slip[point] == tests::relative(-1e-4));
}

TEST_CASE("frame: largest principal stress") {
    CHECK(largest_principal({3, 1, 0}) == relative(3));
    CHECK(largest_principal({-3, -1, 0}) == relative(-1));
    CHECK(largest_principal({0, 0, 2}) == relative(2));
    CHECK(largest_principal({1, 1, -2}) == relative(3));
}

TEST_CASE("frame: a triangle of second order is drawn as six and its interfaces as halves") {
    const Model model = bar(2);
    const Frame frame = make_frame(model, stretched(model));
    REQUIRE(frame.n_triangles() == 6 * model.mesh.n_triangles());
    const Eigen::Vector3d expected = steel.stiffness(PlaneModel::strain) * Eigen::Vector3d(1e-3, -2e-4, 5e-4);
    double area = 0;
    for (Index t = 0; t < frame.n_triangles(); ++t) {
        CHECK((frame.stress[t] - expected).norm() <= 1e-11 * expected.norm());
        const Vec2 &a = frame.position[3 * t], &b = frame.position[3 * t + 1], &c = frame.position[3 * t + 2];
        CHECK(cross(b - a, c - a) > 0);
        area += 0.5 * cross(b - a, c - a);
        for (Index k = 3 * t; k < 3 * t + 3; ++k) {
            const Vec2 x = frame.position[k];
            CHECK((frame.displacement[k] - Vec2(1e-3 * x.x(), -2e-4 * x.y() + 5e-4 * x.x())).norm() <= 1e-17);
            CHECK((frame.velocity[k] - Vec2(x.y(), -x.x())).norm() == 0);
        }
    }
    CHECK(area == relative(4));
    REQUIRE(frame.n_interfaces() == 2 * static_cast<Index>(model.interfaces.size()));
    double precrack = 0;
    for (Index i = 0; i < frame.n_interfaces(); ++i) {
        CHECK((frame.end_position[2 * i + 1] - frame.end_position[2 * i]).norm() ==
              relative(model.interfaces[i / 2].length / 2));
        for (Index end = 0; end < 2; ++end) {
            CHECK((frame.position[frame.side_a[i][end]] - frame.end_position[2 * i + end]).norm() <= 1e-15);
            CHECK((frame.position[frame.side_b[i][end]] - frame.end_position[2 * i + end]).norm() <= 1e-15);
            CHECK(std::abs(frame.opening[2 * i + end]) <= 1e-17);
        }
        CHECK(frame.side_a[i][0] / 3 == frame.side_a[i][1] / 3);
        if (frame.status[2 * i] == InterfaceStatus::precrack) precrack += model.interfaces[i / 2].length / 2;
    }
    CHECK(precrack == relative(1));
}

}  // namespace frame_test
