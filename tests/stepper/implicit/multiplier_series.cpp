// Moves of multipliers that form a series, and how far it is extrapolated.
#include "stepper/implicit/multiplier_series.hpp"
#include "stepper/implicit/bar_step.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace multiplier_series_test {

using namespace knap;
using namespace knap::tests;

namespace {

enum class Forces { act, cancel };

/// The way [moves] on which a fan of the bar is taken after the moves d and q d, where the second one is turned by an
/// angle. Forces that cancel: its last point is there twice, and one of both moves by -d.
double extrapolated(double q, double angle, Forces forces = Forces::act) {
    BarStep bar(1);
    bar.matrix.set_all_near();
    if (forces == Forces::cancel) {
        std::vector<ActivePoint>& points = bar.x.points;
        points.push_back(points.back());
        for (ActivePoint& point : points) point.multipliers.contact = 0.5 * bar.scale();
    }
    MultiplierSeries series(bar.model, bar.matrix);
    const Index fan = bar.x.points.back().fan;
    std::vector<Vec2> move(bar.x.points.size(), Vec2::Zero());
    const double unit = bar.scale();
    for (std::size_t j = 0; j < move.size(); ++j) {
        bar.x.points[j].response.closed = true;
        if (bar.x.points[j].fan == fan && forces == Forces::act) move[j] = {1e-4 * unit, 1e-5 * unit};
    }
    if (forces == Forces::cancel) move.back() = {1e-4 * unit, 1e-5 * unit}, move.end()[-2] = -move.back();
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
        if (move[j].x() != 0) way = along / move[j].x();
        else CHECK(along == 0);
    }
    return way;
}

/// Of a bar whose points hold by the norm: self-stress of an interior vertex, in the direction c. Returned: impulses
/// over the half ellipse of each of its points, or the shear that it bears under pressure; the first has reached 1.
std::vector<double> edges_after_self_stress(const Vec2& c, bool one_turns) {
    BarStep bar(1, Coupling::norm);
    bar.matrix.set_all_near();
    MultiplierSeries series(bar.model, bar.matrix);
    const auto fan =
        std::ranges::find_if(bar.model.fans, [](const Fan& f) { return f.n_points > 2 && f.n_points == f.n_corners; });
    const Index at = static_cast<Index>(fan - bar.model.fans.begin());
    std::vector<Vec2> move(bar.x.points.size(), Vec2::Zero());
    for (std::size_t j = 0; j < move.size(); ++j) {
        ActivePoint& point = bar.x.points[j];
        point.response.sticks = point.response.closed = true, point.response.cohesion_theta = 1;
        if (point.fan != at) continue;
        move[j] = 1e-4 * bar.scale() * point.in_frame(c);
        if (one_turns && move[j - 1].isZero(0)) {
            point.response.sticks = point.response.closed = false;
            point.response.opens = true, point.response.curvature = 0.7;
        }
    }
    for (int i = 0; i < 2; ++i)
        series.extrapolate(move, 1e-10 * bar.scale(), bar.x.points);  // a move and the same again
    std::vector<double> edges;
    for (const ActivePoint& point : bar.x.points) {
        if (point.fan != at) continue;
        const double N = point.multipliers.contact / point.law.strength - 1,
                     T = point.multipliers.tangential / point.law.strength;  // gamma is 1
        edges.push_back(N < 0 ? std::hypot(N, T) : std::abs(T));
    }
    return edges;
}

}  // namespace

TEST_CASE("multiplier series: self-stress of points that hold by the norm grows until the first half ellipse is met") {
    for (const Vec2& c : {Vec2(1, 0), Vec2(-0.4, 0.9), Vec2(0.3, -2)}) {
        CAPTURE(c);
        CHECK(std::ranges::max(edges_after_self_stress(c, false)) == doctest::Approx(1).epsilon(1e-12));
    }
}

TEST_CASE("multiplier series: a point whose force turns with its opening decides how its vertex shares the forces") {
    CHECK(std::ranges::max(edges_after_self_stress({-0.4, 0.9}, true)) == 0);
}

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

TEST_CASE("multiplier series: contradictory bounds lead to a bound and nearly redundant ones to the sum") {
    CHECK(extrapolated(1, 0, Forces::cancel) == doctest::Approx(5000));  // 0.5 over 1e-4 of the scale
    CHECK(extrapolated(0.9999, 0, Forces::cancel) == doctest::Approx(5000).epsilon(1e-3));
    CHECK(extrapolated(0.996, 0, Forces::cancel) == doctest::Approx(0.996 / 0.004));
}

}  // namespace multiplier_series_test
