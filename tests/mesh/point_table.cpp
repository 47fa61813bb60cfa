// Values at scattered points: what is linear over them is reproduced, and nothing is known outside them.
#include "mesh/point_table.hpp"
#include "base/error.hpp"
#include "base/random.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace point_table_test {

using namespace knap;

namespace {

std::array<double, 3> linear(const Vec2& x) { return {1 + 2 * x.x() - 3 * x.y(), -5e6 + 1e6 * x.y(), 7 * x.x()}; }

/// On a square of side 2, with its corners and points on its sides that rounding pushes off them.
std::vector<PointTable::Row> points(int n) {
    Random random(3, "points");
    std::vector<PointTable::Row> rows;
    const auto add = [&](const Vec2& x) { rows.push_back({x, linear(x)}); };
    for (const double x : {0., 2.})
        for (const double y : {0., 2.}) add({x, y});
    for (int i = 1; i < n; ++i) {
        add({2.0 * i / n, 1e-17 * (i % 3 - 1)});
        add({2 + 1e-16 * (i % 3), 2.0 * i / n});
        add({random.uniform(0.01, 1.99), random.uniform(0.01, 1.99)});
    }
    return rows;
}

}  // namespace

TEST_CASE("point table: a linear field is reproduced at its points and between them and on their hull") {
    const std::vector<PointTable::Row> rows = points(40);
    const PointTable table(rows);
    const auto check = [&](const Vec2& x) {
        const auto found = table.at(x);
        REQUIRE(found);
        const std::array<double, 3> exact = linear(x);
        for (int k = 0; k < 3; ++k) CHECK(std::abs((*found)[k] - exact[k]) <= 1e-12 * (k == 1 ? 5e6 : 10));
    };
    for (const PointTable::Row& row : rows) check(row.place);
    Random random(5, "places");
    for (int i = 0; i < 500; ++i) check({random.uniform(0, 2), random.uniform(0, 2)});
    for (int i = 0; i <= 100; ++i) check({0.02 * i, 0}), check({0, 0.02 * i}), check({2, 0.02 * i});
}

TEST_CASE("point table: nothing is known outside the points or of points on one line") {
    const PointTable table(points(10));
    for (const Vec2& outside : {Vec2(2.001, 1), Vec2(-1e-6, 1), Vec2(1, -5), Vec2(3, 3)})
        CHECK_FALSE(table.at(outside));
    std::vector<PointTable::Row> line;
    for (int i = 0; i < 5; ++i) line.push_back({{i * 1., 2. * i}, {}});
    CHECK_THROWS_AS(PointTable{line}, UserError);
}

}  // namespace point_table_test
