// Sweeps of the fans: the impulses that they hand on are those of the body, and they end in the laws of the points.
#include "stepper/implicit/fan_sweep.hpp"
#include "stepper/implicit/bar_step.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace fan_sweep_test {

using namespace knap;
using namespace knap::tests;

TEST_CASE("a sweep hands on the impulses of the body and leaves prescribed nodes") {
    for (const Index order : {1, 2}) {
        CAPTURE(order);
        BarStep bar(order);
        FanSweep fans(bar.model, bar.matrix);
        fans.begin(bar.x.points);
        const std::vector<Vec2> first = bar.x.rate;
        std::vector<Vec2> impulse = bar.impulse(), residual = bar.residual();
        for (int i = 0; i < 3; ++i) fans.sweep(1e-6 * bar.scale(), bar.x.points, bar.x.rate, impulse, residual);
        const std::vector<Vec2> exact = bar.impulse(), missed = bar.residual();
        double largest = 0, moved = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) largest = std::max(largest, exact[i].norm());
        for (Index i = 0; i < bar.nodes.n_nodes(); ++i) {
            CHECK((impulse[i] - exact[i]).norm() <= 1e-13 * largest);
            CHECK((residual[i] - missed[i]).norm() <= 1e-12 * largest);
            moved = std::max(moved, (bar.x.rate[i] - first[i]).norm());
            for (int k = 0; k < 2; ++k)
                if (bar.nodes.prescribed[i][k]) CHECK(bar.x.rate[i][k] == first[i][k]);
        }
        CHECK(moved > 1e-3);
        for (const ActivePoint& point : bar.x.points)
            CHECK((point.rate - point.rate_at(bar.x.rate)).norm() <= 1e-13 * moved);
    }
}

TEST_CASE("sweeps alone end in the balance and the laws of all points") {
    BarStep bar(1);
    FanSweep fans(bar.model, bar.matrix);
    fans.begin(bar.x.points);
    std::vector<Vec2> impulse = bar.impulse(), residual = bar.residual();
    const double goal = 1e-9 * bar.scale();
    int n_sweeps = 0;
    Index n_open = 0;
    for (double missed = infinity; n_sweeps < 1000 && missed > 10 * goal; ++n_sweeps) {
        fans.sweep(goal, bar.x.points, bar.x.rate, impulse, residual);
        residual = bar.residual();
        std::vector<std::uint8_t> has_point(residual.size(), 0);  // corners of the bar without points keep their rates
        missed = n_open = 0;
        for (ActivePoint& point : bar.x.points) {
            point.sides.for_each_node([&](Index node, const auto&) { has_point[node] = 1; });
            n_open += !point.response.closed;
            missed = std::max({missed, std::abs(point.response.contact - point.multipliers.contact),
                               std::abs(point.response.tangential - point.multipliers.tangential)});
            point.multipliers.contact = point.response.contact;  // of fans that rested, too
            point.multipliers.tangential = point.response.tangential;
        }
        for (std::size_t i = 0; i < residual.size(); ++i)
            for (int k = 0; k < 2; ++k)
                if (has_point[i] && !bar.nodes.prescribed[i][k]) missed = std::max(missed, std::abs(residual[i][k]));
        residual = bar.residual();  // with the new multipliers
    }
    CHECK(n_sweeps < 1000);
    CHECK(n_open > 0);
    CHECK(n_open < static_cast<Index>(bar.x.points.size()));
}

}  // namespace fan_sweep_test
