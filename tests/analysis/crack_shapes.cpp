// Cracks drawn by hand: the graph is known, so every number is.
#include "analysis/crack_history.hpp"

#include "crack_drawing.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

namespace crack_shapes_test {

using namespace knap;
using namespace crack_drawing;
using knap::tests::relative;

namespace {
CrackPattern cracks(const Drawing& d, const CrackOptions& o = options()) {
    CrackHistory history(d.graph, o);
    return history.snapshot(0, d.status);
}
}  // namespace

TEST_CASE("nothing broken: no crack") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 6, InterfaceStatus::damaged);
    d.row(0, 3, 1, 0, 6, InterfaceStatus::intact);
    const CrackPattern p = cracks(d);
    CHECK(p.crack_length == 0);
    CHECK(p.broken_length == 0);
    CHECK(p.damaged_length == relative(6 * mm));
    CHECK(p.n_damaged == 6);
    CHECK(p.n_cracks == 0);
    CHECK_FALSE(p.main_end);
    CHECK(p.main_start == CrackStart::none);
}

TEST_CASE("straight crack ahead of a pre-crack") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 12);
    d.row(12, 0, 1, 0, 3, InterfaceStatus::damaged);
    const CrackPattern p = cracks(d);
    CHECK(p.n_broken == 12);
    CHECK(p.broken_length == relative(12 * mm));
    CHECK(p.crack_length == relative(12 * mm));
    CHECK(p.main_length == relative(12 * mm));
    CHECK(p.n_cracks == 1);
    CHECK(p.n_branches == 0);
    REQUIRE(p.tips.size() == 1);
    CHECK((p.tips[0].position - Vec2(12 * mm, 0)).norm() < 1e-12);
    CHECK(p.main_end->path_length == relative(12 * mm));
    CHECK(p.main_start == CrackStart::precrack);
}

TEST_CASE("a crack counts from its first edge at the end of a pre-crack") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 1);
    d.row(-2, 0, 0, 1, 2);  // a longer stub at the side of the notch
    const CrackPattern p = cracks(d);
    CHECK(p.crack_length == relative(1 * mm));
    CHECK(p.broken_length == relative(3 * mm));
    REQUIRE(p.tips.size() == 1);
    CHECK(p.tips[0].position.x() == relative(1 * mm));
}

TEST_CASE("kinked crack: length along edges and along chords") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 6);
    d.row(6, 0, 3, 4, 2);  // two edges of 5 mm
    CHECK(cracks(d).main_length == relative(16 * mm));
    CHECK(cracks(d).crack_length == relative(16 * mm));
    CHECK((cracks(d).main_end->position - mm * Vec2(12, 8)).norm() < 1e-12);
    // chords of seven edges: (0,0) to (9,4) and on to (12,8)
    CrackOptions o = options();
    o.chord_edges = 7;
    CHECK(cracks(d, o).main_length == relative((std::hypot(9, 4) + 5) * mm));
    CHECK(cracks(d, o).crack_length == relative(16 * mm));
}

TEST_CASE("chords take the zigzag out of a path") {
    Drawing d;
    d.notch();
    for (int k = 0; k < 40; k += 2) {
        d.edge(k, 0, k + 1, 1, InterfaceStatus::broken);
        d.edge(k + 1, 1, k + 2, 0, InterfaceStatus::broken);
    }
    CrackOptions o = options();
    CHECK(cracks(d, o).main_length == relative(40 * std::sqrt(2.0) * mm));
    o.chord_edges = 4;  // from (0,0) to (4,0)
    CHECK(cracks(d, o).main_length == relative(40 * mm));
}

TEST_CASE("one branching") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(8, 0, 1, 1, 5);
    d.row(8, 0, 1, -1, 6);
    const CrackPattern p = cracks(d);
    CHECK(p.n_branches == 1);
    CrackHistory history(d.graph, options());
    history.snapshot(0, d.status);
    CHECK((history.first_branching()->position - mm * Vec2(8, 0)).norm() < 1e-12);
    CHECK(p.tips.size() == 2);
    CHECK(p.crack_length == relative((8 + 11 * std::sqrt(2.0)) * mm));
    CHECK(p.main_length == relative((8 + 6 * std::sqrt(2.0)) * mm));
    CHECK((p.main_end->position - mm * Vec2(14, -6)).norm() < 1e-12);
}

TEST_CASE("two branchings one behind the other") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(8, 0, 1, 1, 6);
    d.row(8, 0, 1, -1, 12);
    d.row(14, 6, 1, 0, 5);
    d.row(14, 6, 0, 1, 4);
    const CrackPattern p = cracks(d);
    CHECK(p.n_branches == 2);
    CHECK(p.tips.size() == 3);
}

TEST_CASE("a fork into three counts two branches") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(8, 0, 1, 1, 5);
    d.row(8, 0, 1, -1, 5);
    d.row(8, 0, 1, 0, 5);
    const CrackPattern p = cracks(d);
    CHECK(p.n_branches == 2);
    CHECK(p.tips.size() == 3);
}

TEST_CASE("twig below the pruning length is no branch and no length") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(3, 0, 0, 1, 3);
    CHECK(cracks(d).n_branches == 0);
    CHECK(cracks(d).tips.size() == 1);
    CHECK(cracks(d).crack_length == relative(8 * mm));
    CHECK(cracks(d).broken_length == relative(11 * mm));
    d.row(3, 3, 0, 1, 1);  // now it is 4 mm long
    CHECK(cracks(d).n_branches == 1);
    CHECK(cracks(d).tips.size() == 2);
    CHECK(cracks(d).crack_length == relative(12 * mm));
}

TEST_CASE("a crack that kinks right behind its tip is not a branch of both") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(8, 0, 1, 1, 2);
    d.row(8, 0, 1, -1, 2);
    const CrackPattern p = cracks(d);
    CHECK(p.n_branches == 0);
    CHECK(p.tips.size() == 1);
    CHECK(p.crack_length == relative((8 + 2 * std::sqrt(2.0)) * mm));
}

TEST_CASE("small loop on the path leaves one crack and one tip") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 10);
    d.edge(4, 0, 4, 1, InterfaceStatus::broken);  // a square beside the path
    d.edge(4, 1, 5, 1, InterfaceStatus::broken);
    d.edge(5, 1, 5, 0, InterfaceStatus::broken);
    const CrackPattern p = cracks(d);
    CHECK(p.crack_length == relative(10 * mm));
    CHECK(p.tips.size() == 1);
    CHECK(p.n_branches == 0);
}

TEST_CASE("loop at the tip keeps its tip") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 5);
    d.edge(5, 0, 6, 0, InterfaceStatus::broken);
    d.edge(6, 0, 6, 1, InterfaceStatus::broken);
    d.edge(6, 1, 5, 0, InterfaceStatus::broken);
    const CrackPattern p = cracks(d);
    CHECK(p.tips.size() == 1);
    CHECK(p.crack_length == relative((5 + std::sqrt(2.0)) * mm));  // the longest of the shortest ways
}

TEST_CASE("large loop: a branching whose arms met has no tips") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 4);
    d.row(4, 0, 1, 1, 5);
    d.row(4, 0, 1, -1, 5);
    d.row(9, 5, 1, -1, 5);
    d.row(9, -5, 1, 1, 4);
    CHECK(cracks(d).tips.size() == 2);
    d.row(13, -1, 1, 1, 1);  // closes it
    const CrackPattern p = cracks(d);
    CHECK(p.n_branches == 1);
    CHECK(p.tips.empty());
    CHECK(p.crack_length == relative((4 + 20 * std::sqrt(2.0)) * mm));
    CHECK(p.crack_length == relative(p.broken_length));
}

TEST_CASE("two separate cracks") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 7);
    d.boundary(0, 20);
    d.row(0, 20, 1, 0, 9);
    const CrackPattern p = cracks(d);
    CHECK(p.n_cracks == 2);
    CHECK(p.n_branches == 0);
    CHECK(p.tips.size() == 2);
    CHECK(p.crack_length == relative(16 * mm));
    CHECK(p.main_length == relative(9 * mm));
    CHECK(p.main_start == CrackStart::boundary);
}

TEST_CASE("isolated broken edges ahead of the tip do not count") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 7);
    d.row(9, 0, 1, 0, 2);
    d.row(10, 3, 1, 1, 1);
    const CrackPattern p = cracks(d);
    CHECK(p.n_cracks == 1);
    CHECK(p.tips.size() == 1);
    CHECK(p.crack_length == relative(7 * mm));
    CHECK(p.broken_length == relative((9 + std::sqrt(2.0)) * mm));
}

TEST_CASE("both ends of a pre-crack inside the body") {
    Drawing d;
    d.row(-3, 0, 1, 0, 6, InterfaceStatus::precrack);
    d.row(3, 0, 1, 0, 2);
    d.row(-3, 0, -1, 0, 3);
    const CrackPattern p = cracks(d);
    CHECK(p.n_cracks == 2);
    CHECK(p.n_branches == 0);
    CHECK(p.tips.size() == 2);
    CHECK(p.crack_length == relative(5 * mm));
    CHECK(p.main_length == relative(3 * mm));
}

TEST_CASE("a crack ends at a second pre-crack and what leaves the other end of that is another crack") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 5);
    d.row(5, 0, 1, 0, 10, InterfaceStatus::precrack);
    SUBCASE("arrived") {
        const CrackPattern p = cracks(d);
        CHECK(p.tips.empty());
        CHECK(p.main_end->arrived);
        CHECK(p.main_length == relative(5 * mm));
    }
    SUBCASE("and on at its other end") {
        d.row(15, 0, 1, 0, 3);
        const CrackPattern p = cracks(d);
        CHECK(p.n_cracks == 2);
        CHECK(p.n_branches == 0);
        REQUIRE(p.tips.size() == 1);
        CHECK(p.tips[0].position.x() == relative(18 * mm));
        CHECK(p.crack_length == relative(8 * mm));
        CHECK(p.main_length == relative(5 * mm));
    }
    SUBCASE("and branching at its other end") {
        d.row(15, 0, 1, 1, 4);
        d.row(15, 0, 1, -1, 4);
        CHECK(cracks(d).n_branches == 1);
        CHECK(cracks(d).tips.size() == 2);
    }
}

TEST_CASE("crack that began inside the body: two tips that both move away from the middle") {
    Drawing d;
    d.row(-5, 0, 1, 0, 10);
    d.row(2, 0, 0, 1, 2);
    const CrackPattern p = cracks(d);
    CHECK(p.n_cracks == 1);
    CHECK(p.n_branches == 0);
    CHECK(p.tips.size() == 2);
    CHECK(p.crack_length == relative(10 * mm));
    CHECK(p.main_length == relative(5 * mm));
    CHECK(p.main_start == CrackStart::inside);
}

TEST_CASE("fully cut body: the crack has arrived and keeps its length") {
    Drawing d;
    d.boundary(0, 0);
    d.boundary(0, 3);
    d.row(0, 0, 0, 1, 3);  // shorter than the pruning length: the longest arm of the body counts all the same
    const CrackPattern p = cracks(d);
    CHECK(p.n_cracks == 1);
    CHECK(p.tips.empty());
    CHECK(p.crack_length == relative(3 * mm));
    CHECK(p.main_end->arrived);
    CHECK(p.main_start == CrackStart::boundary);
}

TEST_CASE("branched crack that cut the body into three") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(8, 0, 1, 1, 6);
    d.row(8, 0, 1, -1, 6);
    d.boundary(14, 6);
    d.boundary(14, -6);
    const CrackPattern p = cracks(d);
    CHECK(p.tips.empty());
    CHECK(p.n_branches == 1);
    CHECK(p.crack_length == relative((8 + 12 * std::sqrt(2.0)) * mm));
}

TEST_CASE("equal stubs in a body without a crack are no branching") {
    Drawing d;
    d.boundary(0, 0);
    d.row(0, 0, 1, 1, 2);
    d.row(0, 0, 1, -1, 2);
    CHECK(cracks(d).n_branches == 0);
}

TEST_CASE("the numbering of interfaces does not matter") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 8);
    d.row(8, 0, 1, 1, 5);
    d.row(8, 0, 1, -1, 6);
    d.row(3, 0, 0, 1, 2);
    Drawing r = d;
    std::reverse(r.graph.ends.begin(), r.graph.ends.end());
    std::reverse(r.graph.length.begin(), r.graph.length.end());
    std::reverse(r.status.begin(), r.status.end());
    CHECK(cracks(r).crack_length == relative(cracks(d).crack_length));
    CHECK(cracks(r).main_length == relative(cracks(d).main_length));
    CHECK(cracks(r).main_end->vertex == cracks(d).main_end->vertex);
    CHECK(cracks(r).n_branches == cracks(d).n_branches);
}

}  // namespace crack_shapes_test
