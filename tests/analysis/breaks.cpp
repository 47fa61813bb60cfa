// Breaks of interfaces: mode, time, direction; the rose diagram of a known set of them.
#include "analysis/breaks.hpp"
#include "figures/curve_figures.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace breaks_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Two triangles of a square of side 2 with the diagonal between them, which breaks when their masses are driven apart
/// by `jump`, from rest.
std::vector<double> break_of(const Vec2& jump, const CohesiveLaw& law) {
    ModelInput input;
    input.mesh.vertices = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    input.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    input.mesh.region = {0, 0};
    input.mesh.boundary_names = {"rim"};
    input.thickness = 0.5;
    find_edges(input.mesh);
    input.materials = {{.density = 1, .E = 0, .nu = 0}};
    input.laws = {law};
    input.law_of_pair = {{0}};
    const Model model = make_model(input);
    State state = initial_state(model);
    Breaks breaks(model, state);
    CHECK(breaks.found(state).empty());
    // apart by hand: all fans split, the second triangle moved
    for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) split(model, f, state);
    for (Index k = 3; k < 6; ++k) state.displacement[state.node_of_corner[k]] = jump;
    for (PointState& point : state.points) point.cohesion = 0.2;
    CHECK(breaks.found(state).empty());
    state.points.front().cohesion = 0;
    CHECK(breaks.found(state).empty());  // one of two points
    state.points.back().cohesion = 0;
    state.time = 3;
    const auto lines = breaks.found(state);
    REQUIRE(lines.size() == 1);
    CHECK(breaks.found(state).empty());
    CHECK(breaks.n_tensile() + breaks.n_shear() == 1);
    CHECK((breaks.n_shear() == 1) == is_shear(lines[0][5]));
    return lines[0];
}

const Vec2 across = Vec2(-1, 1).normalized(), along = Vec2(1, 1).normalized();

History table(const std::vector<std::array<double, 3>>& angle_length_shear) {
    History made{.columns = names_of(break_columns()), .rows = {}};
    for (const auto& [angle, length, shear] : angle_length_shear)
        made.rows.push_back({0, 0, 0, angle, length, shear, 1, 0, 0});
    return made;
}

}  // namespace

TEST_CASE("breaks: an interface breaks once with its place and direction and in the mode of its opening") {
    const CohesiveLaw law{.sigma_c = 1, .G_c = 4, .gamma = 1};
    const std::vector<double> open = break_of(across, law);
    CHECK(open[0] == 3);
    CHECK(open[1] == relative(1));
    CHECK(open[2] == relative(1));
    CHECK(open[3] == relative(45));
    CHECK(open[4] == relative(std::sqrt(8.0)));
    CHECK(open[5] < 1e-12);
    CHECK(open[6] == relative(4 * std::sqrt(8.0) * 0.5));
    CHECK(open[7] == relative(1));
    CHECK(std::abs(open[8]) < 1e-12);
    CHECK(break_of(along, law)[5] == relative(1));
    CHECK(break_of(along, law)[8] == relative(1));  // the triangle to the left moves on
    CHECK(break_of(-along, law)[5] == relative(1));
    CHECK(break_of(-along, law)[8] == relative(-1));
    CHECK(std::abs(break_of(-along, law)[7]) < 1e-12);
    CHECK(break_of(along - across, law)[5] == relative(1));  // pressed together it slides all the same
    CHECK(break_of(3 * across + along, law)[5] == relative(0.25));
    CHECK(break_of(3 * across - along, {.sigma_c = 1, .G_c = 1, .gamma = 6})[5] == relative(2. / 3));
    CHECK(break_of(across + 5 * along, {.sigma_c = 1, .G_c = 1, .gamma = 0})[5] == within(0, 1e-12));  // mode I only
}

TEST_CASE(
    "breaks: a run counts each interface once and the energies of all breaks add up to the surface energy of the "
    "broken interfaces") {
    // a bar that flies apart: the right half at once, of random strength nothing
    ModelInput input;
    input.mesh = bar_mesh(12, 3, 4, 1);
    input.materials = {{.density = 1, .E = 100, .nu = 0.2}};
    input.laws = {{.sigma_c = 1, .G_c = 0.01, .gamma = 1, .friction = 0.3}};
    input.law_of_pair = {{0}};
    input.initial_velocities = {{.on = {.boundary = "", .box = Box{{2, 0}, {4, 1}}}, .value = Vec2(1, 0.2)}};
    Run run(input);
    Breaks breaks(run.model, run.now);
    std::vector<double> times;
    double energy = 0, length = 0;
    for (int i = 0; i < 600; ++i) {
        run.step(0.8 * run.stepper.stable_step());
        for (const auto& line : breaks.found(run.now)) times.push_back(line[0]), energy += line[6], length += line[4];
    }
    int n_broken = 0;
    double broken_energy = 0;
    for (std::size_t i = 0; i < run.model.interfaces.size(); ++i) {
        const bool broken = cohesion(run.model, run.now, 2 * i) <= 0 && cohesion(run.model, run.now, 2 * i + 1) <= 0;
        if (broken) ++n_broken, broken_energy += run.model.laws[0].G_c * run.model.interfaces[i].length;
    }
    CHECK(n_broken >= 3);
    CHECK(static_cast<int>(times.size()) == n_broken);
    CHECK(breaks.n_tensile() + breaks.n_shear() == n_broken);
    CHECK(energy == relative(broken_energy, 1e-12));
    CHECK(std::is_sorted(times.begin(), times.end()));
}

TEST_CASE("breaks: rose of a known set") {
    const History breaks = table({{0, 1, 0}, {9.99, 2, 1}, {10, 3, 0.5}, {95, 4, 0.51}, {179.9, 5, 0}});
    const std::vector<Petal> found = petals(breaks);
    REQUIRE(found.size() == n_petals);
    for (int i = 0; i < n_petals; ++i) {
        const double tensile = i == 0 ? 1 : i == 1 ? 3 : i == 17 ? 5 : 0, shear = i == 0 ? 2 : i == 9 ? 4 : 0;
        CHECK(found[i].tensile == tensile);
        CHECK(found[i].shear == shear);
    }
}

TEST_CASE("breaks: curves count them") {
    History breaks{.columns = names_of(break_columns()),
                   .rows = {{1, 0, 0, 0, 1, 0, 1}, {2, 0, 0, 0, 1, 1, 1}, {4, 0, 0, 0, 1, 0.2, 1}}};
    const Chart chart = break_chart(breaks, 0, 5);
    CHECK(chart.curves[0].x == std::vector<double>{0, 1, 1, 2, 2, 4, 4, 5});
    CHECK(chart.curves[0].y == std::vector<double>{0, 0, 1, 1, 2, 2, 3, 3});
    CHECK(chart.curves[1].y.back() == 2);
    CHECK(chart.curves[2].y.back() == 1);
}

}  // namespace breaks_test
