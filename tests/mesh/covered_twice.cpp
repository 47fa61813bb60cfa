// The area that a deformed body covers twice.
#include "mesh/overlap.hpp"

#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace covered_twice_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Squares of n by n cells of two triangles each, whose vertices are their own.
struct Squares {
    std::vector<Vec2> corner;
    std::vector<Index> vertex;
    Index n_vertices = 0;

    void add(const Vec2& low, double width, int n) {
        const auto put = [&](int i, int j) {
            corner.push_back(low + width / n * Vec2(i, j));
            vertex.push_back(n_vertices + j * (n + 1) + i);
        };
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                put(i, j), put(i + 1, j), put(i + 1, j + 1);
                put(i, j), put(i + 1, j + 1), put(i, j + 1);
            }
        n_vertices += (n + 1) * (n + 1);
    }

    CoveredTwice found() const { return find_covered_twice(corner, vertex); }
};

}  // namespace

TEST_CASE("covered twice: two squares that overlap in a known rectangle") {
    for (const int n : {1, 2, 7, 40}) {
        CAPTURE(n);
        Squares squares;
        squares.add({0, 0}, 1, 5);
        squares.add({0.7, 0.4}, 1, n);
        const CoveredTwice found = squares.found();
        CHECK(found.area == relative(0.3 * 0.6, 1e-13));
        CHECK(found.largest <= found.area);
        CHECK(found.triangles == relative(found.area / std::min(1. / 50, 0.5 / (n * n)), 1e-13));
        CHECK(found.place.x() > 0.7);
        CHECK(found.place.x() < 1);
        CHECK(found.place.y() > 0.4);
        CHECK(found.place.y() < 1);
    }
}

TEST_CASE("covered twice: an inverted square counts with the area it covers") {
    Squares squares;
    squares.add({0, 0}, 1, 1);
    squares.add({1.5, 0.25}, -1, 2);  // from 0.5 to 1.5, from -0.75 to 0.25; its triangles stay counterclockwise
    CHECK(squares.found().area == relative(0.5 * 0.25, 1e-13));
    for (std::size_t i = 6; i < squares.corner.size(); i += 3) std::swap(squares.corner[i + 1], squares.corner[i + 2]);
    CHECK(squares.found().area == relative(0.5 * 0.25, 1e-13));
}

TEST_CASE("covered twice: separate and distant pieces cover nothing twice and triangles without numbers are left out") {
    Squares squares;
    squares.add({0, 0}, 1, 3);
    squares.add({1.001, 0}, 1, 3);
    squares.add({1e9, -1e9}, 1, 3);
    CHECK(squares.found().area == 0);
    squares.add({0.5, 0.5}, 1, 1);
    squares.corner.back() =
        Vec2::Constant(std::numeric_limits<double>::quiet_NaN());  // the left upper one of its triangles
    // what is left, the lower right half, has half a quarter in common with the first piece, and with the next one what
    // is between x = 1.001 and 1.5
    CHECK(squares.found().area == relative(0.125 + 0.499 * 0.5, 1e-13));
}

TEST_CASE("covered twice: triangles with a common vertex may overlap a little") {
    Squares squares;
    squares.add({0, 0}, 1, 1);
    const auto lifted = [&](double by) {
        Squares changed = squares;
        for (std::size_t i = 0; i < 3; ++i)
            changed.corner[i] += by * Vec2(-1, 1).normalized();  // into the triangle on the other side of the diagonal
        return changed.found().area;
    };
    CHECK(lifted(0) == 0);
    CHECK(lifted(0.05) == 0);  // the height is 1/sqrt 2
    CHECK(lifted(0.2) > 0.1);
}

}  // namespace covered_twice_test
