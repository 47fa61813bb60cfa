// Cracks that grow as prescribed: arms keep their numbers, lengths never fall, nothing long is lost. Edges of 1 mm;
// ways of four edges are arms.
#include "analysis/crack_history.hpp"

#include "base/random.hpp"
#include "crack_drawing.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

namespace crack_arms_test {

using namespace knap;
using namespace crack_drawing;
using knap::tests::relative;

namespace {

constexpr double us = 1e-6;

/// Edges of a drawing that break, or are damaged, one after the other.
struct Sequence {
    Drawing d;
    std::vector<std::tuple<double, std::size_t, InterfaceStatus>> events;  // [s], edge

    /// A row of n edges, the first at `start`, then one an `interval`.
    void row(int i, int j, int di, int dj, int n, double start, double interval) {
        for (int k = 0; k < n; ++k) one(i + k * di, j + k * dj, di, dj, start + k * interval);
    }
    void one(int i, int j, int di, int dj, double time, InterfaceStatus status = InterfaceStatus::broken) {
        events.emplace_back(time, d.status.size(), status);
        d.row(i, j, di, dj, 1, InterfaceStatus::intact);
    }
    void damaged(int i, int j, int di, int dj, double time, double broken = 1) {
        one(i, j, di, dj, time, InterfaceStatus::damaged);
        events.emplace_back(broken, d.status.size() - 1, InterfaceStatus::broken);
    }
    std::vector<InterfaceStatus> at(double time) const {
        std::vector<InterfaceStatus> status = d.status;
        for (const auto& [t, edge, s] : events)
            if (t <= time * (1 + 1e-9)) status[edge] = std::max(status[edge], s);
        return status;
    }
};

/// What may never happen from one snapshot to the next.
class Watch {
public:
    explicit Watch(const CrackHistory& history) : history_(history) {}

    void look() {
        const CrackPattern& p = history_.pattern();
        const CrackArms& arms = history_.arms();
        CHECK(p.main_length >= main_);
        CHECK(p.crack_length >= all_ * (1 - 1e-12));
        CHECK(p.n_branches >= branches_);
        REQUIRE(arms.arms().size() >= lengths_.size());
        double sum = 0;
        for (std::size_t arm = 0; arm < arms.arms().size(); ++arm) {
            const double length = arms.length(static_cast<Index>(arm));
            const Index start = arms.nodes()[arms.arms()[arm].nodes.front()].vertex;
            if (arm == lengths_.size()) lengths_.push_back(0), starts_.push_back(start);
            CHECK(length >= lengths_[arm]);
            CHECK(start == starts_[arm]);
            lengths_[arm] = length;
            sum += length;
        }
        if (!lengths_.empty() && sum > 4 * mm) CHECK(sum == relative(p.crack_length));
        main_ = p.main_length, all_ = p.crack_length, branches_ = p.n_branches;
    }

private:
    const CrackHistory& history_;
    double main_ = 0, all_ = 0;
    Index branches_ = 0;
    std::vector<double> lengths_;  // per arm
    std::vector<Index> starts_;
};

CrackHistory run(const Sequence& s, double end, const CrackOptions& o = options(), double interval = 0.5 * us) {
    CrackHistory history(s.d.graph, o);
    Watch watch(history);
    for (int k = 0; k * interval <= end * (1 + 1e-9); ++k) {
        history.snapshot(k * interval, s.at(k * interval));
        watch.look();
    }
    return history;
}

CrackOptions with_gaps() {
    CrackOptions o = options();
    o.gap_edges = 2;
    return o;
}

double arm_length(const CrackHistory& history, Index arm) { return history.arms().length(arm); }

}  // namespace

TEST_CASE("a crack that grows an edge a snapshot has an exact length and an exact speed and stands") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 20, 1 * us, 1 * us);
    CrackHistory history(s.d.graph, options());
    for (int k = 0; k <= 40; ++k) {
        history.snapshot(k * us, s.at(k * us));
        const double length = std::min(k, 20) * mm;
        CHECK(std::abs(history.pattern().crack_length - length) < 1e-12);
        CHECK(std::abs(history.pattern().main_length - length) < 1e-12);
        CHECK(history.pattern().tips.size() == (k > 0 ? 1 : 0));
        if (k < 5) CHECK(std::isnan(history.tip_speed()));
        if (k >= 5 && k <= 20) CHECK(history.tip_speed() == relative(1000, 1e-9));
        if (k > 20 && k < 30) CHECK(history.tip_speed() > 0);
        if (k >= 30) CHECK(history.tip_speed() == 0);
    }
    CHECK(history.max_tip_speed() == relative(1000, 1e-9));
    CHECK(history.mean_tip_speed() == relative(1000, 1e-9));
}

TEST_CASE("fork: the arm that is long first goes on: the other is dated back to its first edge") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 8, 1 * us, 1 * us);
    s.row(8, 0, 1, 1, 8, 9 * us, 1 * us);
    s.row(8, 0, 1, -1, 8, 9.5 * us, 1 * us);
    const double edge = std::sqrt(2.0) * mm;
    CrackHistory history = run(s, 20 * us);
    REQUIRE(history.arms().arms().size() == 2);
    CHECK(arm_length(history, 0) == relative(8 * mm + 8 * edge));
    CHECK(arm_length(history, 1) == relative(8 * edge));
    CHECK(history.arms().arms()[1].parent == 0);
    CHECK(history.pattern().tips.size() == 2);
    CHECK(history.pattern().n_branches == 1);
    CHECK(history.first_branching()->time == relative(9.5 * us));
    CHECK((history.first_branching()->position - mm * Vec2(8, 0)).norm() < 1e-12);
    for (const CrackTip& tip : history.pattern().tips) CHECK(tip.speed > 0);
    // both grew from their first edges on
    const std::vector<double> lengths = history.conclude().all;
    for (std::size_t k = 0; k < lengths.size(); ++k) {
        const double t = 0.5 * static_cast<double>(k);  // [us]
        const double trunk = std::min(8.0, std::floor(t)) * mm, upper = std::clamp(std::floor(t - 8), 0.0, 8.0) * edge,
                     lower = std::clamp(std::floor(t - 8.5), 0.0, 8.0) * edge;
        CHECK(std::abs(lengths[k] - trunk - upper - lower) < 1e-12);
    }
    const std::vector<std::vector<double>> rows = history.arm_table().rows;
    REQUIRE(rows.size() == 17 + 9);
    CHECK(rows[17][2] == relative(9.5 * us));
    CHECK(rows[17][6] == 0);
    CHECK(rows[25][6] == relative(8 * edge));
    CHECK(rows[25][5] == relative(1e6 * edge, 0.05));
}

TEST_CASE("a stub that broke first is no arm: the tip goes on with what is longer") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 8, 1 * us, 1 * us);
    s.row(8, 0, 0, 1, 2, 9 * us, 1 * us);
    s.row(8, 0, 1, 0, 10, 11 * us, 1 * us);
    CrackHistory history = run(s, 25 * us);
    CHECK(history.arms().arms().size() == 1);
    CHECK(history.pattern().n_branches == 0);
    CHECK(history.pattern().crack_length == relative(18 * mm));
    CHECK(history.pattern().tips.size() == 1);
}

TEST_CASE("a twig that rests and grows later is an arm from its first edge on") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 20, 1 * us, 1 * us);
    s.row(6, 0, 0, 1, 3, 7 * us, 1 * us);
    s.row(6, 3, 0, 1, 5, 40 * us, 1 * us);
    CrackHistory before = run(s, 39 * us), after = run(s, 50 * us);
    CHECK(before.pattern().n_branches == 0);
    CHECK(before.pattern().crack_length == relative(20 * mm));
    CHECK(after.pattern().n_branches == 1);
    CHECK(after.pattern().crack_length == relative(28 * mm));
    CHECK(after.first_branching()->time == relative(7 * us));
    CHECK(after.conclude().all[22] == relative((11 + 3) * mm));  // at 11 us
    CHECK(after.pattern().main_end->arm == 0);
}

TEST_CASE("one damaged edge does not cut an arm off and its breaking changes nothing") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 5, 1 * us, 1 * us);
    s.damaged(5, 0, 1, 0, 5.5 * us, 30 * us);
    s.row(6, 0, 1, 0, 14, 7 * us, 1 * us);
    SUBCASE("bridged") {
        CrackHistory history = run(s, 25 * us, with_gaps());
        CHECK(history.pattern().crack_length == relative(20 * mm));
        CHECK(history.pattern().broken_length == relative(19 * mm));
        CHECK(history.pattern().tips.size() == 1);
        CHECK(history.pattern().n_cracks == 1);
        CHECK(history.arms().arms().size() == 1);
        CHECK(history.max_tip_speed() == relative(1000, 0.05));
        const CrackHistory closed = run(s, 40 * us, with_gaps());
        CHECK(closed.pattern().crack_length == relative(20 * mm));
        CHECK(closed.pattern().broken_length == relative(20 * mm));
        CHECK(closed.arms().arms().size() == 1);
    }
    SUBCASE("longer than a gap may be") {
        CrackOptions o = with_gaps();
        o.gap_edges = 0;
        CHECK(run(s, 25 * us, o).pattern().n_cracks == 2);
    }
}

TEST_CASE("gaps are bridged to the end of a pre-crack and over two edges: not through intact ones") {
    Drawing d;
    d.notch();
    d.row(0, 0, 1, 0, 1, InterfaceStatus::damaged);
    d.row(1, 0, 1, 0, 3);
    d.row(4, 0, 1, 0, 2, InterfaceStatus::damaged);
    d.row(6, 0, 1, 0, 3);
    d.row(9, 0, 1, 0, 1, InterfaceStatus::intact);
    d.row(10, 0, 1, 0, 3);
    d.row(13, 0, 1, 0, 3, InterfaceStatus::damaged);
    d.row(16, 0, 1, 0, 3);
    CrackHistory history(d.graph, with_gaps());
    const CrackPattern p = history.snapshot(0, d.status);
    CHECK(p.crack_length == relative(9 * mm));
    CHECK(p.n_cracks == 1);
    CHECK(p.tips.size() == 1);
    CHECK(p.main_start == CrackStart::precrack);
}

TEST_CASE("a crack from a hole has a tip and a speed") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 2, 1 * us, 1 * us);
    for (int k = 0; k < 4; ++k) s.d.boundary(20 + k, 10), s.d.boundary(20, 10 + k);  // of a hole inside
    s.row(20, 10, -1, 0, 12, 5 * us, 1 * us);
    CrackHistory history = run(s, 16 * us);
    const CrackPattern& p = history.pattern();
    CHECK(p.n_cracks == 2);
    CHECK(p.main_start == CrackStart::boundary);
    CHECK(p.main_length == relative(12 * mm));
    REQUIRE(p.tips.size() == 2);
    CHECK((p.main_end->position - mm * Vec2(8, 10)).norm() < 1e-12);
    CHECK(p.main_end->speed == relative(1000, 0.01));
    CHECK(*history.first_growth_time() == relative(1 * us));
}

TEST_CASE("cracks that merge: the main one goes on through the one that began ahead of it") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 20, 1 * us, 1 * us);
    s.row(25, 0, -1, 0, 5, 5 * us, 2 * us);  // begins at 25 mm, runs both ways
    s.row(25, 0, 1, 0, 20, 5 * us, 1 * us);
    CrackHistory apart = run(s, 19 * us), merged = run(s, 40 * us);
    CHECK(apart.pattern().n_cracks == 2);
    CHECK(apart.pattern().tips.size() == 3);
    CHECK(apart.pattern().main_length == relative(19 * mm));
    const CrackPattern& p = merged.pattern();
    CHECK(p.n_cracks == 1);
    CHECK(p.n_branches == 0);
    CHECK(p.tips.size() == 1);
    CHECK(p.crack_length == relative(45 * mm));
    CHECK(p.main_length == relative(45 * mm));
    CHECK(p.main_start == CrackStart::precrack);
    CHECK((p.main_end->position - mm * Vec2(45, 0)).norm() < 1e-12);
    CHECK(merged.max_tip_speed() == relative(1000, 0.05));  // no jump of any tip
    const std::vector<double> lengths = merged.conclude().main;
    CHECK(lengths[10] == relative(7 * mm));  // at 5 us: five edges of the one, two of the other
    for (std::size_t k = 1; k < lengths.size(); ++k) CHECK(lengths[k] - lengths[k - 1] < 3.5 * mm);
    CHECK(merged.tip_speed() == 0);
}

TEST_CASE("a crack that runs into another one's side has arrived and where that goes on both ways it is a branching") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 10, 1 * us, 1 * us);
    SUBCASE("of one that came from a boundary") {
        s.d.boundary(10, -8);
        s.row(10, -8, 0, 1, 20, 0, 0.1 * us);
        const CrackPattern p = run(s, 15 * us).pattern();
        CHECK(p.n_cracks == 2);
        CHECK(p.n_branches == 0);
        CHECK(p.tips.size() == 1);
        CHECK(p.main_start == CrackStart::boundary);
    }
    SUBCASE("of one that began inside the body") {
        s.row(10, -6, 0, 1, 12, 0, 0.1 * us);
        const CrackPattern p = run(s, 15 * us).pattern();
        CHECK(p.n_cracks == 1);
        CHECK(p.n_branches == 1);
        CHECK(p.tips.size() == 2);
        CHECK(p.main_length == relative(16 * mm));
    }
}

TEST_CASE("edges that break at once are joined and not run through: they give no tip a speed") {
    Sequence s;
    s.d.notch();
    CrackOptions o = options();
    o.fastest = 3000;
    SUBCASE("a tip runs into a stretch that fails at once and goes on") {
        s.row(0, 0, 1, 0, 20, 1 * us, 1 * us);
        s.row(20, 0, 1, 0, 12, 21 * us, 0);
        s.row(32, 0, 1, 0, 20, 22 * us, 1 * us);
        const CrackHistory history = run(s, 45 * us, o);
        CHECK(history.pattern().main_length == relative(52 * mm));
        CHECK(history.max_tip_speed() == relative(1000, 0.1));
        CHECK(history.mean_tip_speed() <= history.max_tip_speed());
    }
    SUBCASE("a tip that runs by more than five edges from snapshot to snapshot has its speed") {
        s.row(0, 0, 1, 0, 160, 1 * us, 1 * us / 16);  // 16 edges a microsecond, snapshots every half
        o.fastest = 20000;
        const CrackHistory history = run(s, 12 * us, o);
        CHECK(history.mean_tip_speed() == relative(16000, 0.05));
    }
    SUBCASE("a whole row fails at once") {
        s.row(0, 0, 1, 0, 40, 1 * us, 1e-3 * us);
        const CrackHistory history = run(s, 10 * us, o);
        CHECK(history.pattern().main_length == relative(40 * mm));
        CHECK_FALSE(history.max_tip_speed() > 0);
        CHECK_FALSE(history.tip_speed() > 0);
    }
    SUBCASE("a row whose edges fail out of order within less than a wave takes") {
        for (int k = 0; k < 40; ++k) s.one(k, 0, 1, 0, (1 + 7 * k % 11) * us);
        const CrackHistory history = run(s, 20 * us, o);
        CHECK_FALSE(history.max_tip_speed() > 3000);
        CHECK_FALSE(history.mean_tip_speed() > history.max_tip_speed());
    }
}

TEST_CASE(
    "of two arms that lead by turns the longest one in the end is the main one all the time and the main length grows "
    "edge by edge") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 6, 1 * us, 1 * us);
    for (int k = 0; k < 24; ++k) {  // three edges of the one, three of the other
        s.one(6 + k, k, 1, 1, (7 + k + 3 * ((k + 1) / 3 % 2)) * us);
        s.one(6 + k, -k, 1, -1, (7 + k + 3 * ((k + 2) / 3 % 2)) * us);
    }
    CrackHistory history(s.d.graph, options());
    double before = 0;
    for (int k = 0; k <= 80; ++k) {
        const CrackPattern& p = history.snapshot(0.5 * k * us, s.at(0.5 * k * us));
        if (p.main_end && p.main_end->arm >= 0)
            CHECK(p.main_end->path_length >= p.main_length * (1 - 1e-12));  // the tip is that of the longest path
        CHECK(p.main_length - before < 4.5 * std::sqrt(2.0) * mm);          // four edges break at a time
        before = p.main_length;
    }
    CHECK(history.pattern().n_branches == 1);
    // as known in the end, the main tip never turns back, and length and tip are of one crack
    const CrackHistory::Past past = history.conclude();
    const std::vector<std::optional<CrackTip>>& tip = past.tip;
    for (std::size_t k = 1; k < tip.size(); ++k) {
        if (!tip[k - 1]) continue;
        CHECK(tip[k]->arm == history.pattern().main_end->arm);
        CHECK(tip[k]->path_length >= tip[k - 1]->path_length);
        CHECK(past.main[k] >= past.main[k - 1]);
    }
    CHECK(past.main.back() == history.pattern().main_length);
}

TEST_CASE("another crack is the main one once it is longer: length and tip are those of the longest") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 10, 1 * us, 1 * us);
    for (int k = 0; k < 4; ++k) s.d.boundary(20 + k, 10), s.d.boundary(20, 10 + k);
    s.row(20, 10, -1, 0, 20, 11 * us, 1 * us);
    CrackHistory history(s.d.graph, options());
    for (int k = 0; k <= 35; ++k) {
        const CrackPattern& p = history.snapshot(k * us, s.at(k * us));
        CHECK(std::abs(p.main_length - std::max(std::min(k, 10), std::min(k - 10, 20)) * mm) < 1e-12);
        if (k > 0) CHECK((p.main_start == CrackStart::precrack) == (k <= 20));
    }
}

TEST_CASE("half as many edges are an arm when they are long beside the body") {
    for (const double least : {5.9 * mm, 6.1 * mm}) {
        Sequence s;
        s.d.notch();
        s.row(0, 0, 2, 0, 20, 1 * us, 1 * us);
        s.row(20, 0, 0, 2, 3, 12 * us, 1 * us);  // three edges of 2 mm
        CrackOptions o = options();
        o.short_arm_edges = 2, o.short_arm_length = least;
        CHECK(run(s, 30 * us, o).pattern().n_branches == (least < 6 * mm ? 1 : 0));
    }
}

TEST_CASE("many edges are no arm where they are too short to be seen beside the body") {
    for (const double least : {4.9 * mm, 5.1 * mm}) {
        Sequence s;
        s.d.notch();
        s.row(0, 0, 1, 0, 20, 1 * us, 1 * us);
        s.row(12, 0, 0, 1, 5, 12 * us, 1 * us);
        CrackOptions o = options();
        o.min_length = least;
        CHECK(run(s, 30 * us, o).pattern().n_branches == (least < 5 * mm ? 1 : 0));
    }
}

TEST_CASE("twigs that together are as long as an arm are one: and so are loops beside cracks") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 20, 1 * us, 1 * us);
    s.row(10, 0, 0, 1, 1, 12 * us,
          1 * us);  // a stem and two legs, three edges from the crack each, four from end to end
    s.row(10, 1, 1, 0, 2, 13 * us, 1 * us);
    SUBCASE("one leg is a twig") { CHECK(run(s, 30 * us).arms().arms().size() == 1); }
    SUBCASE("two legs") {
        s.row(10, 1, -1, 0, 2, 15 * us, 1 * us);
        const CrackHistory history = run(s, 30 * us);
        CHECK(history.arms().arms().size() == 2);
        CHECK(history.pattern().crack_length == relative(23 * mm));
    }
    SUBCASE("a bow from the crack to the crack") {
        s.row(12, 1, 0, -1, 1, 15 * us, 1 * us);
        CHECK(run(s, 30 * us).arms().arms().size() == 2);
    }
    SUBCASE("a ring that hangs on nothing") {
        s.row(10, 10, 1, 0, 1, 5 * us, 0), s.row(11, 10, 0, 1, 1, 5 * us, 0), s.row(11, 11, -1, 0, 1, 5 * us, 0),
            s.row(10, 11, 0, -1, 1, 5 * us, 0);
        CHECK(run(s, 30 * us).pattern().n_cracks == 2);
    }
}

TEST_CASE("arms and gaps are counted in their own edges where a mesh is graded") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 10, 1 * us, 1 * us);
    s.row(5, 0, 0, 1, 4, 20 * us, 1 * us);       // four edges of 1 mm
    s.damaged(10, 0, 20, 0, 11 * us, 200 * us);  // a gap of two edges of 20 mm
    s.damaged(30, 0, 20, 0, 11 * us, 200 * us);
    s.row(50, 0, 20, 0, 3, 12 * us, 10 * us);
    const CrackHistory history = run(s, 100 * us, with_gaps());
    CHECK(history.pattern().crack_length == relative((10 + 40 + 60 + 4) * mm));
    CHECK(history.pattern().n_branches == 1);
    CHECK(history.pattern().n_cracks == 1);
}

TEST_CASE("a speed is known from a quarter of its window on: the largest one from half of it") {
    Sequence s;
    s.d.notch();
    s.row(0, 0, 1, 0, 40, 1 * us, 1 * us);
    CrackOptions o = options();
    o.speed_edges = 32;
    CrackHistory history(s.d.graph, o);
    for (int k = 0; k <= 40; ++k) {
        history.snapshot(k * us, s.at(k * us));
        CHECK(std::isnan(history.tip_speed()) == (k < 8));
    }
    CHECK(history.max_tip_speed() == relative(1000, 1e-9));
    CHECK(history.mean_tip_speed() <= history.max_tip_speed());
}

namespace {

/// A grid of triangles where edges are damaged and break at random, most of them ahead of others.
class RandomCracks {
public:
    static constexpr int n = 24;

    explicit RandomCracks(int seed) : random_(seed, "cracks") {
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j <= n; ++j) {
                const bool cut = j == n / 2 && i < 6;  // a pre-crack from the left
                if (i < n) d.edge(i, j, i + 1, j, cut ? InterfaceStatus::precrack : InterfaceStatus::intact);
                if (j < n) d.edge(i, j, i, j + 1, InterfaceStatus::intact);
                if (i < n && j < n) d.edge(i, j, i + 1, j + 1, InterfaceStatus::intact);
            }
        for (int i = 0; i <= n; ++i) d.boundary(i, 0), d.boundary(i, n), d.boundary(0, i), d.boundary(n, i);
        touched_.assign(d.graph.vertices.size(), 0);
        touched_[d.vertex(6, n / 2)] = 1;
    }

    void step(int n_edges) {
        for (int k = 0; k < n_edges; ++k) {
            const auto e = static_cast<std::size_t>(random_.uniform() * static_cast<double>(d.status.size()));
            const auto [a, b] = d.graph.ends[e];
            const int n_touched = touched_[a] + touched_[b];
            const double odds = n_touched == 1 ? 0.5 : n_touched == 2 ? 0.03 : 0.002;
            if (d.status[e] == InterfaceStatus::precrack || random_.uniform() > odds) continue;
            if (d.status[e] == InterfaceStatus::intact && random_.uniform() < 0.3) {
                d.status[e] = InterfaceStatus::damaged;
            } else {
                d.status[e] = InterfaceStatus::broken;
                touched_[a] = touched_[b] = 1;
            }
        }
    }

    Drawing d;

private:
    Random random_;
    std::vector<int> touched_;  // per vertex
};

/// Edges that are on no arm nowhere make up as many as an arm has, and the way to each tip is what its length says.
void check_nothing_lost(const CrackHistory& history, const CrackOptions& o) {
    const CrackArms& arms = history.arms();
    const CrackedEdges& edges = arms.edges();
    std::set<Index> placed, on_arms, arm_vertices;
    for (const CrackNode& node : arms.nodes()) {
        if (node.arm >= 0) arm_vertices.insert(node.vertex);
        if (node.parent < 0) continue;
        CHECK(placed.insert(node.edge).second);
        if (node.arm >= 0) on_arms.insert(node.edge);
    }
    for (Index start = 0; start < static_cast<Index>(edges.graph().vertices.size()); ++start) {
        std::map<Index, Index> n_edges{{start, 0}};
        std::vector<Index> order{start};
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Index v = order[i];
            if (i > 0 && (edges.terminal(v) || arm_vertices.contains(v))) continue;
            for (const Index e : edges.edges_at(v))
                if (edges.cracked(e) && !on_arms.contains(e) &&
                    n_edges.try_emplace(edges.far_end(e, v), n_edges[v] + 1).second)
                    order.push_back(edges.far_end(e, v));
        }
        CHECK(n_edges[order.back()] < o.arm_edges);
    }
    for (const CrackArm& arm : arms.arms()) {
        const std::vector<Index> way = arms.way(arm.tip());
        double length = 0;
        for (std::size_t i = 1; i < way.size(); ++i)
            length += (edges.graph().vertices[arms.nodes()[way[i]].vertex] -
                       edges.graph().vertices[arms.nodes()[way[i - 1]].vertex])
                          .norm();
        CHECK(length == relative(arm.path_length));
    }
}

}  // namespace

TEST_CASE(
    "random cracks that fork and merge and arrive: no length falls and no arm changes its number and nothing long is "
    "lost") {
    std::size_t n_arms = 0;
    Index n_branches = 0;
    for (int seed = 0; seed < 30; ++seed) {
        CAPTURE(seed);
        RandomCracks cracks(seed);
        CrackOptions o = seed % 2 == 0 ? options() : with_gaps();
        o.fastest = 20e-3 / us;
        CrackHistory history(cracks.d.graph, o);
        Watch watch(history);
        for (int k = 0; k < 80; ++k) {
            cracks.step(seed % 3 == 0 ? 20 : 100);
            history.snapshot(k * us, cracks.d.status);
            watch.look();
        }
        check_nothing_lost(history, o);
        CHECK_FALSE(history.mean_tip_speed() > history.max_tip_speed());
        CHECK_FALSE(history.max_tip_speed() > o.fastest);
        n_arms += history.arms().arms().size(), n_branches += history.pattern().n_branches;
    }
    CHECK(n_arms > 300);
    CHECK(n_branches > 100);
}

TEST_CASE("a gap through a wide damaged zone is found among its vertices: its ways are 184 756 and more") {
    constexpr int n = 10;
    Drawing d;
    for (int i = 0; i <= n; ++i)
        d.row(i, 0, 0, 1, n, InterfaceStatus::damaged), d.row(0, i, 1, 0, n, InterfaceStatus::damaged);
    d.row(-1, 0, 1, 0, 1);
    d.row(n, n, 1, 0, 1);
    const auto joined = [&](Index gap) {
        CrackedEdges edges(d.graph, gap);
        std::vector<EdgeStatus> statuses;
        for (std::size_t e = 0; e < d.status.size(); ++e) statuses.push_back({static_cast<Index>(e), d.status[e]});
        return edges.add(0, statuses).size();
    };
    CHECK(joined(2 * n) == 2 + 2 * n);
    CHECK(joined(2 * n - 1) == 2);
}

}  // namespace crack_arms_test
