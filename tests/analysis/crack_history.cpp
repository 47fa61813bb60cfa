// Tip speed, first growth and first branching of cracks that move as prescribed.
#include "analysis/crack_history.hpp"

#include "base/random.hpp"
#include "crack_drawing.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace crack_history_test {

using namespace knap;
using namespace crack_drawing;
using knap::tests::relative;

using Samples = std::vector<std::pair<double, double>>;

TEST_CASE("tip speed of smooth growth is exact") {
    Samples front;
    for (int k = 0; k < 10; ++k) front.emplace_back(k * 1e-6, 1000.0 * k * 1e-6);
    CHECK(speed_over_window(front, 5 * mm, 2 * mm) == relative(1000, 1e-9));
    CHECK(speed_over_window(front, 17.9 * mm, 8.9 * mm) == relative(1000, 1e-9));  // shorter than a window will do
    CHECK(std::isnan(speed_over_window(front, 18.1 * mm, 9.1 * mm)));
}

TEST_CASE("tip speed of growth by whole edges is right within 1 percent on average") {
    // edges of 0.4 to 0.6 mm as in a random mesh, 0.2 us between snapshots, window of 10 mm
    Random random(3, "edges");
    const double speed = 1380;
    Samples front;
    double length = 0, next_edge = 0, worst = 0, sum = 0;
    int n = 0;
    for (int k = 0; k < 250; ++k) {
        const double t = k * 0.2e-6;
        for (; length + next_edge <= speed * t; next_edge = random.uniform(0.4 * mm, 0.6 * mm)) length += next_edge;
        front.emplace_back(t, length);
        const double found = speed_over_window(front, 10 * mm, 5 * mm);
        if (found > 0 && length > 10 * mm) worst = std::max(worst, std::abs(found / speed - 1)), sum += found, ++n;
    }
    REQUIRE(n > 100);
    CHECK(sum / n == relative(speed, 0.005));
    CHECK(worst < 0.015);
}

TEST_CASE("the speed of a crack that stopped goes to zero") {
    Samples front;
    for (int k = 0; k < 200; ++k) front.emplace_back(k * 1e-6, std::min(1000.0 * k * 1e-6, 20 * mm));
    CHECK(speed_over_window(front, 5 * mm, 2 * mm) == 0);
    const auto until = [&](std::size_t n) {
        return speed_over_window(Samples(front.begin(), front.begin() + n), 5 * mm, 2 * mm);
    };
    CHECK(until(21) == relative(1000, 1e-9));
    for (std::size_t n = 21; n < 25; ++n) CHECK(until(n + 1) < until(n));
    CHECK(until(26) == 0);  // it has stood for as long as the last 5 mm took
}

namespace {
/// Breaks the interfaces from `first` on, one an `interval`, up to time t.
void break_until(std::vector<InterfaceStatus>& status, std::size_t first, std::size_t n, double start, double interval,
                 double t) {
    for (std::size_t k = 0; k < n; ++k) {
        if (start + static_cast<double>(k + 1) * interval <= t) status[first + k] = InterfaceStatus::broken;
    }
}
}  // namespace

TEST_CASE("history of a straight crack of known speed") {
    Drawing d;
    d.notch();
    const std::size_t first = d.status.size();
    d.row(0, 0, 1, 0, 60, InterfaceStatus::intact);
    CrackHistory history(d.graph, options());
    const double speed = 1000, start = 10e-6;
    for (int k = 0; k <= 340; ++k) {
        const double t = k * 0.2e-6;
        break_until(d.status, first, 60, start, 1 * mm / speed, t + 1e-12);
        history.snapshot(t, d.status);
    }
    CHECK(history.pattern().crack_length == relative(58 * mm));
    CHECK(history.tip_speed() == relative(speed, 0.01));
    CHECK(history.max_tip_speed() == relative(speed, 0.03));  // of the first half window, five edges
    CHECK(*history.first_growth_time() == relative(11e-6));
    CHECK_FALSE(history.first_branching());
}

TEST_CASE("the angle of a straight crack and its times when the clock is set back") {
    for (const int down : {1, -1}) {
        Drawing d;
        d.notch();
        const std::size_t first = d.status.size();
        d.row(0, 0, 1, 2 * down, 20, InterfaceStatus::intact);
        CrackHistory history(d.graph, options());
        CHECK(std::isnan(history.main_angle()));
        for (int k = 0; k <= 20; ++k) {
            break_until(d.status, first, 20, 0, 1e-6, k * 1e-6 + 1e-12);
            history.snapshot(k * 1e-6, d.status);
        }
        const double speed = history.tip_speed();
        CHECK(history.main_angle() == relative(std::atan(2.) * 180 / std::acos(-1.), 1e-9));
        CHECK(*history.first_growth_time() == relative(1e-6));
        history.set_back(20e-6);
        CHECK(*history.first_growth_time() == relative(-19e-6));
        history.snapshot(1e-6, d.status);  // it has stood for a step of the new clock
        CHECK(history.tip_speed() < speed);
        CHECK(history.tip_speed() > 0);
    }
}

TEST_CASE("a gap that closes late behind the tip is no jump of the tip") {
    // interfaces 8 to 11 ahead hold until the crack is 20 further on; all others break at 1000 m/s
    Drawing d;
    d.notch();
    const std::size_t first = d.status.size();
    d.row(0, 0, 1, 0, 60, InterfaceStatus::intact);
    CrackHistory history(d.graph, options());
    for (int k = 0; k <= 300; ++k) {
        const double t = k * 0.2e-6;
        for (std::size_t i = 0; i < 60; ++i) {
            const double breaks = static_cast<double>(i + 1) * 1e-6 + (i >= 8 && i < 12 ? 20e-6 : 0);
            if (t + 1e-12 >= breaks) d.status[first + i] = InterfaceStatus::broken;
        }
        history.snapshot(t, d.status);
    }
    CHECK(history.max_tip_speed() == relative(1000, 0.1));
    CHECK(history.tip_speed() == relative(1000, 0.01));
}

TEST_CASE("first branching is dated back to the first edge of the arm that made it") {
    Drawing d;
    d.notch();
    const std::size_t main = d.status.size();
    d.row(0, 0, 1, 0, 20, InterfaceStatus::intact);
    const std::size_t arm = d.status.size();
    d.row(8, 0, 0, 1, 10, InterfaceStatus::intact);
    const std::size_t stub = d.status.size();
    d.row(4, 0, 0, 1, 3, InterfaceStatus::intact);  // breaks earlier, and stops
    CrackHistory history(d.graph, options());
    double seen = 0;
    for (int k = 0; k <= 60; ++k) {
        const double t = k * 0.5e-6;
        break_until(d.status, main, 20, 0, 1e-6, t + 1e-12);
        break_until(d.status, stub, 3, 4e-6, 1e-6, t + 1e-12);
        break_until(d.status, arm, 10, 9e-6, 1.5e-6, t + 1e-12);
        history.snapshot(t, d.status);
        if (history.first_branching() && seen == 0) seen = t;
    }
    REQUIRE(history.first_branching());
    CHECK(seen == relative(15e-6));  // four edges of the arm: the pruning length
    CHECK(history.first_branching()->time == relative(10.5e-6));
    CHECK((history.first_branching()->position - mm * Vec2(8, 0)).norm() < 1e-12);
}

TEST_CASE("two cracks that meet did not run the length of the other") {
    Drawing d;
    d.notch();
    const std::size_t first = d.status.size();
    d.row(0, 0, 1, 0, 30, InterfaceStatus::intact);
    d.row(30, 0, 1, 0, 12);  // another crack that waits
    d.boundary(42, 0);
    CrackHistory history(d.graph, options());
    for (int k = 0; k <= 200; ++k) {
        break_until(d.status, first, 30, 0, 1e-6, k * 0.2e-6 + 1e-12);
        history.snapshot(k * 0.2e-6, d.status);
    }
    CHECK(history.pattern().n_cracks == 2);
    CHECK(history.pattern().tips.empty());
    CHECK(history.pattern().main_length == relative(30 * mm));
    CHECK(history.pattern().crack_length == relative(42 * mm));
    CHECK(history.max_tip_speed() == relative(1000, 0.03));  // of the first half window, five edges
}

}  // namespace crack_history_test
