#include "observe/fragments.hpp"

#include "model/state.hpp"
#include "support/meshes.hpp"

#include <doctest/doctest.h>

#include <sstream>

using namespace knap;
using doctest::Approx;

namespace {
TriangleContent triangle(double mass, const Vec2& velocity, const Vec2& centroid = Vec2::Zero()) {
    return {.area = 2 * mass, .mass = mass, .momentum = mass * velocity, .centroid = centroid};
}
}  // namespace

TEST_CASE("fragments: pieces of a strip cut in two places") {
    // triangles 0 1 | 2 3 4 | 5, each of 1 kg, triangle i at x = i
    std::vector<TriangleContent> triangles;
    for (int i = 0; i < 6; ++i) triangles.push_back(triangle(1, Vec2(i, 1), Vec2(i, 0)));
    const std::vector<std::array<Index, 2>> joined{{4, 3}, {0, 1}, {3, 2}};
    const Fragments f = find_fragments(triangles, joined);
    REQUIRE(f.pieces.size() == 3);
    CHECK(f.pieces[0].first_triangle == 2);
    CHECK(f.pieces[0].n_triangles == 3);
    CHECK(f.pieces[0].mass == Approx(3));
    CHECK(f.pieces[0].area == Approx(6));
    CHECK((f.pieces[0].velocity - Vec2(3, 1)).norm() < 1e-12);
    CHECK((f.pieces[0].centre - Vec2(3, 0)).norm() < 1e-12);
    CHECK(f.pieces[1].first_triangle == 0);
    CHECK((f.pieces[1].velocity - Vec2(0.5, 1)).norm() < 1e-12);
    CHECK(f.pieces[2].first_triangle == 5);
    CHECK(f.piece_of_triangle == std::vector<Index>{1, 1, 0, 0, 0, 2});
}

TEST_CASE("fragments: mean velocity weighs by mass and mass is kept") {
    const std::vector<TriangleContent> triangles{triangle(1, {4, 0}), triangle(3, {0, 4})};
    const std::vector<std::array<Index, 2>> joined{{0, 1}};
    const Fragments whole = find_fragments(triangles, joined);
    REQUIRE(whole.pieces.size() == 1);
    CHECK((whole.pieces[0].velocity - Vec2(1, 3)).norm() < 1e-12);
    const Fragments apart = find_fragments(triangles, {});
    REQUIRE(apart.pieces.size() == 2);
    CHECK(apart.pieces[0].mass + apart.pieces[1].mass == Approx(whole.pieces[0].mass));
}

TEST_CASE("fragments: table") {
    const std::vector<TriangleContent> triangles{triangle(1, {4, 0}), triangle(3, {0, 4})};
    std::ostringstream out;
    write_fragments(out, find_fragments(triangles, {}));
    CHECK(out.str() ==
          "fragment,triangles,area_m2,mass_kg,centre_x_m,centre_y_m,velocity_x_m_s,velocity_y_m_s\n"
          "0,1,6,3,0,0,0,4\n"
          "1,1,2,1,0,0,4,0\n");
}

TEST_CASE("fragments: of a model each triangle has its own mass") {
    // a heavy and a light half, an uncracked bar: one fragment with the mass and the centre of mass of both
    ModelInput input;
    input.mesh = tests::bar_mesh(4, 1, 4, 1, [](int column) { return column < 2 ? 0 : 1; });
    input.thickness = 0.5;
    input.materials = {{.density = 3, .E = 1, .nu = 0.2}, {.density = 1, .E = 1, .nu = 0.2}};
    input.laws = {CohesiveLaw::unbreakable()};
    input.law_of_pair = {{0, 0}, {0, 0}};
    input.initial_velocities = {{.on = {}, .value = Vec2(2, 0)}};
    const Model model = make_model(input);
    const Fragments fragments = find_fragments(model, initial_state(model));
    REQUIRE(fragments.pieces.size() == 1);
    CHECK(fragments.pieces[0].mass == Approx(4));  // (3 x 2 + 1 x 2) x .5
    CHECK((fragments.pieces[0].velocity - Vec2(2, 0)).norm() < 1e-12);
    CHECK(fragments.pieces[0].centre.x() == Approx((3.0 * 1 + 1.0 * 3) / 4));
}
