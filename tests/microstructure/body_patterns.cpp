// Walls, cells and heaps: numbers, areas, distances, seeds.
#include "microstructure/body_patterns.hpp"

#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace body_patterns_test {

using namespace knap;
using knap::tests::relative;
using knap::tests::within;

namespace {

double area(const Outlines& outlines) {
    double sum = 0;
    for (const auto& polygon : outlines) sum += signed_area(polygon);
    return sum;
}

Shape shape_of(const std::vector<Vec2>& polygon) {
    return {.outer = {polygon, std::vector<Index>(polygon.size(), 0)}, .boundary_names = {"rim"}};
}

/// Number of pairs that lie in each other by more than `tolerance` [m].
int n_overlaps(const Outlines& outlines, double tolerance) {
    int n = 0;
    for (std::size_t a = 0; a < outlines.size(); ++a)
        for (std::size_t b = a + 1; b < outlines.size(); ++b)
            n += overlap(shape_of(outlines[a]), shape_of(outlines[b]), tolerance).has_value();
    return n;
}

double smallest_distance(const Outlines& outlines) {
    double smallest = 1e300;
    for (std::size_t a = 0; a < outlines.size(); ++a)
        for (std::size_t b = a + 1; b < outlines.size(); ++b)
            for (const Segment& s : sides_of(outlines[a], true))
                for (const Segment& t : sides_of(outlines[b], true))
                    smallest = std::min(smallest, distance_between(s, t));
    return smallest;
}

double diameter(const std::vector<Vec2>& polygon) { return std::sqrt(4 * signed_area(polygon) / std::numbers::pi); }

const Box box{{1, 2}, {5, 4}};

}  // namespace

TEST_CASE("wall: blocks in bond fill a rectangle but for the joints") {
    for (const double gap : {0., 0.02}) {
        CAPTURE(gap);
        const Outlines blocks =
            wall({.columns = 4, .rows = 3, .block = {0.5, 0.2}, .gap = gap, .bond = 0.4, .origin = {1, -1}});
        REQUIRE(blocks.size() == 4 + 5 + 4);
        const double length = 4 * 0.5 + 3 * gap, height = 3 * 0.2 + 2 * gap;
        for (const auto& block : blocks) {
            const Box b = bounding_box(block);
            CHECK(signed_area(block) == relative(b.extent().prod(), 1e-12));  // a rectangle
            CHECK(b.extent().y() == relative(0.2, 1e-12));
            CHECK(b.low.x() >= 1 - 1e-12);
            CHECK(b.high.x() <= 1 + length + 1e-12);
        }
        CHECK(bounding_box(blocks.back()).high.x() == relative(1 + length, 1e-12));
        CHECK(bounding_box(blocks.back()).high.y() == relative(-1 + height, 1e-12));
        CHECK(bounding_box(blocks[8]).high.x() == relative(1 + length, 1e-12));  // the short one of the second row
        CHECK(bounding_box(blocks[4]).extent().x() == relative(0.4 * (0.5 + gap) - gap, 1e-12));
        CHECK(bounding_box(blocks[8]).extent().x() == relative(0.6 * (0.5 + gap) - gap, 1e-12));
        // the joints of a row have the area of 3 or 4 gaps
        CHECK(area(blocks) == relative(3 * length * 0.2 - (3 + 4 + 3) * gap * 0.2, 1e-12));
        CHECK(n_overlaps(blocks, 1e-9) == 0);
        CHECK(smallest_distance(blocks) == within(gap, 1e-9));
    }
    CHECK(wall({.columns = 4, .rows = 3, .block = {0.5, 0.2}, .bond = 0}).size() == 12);
}

TEST_CASE("cells fill their box without overlap and without short sides") {
    const GrainOptions options{.size = 0.3, .spread = 0.25};
    const Outlines cells = cells_of_box(options, box, 0, 0.03, 1, "cells");
    CHECK(area(cells) == relative(8, 1e-9));
    CHECK(n_overlaps(cells, 1e-9) == 0);
    double mean = 0, shortest = 1e300;
    for (const auto& cell : cells) {
        mean += diameter(cell) / static_cast<double>(cells.size());
        for (const auto& [a, b] : sides_of(cell, true)) shortest = std::min(shortest, (b - a).norm());
        for (const Vec2& p : cell) CHECK(Box{{1 - 1e-12, 2 - 1e-12}, {5 + 1e-12, 4 + 1e-12}}.contains(p));
    }
    CHECK(mean == relative(0.3, 0.05));
    CHECK(shortest > 0.02);
    // shrunk by half of the gap on every side within the box
    const Outlines apart = cells_of_box(options, box, 0.02, 0.03, 1, "cells");
    CHECK(apart.size() == cells.size());
    CHECK(smallest_distance(apart) > 0.02 - 1e-9);
    double circumference = -box.extent().sum() * 2;  // of the cells, without the border of the box
    for (const auto& cell : cells)
        for (const auto& [a, b] : sides_of(cell, true)) circumference += (b - a).norm();
    CHECK(area(apart) == relative(8 - 0.01 * circumference, 0.01));
    // the seed
    CHECK(cells_of_box(options, box, 0, 0.03, 1, "cells") == cells);
    CHECK(cells_of_box(options, box, 0, 0.03, 2, "cells") != cells);
}

TEST_CASE("a heap has the requested stones at their distance") {
    const InclusionOptions options{.size = 0.25, .spread = 0.2, .number = 40, .distance = 0.02, .corners = 7};
    const Outlines stones = heap(options, box, 3, "heap");
    REQUIRE(stones.size() == 40);
    CHECK(smallest_distance(stones) > 0.02 - 1e-12);
    double mean = 0;
    for (const auto& stone : stones) {
        CHECK(is_convex(stone));
        CHECK(stone.size() >= 3);
        CHECK(stone.size() <= 7);
        mean += diameter(stone) / 40;
        const Box b = bounding_box(stone);
        CHECK(b.low.x() > 1.02 - 1e-12);
        CHECK(b.high.y() < 3.98 + 1e-12);
    }
    CHECK(mean == relative(0.25, 0.1));  // 40 draws of deviation 0.2
    CHECK(std::ranges::is_sorted(stones, std::greater(), signed_area));
    CHECK(heap(options, box, 3, "heap") == stones);
    CHECK(heap(options, box, 4, "heap") != stones);
    InclusionOptions discs = options;
    discs.corners = 0, discs.mesh.size = 0.05, discs.spread = 0;
    for (const auto& disc : heap(discs, box, 3, "heap")) CHECK(diameter(disc) == relative(0.25, 1e-9));
    InclusionOptions many = options;
    many.number = 1000;
    CHECK_THROWS_AS(heap(many, box, 3, "heap"), ShapeError);
}

}  // namespace body_patterns_test
