#pragma once
// An independent judge of solved fans: it evaluates the formulas of nonsmooth/fan_problem.hpp directly and shares no code with the solver.
#include "nonsmooth/fan_problem.hpp"

#include <algorithm>
#include <cmath>

namespace knap::tests {

/// Worst violations, relative to the largest momentum or cohesive impulse and to the largest speed of the problem.
struct FanVerdict {
    double balance = 0;        // of momentum of the bodies, and prescribed velocities
    double law = 0;            // distance of (V, P) from the graph of the law
    double impact_work = 0;    // largest work of one impact (should be <= 0)
    double friction_work = 0;  // largest work of one friction force (should be <= 0)
    double worst() const { return std::max({balance, law, impact_work, friction_work}); }
};

class FanJudge {
public:
    FanJudge(const FanProblem& problem, const FanResult& result) : problem_(problem), result_(result) {
        for (const FanBody& body : problem.bodies)
            speed_ = std::max({speed_, body.velocity.cwiseAbs().maxCoeff(), body.free_velocity.cwiseAbs().maxCoeff()});
        for (const FanBody& body : problem.bodies)
            for (int k = 0; k < 2; ++k)
                if (body.inverse_mass[k] > 0)
                    impulse_ =
                        std::max(impulse_, std::max(std::abs(body.velocity[k]), std::abs(body.free_velocity[k])) /
                                               body.inverse_mass[k]);
        for (const FanLink& link : problem.links) {
            if (link.unbreakable) continue;
            impulse_ = std::max(impulse_, link.cohesive);
            for (const Index body : {link.before, link.after})
                if (body >= 0) speed_ = std::max(speed_, link.cohesive * problem.bodies[body].inverse_mass.maxCoeff());
        }
        if (speed_ == 0) speed_ = 1;
        if (impulse_ == 0) impulse_ = 1;
    }

    FanVerdict verdict() const {
        FanVerdict worst;
        worst.balance = balance();
        for (std::size_t i = 0; i < problem_.links.size(); ++i) {
            const FanLink& link = problem_.links[i];
            const LinkResult& found = result_.links[i];
            worst.law = std::max(worst.law, law_distance(link, found));
            if (link.unbreakable) continue;
            worst.impact_work = std::max(worst.impact_work, impact_work(link, found));
            worst.friction_work = std::max(worst.friction_work, friction_work(link, found));
        }
        return worst;
    }

    /// Do the velocities alone meet the bounds, the unbreakable links and the driven motion?
    bool admissible() const {
        for (const FanLink& link : problem_.links)
            if (link.unbreakable ? !after(link).isZero(0) : normal_part(link, after(link)) < bound(link)) return false;
        for (std::size_t b = 0; b < problem_.bodies.size(); ++b)
            for (int k = 0; k < 2; ++k)
                if (const FanBody& body = problem_.bodies[b];
                    body.inverse_mass[k] == 0 && result_.velocity[b][k] != body.free_velocity[k])
                    return false;
        return true;
    }

    double speed_scale() const { return speed_; }
    double impulse_scale() const { return impulse_; }

private:
    Vec2 before(const FanLink& link) const {
        return problem_.velocity_before(link.after) - problem_.velocity_before(link.before);
    }
    Vec2 after(const FanLink& link) const { return result_.across(link); }
    static double normal_part(const FanLink& link, const Vec2& a) { return link.normal.dot(a); }
    static double tangential_part(const FanLink& link, const Vec2& a) { return turned_left(link.normal).dot(a); }

    double balance() const {
        double worst = 0;
        for (std::size_t b = 0; b < problem_.bodies.size(); ++b) {
            const FanBody& body = problem_.bodies[b];
            Vec2 pushed = Vec2::Zero();
            for (std::size_t i = 0; i < problem_.links.size(); ++i) {
                if (problem_.links[i].after == static_cast<Index>(b)) pushed += result_.links[i].impulse;
                if (problem_.links[i].before == static_cast<Index>(b)) pushed -= result_.links[i].impulse;
            }
            const Vec2 change = result_.velocity[b] - body.free_velocity;
            for (int k = 0; k < 2; ++k)
                worst = std::max(worst, body.inverse_mass[k] == 0
                                            ? std::abs(change[k]) / speed_
                                            : std::abs(change[k] / body.inverse_mass[k] - pushed[k]) / impulse_);
        }
        return worst;
    }

    /// [m/s] b, or minus infinity for what may not touch
    double bound(const FanLink& link) const {
        const double v = normal_part(link, before(link));
        if (link.u_N <= 1e-12 * speed_ * problem_.drift_time) return v <= 0 ? -link.restitution * v : -v;
        return link.restitution == 0 ? -std::max(link.u_N / problem_.drift_time, v) : -INFINITY;
    }

    double cohesion(const FanLink& link, const LinkResult& found) const {
        return link.ramp > 0 ? found.cohesive_impulse : link.cohesive;
    }

    /// Distance of (s, borne) from  C clamp(s/kappa, 0, 1)  at the mean opening of the half steps.
    double ramp_distance(const FanLink& link, const LinkResult& found) const {
        if (!(link.ramp > 0) || link.cohesive == 0) return 0;
        const Vec2 V = after(link);
        const double s = link.ramp_start.x() + normal_part(link, V) +
                         link.gamma * std::abs(link.ramp_start.y() + tangential_part(link, V)),
                     part = found.cohesive_impulse / link.cohesive;
        const double off = part >= 1   ? std::max(link.ramp - s, 0.0)
                           : part <= 0 ? std::max(s, 0.0)
                                       : std::abs(s - part * link.ramp);
        return std::max(
            std::min(off / speed_,
                     std::abs(found.cohesive_impulse - link.cohesive * std::clamp(s / link.ramp, 0.0, 1.0)) / impulse_),
            std::max(part - 1, -part) * link.cohesive / impulse_);
    }
    double contact(const FanLink& link, const LinkResult& found) const {
        return normal_part(link, found.impulse) + cohesion(link, found);
    }

    double law_distance(const FanLink& link, const LinkResult& found) const {
        const Vec2 V = after(link);
        if (link.unbreakable) return V.cwiseAbs().maxCoeff() / speed_;
        const double p = contact(link, found), b = bound(link);
        const double normal = b == -INFINITY ? std::abs(p) / impulse_
                                             : std::abs(std::min(p / impulse_, (normal_part(link, V) - b) / speed_));
        return std::max({normal, tangential_distance(link, found, std::max(p, 0.0)), ramp_distance(link, found)});
    }

    /// mu p, or the lowest line of a friction over pressure.
    static double rubbing(const FanLink& link, double p) {
        if (!link.pressed) return link.friction * p;
        double lowest = INFINITY;
        for (const FrictionLine& line : link.pressed.law->lines())
            lowest = std::min(lowest, line.slope * p + line.offset * link.pressed.unit);
        return lowest;
    }

    /// Distance of (V_T, -P_T) from  gamma C sgn(u_T + h V_T) + mu p 1/2 [ sgn(V_T) + sgn(V_T + V_T-) ]
    double tangential_distance(const FanLink& link, const LinkResult& found, double p) const {
        const double V = tangential_part(link, after(link)), V_before = tangential_part(link, before(link));
        const double friction = rubbing(link, p),
                     weight[3] = {link.gamma * cohesion(link, found), 0.5 * friction, 0.5 * friction};
        const double kink[3] = {link.ramp > 0 ? -link.ramp_start.y() : -link.u_T / problem_.drift_time, 0, -V_before};
        const double held = -found.impulse.dot(turned_left(link.normal));
        const auto off_graph = [&](double at) {  // distance of `held` from the values of the law at velocity `at`
            double low = 0, high = 0;
            for (int i = 0; i < 3; ++i) {
                low += at > kink[i] ? weight[i] : -weight[i];
                high += at < kink[i] ? -weight[i] : weight[i];
            }
            return std::max({low - held, held - high, 0.0}) / impulse_;
        };
        double distance = off_graph(V);
        for (const double at : kink) distance = std::min(distance, std::max(std::abs(V - at) / speed_, off_graph(at)));
        return distance;
    }

    double impact_work(const FanLink& link, const LinkResult& found) const {
        return contact(link, found) * 0.5 * normal_part(link, before(link) + after(link)) / (impulse_ * speed_);
    }

    double friction_work(const FanLink& link, const LinkResult& found) const {
        return found.friction_part * 0.5 * tangential_part(link, before(link) + after(link)) / (impulse_ * speed_);
    }

    const FanProblem& problem_;
    const FanResult& result_;
    double speed_ = 0, impulse_ = 0;
};

}  // namespace knap::tests
