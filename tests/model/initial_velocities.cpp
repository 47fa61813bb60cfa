// Initial velocity and spin of a body: momentum and angular momentum to rounding.
#include "model/make_model.hpp"
#include "model/selections.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

namespace initial_velocities_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// A bar of two materials and, with a crack along their border, a small one on top of it.
ModelInput two_bars(Index order) {
    ModelInput input;
    input.mesh = bar_mesh(4, 2, 4, 1, [](int column) { return Index{column >= 2}; });
    for (InteriorEdge& edge : input.mesh.interior_edges)
        edge.cracked = input.mesh.region[edge.triangle[0]] != input.mesh.region[edge.triangle[1]];
    const Index first = input.mesh.n_triangles();
    Mesh small = bar_mesh(2, 2, 1, 1);
    for (Vec2& x : small.vertices) x += Vec2(1, 1);
    append(input.mesh, small);
    input.mesh.order = order;
    input.mesh.parts = {{"bar", 0, first}, {"hat", first, input.mesh.n_triangles() - first}};
    input.thickness = 0.5;
    input.materials = {{.density = 3, .E = 1, .nu = 0}, {.density = 7, .E = 1, .nu = 0}};
    input.laws = {{.sigma_c = 1, .G_c = 1}};
    input.law_of_pair = {{0, 0}, {0, 0}};
    return input;
}

struct Momentum {
    double mass = 0;
    Vec2 centre = Vec2::Zero(), linear = Vec2::Zero();
    double angular = 0, inertia = 0;  // about the centre
};

Momentum momentum_of(const Model& model, const MeshPart& part) {
    Momentum sum;
    const Index n = model.mesh.corners_per_triangle(), first = n * part.first_triangle,
                end = first + n * part.n_triangles;
    for (Index c = first; c < end; ++c) {
        sum.mass += model.corner_mass[c];
        sum.centre += model.corner_mass[c] * model.mesh.corner(c);
        sum.linear += model.corner_mass[c] * model.initial_velocity_of(c);
    }
    sum.centre /= sum.mass;
    for (Index c = first; c < end; ++c) {
        const Vec2 arm = model.mesh.corner(c) - sum.centre;
        sum.angular += model.corner_mass[c] * cross(arm, model.initial_velocity_of(c));
        sum.inertia += model.corner_mass[c] * arm.squaredNorm();
    }
    return sum;
}

}  // namespace

TEST_CASE("initial velocity and spin of a body are exact") {
    for (const Index order : {1, 2}) {
        CAPTURE(order);
        ModelInput input = two_bars(order);
        input.initial_velocities = {{.on = {.body = "bar"}, .value = {3, -4}, .spin = 2.5},
                                    {.on = {.body = "hat"}, .value = Vec2::Zero(), .spin = -7}};
        const Model model = make_model(std::move(input));
        const Momentum bar = momentum_of(model, model.mesh.parts[0]), hat = momentum_of(model, model.mesh.parts[1]);
        CHECK(bar.centre.x() == relative(2.4, 1e-14));  // 3 at 1, 7 at 3
        CHECK((bar.linear - bar.mass * Vec2(3, -4)).norm() <= 1e-14 * bar.mass * 5);
        CHECK(bar.angular == relative(2.5 * bar.inertia, 1e-14));
        CHECK(hat.linear.norm() <= 1e-14 * hat.mass * 7);
        CHECK(hat.angular == relative(-7 * hat.inertia, 1e-14));
        // a rigid motion strains nothing: all corners at a place have one velocity
        for (const Fan& fan : model.fans)
            for (const Index c : model.corners(fan))
                CHECK((model.initial_velocity_of(c) - model.initial_velocity_of(model.corners(fan)[0])).norm() == 0);
    }
}

TEST_CASE("a body that expands has velocities that are linear about its centre and no momentum of its own") {
    ModelInput input = two_bars(1);
    input.initial_velocities = {{.on = {.body = "bar"}, .value = {3, -4}, .strain_rate = {2, -1, 0.5}}};
    const Model model = make_model(std::move(input));
    const Momentum bar = momentum_of(model, model.mesh.parts[0]);
    CHECK((bar.linear - bar.mass * Vec2(3, -4)).norm() <= 1e-14 * bar.mass * 5);
    const MeshPart& part = model.mesh.parts[0];
    for (Index c = 3 * part.first_triangle; c < 3 * (part.first_triangle + part.n_triangles); ++c) {
        const Vec2 arm = model.mesh.corner(c) - bar.centre;
        const Vec2 exact(3 + 2 * arm.x() + 0.5 * arm.y(), -4 + 0.5 * arm.x() - arm.y());
        CHECK((model.initial_velocity_of(c) - exact).norm() <= 1e-13);
    }
}

TEST_CASE("a later initial velocity overwrites an earlier one where it acts") {
    ModelInput input = two_bars(1);
    input.initial_velocities = {{.on = {}, .value = {1, 0}},
                                {.on = {.body = "hat"}, .value = {0, 2}},
                                {.on = {.box = Box{{2, 0}, {4, 1}}, .body = "bar"}, .value = Vec2::Zero(), .spin = 1}};
    const Model model = make_model(std::move(input));
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        for (Index c = 3 * t; c < 3 * t + 3; ++c) {
            const Vec2 arm = model.mesh.corner(c) - Vec2(3, 0.5);
            const Vec2 expected = t >= 16 ? Vec2(0, 2) : model.mesh.centroid(t).x() < 2 ? Vec2(1, 0) : turned_left(arm);
            CHECK((model.initial_velocity_of(c) - expected).norm() <= 1e-14);
        }
}

TEST_CASE("selections by body") {
    const ModelInput input = two_bars(1);
    const Mesh& mesh = input.mesh;
    CHECK(selected_triangles(mesh, {.body = "hat"}).size() == 8);
    CHECK(selected_triangles(mesh, {.box = Box{{1, 1}, {1.5, 2}}, .body = "bar"}).empty());
    CHECK(selected_edges(mesh, {.body = "hat"}).size() == 8);
    CHECK(selected_edges(mesh, {.body = "bar"}).size() == 12);
    CHECK(selected_edges(mesh, {.boundary = "top", .body = "hat"}).size() == 2);  // both bodies have this name here
    const std::vector<char> corners = selected_corners(mesh, {.body = "hat"});
    CHECK(std::ranges::count(corners, 1) == 3 * 8);
    CHECK(selected_triangles(mesh, {.body = "cap"}).empty());
    Mesh own = mesh;  // with a name of its own for each side, as those of a scenario
    own.parts.push_back({"all", 0, own.n_triangles()});
    const auto n_names = static_cast<Index>(mesh.boundary_names.size());
    own.boundary_names.clear();
    for (const std::string body : {"bar.", "hat."})
        for (const std::string& name : mesh.boundary_names) own.boundary_names.push_back(body + name);
    for (BoundaryEdge& edge : own.boundary_edges) edge.boundary += edge.triangle < 16 ? 0 : n_names;
    const std::size_t of_bar = selected_edges(own, {.boundary = "bar.top"}).size();
    CHECK(of_bar > 0);
    CHECK(selected_edges(own, {.boundary = "top", .body = "bar"}).size() == of_bar);
    CHECK(selected_edges(own, {.boundary = "top", .body = "hat"}).size() == 2);
    CHECK(selected_edges(own, {.boundary = "hat.top", .body = "hat"}).size() == 2);
    CHECK(selected_edges(own, {.boundary = "top", .body = "all"}).size() == of_bar + 2);
    CHECK(selected_edges(own, {.boundary = "top"}).empty());
    CHECK(selected_edges(own, {.boundary = "op", .body = "all"}).empty());
    ModelInput wrong = two_bars(1);
    wrong.initial_velocities = {{.on = {.body = "cap"}, .value = {1, 0}}};
    CHECK_THROWS_AS(make_model(std::move(wrong)), EmptySelection);
}

}  // namespace initial_velocities_test
