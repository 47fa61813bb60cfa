#include "stepper/bound_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap {

Vec2 BoundTest::least_norm_circulation(const Fan& fan, std::span<const Vec2> taken) const {
    // minimises sum of |impulse|^2/area over the constant that is free round the vertex
    const FanPoint* point = &model_.fan_points[fan.first_point];
    Vec2 walked = Vec2::Zero(), sum = Vec2::Zero();
    double weight = 0;
    for (Index j = 0; j < fan.n_points; ++j) {
        sum += walked / point[j].area;
        weight += 1 / point[j].area;
        walked -= taken[j];
    }
    return -sum / weight;
}

void BoundTest::walk(const Fan& fan, std::span<const Vec2> taken, const Vec2& start) {
    // what a point gives to the corner after it, it takes from the one before: P_next = P - taken
    impulse_.resize(fan.n_points);
    Vec2 walked = start;
    for (Index j = 0; j < fan.n_points; ++j) {
        if (!fan.closed) walked -= taken[j];
        impulse_[j] = walked;
        if (fan.closed) walked -= taken[j];
    }
}

double BoundTest::smallest_slack(const Fan& fan, double time) const {
    double slack = std::numeric_limits<double>::infinity();
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model_.fan_points[fan.first_point + j];
        const CohesiveLaw& law = model_.laws[point.law];
        if (!law.breakable()) continue;
        const double strength = law.sigma_c * point.area * time, pressure = impulse_[j].dot(point.normal) + strength;
        const double shear = std::abs(impulse_[j].dot(turned_left(point.normal)));
        slack = std::min({slack, pressure, law.gamma * strength + law.friction * pressure - shear});
    }
    return slack;
}

bool BoundTest::holds(Index f, std::span<const Vec2> taken, double time) {
    const Fan& fan = model_.fans[f];
    const Vec2 least_norm = fan.closed ? least_norm_circulation(fan, taken) : Vec2::Zero();
    walk(fan, taken, least_norm);
    if (smallest_slack(fan, time) >= 0) return true;
    if (!fan.closed) return false;

    planes_.clear();
    walk(fan, taken, Vec2::Zero());
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model_.fan_points[fan.first_point + j];
        const CohesiveLaw& law = model_.laws[point.law];
        if (!law.breakable()) continue;
        const Vec2 n = point.normal, t = turned_left(n);
        const double strength = law.sigma_c * point.area * time, pressure = impulse_[j].dot(n) + strength;
        planes_.push_back({.value = pressure, .gradient = n, .link = j, .kind = 0});
        for (const int sign : {1, -1})
            planes_.push_back({.value = law.gamma * strength + law.friction * pressure - sign * impulse_[j].dot(t),
                               .gradient = law.friction * n - sign * t,
                               .link = j,
                               .kind = sign});
    }
    const Circulation found = find_circulation(planes_, least_norm);
    walk(fan, taken, found.c);
    return found.slack >= 0;
}

}  // namespace knap
