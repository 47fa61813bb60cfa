#include "stepper/implicit/interior_point.hpp"

#include "base/tolerance.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_steps = 80;
constexpr double least_start = 1e-2;    // [-] of their scales: impulses and rates at the start
constexpr double centring = 0.3;        // of the products lambda z: what a step aims at
constexpr double near_enough = 1e-2;    // of the scale: rates that lack are left to the active set
constexpr double slips_beyond = 0.999;  // of mu p
constexpr std::array edges{1.0, -1.0};  // sign of mu

}  // namespace

bool InteriorPoint::fits(const std::vector<ActivePoint>& points) {
    return std::ranges::all_of(points, [](const ActivePoint& point) { return point.law.strength == 0; });
}

void InteriorPoint::begin() {
    std::vector<ActivePoint>& points = newton_.x.points;
    newton_.system.begin(points);
    newton_.system.evaluate();
    for (const ActivePoint& point : points) {
        const Multipliers& at = point.multipliers;
        point.sides.add_force(-point.out_of_frame({at.contact, at.tangential}), newton_.system.residual());
    }
    unit_ = std::max(newton_.unit, newton_.residual());
    const bool is_new = std::ranges::all_of(points, [](const ActivePoint& p) { return p.multipliers.contact <= 0; });
    const double least = (is_new ? 1 : least_start) * unit_;
    contacts_.resize(points.size());
    for (std::size_t j = 0; j < points.size(); ++j) {
        ActivePoint& point = points[j];
        point.rate = point.rate_at(newton_.x.rate);
        // what is driven along its tangent takes its friction from the rate: it is left to the active set
        // (of a friction over pressure its chord there is near enough)
        const double p = std::max(0.0, point.multipliers.contact),
                     slope = point.law.pressed && p > 0 ? point.law.rubbing(p) / p : point.law.rubbing_slope(p),
                     mu = std::isinf(point.multipliers.rho_T) ? 0 : slope,
                     t = std::clamp(point.multipliers.tangential, -mu * p, mu * p);
        Contact& c = contacts_[j];
        c.friction = mu;
        c.dilation = p > 0 && std::abs(t) > slips_beyond * mu * p ? std::abs(point.rate.y()) : 0;
        for (int k = 0; k < 2; ++k) {
            const double lambda = 0.5 * (p + (mu > 0 ? edges[k] * t / mu : 0)),
                         z = point.rate.x() - point.law.contact.rate + mu * (c.dilation + edges[k] * point.rate.y());
            c.lambda[k] = std::max(lambda, least), c.z[k] = std::max(z, least / point.mass);
        }
    }
    if (is_new) spread();
    rate_ = newton_.x.rate;
}

/// S. Mehrotra's start: what one step of equal springs gives, all impulses and all rates raised until none is negative.
void InteriorPoint::spread() {
    find_distance();
    if (!find_direction(unit_ * unit_)) return;
    move(1);
    if (newton_.system.is_condensed()) newton_.system.complete();
    double lambda = 0, z = 0;  // [N s]
    const auto each = [&](const auto& visit) {
        for (std::size_t j = 0; j < contacts_.size(); ++j)
            for (int k = 0; k < 2 && newton_.x.points[j].law.contact.may_touch; ++k)
                visit(contacts_[j].lambda[k], contacts_[j].z[k], newton_.x.points[j].mass);
    };
    each([&](double l, double rate, double mass) { lambda = std::min(lambda, l), z = std::min(z, mass * rate); });
    each([&](double& l, double& rate, double mass) {
        l += least_start * unit_ - 1.5 * lambda, rate += (least_start * unit_ - 1.5 * z) / mass;
    });
}

bool InteriorPoint::approach(double goal) {
    newton_.x.rate = rate_;
    newton_.system.forget();
    for (ActivePoint& point : newton_.x.points) point.rate = point.rate_at(rate_);
    bool found = false;
    for (int i = 0; i < max_steps && !found; ++i) {
        newton_.give_up_if_asked();
        const Distance at = find_distance();
        if (!std::isfinite(at.product) || !find_direction(centring * at.product)) break;
        move(longest_step());
        found = at.product <= goal * goal * unit_ * unit_ && at.lack <= near_enough * unit_;
    }
    finish();
    return found;
}

InteriorPoint::Distance InteriorPoint::find_distance() {
    Distance distance;
    int n = 0;
    for (std::size_t j = 0; j < contacts_.size(); ++j) {
        const ActivePoint& point = newton_.x.points[j];
        if (!point.law.contact.may_touch) continue;
        Contact& c = contacts_[j];
        for (int k = 0; k < 2; ++k) {
            c.lack[k] = point.rate.x() - point.law.contact.rate +
                        c.friction * (c.dilation + edges[k] * point.rate.y()) - c.z[k];
            distance.product += c.lambda[k] * c.z[k] * point.mass, ++n;
            distance.lack = std::max(distance.lack, point.mass * std::abs(c.lack[k]));
        }
    }
    if (n > 0) distance.product /= n;
    return distance;
}

/// dz = G' H dw + lack,  d lambda = (tau - lambda dz)/z - lambda:  (M_hat + H' G lambda/z G' H) dw = right-hand side
bool InteriorPoint::find_direction(double tau) {
    const std::vector<ActivePoint>& points = newton_.x.points;
    tangents_.clear();
    newton_.system.evaluate();
    for (std::size_t j = 0; j < contacts_.size(); ++j) {
        const ActivePoint& point = points[j];
        const Contact& c = contacts_[j];
        if (!point.law.contact.may_touch) continue;
        Eigen::Matrix2d D = Eigen::Matrix2d::Zero();
        Vec2 q = Vec2::Zero();
        for (int k = 0; k < 2; ++k) {
            const Vec2 along(1, c.friction * edges[k]);
            D += c.lambda[k] / c.z[k] * along * along.transpose();
            q += (tau / point.mass - c.lambda[k] * c.lack[k]) / c.z[k] * along;
        }
        const Eigen::Matrix2d block = point.axes() * D * point.axes().transpose();
        tangents_.push_back({point.sides, block, block});
        point.sides.add_force(-point.out_of_frame(q), newton_.system.residual());
    }
    ++newton_.counts.factorisations, ++newton_.counts.linear_solves;
    if (!matrix_.factorise(tangents_) || !newton_.system.find_direction(points)) return false;
    for (std::size_t j = 0; j < contacts_.size(); ++j) {
        Contact& c = contacts_[j];
        const Vec2 d = points[j].across(newton_.system.direction());
        for (int k = 0; k < 2; ++k) {
            c.z_step[k] = d.x() + c.friction * edges[k] * d.y() + c.lack[k];
            c.lambda_step[k] = (tau / points[j].mass - c.lambda[k] * c.z_step[k]) / c.z[k] - c.lambda[k];
        }
    }
    return true;
}

double InteriorPoint::longest_step() const {
    double a = 1 / part_of_longest_step;
    const auto stop_at = [&](double value, double step) {
        if (step < 0) a = std::min(a, -value / step);
    };
    for (std::size_t j = 0; j < contacts_.size(); ++j)
        for (int k = 0; k < 2 && newton_.x.points[j].law.contact.may_touch; ++k)
            stop_at(contacts_[j].lambda[k], contacts_[j].lambda_step[k]),
                stop_at(contacts_[j].z[k], contacts_[j].z_step[k]);
    return part_of_longest_step * a;
}

void InteriorPoint::move(double a) {
    newton_.system.step(a);
    for (std::size_t j = 0; j < contacts_.size(); ++j) {
        ActivePoint& point = newton_.x.points[j];
        Contact& c = contacts_[j];
        point.rate = point.rate_at(newton_.x.rate);
        for (int k = 0; k < 2; ++k) c.lambda[k] += a * c.lambda_step[k], c.z[k] += a * c.z_step[k];
        c.dilation = std::abs(point.rate.y());
    }
}

void InteriorPoint::finish() {
    if (newton_.system.is_condensed()) newton_.system.complete();
    newton_.newton_matrix.forget();
    rate_ = newton_.x.rate;
    for (std::size_t j = 0; j < contacts_.size(); ++j) {
        const Contact& c = contacts_[j];
        Multipliers& at = newton_.x.points[j].multipliers;
        if (!newton_.x.points[j].law.contact.may_touch) continue;
        at.contact = c.lambda[0] + c.lambda[1];
        if (c.friction > 0) at.tangential = c.friction * (c.lambda[0] - c.lambda[1]);
    }
}

}  // namespace knap
