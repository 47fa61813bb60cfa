// Moves of multipliers that form a series, and how far it is extrapolated.
#include "stepper/implicit/multiplier_series.hpp"
#include "stepper/implicit/bar_step.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace multiplier_series_test {

using namespace knap;
using namespace knap::tests;

namespace {

enum class Forces { act, cancel, cancel_with_faces };

/// The way [moves] on which a fan of the bar is taken after the moves d and q d, where the second one is turned by an
/// angle. Forces that cancel: its last point is there twice, and one of both moves by -d; or this one is a contact of
/// faces, which another series moves.
double extrapolated(double q, double angle, Forces forces = Forces::act) {
    BarStep bar(1);
    bar.matrix.set_all_near();
    if (forces != Forces::act) {
        std::vector<ActivePoint>& points = bar.x.points;
        points.push_back(points.back());
        for (ActivePoint& point : points) point.multipliers.contact = 0.5 * bar.scale();
    }
    MultiplierSeries series(bar.model, bar.matrix);
    const Index fan = bar.x.points.back().fan;
    if (forces == Forces::cancel_with_faces) bar.x.points.back().fan = between_faces;
    std::vector<Vec2> move(bar.x.points.size(), Vec2::Zero());
    const double unit = bar.scale();
    for (std::size_t j = 0; j < move.size(); ++j) {
        bar.x.points[j].response.closed = true;
        if (bar.x.points[j].fan == fan && forces == Forces::act) move[j] = {1e-4 * unit, 1e-5 * unit};
    }
    if (forces != Forces::act) move.back() = {1e-4 * unit, 1e-5 * unit}, move.end()[-2] = -move.back();
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
        if (move[j].x() != 0) way = std::max(way, along / move[j].x());
        else CHECK(along == 0);
    }
    return way;
}

/// Of a bar whose points hold by the norm: self-stress of an interior vertex, in the direction c. Returned: impulses
/// of its points over their strength after a move and another one of that ratio to it. `opens`: the first point of the
/// vertex; `start`: tension of all its points before, whose sides overlap.
std::vector<Vec2> after_self_stress(const Vec2& c, double ratio = 1, bool opens = false, double start = 0) {
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
        if (start != 0) point.law.contact.rate = -1, point.multipliers.contact += start * point.law.strength;
        move[j] = 1e-4 * bar.scale() * point.in_frame(c);
        if (opens && move[j - 1].isZero(0)) {
            point.response.sticks = point.response.closed = false;
            point.response.opens = true, point.response.curvature = 0.7;
        }
    }
    series.extrapolate(move, 1e-10 * bar.scale(), bar.x.points);
    for (Vec2& d : move) d *= ratio;
    series.extrapolate(move, 1e-10 * bar.scale(), bar.x.points);
    std::vector<Vec2> stress;
    for (const ActivePoint& point : bar.x.points)
        if (point.fan == at)
            stress.push_back(Vec2(point.multipliers.contact - point.law.strength, point.multipliers.tangential) /
                             point.law.strength);
    return stress;
}

/// [-] Of the half ellipse, or of the shear that a point bears under pressure; gamma is 1.
double edge(const Vec2& stress) { return stress.x() < 0 ? stress.norm() : std::abs(stress.y()); }

}  // namespace

TEST_CASE("multiplier series: self-stress of points that hold by the norm grows until the first half ellipse is met") {
    for (const Vec2& c : {Vec2(1, 0), Vec2(-0.4, 0.9), Vec2(0.3, -2)}) {
        CAPTURE(c);
        CHECK(edge(std::ranges::max(after_self_stress(c), {}, edge)) == relative(1, 1e-12));
    }
}

TEST_CASE("multiplier series: sides that overlap are free where their tension ends") {
    for (const Vec2& c : {Vec2(1, 0), Vec2(-0.4, 0.9), Vec2(0.3, -2)}) {
        CAPTURE(c);
        const std::vector<Vec2> stress = after_self_stress(c, 1, false, -0.3);
        double largest = -1;
        for (const Vec2& q : stress) largest = std::max(largest, q.x()), CHECK(edge(q) < 1);
        CHECK(std::abs(largest) <= 1e-12);
    }
}

TEST_CASE("multiplier series: sides that land on a ramp are held until their tension ends or all of it is borne") {
    for (const double sign : {1., -1.}) {
        BarStep bar(1);
        bar.matrix.set_all_near();
        MultiplierSeries series(bar.model, bar.matrix);
        ActivePoint& point = bar.x.points.back();
        point.law.ramp = point.law.cohesion = 1;
        point.response = {.cohesion_theta = 0.5, .on_ramp = true, .lands = true};
        const double C = point.law.strength;
        point.multipliers.contact = 0.8 * C;  // a tension of 0.2 C, of which the ramp leaves at most 0.5 C
        std::vector<Vec2> move(bar.x.points.size(), Vec2::Zero());
        for (const double d : {1e-2, 0.99e-2}) {
            move.back() = {sign * d * C, 0};
            series.extrapolate(move, 1e-10 * C, bar.x.points);
        }
        CHECK(point.multipliers.contact == relative(sign > 0 ? C : 0.5 * C, 1e-12));
    }
}

TEST_CASE("multiplier series: a point whose force turns with its opening decides how its vertex shares the forces") {
    for (const Vec2& c : {Vec2(-0.4, 0.9), Vec2(0.4, -0.9)}) {  // one opens the point, the other one closes it
        CAPTURE(c);
        const std::vector<Vec2> shared = after_self_stress(c, 0.9, true), free = after_self_stress(c);
        for (std::size_t j = 0; j < shared.size(); ++j) CHECK(shared[j].y() * free[j].y() > 0);
        CHECK(edge(std::ranges::max(shared, {}, edge)) < 1e-2);            // 0.9/(1 - 0.9) moves
        CHECK(after_self_stress(c, 1, true)[0].norm() == relative(0.25));  // without end: as far as its force may turn
    }
}

TEST_CASE(
    "multiplier series: moves of one direction are extrapolated to their sum where it is below a thousand moves") {
    for (const double q : {0.3, 0.9, 0.996, 0.999}) {
        CAPTURE(q);
        CHECK(extrapolated(q, 0) == relative(q / (1 - q), 1e-6));
    }
    CHECK(extrapolated(0.99999, 0) == relative(1000));  // as far as moves near rounding are trusted
}

TEST_CASE("multiplier series: a ratio that the moves do not tell is not trusted near 1") {
    CHECK(extrapolated(0.996, 0.05) == relative(20));  // the direction changed by 0.05, 1 - q may be that, too
    CHECK(extrapolated(0.996, 1e-3) == relative(100, 1e-2));
    CHECK(extrapolated(0.996, 0.2) == 0);
    CHECK(extrapolated(1.01, 0) == 0);
}

TEST_CASE("multiplier series: contradictory bounds lead to a bound and nearly redundant ones to the sum") {
    CHECK(extrapolated(1, 0, Forces::cancel) == relative(5000));  // 0.5 over 1e-4 of the scale
    CHECK(extrapolated(0.9999, 0, Forces::cancel) == relative(5000, 1e-3));
    CHECK(extrapolated(0.996, 0, Forces::cancel) == relative(0.996 / 0.004));
    // without the contacts that balance it a fan must not go on: its forces load its nodes
    CHECK(extrapolated(1, 0, Forces::cancel_with_faces) == 0);
}

}  // namespace multiplier_series_test
