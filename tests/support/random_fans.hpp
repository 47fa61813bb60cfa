#pragma once
// Random fans: closed, open, on the support; with equal and with very unequal masses; at rest, moving together, impacting; with ties; in
// any units. Every one has a solution: what is joined for ever moves together before the step, and what is driven can be followed.
#include "base/random.hpp"
#include "material/friction_over_pressure.hpp"
#include "nonsmooth/fan_problem.hpp"

#include <algorithm>
#include <cmath>

namespace knap::tests {

inline FanLink contact_without_cohesion(Index before, Index after, const Vec2& normal, double friction) {
    return {.before = before,
            .after = after,
            .normal = normal,
            .u_N = 0,
            .u_T = 0,
            .cohesive = 0,
            .gamma = 0,
            .friction = friction,
            .restitution = 0,
            .unbreakable = false};
}

struct RandomFanOptions {
    bool friction = true;
    bool prescribed = true;      // some bodies driven
    bool units = true;           // random units of length, mass, time
    bool secant = false;         // most links with cohesion have secant unloading
    bool vertical = false;       // or vertical unloading, at or below their largest opening
    bool over_pressure = false;  // links with friction mu have it at pressure 0, and less and less beyond
    int max_bodies = 12;
};

class RandomFan {
public:
    RandomFan(std::uint64_t seed, const RandomFanOptions& options = {}) : random_(seed, "fan"), options_(options) {}
    RandomFan(const RandomFan&) = delete;  // its problem refers to its tables

    FanProblem problem() {
        const int n = 1 + static_cast<int>(random_.uniform(0, options_.max_bodies));
        FanProblem fan;
        fan.drift_time = unit(3);
        speed_ = unit(6);
        mass_ = unit(6);
        fan.closed = n >= 3 && chance(0.5);
        make_bodies(fan, n);
        make_links(fan, n);
        join_unbreakable(fan);
        if (options_.prescribed) prescribe(fan);
        make_openings(fan);
        if (options_.over_pressure) bend_friction(fan);
        return fan;
    }

private:
    double unit(double decades) { return options_.units ? std::pow(10, random_.uniform(-decades, decades)) : 1; }
    bool chance(double part) { return random_.uniform() < part; }
    Vec2 vector() {
        const double x = random_.uniform(-1, 1), y = random_.uniform(-1, 1);
        return {x, y};
    }
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return *(values.begin() + static_cast<int>(random_.uniform(0, static_cast<double>(values.size()))));
    }

    void make_bodies(FanProblem& fan, int n) {
        const double decades = one_of({0.0, 0.3, 1.0, 4.0}), spread = one_of({0.0, 0.1, 1.0});
        const Vec2 common = one_of({0.0, 1.0}) * vector();
        const bool some_together = chance(0.5);  // like bodies that stuck in the step before
        displacement_.assign(n, Vec2::Zero());
        fan.bodies.resize(n);
        for (int b = 0; b < n; ++b) {
            fan.bodies[b].inverse_mass = Vec2::Constant(std::pow(10, random_.uniform(0, decades)) / mass_);
            fan.bodies[b].velocity = speed_ * (common + spread * vector());
            displacement_[b] = vector();
            if (b > 0 && some_together && chance(0.6)) fan.bodies[b].velocity = fan.bodies[b - 1].velocity;
            if (b > 0 && chance(0.5)) displacement_[b] = displacement_[b - 1];
        }
        force_ = one_of({0.0, 1e-3, 0.1, 1.0, 10.0});
    }

    FanLink random_law() {
        return {.before = 0,
                .after = 0,
                .normal = Vec2::Zero(),
                .u_N = 0,
                .u_T = 0,
                .cohesive = 0,
                .gamma = one_of({0.0, 0.5, 1.0, random_.uniform(0, 3)}),
                .friction = options_.friction ? one_of({0.0, 0.3, 1.0, random_.uniform(0, 3), 30.0, 1000.0}) : 0,
                .restitution = one_of({0.0, 0.0, 0.5, 1.0, random_.uniform()}),
                .unbreakable = false};
    }

    void make_links(FanProblem& fan, int n) {
        const bool support_first = !fan.closed && (n == 1 || chance(0.3)), support_last = !fan.closed && chance(0.3);
        const int lattice = one_of({0, 0, 0, 4, 6, 8});  // rays of a regular mesh: many ties
        const double strength = one_of({1e-2, 1.0, 1.0, 30.0});
        const bool alike = chance(0.6), some_unbreakable = chance(0.2);
        const FanLink common = random_law();
        double angle = random_.uniform(0, 2 * M_PI);
        for (int i = fan.closed || support_first ? 0 : 1; i <= (support_last ? n : n - 1); ++i) {
            FanLink link = alike ? common : random_law();
            link.before = fan.closed ? (i + n - 1) % n : i - 1;
            link.after = i == n ? -1 : i;
            angle += lattice ? 2 * M_PI / lattice : random_.uniform(0.05, 1.95) * 2 * M_PI / n;
            const Vec2 ray = lattice == 4 ? Vec2(one_of({Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)}))
                                          : Vec2(std::cos(angle), std::sin(angle));
            link.normal = turned_left(ray);
            link.cohesive = chance(0.3) ? 0 : strength * mass_ * speed_ * one_of({1.0, 1.0, random_.uniform()});
            if (some_unbreakable && chance(0.4)) link.unbreakable = true, link.cohesive = 0;
            fan.links.push_back(link);
        }
    }

    /// What an unbreakable link joins has moved together before.
    void join_unbreakable(FanProblem& fan) {
        const Index n = static_cast<Index>(fan.bodies.size());
        std::vector<Index> leader(n);  // of each body: the smallest of its group, or -1 = support
        for (Index b = 0; b < n; ++b) leader[b] = b;
        const auto leader_of = [&](Index b) { return b < 0 ? -1 : leader[b]; };
        for (const FanLink& link : fan.links) {
            if (!link.unbreakable) continue;
            const Index a = leader_of(link.before), b = leader_of(link.after);
            std::replace(leader.begin(), leader.end(), std::max(a, b), std::min(a, b));
        }
        for (Index b = 0; b < n; ++b) {
            fan.bodies[b].velocity = fan.velocity_before(leader[b]);
            displacement_[b] = leader[b] < 0 ? Vec2(Vec2::Zero()) : Vec2(displacement_[leader[b]]);
        }
    }

    void prescribe(FanProblem& fan) {
        const int kind = one_of({0, 0, 0, 0, 1, 2});
        const bool supported = std::any_of(fan.links.begin(), fan.links.end(),
                                           [](const FanLink& l) { return l.before < 0 || l.after < 0; });
        const Vec2 before = supported ? Vec2(Vec2::Zero()) : Vec2(speed_ * vector()),
                   after = supported ? before : Vec2(speed_ * vector());
        const std::array<bool, 2> which = {chance(0.6), chance(0.6)};
        const std::size_t single = static_cast<std::size_t>(random_.uniform(0, static_cast<double>(fan.bodies.size())));
        for (std::size_t b = 0; b < fan.bodies.size(); ++b)
            for (int k = 0; k < 2; ++k) {
                // 1: a whole vertex is driven, as a scenario can; 2: one body
                if (!which[k] || kind == 0 || (kind == 2 && (b != single || supported))) continue;
                fan.bodies[b].inverse_mass[k] = 0;
                if (kind == 1) fan.bodies[b].velocity[k] = before[k];
                driven_velocity_ = after;
            }
    }

    void make_openings(FanProblem& fan) {
        const double reach = chance(0.3) ? 0 : fan.drift_time * speed_ * std::pow(10, random_.uniform(-2, 2));
        for (FanBody& body : fan.bodies) {
            const Vec2 push = force_ * speed_ * mass_ * vector();
            body.free_velocity = body.velocity + body.inverse_mass.cwiseProduct(push);
            for (int k = 0; k < 2; ++k)
                if (body.inverse_mass[k] == 0) body.free_velocity[k] = driven_velocity_[k];
        }
        const auto at = [&](Index body) -> Vec2 { return body < 0 ? Vec2::Zero() : Vec2(reach * displacement_[body]); };
        for (FanLink& link : fan.links) {
            const Vec2 jump = at(link.after) - at(link.before);
            link.u_N = link.normal.dot(jump);
            link.u_T = turned_left(link.normal).dot(jump);
            if (!(options_.secant || options_.vertical) || link.cohesive == 0 || chance(0.2)) continue;
            if (options_.vertical) {
                const Vec2 mobility = fan.inverse_mass(link.after) + fan.inverse_mass(link.before);
                const double opened = std::max(link.u_N, 0.0) + link.gamma * std::abs(link.u_T);
                link.restitution = 0;
                link.floor = opened + fan.drift_time * speed_ * one_of({0.0, 0.0, 1e-6, 1e-2, 1.0});
                if (link.floor > 0)
                    link.set_floor(fan.drift_time, 1e-7 * link.cohesive * mobility.sum() +
                                                       1e-12 * link.floor / fan.drift_time + 1e-12 * speed_);
                continue;
            }
            // from next to nothing, which is rigid, to far beyond what the step moves
            const Vec2 rate = fan.velocity_before(link.after) - fan.velocity_before(link.before);
            link.restitution = 0;
            link.ramp = std::max(speed_, 4 * reach / fan.drift_time) * one_of({1e-12, 1e-6, 1e-2, 1.0, 1.0, 10.0, 1e3});
            link.ramp_start = 4 / fan.drift_time * Vec2(link.u_N, link.u_T) -
                              one_of({1.0, 1.0, 0.0, 0.7}) * Vec2(link.normal.dot(rate), link.tangent().dot(rate));
        }
    }

    /// At impulses of the size of the momenta, some between bends and many at one.
    void bend_friction(FanProblem& fan) {
        tables_.reserve(fan.links.size());
        for (FanLink& link : fan.links) {
            if (!(link.friction > 0)) continue;
            std::vector<Vec2> points{Vec2::Zero()};
            double slope = link.friction;
            for (int i = 0; i < one_of({1, 2, 4}); ++i) {
                const double piece = std::pow(10, random_.uniform(-2, 1));
                points.push_back(points.back() + Vec2(piece, slope * piece));
                slope *= one_of({0.0, 0.3, 0.9});
            }
            points.push_back(points.back() + Vec2(1, slope));
            tables_.emplace_back(points);
            link.pressed = {&tables_.back(), mass_ * speed_};
            link.friction = NAN;  // nothing reads it
        }
    }

    std::vector<FrictionOverPressure> tables_;
    Random random_;
    RandomFanOptions options_;
    double speed_ = 1, mass_ = 1, force_ = 0;
    Vec2 driven_velocity_ = Vec2::Zero();
    std::vector<Vec2> displacement_;  // in units of the reach
};

}  // namespace knap::tests
