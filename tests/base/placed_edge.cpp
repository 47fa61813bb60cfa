// The frame of an edge, and the cone of normals that a vertex accepts.
#include "base/placed_edge.hpp"
#include "base/rotation.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace placed_edge_test {

using namespace knap;
using knap::tests::relative;

TEST_CASE("gap and share of a place at an edge are those of the drawing however both are turned and moved") {
    const Vec2 start(0.3, -0.2), end(2.3, -0.2), x(0.8, -0.5);  // the material lies above, x in front
    for (int k = 0; k < 24; ++k) {
        const Rotation turn = Rotation::by(k * 15 * degree);
        const auto moved = [&](const Vec2& p) { return Vec2(turn.turned(p) + Vec2(0.1 * k, -0.7 * k)); };
        const PlacedEdge edge = placed_edge(moved(start), moved(end));
        CHECK(edge.length == relative(2, 1e-14));
        CHECK(edge.gap(moved(x)) == relative(0.3, 1e-13));
        CHECK(edge.share(moved(x)) == relative(0.25, 1e-13));
        CHECK(edge.share(edge.end) == relative(1, 1e-14));
        CHECK((edge.start + edge.place(moved(x)) * edge.along + edge.gap(moved(x)) * edge.outward - moved(x)).norm() <
              1e-14);
    }
}

TEST_CASE("a vertex accepts the normals between those of its edges and fifteen degrees beyond them") {
    const VertexCone corner(Vec2(1, 0), Vec2(0, 1));  // of a square, below on the right: normals at -90 and 0 degrees
    const VertexCone tip(Vec2(1, 0), Vec2(std::cos(170 * degree), std::sin(170 * degree)));  // normals at -90 and 80
    for (int angle = -180; angle < 180; ++angle) {
        const Vec2 n(-std::cos(angle * degree), -std::sin(angle * degree));  // points to the body
        CAPTURE(angle);
        CHECK(corner.accepts(n) == (angle >= -105 && angle <= 15));
        CHECK(tip.accepts(n) == (angle >= -105 && angle <= 95));
    }
}

}  // namespace placed_edge_test
