// The corners and points round a vertex: closed and open fans, cracks, supports, a vertex where two bodies touch.
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace fans_test {

using namespace knap;
using namespace knap::tests;

namespace {

ModelInput input_of(Mesh mesh) {
    ModelInput input;
    input.mesh = std::move(mesh);
    input.thickness = 0.5;
    input.materials = {{.density = 3, .E = 1, .nu = 0}};
    input.laws = {{.sigma_c = 1, .G_c = 1}, {.sigma_c = 2, .G_c = 1}};
    input.law_of_pair = {{0}};
    return input;
}

Vec2 centroid(const Mesh& mesh, Index t) { return (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3; }

/// What must hold in every model.
void check_fans(const Model& model) {
    std::vector<int> seen_corner(model.mesh.n_corners(), 0), seen_point(model.n_points(), 0);
    for (std::size_t f = 0; f < model.fans.size(); ++f) {
        const Fan& fan = model.fans[f];
        const Vec2 centre = model.mesh.vertices[fan.vertex];
        double mass = 0;
        int n_supports = 0;
        for (Index i = 0; i < fan.n_corners; ++i) {
            const Index c = model.fan_corners[fan.first_corner + i];
            ++seen_corner[c];
            mass += model.corner_mass[c];
            CHECK(model.mesh.triangles[c / 3][c % 3] == fan.vertex);
            CHECK(model.fan_of_corner[c] == static_cast<Index>(f));
        }
        CHECK(fan.mass == relative(mass, 1e-12));
        for (Index i = 0; i < fan.n_points; ++i) {
            const FanPoint& point = model.fan_points[fan.first_point + i];
            const Interface& edge = model.interfaces[point.point / 2];
            ++seen_point[point.point];
            CHECK(model.fan_point_of[point.point] == fan.first_point + i);
            CHECK(edge.vertex[point.point % 2] == fan.vertex);
            CHECK(point.area == relative(0.5 * edge.length * model.thickness, 1e-12));
            CHECK(point.normal.norm() == relative(1));
            // the normal is across the edge, counterclockwise round the vertex: from `before` to `after`
            const Vec2 ray = model.mesh.vertices[edge.vertex[1 - point.point % 2]] - centre;
            CHECK(point.normal.dot(ray) == within(0, 1e-12));
            CHECK(cross(ray, point.normal) > 0);
            if (point.before != rigid_support)
                CHECK((centroid(model.mesh, point.before / 3) - centre).dot(point.normal) < 0);
            if (point.after != rigid_support)
                CHECK((centroid(model.mesh, point.after / 3) - centre).dot(point.normal) > 0);
            n_supports += point.before == rigid_support || point.after == rigid_support;
            if (fan.closed) CHECK(point.after == model.fan_corners[fan.first_corner + i]);
            if (fan.closed)
                CHECK(point.before == model.fan_corners[fan.first_corner + (i + fan.n_corners - 1) % fan.n_corners]);
            // in the frame of its interface, up to a turn by 180 degrees
            CHECK(std::abs(point.normal.dot(edge.normal)) == relative(1));
        }
        CHECK(fan.n_points == (fan.closed ? fan.n_corners : fan.n_corners - 1 + n_supports));
    }
    CHECK(std::all_of(seen_corner.begin(), seen_corner.end(), [](int n) { return n == 1; }));
    CHECK(std::all_of(seen_point.begin(), seen_point.end(), [](int n) { return n == 1; }));
    for (const Interface& edge : model.interfaces) {
        const Vec2 middle = 0.5 * (model.mesh.vertices[edge.vertex[0]] + model.mesh.vertices[edge.vertex[1]]);
        if (edge.triangle[0] != rigid_support)
            CHECK((centroid(model.mesh, edge.triangle[0]) - middle).dot(edge.normal) < 0);
        CHECK((centroid(model.mesh, edge.triangle[1]) - middle).dot(edge.normal) > 0);
    }
}

const Fan& fan_at(const Model& model, Index vertex) {
    return *std::find_if(model.fans.begin(), model.fans.end(), [&](const Fan& fan) { return fan.vertex == vertex; });
}

}  // namespace

TEST_CASE("closed fans inside and open fans at the boundary") {
    const Model model = make_model(input_of(bar_mesh(3, 3, 3, 2)));
    check_fans(model);
    CHECK(model.fans.size() == 16);
    CHECK(std::count_if(model.fans.begin(), model.fans.end(), [](const Fan& fan) { return fan.closed; }) == 4);
    CHECK(std::none_of(model.fans.begin(), model.fans.end(), [](const Fan& fan) { return fan.split_at_start; }));
    CHECK(fan_at(model, 5).n_corners == 6);
    CHECK(fan_at(model, 0).n_corners == 2);
    CHECK(fan_at(model, 3).n_corners == 1);
    CHECK(fan_at(model, 3).n_points == 0);
}

TEST_CASE("a crack line splits the fans along it and cuts none of its own") {
    Mesh mesh = bar_mesh(4, 2, 4, 2);
    for (InteriorEdge& edge : mesh.interior_edges) {
        const Vec2 a = mesh.corner(edge.triangle[0], edge.side[0]),
                   b = mesh.corner(edge.triangle[0], (edge.side[0] + 1) % 3);
        edge.cracked = a.y() == 1 && b.y() == 1 && std::max(a.x(), b.x()) <= 2;
    }
    const Model model = make_model(input_of(mesh));
    check_fans(model);
    CHECK(model.fans.size() == 15);
    const auto split = [&](Index i, Index j) { return fan_at(model, 5 * j + i).split_at_start; };
    CHECK(split(0, 1));
    CHECK(split(1, 1));
    CHECK(split(2, 1));  // the tip
    CHECK(!split(3, 1));
    CHECK(!split(1, 0));
    CHECK(!split(1, 2));
    const State state = initial_state(model);
    CHECK(state.split_fans.size() == 3);
    CHECK(state.displacement.size() ==
          15 + 2 + 5 + 5);  // a corner each instead of one for all: fans of 3, 6 and 6 corners
    for (Index p = 0; p < model.n_points(); ++p)
        CHECK(cohesion(model, state, p) == (model.interfaces[p / 2].cracked ? 0 : 1));
}

TEST_CASE("supports at one side and round a corner") {
    ModelInput input = input_of(bar_mesh(2, 1, 2, 1));
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = true},
                      {.on = {.boundary = "left", .box = {}}, .law = 0, .glued = false, .gap = 0.25}};
    const Model model = make_model(input);
    check_fans(model);
    CHECK(model.interfaces.size() == 3 + 3);
    const Fan& corner = fan_at(model, 0);  // support, two corners, support
    CHECK(!corner.closed);
    CHECK(corner.n_corners == 2);
    REQUIRE(corner.n_points == 3);
    CHECK(model.fan_points[corner.first_point].before == rigid_support);
    CHECK(model.fan_points[corner.first_point + 2].after == rigid_support);
    CHECK(model.fan_points[corner.first_point].law == 1);
    CHECK(!model.fan_points[corner.first_point].cracked);
    CHECK(model.fan_points[corner.first_point + 2].cracked);
    CHECK(model.fan_points[corner.first_point + 2].gap == 0.25);
    CHECK(corner.split_at_start);
    const State state = initial_state(model);
    for (Index p = 0; p < model.n_points(); ++p) {
        const Interface& edge = model.interfaces[p / 2];
        CHECK(opening(model, state, p).x() == edge.gap);
        // from the support into the body
        if (edge.triangle[0] == rigid_support) CHECK(edge.normal == (edge.gap > 0 ? Vec2(1, 0) : Vec2(0, 1)));
    }
    const Fan& right = fan_at(model, 2);  // one corner on the support
    CHECK(right.n_corners == 1);
    CHECK(right.n_points == 1);
}

TEST_CASE("a vertex where two bodies only touch has a fan for each") {
    Mesh mesh;
    mesh.vertices = {{-1, -1}, {0, 0}, {-1, 1}, {1, -1}, {1, 1}};
    mesh.triangles = {{0, 1, 2}, {1, 3, 4}};
    mesh.region = {0, 0};
    mesh.boundary_names = {"all"};
    find_edges(mesh);
    const Model model = make_model(input_of(mesh));
    check_fans(model);
    CHECK(model.fans.size() == 6);
    CHECK(std::count_if(model.fans.begin(), model.fans.end(), [](const Fan& fan) { return fan.vertex == 1; }) == 2);
}

TEST_CASE("openings are seen in the frame of the interface whichever end") {
    Model model = make_model(input_of(bar_mesh(3, 2, 3, 2)));
    for (Fan& fan : model.fans) fan.split_at_start = true;
    State state = initial_state(model);
    // triangle t moves by (t, t^2)
    const auto moved = [](Index t) { return Vec2(t, t * t); };
    for (Index c = 0; c < model.mesh.n_corners(); ++c) state.displacement[state.node_of_corner[c]] = moved(c / 3);
    for (Index p = 0; p < model.n_points(); ++p) {
        const Interface& edge = model.interfaces[p / 2];
        const Vec2 jump = moved(edge.triangle[1]) - moved(edge.triangle[0]);
        CHECK(opening(model, state, p).x() == within(edge.normal.dot(jump), 1e-12));
        CHECK(opening(model, state, p).y() == within(turned_left(edge.normal).dot(jump), 1e-12));
    }
}

TEST_CASE("masses and loads add up") {
    ModelInput input = input_of(bar_mesh(3, 2, 3, 2));
    input.loads = {load(Load::Kind::traction, "right", 4.0, -1.0), load(Load::Kind::body_force, "", 2.0, std::nullopt),
                   load(Load::Kind::acceleration, "", 0.0, -10.0)};
    input.loads.push_back({.kind = Load::Kind::traction,
                           .on = {.boundary = "top", .box = Box{{0.9, 1.9}, {2.1, 2.1}}},
                           .value = {0.0, 5.0},
                           .history = {}});
    input.loads.push_back(load(Load::Kind::force, "top", 6.0, -3.0));
    input.loads.push_back({.kind = Load::Kind::force,
                           .on = {.boundary = "", .box = Box{{2.9, 1.9}, {3.1, 2.1}}},
                           .value = {0.0, 7.0},
                           .history = {}});
    input.initial_velocities = {{.on = {}, .value = {1, 2}},
                                {.on = {.boundary = "", .box = Box{{0, 0}, {1, 2}}}, .value = {-3, 0}}};
    const Model model = make_model(input);
    const double mass = std::accumulate(model.corner_mass.begin(), model.corner_mass.end(), 0.0);
    CHECK(mass == relative(3 * 6 * 0.5));
    std::vector<Vec2> total(6, Vec2::Zero());
    std::map<std::pair<Index, Index>, Vec2> at;  // of a history, at a vertex
    for (const CornerLoad& corner : model.corner_loads) {
        total[corner.history] += corner.force;
        at.try_emplace({corner.history, model.mesh.triangles[corner.corner / 3][corner.corner % 3]}, Vec2::Zero())
            .first->second += corner.force;
    }
    CHECK((total[0] - Vec2(4, -1) * 2 * 0.5).norm() <= 1e-14);  // traction x length x thickness
    CHECK((total[1] - Vec2(2, 0) * 6 * 0.5).norm() <= 1e-14);   // force density x volume
    CHECK((total[2] - Vec2(0, -10) * mass).norm() <= 1e-13);
    CHECK((total[3] - Vec2(0, 5) * 1 * 0.5).norm() <= 1e-14);  // only the edge whose middle lies in the box
    CHECK((total[4] - Vec2(6, -3)).norm() <= 1e-14);
    for (const auto& [where, force] : at)
        if (where.first == 4)
            CHECK((force - Vec2(6, -3) / 4).norm() <= 1e-14);  // four vertices on top, also those of one triangle only
    CHECK((total[5] - Vec2(0, 7)).norm() <= 1e-14);
    CHECK(std::count_if(at.begin(), at.end(), [](const auto& entry) { return entry.first.first == 5; }) == 1);
    Vec2 momentum = Vec2::Zero();
    for (Index c = 0; c < model.mesh.n_corners(); ++c) momentum += model.corner_mass[c] * model.initial_velocity_of(c);
    CHECK((momentum - mass / 3 * (Vec2(-3, 0) + 2 * Vec2(1, 2))).norm() <= 1e-13);
}

TEST_CASE("a pressure pushes against the outward normal of every edge and a stress pulls with its traction") {
    // on a border that is closed both have no resultant and no moment about any point but what the stress is: sum of x
    // (x) f = V sigma (Gauss)
    for (const int order : {1, 2}) {
        ModelInput input = input_of(bar_mesh(3, 2, 3, 2));
        for (Vec2& x : input.mesh.vertices)
            x = Vec2(0.8 * x.x() - 0.6 * x.y(), 0.6 * x.x() + 0.8 * x.y() + 0.1 * std::sin(x.x()));
        input.mesh.order = order;
        const Box everywhere{{-9, -9}, {9, 9}};
        input.loads = {{.kind = Load::Kind::stress, .on = {.boundary = "", .box = everywhere}, .stress = {-3, -3, 0}},
                       {.kind = Load::Kind::stress, .on = {.boundary = "", .box = everywhere}, .stress = {5, -2, 7}}};
        const Model model = make_model(input);
        double volume = 0;
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) volume += model.mesh.area(t) * model.thickness;
        Eigen::Matrix2d sum[2] = {Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()}, expected[2];
        Vec2 resultant[2] = {Vec2::Zero(), Vec2::Zero()};
        expected[0] << -3, 0, 0, -3;
        expected[1] << 5, 7, 7, -2;
        for (const CornerLoad& at : model.corner_loads) {
            sum[at.history] += at.force * model.mesh.corner(at.corner).transpose();
            resultant[at.history] += at.force;
        }
        for (int i = 0; i < 2; ++i) {
            CHECK(resultant[i].norm() <= 1e-14 * volume * expected[i].norm());
            CHECK((sum[i] - volume * expected[i]).norm() <= 1e-14 * volume * expected[i].norm());
        }
    }
}

TEST_CASE("a time function is linear between its points and constant outside") {
    const TimeFunction ramp{{1, 2, 4}, {10, 20, 0}};
    CHECK(ramp(0) == 10);
    CHECK(ramp(1.5) == relative(15));
    CHECK(ramp(2) == relative(20));
    CHECK(ramp(3) == relative(10));
    CHECK(ramp(9) == 0);
    CHECK(TimeFunction{}(3) == 1);
}

TEST_CASE(
    "of second order the middles of edges are fans of two corners and a point and the centres fans of one corner") {
    ModelInput input = input_of(bar_mesh(3, 2, 3, 2));
    input.mesh.order = 2;
    input.supports = {{.on = {.boundary = "bottom", .box = {}}, .law = 1, .glued = true}};
    const Model model = make_model(std::move(input));
    const Index n_edges = static_cast<Index>(model.mesh.interior_edges.size() + model.mesh.boundary_edges.size());
    CHECK(static_cast<Index>(model.fans.size()) == model.mesh.n_vertices() + n_edges + model.mesh.n_triangles());
    CHECK(model.n_points() == 3 * static_cast<Index>(model.interfaces.size()));
    std::vector<double> area(model.interfaces.size(), 0);
    std::vector<int> seen_corner(model.mesh.n_corners(), 0), seen_point(model.n_points(), 0);
    Index n_middles = 0, n_centres = 0;
    double mass = 0;
    for (const Fan& fan : model.fans) {
        mass += fan.mass;
        const Vec2 place = model.mesh.corner(model.fan_corners[fan.first_corner]);
        for (Index i = 0; i < fan.n_corners; ++i) {
            const Index c = model.fan_corners[fan.first_corner + i];
            ++seen_corner[c];
            CHECK((model.mesh.corner(c) - place).norm() <= 1e-15);
        }
        if (fan.vertex >= 0) CHECK((model.mesh.vertices[fan.vertex] - place).norm() == 0);
        for (Index i = 0; i < fan.n_points; ++i) {
            const FanPoint& point = model.fan_points[fan.first_point + i];
            const Interface& edge = model.interfaces[model.interface_of(point.point)];
            ++seen_point[point.point];
            area[model.interface_of(point.point)] += point.area;
            if (fan.vertex >= 0) continue;
            CHECK(point.normal == edge.normal);
            CHECK(point.area == relative(4. / 6 * edge.length * model.thickness, 1e-12));
            CHECK((point.before == rigid_support ? rigid_support : model.mesh.triangle_of(point.before)) ==
                  edge.triangle[0]);
            CHECK(model.mesh.triangle_of(point.after) == edge.triangle[1]);
        }
        if (fan.vertex >= 0) continue;
        (model.mesh.place_in_triangle(model.fan_corners[fan.first_corner]) == 6 ? n_centres : n_middles) += 1;
        const bool on_support = fan.n_points == 1 && model.fan_points[fan.first_point].before == rigid_support;
        CHECK(fan.n_points == (on_support ? 1 : fan.n_corners - 1));
        CHECK(fan.split_at_start == on_support);
    }
    CHECK(n_middles == n_edges);
    CHECK(n_centres == model.mesh.n_triangles());
    CHECK(mass == relative(6 * 3 * model.thickness, 1e-13));
    CHECK(std::all_of(seen_corner.begin(), seen_corner.end(), [](int n) { return n == 1; }));
    CHECK(std::all_of(seen_point.begin(), seen_point.end(), [](int n) { return n == 1; }));
    for (std::size_t i = 0; i < area.size(); ++i)
        CHECK(area[i] == relative(model.interfaces[i].length * model.thickness, 1e-12));
}

TEST_CASE("of second order stress and traction follow a linear strain") {
    ModelInput input = input_of(bar_mesh(3, 2, 3, 2));
    input.mesh.order = 2;
    input.materials = {{.density = 3, .E = 2, .nu = 0}};
    const Model model = make_model(std::move(input));
    State state = initial_state(model);
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Vec2 x = model.mesh.corner(c);
        state.displacement[state.node_of_corner[c]] = Vec2(0.5 * x.x() * x.x(), 0);  // strain_xx = x
    }
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        CHECK((stress(model, state, t) - Eigen::Vector3d(2 * centroid(model.mesh, t).x(), 0, 0)).norm() <= 1e-14);
        for (Index k = 0; k < 7; ++k)
            CHECK((stress(model, state, t, coordinates(model.mesh, 7 * t + k)) -
                   Eigen::Vector3d(2 * model.mesh.corner(t, k).x(), 0, 0))
                      .norm() <= 1e-13);
    }
    for (const FanPoint& at : model.fan_points) {
        const double sigma = 2 * model.mesh.corner(at.after).x();
        const Vec2 n = at.normal, found = traction(model, state, at.point);
        CHECK(found.x() == within(-sigma * n.x() * n.x(), 1e-12));
        CHECK(found.y() == within(-sigma * n.x() * turned_left(n).x(), 1e-12));
    }
}

}  // namespace fans_test
