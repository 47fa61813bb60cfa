#include "analysis/fragments.hpp"

#include "figures/curve_figures.hpp"
#include "model/make_model.hpp"
#include "model/state.hpp"
#include "support/meshes.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fragments_test {

using namespace knap;
using knap::tests::relative;

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
    CHECK(f.pieces[0].mass == relative(3));
    CHECK(f.pieces[0].area == relative(6));
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
    CHECK(apart.pieces[0].mass + apart.pieces[1].mass == relative(whole.pieces[0].mass));
}

TEST_CASE("fragments: table with the size distribution") {
    // masses 1, 3 and 4 of diameters in the ratio 1 : sqrt 3 : 2
    const std::vector<TriangleContent> triangles{triangle(1, {4, 0}), triangle(4, {0, 4}), triangle(3, {0, 0}, {5, 6})};
    const History table = fragment_table(find_fragments(triangles, {}));
    CHECK(table.columns[2] == "area");
    REQUIRE(table.rows.size() == 3);
    CHECK(table.column("mass") == std::vector<double>{4, 3, 1});
    CHECK(table.column("centre_y") == std::vector<double>{0, 6, 0});
    CHECK(table.column("velocity_x") == std::vector<double>{0, 0, 4});
    CHECK(table.column("mass_part") == std::vector<double>{0.5, 0.375, 0.125});
    CHECK(table.column("passing") == std::vector<double>{1, 0.5, 0.125});
    const double d = std::sqrt(4 * 2 / std::numbers::pi);  // of an area of 2
    CHECK(table.column("diameter")[2] == relative(d));
    CHECK(table.column("diameter")[0] == relative(2 * d));
    CHECK(diameter_passing(table, 0.1) == relative(d));
    CHECK(diameter_passing(table, 0.5) == relative(std::sqrt(3.0) * d));
    CHECK(diameter_passing(table, 0.51) == relative(2 * d));
    // the curve goes through these points, from 0 to 100 %
    const Chart chart = fragment_size_chart(table);
    CHECK(chart.x_logarithmic);
    const Curve& curve = chart.curves.at(0);
    CHECK(curve.y == std::vector<double>{0, 0, 12.5, 12.5, 50, 50, 100, 100});
    CHECK(curve.x[4] == relative(std::sqrt(3.0) * d));
}

TEST_CASE("fragments: how a bar lies and turns") {
    // a bar of 4 x 1 turned by 30 degrees that spins about its centre at 7 rad/s and flies
    ModelInput input;
    input.mesh = tests::bar_mesh(40, 10, 4, 1);
    input.materials = {{.density = 3, .E = 1, .nu = 0.2}};
    input.laws = {CohesiveLaw::unbreakable()};
    input.law_of_pair = {{0}};
    for (Vec2& x : input.mesh.vertices)
        x = Vec2(std::cos(std::numbers::pi / 6) * x.x() - 0.5 * x.y(),
                 0.5 * x.x() + std::cos(std::numbers::pi / 6) * x.y());
    const Model model = make_model(input);
    State state = initial_state(model);
    const Vec2 centre = find_fragments(model, state).pieces.at(0).centre;
    double energy = 0;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Vec2 velocity = Vec2(2, -1) + 7 * turned_left(model.mesh.corner(c) - centre);
        state.velocity[state.node_of_corner[c]] = velocity;
        energy += 0.5 * model.corner_mass[c] * velocity.squaredNorm();
    }
    const Fragment piece = find_fragments(model, state).pieces.at(0);
    CHECK(piece.spin() == relative(7, 1e-12));
    CHECK((piece.velocity - Vec2(2, -1)).norm() < 1e-12);
    CHECK(piece.kinetic_energy == relative(energy, 1e-12));
    CHECK(piece.angle() == relative(30, 0.005));     // the diagonals of the mesh all lean one way
    CHECK(piece.elongation() == relative(4, 0.02));  // its mass sits at the vertices
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
    CHECK(fragments.pieces[0].mass == relative(4));  // (3 x 2 + 1 x 2) x .5
    CHECK((fragments.pieces[0].velocity - Vec2(2, 0)).norm() < 1e-12);
    CHECK(fragments.pieces[0].centre.x() == relative((3.0 * 1 + 1.0 * 3) / 4));
}

TEST_CASE("fragments: history and paths") {
    // fragments of 4 and 2 kg, and the light one spins: two triangles with opposite velocities across its axis
    std::vector<TriangleContent> triangles{triangle(1, {0, 3}, {5, 1}), triangle(4, {3, 0}, {-2, 7}),
                                           triangle(1, {0, -3}, {3, 1})};
    const std::vector<std::array<Index, 2>> joined{{0, 2}};
    const Fragments f = find_fragments(triangles, joined);
    const History table = fragment_table(f);
    const std::vector<double> line = values_of(fragment_moment_columns(), FragmentMoment{0.5, f, table});
    const auto value = [&](std::string_view name) {
        const auto columns = fragment_moment_columns();
        return line[std::ranges::find(columns, name, &Output::name) - columns.begin()];
    };
    CHECK(value("time") == 0.5);
    CHECK(value("fragments") == 2);
    CHECK(value("largest_fragment") == relative(2. / 3));
    CHECK(value("from_x") == -2);
    CHECK(value("to_x") == 4);
    CHECK(value("from_y") == 1);
    CHECK(value("to_y") == 7);
    CHECK(value("largest_speed") == 3);
    CHECK(value("translation") == relative(0.5 * 4 * 9));
    CHECK(value("rotation") == relative(0.5 * 2 * 9));  // two points of 1 kg at 3 m/s
    CHECK(value("median_fragment") == relative(f.pieces[0].diameter()));
    const auto lines = fragment_path_lines(0.5, f, table);
    REQUIRE(lines.size() == 2);
    CHECK(lines[0].size() == fragment_path_columns(false).size());
    CHECK(lines[0][0] == 0.5);
    CHECK(lines[0][1] == 1);  // its lowest triangle
    CHECK(lines[1][1] == 0);
    CHECK(std::vector<double>(lines[1].begin() + 2, lines[1].end()) == table.rows[1]);
}

}  // namespace fragments_test
