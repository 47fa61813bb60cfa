// Moves of multipliers that form a series, and how far it is extrapolated.
#include "stepper/implicit/multiplier_series.hpp"
#include "stepper/implicit/bar_step.hpp"

#include <doctest/doctest.h>

namespace multiplier_series_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// The way [moves] on which a fan of the bar is taken after the moves d and q d, where the second one is turned by an
/// angle.
double extrapolated(double q, double angle) {
    BarStep bar(1);
    bar.matrix.set_all_near();
    MultiplierSeries series(bar.model, bar.matrix);
    const Index fan = bar.x.points.back().fan;
    std::vector<Vec2> move(bar.x.points.size(), Vec2::Zero());
    const double unit = bar.scale();
    for (std::size_t j = 0; j < move.size(); ++j) {
        bar.x.points[j].response.closed = true;
        if (bar.x.points[j].fan == fan) move[j] = {1e-4 * unit, 1e-5 * unit};
    }
    const std::vector<ActivePoint> before = bar.x.points;
    series.extrapolate(move, 1e-10 * unit, bar.x.points);
    for (std::size_t j = 0; j < move.size(); ++j) {
        CHECK(bar.x.points[j].multipliers.contact == before[j].multipliers.contact);
        move[j] = q * Vec2(std::cos(angle) * move[j].x() - std::sin(angle) * move[j].y(),
                           std::sin(angle) * move[j].x() + std::cos(angle) * move[j].y());
    }
    series.extrapolate(move, 1e-10 * unit, bar.x.points);
    double way = 0;
    for (std::size_t j = 0; j < move.size(); ++j) {
        const double along = bar.x.points[j].multipliers.contact - before[j].multipliers.contact;
        if (before[j].fan == fan) way = along / move[j].x();
        else CHECK(along == 0);
    }
    return way;
}

}  // namespace

TEST_CASE(
    "multiplier series: moves of one direction are extrapolated to their sum where it is below a thousand moves") {
    for (const double q : {0.3, 0.9, 0.996, 0.999}) {
        CAPTURE(q);
        CHECK(extrapolated(q, 0) == doctest::Approx(q / (1 - q)).epsilon(1e-6));
    }
    CHECK(extrapolated(0.99999, 0) == doctest::Approx(1000));  // as far as moves near rounding are trusted
}

TEST_CASE("multiplier series: a ratio that the moves do not tell is not trusted near 1") {
    CHECK(extrapolated(0.996, 0.05) == doctest::Approx(20));  // the direction changed by 0.05, 1 - q may be that, too
    CHECK(extrapolated(0.996, 1e-3) == doctest::Approx(100).epsilon(1e-2));
    CHECK(extrapolated(0.996, 0.2) == 0);
    CHECK(extrapolated(1.01, 0) == 0);
}

}  // namespace multiplier_series_test
