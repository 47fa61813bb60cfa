// Starts in equilibrium of walls, lintels and arches whose irregular meshes do not match: many contacts too many, gaps
// of rounding, corners of four blocks at one place.
#include "mesh/triangulate.hpp"
#include "support/obstacles.hpp"
#include "support/resting.hpp"

#include <cmath>
#include <vector>

namespace resting_walls_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double gravity = 10, density = 2000;

/// Bodies with their number of row; 0: what stands on the ground.
struct Masonry {
    Bodies bodies;
    std::vector<int> row;

    void add(std::vector<Vec2> points, double size, int of_row) {
        Shape shape;
        for (std::size_t i = 0; i < points.size(); ++i) shape.outer.boundary.push_back(0);
        shape.outer.points = std::move(points);
        shape.boundary_names = {"free"};
        row.push_back(of_row);
        bodies.add(triangulate(shape, {.size = size, .seed = row.size()}), {0, 0});
    }
    void add_block(double x, double y, double width, double height, double size, int of_row) {
        add({{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}}, size, of_row);
    }
    double weight(int from_row = 0) const {
        double area = 0;
        for (Index t = 0; t < bodies.mesh.n_triangles(); ++t)
            if (row[bodies.mesh.region[t]] >= from_row) area += bodies.mesh.area(t);
        return gravity * density * area;
    }
    /// On a rough half plane.
    ModelInput on_ground(double friction) {
        ModelInput input = hard(bodies, friction);
        input.loads = {everywhere(0, -gravity)};
        input.obstacles = {polygon({{-50, -1}, {50, -1}, {50, 0}, {-50, 0}}, {.friction = friction})};
        return input;
    }
    /// [N] Upwards, on all bodies from this row on from those below.
    double cohesive_impulse(int from_row, const State& state) const {
        const Mesh& mesh = bodies.mesh;
        const auto row_of = [&](Index corner) { return row[mesh.region[mesh.triangle_of(corner)]]; };
        const auto place = [&](Index corner) -> Vec2 { return mesh.corner(corner) + state.displacement_of(corner); };
        double sum = 0;
        for (const FaceContactState& at : state.face_contacts) {
            const Index next = 3 * mesh.triangle_of(at.edge) + (at.edge + 1) % 3;
            const bool above = row_of(at.vertex) >= from_row;
            if (above == (row_of(at.edge) >= from_row)) continue;
            const Vec2 t = (place(next) - place(at.edge)).normalized(), n = -turned_left(t);
            sum += (above ? 1 : -1) * (at.contact * n + at.tangential * t).y() / state.last_step;
        }
        return sum;
    }
};

/// Blocks of 0.6 x 0.3 m in rows as of a pattern "wall".
Masonry wall(int columns, int rows, double bond, double size) {
    Masonry found;
    for (int i = 0; i < rows; ++i) {
        std::vector<double> joints{0};
        for (int k = 0; k <= columns; ++k)
            if (const double x = 0.6 * (k + (i % 2) * bond); x > 0 && x < 0.6 * columns - 1e-9) joints.push_back(x);
        joints.push_back(0.6 * columns);
        for (std::size_t k = 0; k + 1 < joints.size(); ++k)
            found.add_block(joints[k], 0.3 * i, joints[k + 1] - joints[k], 0.3, size, i);
    }
    return found;
}

/// At rest, each row bears what lies on it.
void check_stands(Masonry& found, double friction) {
    const Rest rest = rest_of(found.on_ground(friction), 60);
    check_rests(rest);
    if (!rest.refused.empty()) return;
    CHECK(rest.reaction.y() == relative(found.weight(), 1e-9));
    for (int i = 1; i <= *std::ranges::max_element(found.row); ++i) {
        CAPTURE(i);
        CHECK(found.cohesive_impulse(i, rest.now) == relative(found.weight(i), 1e-8));
    }
}

std::vector<Vec2> stone_of_arch(int k, int n, double radius, double thickness, double rounded) {
    const auto place = [&](double r, int at) -> Vec2 {
        const double angle = M_PI * (n - at) / n;
        return Vec2(std::round(r * std::cos(angle) / rounded), std::round(r * std::sin(angle) / rounded)) * rounded;
    };
    return {place(radius, k + 1), place(radius + thickness, k + 1), place(radius + thickness, k), place(radius, k)};
}

Masonry arch(double thickness, double rounded) {
    Masonry found;
    for (int k = 0; k < 9; ++k) found.add(stone_of_arch(k, 9, 2, thickness, rounded), 0.25, k == 0 || k == 8 ? 0 : 1);
    return found;
}

}  // namespace

TEST_CASE("walls of irregular meshes in running bond stand and each row bears the weight above") {
    for (const auto& [columns, rows] : {std::pair(2, 2), {3, 3}, {4, 3}}) {
        CAPTURE(columns);
        CAPTURE(rows);
        Masonry found = wall(columns, rows, 0.5, 0.2);
        check_stands(found, 0.5);
    }
}

TEST_CASE("a wall of five rows stands in any bond with corners of four blocks at one place in stack bond") {
    for (const double bond : {0.5, 0.3, 0.}) {
        CAPTURE(bond);
        Masonry found = wall(4, 5, bond, 0.2);
        check_stands(found, 0.5);
    }
}

TEST_CASE("a wall without friction slides on the tilt of its elastic faces and a millionth of friction holds it") {
    Masonry found = wall(3, 3, 0.5, 0.2);
    check_refused(rest_of(found.on_ground(0)), "contacts without friction slide on the least slope");
    check_rests(rest_of(found.on_ground(1e-6)));
}

TEST_CASE("a wall stands on a held body with another mesh and is refused where the slope exceeds friction") {
    for (const double part : {0.98, 1.02}) {
        Masonry found = wall(3, 3, 0.5, 0.17);
        found.add_block(-0.4, -0.3 - below, 2.6, 0.3, 0.23, -1);
        ModelInput input = hard(found.bodies, 0.3);
        input.loads = {everywhere(0.3 * part * gravity, -gravity), held()};
        const Rest rest = rest_of(std::move(input), 60);
        if (part < 1) check_rests(rest);
        else
            check_refused(
                rest, "contact and friction do not hold the body, it would move away with 0.06 m/s2 without turning");
    }
}

TEST_CASE("a lintel bridges two pillars and carries blocks and is refused where a pillar does not reach it") {
    for (const double missing : {0., 0.001}) {
        Masonry found;
        found.add_block(0, 0, 0.4, 1.2, 0.2, 0);
        found.add_block(1.4, 0, 0.5, 1.2 - missing, 0.15, 0);
        found.add_block(-0.1, 1.2, 2.1, 0.3, 0.13, 1);
        for (const double x : {0., 0.5, 1.1}) found.add_block(x, 1.5, 0.5, 0.3, 0.19, 2);
        if (missing == 0) check_stands(found, 0.5);
        else check_refused(rest_of(found.on_ground(0.5)), "contact and friction do not hold the body, it would");
    }
}

TEST_CASE("a dry arch stands with places rounded to millimetres and a thinner one than a tenth of its radius falls") {
    for (const double rounded : {1e-9, 1e-3}) {
        Masonry found = arch(0.5, rounded);
        check_stands(found, 0.7);
    }
    Masonry thin = arch(0.2, 1e-9);  // Couplet, Milankovitch: 0.1075 of the mean radius
    check_refused(rest_of(thin.on_ground(0.7)), "contact and friction do not hold the body, it would move away with");
}

TEST_CASE("a pyramid and a buttress stand and a block beyond its edge turns over") {
    Masonry pyramid;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4 - j; ++i)
            pyramid.add_block(0.52 * i + 0.26 * j, 0.3 * j, 0.5, 0.3, 0.12 + 0.03 * ((i + j) % 3), j);
    check_stands(pyramid, 0.5);
    Masonry buttress;
    buttress.add_block(0, 0, 0.5, 1.5, 0.2, 0);
    buttress.add({{0.5, 0}, {1.5, 0}, {0.5, 1.2}}, 0.2, 0);
    check_stands(buttress, 0.6);
    for (const double overhang : {0.49, 0.51}) {
        Masonry two;
        two.add_block(0, 0, 1, 0.4, 0.2, 0);
        two.add_block(overhang, 0.4, 1, 0.3, 0.2, 1);
        if (overhang < 0.5) check_stands(two, 0.5);
        else check_refused(rest_of(two.on_ground(0.5)), "and turn, at (");
    }
}

}  // namespace resting_walls_test
