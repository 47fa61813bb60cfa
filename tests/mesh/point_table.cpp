// Values at scattered points and times: what is linear over them is reproduced, and nothing is known outside the points.
#include "mesh/point_table.hpp"
#include "base/error.hpp"
#include "base/random.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace point_table_test {

using namespace knap;
using knap::tests::relative;

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
        const auto found = table.at(x, 0);
        REQUIRE(found);
        const std::array<double, 3> exact = linear(x);
        for (int k = 0; k < 3; ++k) CHECK(std::abs((*found)[k] - exact[k]) <= 1e-12 * (k == 1 ? 5e6 : 10));
    };
    for (const PointTable::Row& row : rows) check(row.place);
    Random random(5, "places");
    for (int i = 0; i < 500; ++i) check({random.uniform(0, 2), random.uniform(0, 2)});
    for (int i = 0; i <= 100; ++i) check({0.02 * i, 0}), check({0, 0.02 * i}), check({2, 0.02 * i});
}

TEST_CASE("point table: nothing is known outside the points or beside their line") {
    const PointTable table(points(10));
    for (const Vec2& outside : {Vec2(2.001, 1), Vec2(-1e-6, 1), Vec2(1, -5), Vec2(3, 3)})
        CHECK_FALSE(table.at(outside, 0));
    std::vector<PointTable::Row> line;
    for (const double i : {3., 0., 1., 4., 2.}) line.push_back({{0.1 * i, 0.3 * i}, {i * i, 0, 0}});  // rounded
    const PointTable along(line);
    CHECK(along.at({0.25, 0.75}, 0).value()[0] == relative(6.5));
    CHECK(along.at({0.4, 1.2}, 0).value()[0] == relative(16));
    CHECK_FALSE(along.at({0.25, 0.751}, 0));
    CHECK_FALSE(along.at({0.401, 1.203}, 0));
    CHECK_THROWS_AS(PointTable({line[0]}), UserError);
}

TEST_CASE("point table: values are linear between moments and constant beyond them") {
    std::vector<PointTable::Row> rows;
    for (const double t : {5., 1., 2.})
        for (const Vec2& x : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}) rows.push_back({x, {t * x.x(), t, 0}, t});
    rows.push_back({{1, 1}, {2, 2, 0}, 2});  // at this moment alone
    const PointTable table(rows);
    CHECK(table.depends_on_time());
    const auto at = [&](double t) { return table.at({0.5, 0.25}, t).value(); };
    CHECK(at(-3) == std::array<double, 3>{0.5, 1, 0});
    CHECK(at(3.5)[0] == relative(1.75));
    CHECK(at(3.5)[1] == relative(3.5));
    CHECK(at(9)[1] == relative(5));
    CHECK(table.at({0.9, 0.9}, 2));
    CHECK_FALSE(table.at({0.9, 0.9}, 2.1));
    CHECK_FALSE(table.reaches({0.9, 0.9}));
    CHECK(table.reaches({0.5, 0.5}));
    CHECK_FALSE(PointTable(points(3)).depends_on_time());
}

}  // namespace point_table_test
