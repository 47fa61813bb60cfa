// Laws of single interfaces: within and between grains, joints, random strength.
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/meshes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace interface_strength_test {

using namespace knap;
using namespace knap::tests;

namespace {

ModelInput input_of(Mesh mesh) {
    ModelInput input;
    input.mesh = std::move(mesh);
    input.materials = {{.density = 3, .E = 1, .nu = 0}, {.density = 4, .E = 1, .nu = 0}};
    input.laws = {
        {.sigma_c = 2, .G_c = 3}, {.sigma_c = 5, .G_c = 3}, CohesiveLaw::unbreakable(), {.sigma_c = 1, .G_c = 1}};
    input.law_of_pair = {{0, 1}, {1, 0}};
    input.law_within = {2, 2};
    input.law_of_joint = {3};
    return input;
}

}  // namespace

TEST_CASE("the law of an interface: joint before grain before pair of materials") {
    Mesh mesh = bar_mesh(6, 1, 6, 1, [](int i) { return i / 3; });               // two triangles a column
    for (Index t = 0; t < mesh.n_triangles(); ++t) mesh.grain.push_back(t / 4);  // two columns a grain
    for (InteriorEdge& edge : mesh.interior_edges)
        if (edge.triangle[0] / 2 == 0 && edge.triangle[1] / 2 == 0) edge.joint = 0;
    const Model model = make_model(input_of(mesh));
    for (const Interface& i : model.interfaces) {
        const Index a = i.triangle[0] / 2, b = i.triangle[1] / 2;  // columns
        const Index expected = a == 0 && b == 0 ? 3 : a / 2 == b / 2 ? 2 : 0;
        CHECK(i.law == expected);
    }
    mesh.grain.clear();
    for (InteriorEdge& edge : mesh.interior_edges) edge.joint = -1;
    const Model plain = make_model(input_of(mesh));
    for (const Interface& i : plain.interfaces) CHECK(i.law == (i.triangle[0] / 6 == i.triangle[1] / 6 ? 0 : 1));
}

TEST_CASE("every interface whose law scatters has a law of its own") {
    ModelInput input = input_of(bar_mesh(20, 3, 20, 3, [](int i) { return i / 10; }));
    input.scatter = {{.kind = Scatter::Kind::weibull, .modulus = 4, .of_energy = true}, {}, {}, {}};
    const Model model = make_model(input);
    Index n_scattered = 0;
    double sum = 0;
    for (const Interface& i : model.interfaces) {
        const CohesiveLaw& law = model.laws[i.law];
        if (model.mesh.region[i.triangle[0]] != model.mesh.region[i.triangle[1]]) {
            CHECK(i.law == 1);
            continue;
        }
        CHECK(i.law >= 4);
        CHECK(law.G_c / law.sigma_c == relative(1.5, 1e-14));  // one factor
        sum += law.sigma_c / 2;
        ++n_scattered;
    }
    CHECK(model.laws.size() == 4u + n_scattered);
    CHECK(sum / n_scattered == relative(1, 4 * 0.28 / std::sqrt(n_scattered)));
    for (const FanPoint& point : model.fan_points) CHECK(point.law == model.interfaces[point.point / 2].law);

    const Model again = make_model(input);
    for (std::size_t i = 0; i < model.laws.size(); ++i) CHECK(model.laws[i].sigma_c == again.laws[i].sigma_c);
    input.seed = 2;
    const Model other = make_model(input);
    CHECK(model.laws[10].sigma_c != other.laws[10].sigma_c);
}

TEST_CASE("strength scales with length and area as Weibull's weakest link says and not with the unit") {
    const auto model_of = [](const Mesh& mesh, double length, double area) {
        ModelInput input = input_of(mesh);
        input.scatter = {{.kind = Scatter::Kind::weibull, .modulus = 5, .length = length, .area = area}};
        return make_model(input);
    };
    const Mesh mesh = bar_mesh(8, 2, 8, 2);
    const Model plain = model_of(mesh, 0, 0), by_length = model_of(mesh, 3, 0), by_area = model_of(mesh, 0, 3);
    for (std::size_t i = 0; i < plain.interfaces.size(); ++i) {
        const double strength = plain.laws[plain.interfaces[i].law].sigma_c, length = plain.interfaces[i].length;
        CHECK(by_length.laws[by_length.interfaces[i].law].sigma_c ==
              relative(std::pow(3 / length, 0.2) * strength, 1e-12));
        CHECK(by_area.laws[by_area.interfaces[i].law].sigma_c ==
              relative(std::pow(3 / (1.0 / 3), 0.2) * strength, 1e-12));  // 2/3 of a half
    }
    Mesh large = mesh;
    for (Vec2& x : large.vertices) x *= 1000;
    const Model scaled = model_of(large, 3000, 0);
    for (std::size_t i = 0; i < plain.interfaces.size(); ++i)
        CHECK(scaled.laws[scaled.interfaces[i].law].sigma_c ==
              relative(by_length.laws[by_length.interfaces[i].law].sigma_c, 1e-12));
}

TEST_CASE("a correlated field gives the same strength on every mesh") {
    const auto strength_near = [](int n, const Vec2& x) {
        ModelInput input = input_of(bar_mesh(8 * n, 2 * n, 8, 2));
        input.scatter = {{.kind = Scatter::Kind::lognormal, .deviation = 0.3, .correlation = 2}};
        const Model model = make_model(input);
        double nearest = 1e300, strength = 0;
        for (const Interface& i : model.interfaces) {
            const Vec2 middle = 0.5 * (model.mesh.vertices[i.vertex[0]] + model.mesh.vertices[i.vertex[1]]);
            if ((middle - x).norm() < nearest) nearest = (middle - x).norm(), strength = model.laws[i.law].sigma_c;
        }
        return strength;
    };
    for (const Vec2& x : {Vec2(1.1, 0.9), Vec2(4.3, 1.2), Vec2(7, 0.4)}) {
        // the field changes by about 0.3 * distance/2 a correlation length; places differ by less than an edge
        CHECK(strength_near(16, x) == relative(strength_near(8, x), 0.05));
        CHECK(strength_near(16, x) != relative(strength_near(16, x + Vec2(4, 0)), 1e-3));
    }
}

TEST_CASE("the strength of a facet follows its angle to the layers beside it and the weaker side counts") {
    constexpr double degree = std::numbers::pi / 180;
    ModelInput input = input_of(bar_mesh(4, 4, 4, 4, [](int i) { return i < 2 ? 0 : 1; }));
    input.materials = {input.materials[0], input.materials[0]};
    input.law_of_pair = {{0, 0}, {0, 0}};
    const auto layers = [](double angle) { return Bedding{.E = 1, .nu = 0.2, .G = 0.5, .angle = angle}; };
    input.materials[0].bedding = layers(30 * degree);
    input.over_bedding = {{.strength = {.angle = {0, 60 * degree}, .factor = {0.25, 1}},
                           .energy = {.angle = {0, 90 * degree}, .factor = {0.1, 1}}}};
    const CohesiveLaw law = input.laws[0];
    const auto check = [&](const std::vector<double>& angle_of_region) {  // [deg], negative: no layers
        const Model model = make_model(input);
        for (const Interface& interface : model.interfaces) {
            const Vec2 along = model.mesh.vertices[interface.vertex[1]] - model.mesh.vertices[interface.vertex[0]];
            double strength = infinity, energy = infinity;
            for (const Index t : interface.triangle) {
                if (angle_of_region[model.mesh.region[t]] < 0) continue;
                double between = std::fmod(
                    std::abs(std::atan2(along.y(), along.x()) / degree - angle_of_region[model.mesh.region[t]]), 180);
                if (between > 90) between = 180 - between;
                strength = std::min(strength, 0.25 + 0.75 * std::min(between / 60, 1.));
                energy = std::min(energy, 0.1 + 0.9 * between / 90);
            }
            const CohesiveLaw& own = model.laws[interface.law];
            CHECK(own.sigma_c == relative(law.sigma_c * (std::isinf(strength) ? 1 : strength), 1e-14));
            CHECK(own.G_c == relative(law.G_c * (std::isinf(energy) ? 1 : energy), 1e-14));
        }
    };
    check({30, -1});
    input.materials[1].bedding = layers(-60 * degree);
    check({30, 120});
}

}  // namespace interface_strength_test
