// Collectors: mass counts once however pieces break and turn back, and the path between two steps is a parabola.
#include "analysis/collectors.hpp"
#include "base/quantile.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace collectors_test {

using namespace knap;
using knap::tests::relative;

namespace {

ModelInput with_one_law(Mesh mesh) {
    ModelInput input;
    input.mesh = std::move(mesh);
    input.materials = {{.density = 1, .E = 0, .nu = 0}};
    input.laws = {{.sigma_c = 1, .G_c = 1}};
    input.law_of_pair = {{0}};
    return input;
}

/// A body that is moved by hand in steps of 1 s through lines, split at every vertex from the start.
struct Flight {
    Flight(Mesh mesh, std::vector<CollectorOptions> lines)
        : model(make_model(with_one_law(std::move(mesh)))),
          state(split_everywhere(model)),
          collectors(model, state, lines) {}

    static State split_everywhere(const Model& model) {
        State state = initial_state(model);
        for (Index f = 0; f < static_cast<Index>(model.fans.size()); ++f) split(model, f, state);
        return state;
    }
    void break_interface(Index i) {
        for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
            const Fan& fan = model.fans[state.split_fans[s]];
            for (Index k = 0; k < fan.n_points; ++k)
                if (model.interface_of(model.fan_points[fan.first_point + k].point) == i)
                    state.points[state.first_point[s] + k].cohesion = 0;
        }
        changed = true;
    }
    /// All corners of a triangle move alike.
    void step(const std::function<Vec2(Index)>& velocity_of_triangle) {
        double speed = 0;
        for (Index c = 0; c < model.mesh.n_corners(); ++c) {
            const Vec2 v = velocity_of_triangle(model.mesh.triangle_of(c));
            state.velocity[state.node_of_corner[c]] = v, state.displacement[state.node_of_corner[c]] += v;
            speed = std::max(speed, v.norm());
        }
        state.time += 1, state.last_step = 1, ++state.n_steps;
        for (const auto& line : collectors.after_step(state, speed, changed)) lines.push_back(line);
        changed = false;
    }
    void move(double x) {
        step([&](Index) { return Vec2(x, 0); });
    }
    std::vector<double> column(std::string_view name) const {
        const auto columns = passage_columns();
        const std::size_t place = std::ranges::find(columns, name, &Output::name) - columns.begin();
        std::vector<double> values;
        for (const auto& line : lines) values.push_back(line[place]);
        return values;
    }
    double total(std::string_view name) const {
        double sum = 0;
        for (const double value : column(name)) sum += value;
        return sum;
    }

    Model model;
    State state;
    Collectors collectors;
    std::vector<std::vector<double>> lines;
    bool changed = false;
};

/// Triangles of 2 kg below and above the diagonal of a square of side 2, centres at x = 4/3 and 2/3.
Mesh square() {
    Mesh mesh;
    mesh.vertices = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.region = {0, 0};
    mesh.boundary_names = {"rim"};
    find_edges(mesh);
    return mesh;
}

CollectorOptions at(double x) { return {.name = "line", .x = x}; }

using Values = std::vector<double>;

}  // namespace

TEST_CASE("collectors: a piece that breaks behind the line has passed and its rear part does not pass again") {
    Flight flight(square(), {at(1.2)});
    flight.move(0.3);
    CHECK(flight.column("mass") == Values{4});
    flight.break_interface(0);
    flight.move(0.05);
    flight.move(0.05);
    flight.move(1);
    CHECK(flight.column("mass") == Values{4});
    flight.move(-2);  // both return, on their own
    CHECK(flight.column("mass") == Values{4, 2, 2});
    CHECK(flight.column("direction") == Values{1, -1, -1});
    flight.move(-1);
    CHECK(flight.lines.size() == 3);
}

TEST_CASE("collectors: a piece that breaks before the line passes in parts") {
    Flight flight(square(), {at(3.2)});
    flight.move(2.1);
    CHECK(flight.lines.empty());
    flight.break_interface(0);
    flight.move(0.01);  // the front part is beyond the line
    CHECK(flight.column("mass") == Values{2});
    CHECK(flight.column("x").at(0) == relative(4. / 3 + 2.11));
    flight.move(0.2);
    flight.move(0.5);
    CHECK(flight.column("mass") == Values{2, 2});
    CHECK(flight.column("direction") == Values{1, 1});
    CHECK(flight.column("x").at(1) == relative(3.2, 1e-14));
}

TEST_CASE("collectors: a body that stands on the line and breaks has not passed") {
    Flight flight(square(), {at(1.1)});
    flight.move(0);
    flight.break_interface(0);
    for (int i = 0; i < 5; ++i) flight.move(0);
    CHECK(flight.lines.empty());
    flight.move(-1);  // now its right half comes through
    CHECK(flight.column("mass") == Values{2});
    CHECK(flight.column("direction") == Values{-1});
}

TEST_CASE("collectors: a piece that trembles on the line has not passed and one that goes on has") {
    Flight flight(square(), {at(1), {.name = "back", .x = 1, .direction = CollectorOptions::Direction::backward}});
    flight.move(-0.5);
    flight.move(0.4995);
    for (int i = 0; i < 100; ++i) flight.move(i % 2 ? -1e-3 : 1e-3);
    CHECK(flight.column("direction") == Values{-1, -1});  // the start, at 1, counts as beyond
    flight.move(0.1);
    flight.move(0.1);
    CHECK(flight.column("direction") == Values{-1, -1, 1});
    CHECK(flight.column("collector") == Values{0, 1, 0});
}

TEST_CASE("collectors: beside the ends of a line nothing passes and its lower end is the origin of heights") {
    const Vec2 top(3, 3), foot(3, 0.5);
    Flight flight(square(), {{.name = "net", .from = foot, .to = top},
                             {.name = "turned", .from = top, .to = foot},
                             {.name = "high", .from = {3, 2}, .to = top}});
    flight.move(1.5), flight.move(1.5);
    CHECK(flight.column("collector") == Values{0, 1});
    CHECK(flight.column("direction") == Values{1, -1});
    CHECK(flight.column("height") == Values{0.5, 0.5});
    CHECK(flight.column("translation") == Values{4.5, 4.5});
    CHECK(flight.column("time").at(0) == relative(4. / 3, 1e-14));
}

TEST_CASE("collectors: with pieces that break at any moment and drive apart every triangle passes once") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(0, 1);
    Flight flight(tests::bar_mesh(8, 5, 4, 2), {at(4.7), at(6.1)});
    const Index n = static_cast<Index>(flight.model.interfaces.size());
    for (int i = 0; i < 400; ++i) {
        for (Index k = 0; k < n; ++k)
            if (any(random) < 0.02) flight.break_interface(k);
        const Fragments fragments = find_fragments(flight.model, flight.state);
        CHECK(fragment_of_triangles(flight.model, flight.state) == fragments.piece_of_triangle);
        std::vector<double> velocity;
        for (const Fragment& piece : fragments.pieces) velocity.push_back(0.02 + 0.002 * (piece.first_triangle % 17));
        flight.step([&](Index t) { return Vec2(velocity[fragments.piece_of_triangle[t]], 0); });
    }
    const auto total_of = [&](double collector) {
        double sum = 0;
        for (const auto& line : flight.lines) sum += line[0] == collector ? line[5] : 0;
        return sum;
    };
    CHECK(total_of(0) == relative(8, 1e-13));
    CHECK(total_of(1) == relative(8, 1e-13));
    CHECK(flight.total("direction") == static_cast<double>(flight.lines.size()));
    CHECK(flight.lines.size() > 40);
}

TEST_CASE("collectors: a passage in free flight is that of the parabola and a blow bends no path") {
    Flight flight(square(), {at(25.5)});
    const double v_x = 2, v_y = 30, g = 9.81, y_start = 1;
    for (int i = 0; i < 30; ++i)  // the velocity of a step is that of its middle
        flight.step([&](Index) { return Vec2(v_x, v_y - g * (i + 0.5)); });
    const double t = 24.5 / v_x;
    REQUIRE(flight.lines.size() == 1);
    CHECK(flight.column("time").at(0) == relative(t, 1e-14));
    CHECK(flight.column("y").at(0) == relative(y_start + v_y * t - 0.5 * g * t * t, 1e-13));
    CHECK(flight.column("velocity_y").at(0) == relative(v_y - g * t, 1e-13));
    CHECK(flight.column("energy").at(0) == relative(0.5 * 4 * (4 + std::pow(v_y - g * t, 2)), 1e-13));

    Flight blow(square(), {at(25.5)});
    for (int i = 0; i < 15; ++i) blow.step([&](Index) { return Vec2(i < 12 ? 2 : 1, i < 12 ? -3 : 5); });
    CHECK(blow.column("velocity_y") == Values{5});
    CHECK(blow.column("speed").at(0) == relative(std::sqrt(26), 1e-14));
}

TEST_CASE("collectors: quantiles are linear between two values") {
    CHECK(quantile({3, 1, 2}, 0.5) == 2);
    CHECK(quantile({4, 1}, 0.95) == relative(3.85, 1e-15));
    CHECK(quantile({4, NAN, 1}, 1) == 4);
    CHECK(quantile({7}, 0.95) == 7);
    CHECK(std::isnan(quantile({}, 0.5)));
}

}  // namespace collectors_test
