// Shape::snap: maps of traces as they were digitised.
#include "mesh/shape_graph.hpp"
#include "mesh/shapes.hpp"
#include "mesh/triangulate.hpp"
#include "support/trace_map.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace snap_test {

using namespace knap;
using tests::relative;

namespace {

/// A box of 10 m x 10 m with cracks.
Shape box(const std::vector<std::vector<Vec2>>& cracks, double snap, const Vec2& extent = {10, 10}) {
    Shape shape;
    shape.boundary_names = {"rim"};
    shape.outer = {{{0, 0}, {extent.x(), 0}, extent, {0, extent.y()}}, {0, 0, 0, 0}};
    for (const auto& points : cracks) shape.cracks.push_back({.points = points});
    shape.snap = snap;
    return shape;
}

struct Snapped {
    SnapCounts counts;
    PlanarGraph graph;
    double length = 0;  // [m] of the cracks

    explicit Snapped(const Shape& shape) : graph(planar_graph(shape, 0, &counts)) {
        for (const GraphSegment& s : graph.segments)
            if (s.crack >= 0) length += (graph.line(s).b - graph.line(s).a).norm();
    }
    bool has(const Vec2& x) const {
        return std::ranges::any_of(graph.nodes, [&](const Vec2& node) { return (node - x).norm() < 1e-9; });
    }
};

/// What a mesh whose twentieth is `length` finds wrong.
std::vector<ShapeFault> faults_below(double length, const PlanarGraph& graph) {
    return faults_of_details(graph, {.size = 20 * length * (1 - 1e-9)});
}

}  // namespace

TEST_CASE("snap: ends that nearly meet are joined whether short of a line or beyond") {
    // the second ends 30 mm short of the first, the third 30 mm beyond it, the fourth 30 mm from the end of the second
    const std::vector<std::vector<Vec2>> cracks{
        {{1, 5}, {9, 5}}, {{3, 2}, {3, 4.97}}, {{7, 2}, {7, 5.03}}, {{2, 1}, {2.98, 1.99}}};
    const Snapped raw(box(cracks, 0)), joined(box(cracks, 0.05));
    CHECK(raw.graph.nodes.size() == 4 + 2 + 2 + 3 + 2);  // with one crossing
    CHECK(joined.graph.nodes.size() == 4 + 2 + 2 + 2 + 1);
    CHECK(joined.has({3, 5}) == false);  // the first is bent onto the end of the second, which is the smaller move
    CHECK(joined.has({3, 4.97}));
    CHECK(joined.counts.n_joined == 2);
    CHECK(joined.counts.n_left_out == 1);
    CHECK(joined.counts.length_left_out == relative(0.03, 1e-9));
    CHECK(joined.counts.lost.empty());
    CHECK(faults_below(0.05, joined.graph).empty());
    const std::vector<ShapeFault> faults = faults_below(0.05, raw.graph);
    for (const char* part : {"cracks[1]", "cracks[2]", "cracks[3]"})
        CHECK(std::ranges::count(faults, part, &ShapeFault::part) > 0);
}

TEST_CASE("snap: crossings side by side become one and a crack drawn twice is one") {
    const std::vector<std::vector<Vec2>> star{{{1, 5}, {9, 5}}, {{5, 1}, {5.02, 9}}, {{1, 1}, {9, 9.02}}};
    const Snapped one(box(star, 0.05));
    CHECK(one.graph.nodes.size() == 4 + 6 + 1);
    CHECK(one.graph.segments.size() == 4 + 6);
    CHECK(one.counts.n_left_out == 3);  // the sides of the little triangle between the crossings
    const Snapped twice(box({{{1, 5}, {9, 5}}, {{1.01, 5.02}, {9.01, 4.98}}, {{3, 1}, {3.01, 1.01}}}, 0.05));
    CHECK(twice.graph.segments.size() == 4 + 2);  // they cross half-way
    CHECK(twice.length == relative(8, 1e-9));
    CHECK(twice.counts.lost == std::vector<Index>{1, 2});
    CHECK(twice.counts.n_left_out == 1);  // 14 mm
}

TEST_CASE("snap: exact copies and cracks on the border are left out with snap and name their place without") {
    const std::vector<std::vector<Vec2>> traces{{{1, 5}, {9, 5}}, {{9, 5}, {1, 5}}, {{3, 5}, {4, 5}}, {{0, 2}, {0, 3}}};
    const Snapped kept(box(traces, 0.05));
    CHECK(kept.counts.lost == std::vector<Index>{1, 2, 3});
    CHECK(kept.length == relative(8, 1e-12));
    check_shape(box(traces, 0.05));
    const auto texts = [](const Shape& shape) {
        std::vector<std::string> found;
        try {
            check_shape(shape);
        } catch (const ShapeError& error) {
            for (const ShapeFault& fault : error.faults) found.push_back(fault.part + ": " + fault.text);
        }
        return found;
    };
    const std::vector<std::string> named = texts(box(traces, 0));
    REQUIRE(named.size() == 3);
    CHECK(named[0].starts_with("cracks[1]: has no length of its own inside the body: it lies along cracks[0]: remove"));
    CHECK(named[1].starts_with("cracks[2]: has no length of its own inside the body: it lies along cracks[0]: remove"));
    CHECK(named[2].find("it lies along the border of the body: remove") != std::string::npos);
    // one that lies outside is a mistake with snap, too
    const std::vector<std::string> outside = texts(box({{{1, 5}, {9, 5}}, {{11, 1}, {12, 1}}}, 0.05));
    REQUIRE(outside.size() == 1);
    CHECK(outside[0] == "cracks[1]: has no length of its own inside the body: it lies outside the body");
}

TEST_CASE("snap: a repeated point hides no other mistake and is a piece that snap leaves out") {
    const std::vector<std::vector<Vec2>> traces{
        {{1, 5}, {5, 5}, {5, 5}, {9, 5}}, {{1, 7}}, {{1, 3}, {4.99, 3}}, {{5, 1}, {5, 9}}, {{2, 2}, {2, 2}}};
    const auto parts = [&](double snap) {
        std::vector<std::string> found;
        try {
            checked_graph(box(traces, snap), {.size = 1}, 0);
        } catch (const ShapeError& error) {
            for (const ShapeFault& fault : error.faults) found.push_back(fault.part);
        }
        return found;
    };
    // without: the repeated points, the single one, the end that nearly meets
    CHECK(parts(0) == std::vector<std::string>{"cracks[0]", "cracks[1]", "cracks[4]", "cracks[3]"});
    CHECK(parts(0.05) == std::vector<std::string>{"cracks[1]"});  // no line, with snap either
}

TEST_CASE("snap: the outline stays where it is and takes the ends near it") {
    const Snapped rim(box({{{0.03, 4}, {5, 4}}, {{5, 7}, {9.97, 9.98}}, {{0.02, 6}, {0.03, 8}}}, 0.05));
    CHECK(rim.has({0, 4}));
    CHECK(rim.has({10, 10}));
    CHECK(rim.counts.lost == std::vector<Index>{2});  // it ran along the rim
    for (const GraphSegment& s : rim.graph.segments)
        if (s.ring >= 0) {
            const auto [a, b] = rim.graph.line(s);
            CHECK((a.x() == b.x() || a.y() == b.y()));  // bit for bit
        }
    CHECK(faults_below(0.05, rim.graph).empty());
}

TEST_CASE("snap: the line of a region stays where it is and takes what comes near it") {
    // one ends 0.1 m short of it, one 0.1 m beyond, one crosses both sides of a corner, one is nearly parallel
    const std::vector<std::vector<Vec2>> cracks{
        {{1, 5}, {2.9, 5}}, {{5, 9}, {5, 6.9}}, {{6, 7.95}, {7.95, 6}}, {{3.5, 2.95}, {6.5, 3.1}}};
    for (const bool only_line : {false, true}) {
        CAPTURE(only_line);
        Shape shape = box(cracks, 0.2);
        shape.regions.push_back({.points = {{3, 3}, {7, 3}, {7, 7}, {3, 7}}, .tag = 1, .only_line = only_line});
        const Snapped snapped(shape);
        CHECK(snapped.has({3, 5}));
        CHECK(snapped.has({5, 7}));
        CHECK(snapped.has({7, 7}));
        CHECK(snapped.counts.n_joined == 3);  // the first, and both ends of the last
        CHECK(snapped.counts.n_left_out == 2);
        CHECK(snapped.counts.length_left_out == relative(0.1 + 0.05 * std::numbers::sqrt2, 1e-9));
        CHECK(snapped.counts.lost.empty());
        double border = 0, crack_on_it = 0;  // [m]
        for (const GraphSegment& s : snapped.graph.segments) {
            if (s.region < 0) continue;
            const auto [a, b] = snapped.graph.line(s);
            CHECK((a.x() == b.x() || a.y() == b.y()));  // bit for bit
            border += (b - a).norm();
            if (s.crack == 3) crack_on_it += (b - a).norm();
        }
        CHECK(border == relative(16, 1e-12));
        CHECK(crack_on_it == relative(3, 1e-12));
        CHECK(faults_below(0.2, snapped.graph).empty());
        shape.snap = 0;
        CHECK(faults_below(0.2, planar_graph(shape)).size() >= 4);
    }
}

TEST_CASE("snap: a map of 300 traces is meshable round a hole and in a region and a tunnel as well") {
    const Vec2 extent(40, 30);
    const double snap = 0.3;
    const std::vector<Vec2> round = circle(Vec2(20, 15), 3, 40),  // with sides of 0.47 m
        square{{8, 6}, {32, 6}, {32, 24}, {8, 24}};
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
        CAPTURE(seed);
        Shape shape = box(tests::trace_map(300, extent, 0.1, seed), snap, extent);
        shape.regions = {{.points = square, .tag = 1}, {.points = round, .only_line = true}};
        // a mesh whose twentieth is a sixth of the snap
        const PlanarGraph graph = checked_graph(shape, {.size = 20 * snap / 6}, 0.5 * snap);
        double border = 0;  // [m]
        for (const GraphSegment& s : graph.segments)
            if (s.region >= 0) border += (graph.line(s).b - graph.line(s).a).norm();
        CHECK(border == relative(2 * (24 + 18) + 2 * 40 * 3 * std::sin(std::numbers::pi / 40), 1e-6));
    }
}

TEST_CASE("snap: two lines at a small angle part where they are apart") {
    const Snapped wedge(box({{{1, 5}, {9, 5}}, {{1, 5}, {9, 5.12}}}, 0.02));  // 0.86 degree
    CHECK(faults_below(0.02, wedge.graph).empty());
    CHECK(wedge.counts.lost.empty());
    CHECK(wedge.length > 8 + 4);
}

TEST_CASE("snap: a map of 2000 traces is meshable down to the snap and all its mistakes are named at once") {
    const Vec2 extent(40, 30);
    const auto traces = tests::trace_map(2000, extent, 0.02, 7);
    const double snap = 0.05;
    const Shape drawn = box(traces, 0, extent), snapped = box(traces, snap, extent);
    const Snapped raw(drawn), map(snapped);
    const std::vector<ShapeFault> faults = faults_below(snap, raw.graph);
    CHECK(faults.size() > 1000);
    try {
        checked_graph(drawn, {.size = 20 * snap}, 0);
        CHECK(false);
    } catch (const ShapeError& error) {
        CHECK(error.faults.size() >= faults.size());
    }
    for (const ShapeFault& fault : faults_below(snap, map.graph)) FAIL_CHECK(fault.part, " ", fault.text);
    CHECK(map.counts.n_joined > 500);
    CHECK(map.counts.n_left_out > 100);
    CHECK(map.counts.lost.size() < 120);  // those that were drawn twice, 50, and the shortest
    CHECK(map.length < raw.length);
    CHECK(map.length > 0.94 * raw.length);  // 3 % were drawn twice
    // a finer mesh sees the same lines
    CHECK(checked_graph(snapped, {.size = 10 * snap}, 0).nodes == checked_graph(snapped, {.size = 20 * snap}, 0).nodes);
}

TEST_CASE("snap: both lengths and the cure are in the message") {
    const Shape shape = box({{{1, 5}, {9, 5}}, {{3, 2}, {3, 4.97}}}, 0.01);
    try {
        triangulate(shape, {.size = 1});
        CHECK(false);
    } catch (const ShapeError& error) {
        const std::string text = error.what();
        CAPTURE(text);
        for (const char* words : {"within 30 mm of cracks[1]", "at least 50 mm, a twentieth of the mesh size of 1 m",
                                  "its snap of 10 mm is below that"})
            CHECK(text.find(words) != std::string::npos);
    }
}

TEST_CASE("a star of 2001 points has the crossings that geometry says or too many") {
    constexpr int n = 2001;
    const auto star = [](int k) {  // every point is joined with the k-th next: n (k - 1) crossings inside
        std::vector<Vec2> points;
        for (int i = 0; i <= n; ++i) {
            const double angle = 2 * std::numbers::pi * ((static_cast<long>(i) * k) % n) / n;
            points.push_back(Vec2(5 + 4 * std::cos(angle), 5 + 4 * std::sin(angle)));
        }
        return planar_graph(box({points}, 0));
    };
    const PlanarGraph graph = star(20);
    CHECK(graph.nodes.size() == 4 + n * 20);
    CHECK(graph.segments.size() == 4 + n + 2 * n * 19);
    CHECK_THROWS_WITH(star(1000), doctest::Contains("at more than 100000 places"));
}

}  // namespace snap_test
