#pragma once
// An independent judge of one implicit step: it evaluates the equations of stepper/implicit_scheme.hpp, point by point and corner by
// corner, and shares no code with what found the solution. Corners that unbreakable points join are judged together: nothing is known of
// the impulses between them.
#include "bulk/elastic_forces.hpp"
#include "stepper/step_lcp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace knap::tests {

/// Worst violations, relative to the scales of the step.
struct ImplicitVerdict {
    double balance = 0;        // of momentum
    double contact = 0;        // 0 <= p perp w_N - c >= 0
    double cohesion = 0;       // beta+ against the law
    double normal = 0;         // P_N against p and beta_theta
    double tangential = 0;     // P_T against the signs of u_T+ and w_T
    double impact_work = 0, friction_work = 0;  // largest of a single point; should be <= 0
    double worst() const { return std::max({balance, contact, cohesion, normal, tangential, impact_work, friction_work}); }
};

class ImplicitJudge {
public:
    ImplicitJudge(const Model& model, const State& begin, double h, const SchemeOptions& options)
        : model_(model), begin_(begin), h_(h), options_(options) {}

    ImplicitVerdict verdict(const StepLcpEnd& end) {
        set_scales(end);
        ImplicitVerdict found;
        found.balance = balance(end);
        for (const FanPoint& point : model_.fan_points)
            if (!unbreakable(point)) judge(point, end, found);
        return found;
    }

    double speed_scale() const { return speed_; }

private:
    void set_scales(const StepLcpEnd& end) {
        speed_ = impulse_ = std::numeric_limits<double>::min();
        double mass = 0;
        for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
            speed_ = std::max({speed_, velocity(c).norm(), end.rate[c].norm(), end.velocity[c].norm()});
            mass = std::max(mass, model_.corner_mass[c]);
        }
        for (const FanPoint& point : model_.fan_points) {
            if (unbreakable(point)) continue;
            impulse_ = std::max(impulse_, end.impulse[point.point].norm());
            if (cohesion_before(point) > 0) impulse_ = std::max(impulse_, h_ * point.area * model_.laws[point.law].sigma_c);
        }
        impulse_ = std::max(impulse_, mass * speed_);
    }

    bool unbreakable(const FanPoint& point) const { return !point.cracked && !model_.laws[point.law].breakable(); }
    Vec2 velocity(Index corner) const { return corner == ground ? Vec2::Zero() : begin_.velocity[begin_.node_of_corner[corner]]; }
    Vec2 displacement(Index corner) const { return corner == ground ? Vec2::Zero() : begin_.displacement[begin_.node_of_corner[corner]]; }
    static Vec2 rate(const StepLcpEnd& end, Index corner) { return corner == ground ? Vec2::Zero() : end.rate[corner]; }
    double cohesion_before(const FanPoint& point) const {
        return point.cracked || model_.laws[point.law].sigma_c == 0 ? 0 : cohesion(model_, begin_, point.point);
    }
    bool prescribed(Index corner, int k) const {
        return !model_.prescribed.empty() && model_.prescribed_of_corner[corner] >= 0 &&
               model_.prescribed[model_.prescribed_of_corner[corner]].component[k];
    }

    /// Both sides are, in the direction of the normal: no contact can stop that.
    bool driven(const FanPoint& point) const {
        for (int k = 0; k < 2; ++k)
            for (const Index corner : {point.before, point.after})
                if (std::abs(point.normal[k]) > 1e-12 && corner != ground && !prescribed(corner, k)) return false;
        return true;
    }

    double balance(const StepLcpEnd& end) const {
        const double theta = options_.theta;
        const Index n = model_.mesh.n_corners();
        std::vector<Vec2> at_theta(n), missing(n, Vec2::Zero());
        std::vector<Index> itself(n);
        for (Index c = 0; c < n; ++c) at_theta[c] = displacement(c) + theta * h_ * rate(end, c), itself[c] = c;
        std::vector<std::uint8_t> hot(model_.fans.size());
        ElasticForces(model_.mesh, model_.materials, model_.plane, model_.thickness).evaluate(at_theta, itself, missing, hot);
        for (Vec2& force : missing) force *= h_;
        for (const CornerLoad& load : model_.corner_loads) {
            const TimeFunction& history = model_.histories[load.history];
            missing[load.corner] += h_ * (theta * history(begin_.time + h_) + (1 - theta) * history(begin_.time)) * load.force;
        }
        for (const FanPoint& point : model_.fan_points) {
            if (unbreakable(point)) continue;
            const Vec2 P = end.impulse[point.point].x() * point.normal + end.impulse[point.point].y() * turned_left(point.normal);
            if (point.after != ground) missing[point.after] += P;
            if (point.before != ground) missing[point.before] -= P;
        }
        for (Index c = 0; c < n; ++c) {
            const Vec2 change = end.velocity[c] - velocity(c);
            if (options_.mass == MassMatrix::lumped) missing[c] -= model_.corner_mass[c] * change;
            else
                for (Index d = c / 3 * 3; d < c / 3 * 3 + 3; ++d) missing[d] -= (c == d ? 0.5 : 0.25) * model_.corner_mass[c] * change;
        }
        return worst_sum(missing) / impulse_;
    }

    /// Of the corners that move together, where nothing is prescribed.
    double worst_sum(const std::vector<Vec2>& of_corner) const {
        const Index n = model_.mesh.n_corners();
        std::vector<Index> group(n);
        std::vector<std::array<bool, 2>> known(n);
        for (Index c = 0; c < n; ++c) group[c] = c, known[c] = {prescribed(c, 0), prescribed(c, 1)};
        for (const FanPoint& point : model_.fan_points) {
            if (!unbreakable(point)) continue;
            if (point.before == ground || point.after == ground) {
                known[group[point.before == ground ? point.after : point.before]] = {true, true};
                continue;
            }
            const Index from = group[point.before], to = group[point.after];
            for (int k = 0; k < 2; ++k) known[to][k] = known[to][k] || known[from][k];
            std::replace(group.begin(), group.end(), from, to);
        }
        std::vector<Vec2> sum(n, Vec2::Zero());
        for (Index c = 0; c < n; ++c) sum[group[c]] += of_corner[c];
        double worst = 0;
        for (Index c = 0; c < n; ++c)
            for (int k = 0; k < 2; ++k)
                if (group[c] == c && !known[c][k]) worst = std::max(worst, std::abs(sum[c][k]));
        return worst;
    }

    void judge(const FanPoint& point, const StepLcpEnd& end, ImplicitVerdict& found) const {
        const CohesiveLaw& law = model_.laws[point.law];
        const double theta = options_.theta, S = point.area;
        const Vec2 n = point.normal, t = turned_left(n);
        const Vec2 u = displacement(point.after) - displacement(point.before), V = velocity(point.after) - velocity(point.before),
                   w = rate(end, point.after) - rate(end, point.before);
        const double u_N = point.gap + n.dot(u), u_T = t.dot(u), w_N = n.dot(w), w_T = t.dot(w), p = end.contact[point.point];
        const double scale = displacement(point.after).norm() + displacement(point.before).norm() + point.gap + law.delta_c();

        // contact
        const double approach = std::max(-n.dot(V), 0.0);
        const bool touches = u_N <= 1e-11 * scale;
        if ((!touches && law.restitution > 0) || driven(point)) found.contact = std::max(found.contact, std::abs(p) / impulse_);
        else {
            const double c = touches ? -(1 - theta * (1 + law.restitution)) * approach : std::min(-u_N / h_, -(1 - theta) * approach);
            found.contact = std::max(found.contact, std::abs(std::min(p / impulse_, (w_N - c) / speed_)));
        }

        // cohesion
        const double before = cohesion_before(point), end_u_N = u_N + h_ * w_N, end_u_T = u_T + h_ * w_T;
        const double expected = before > 0 ? law.next_cohesion(before, end_u_N, end_u_T) : 0;
        const double unit = before > 0 ? std::max(1.0, h_ * speed_ / law.delta_c()) : 1;
        found.cohesion = std::max(found.cohesion, std::abs(end.cohesion[point.point] - expected) / unit);
        const double beta = options_.cohesion == CohesionScheme::implicit_beta ? theta * expected + (1 - theta) * before : before;
        const double strength = before > 0 ? h_ * S * law.sigma_c * beta : 0;
        found.normal = std::max(found.normal, std::abs(end.impulse[point.point].x() - (p - strength)) / impulse_);

        // -P_T in G sgn(u_T+) + mu p sgn(w_T): distance of (w_T, P_T) from the graph
        const double G = law.gamma * strength, F = law.friction * std::max(p, 0.0), held = -end.impulse[point.point].y();
        const auto off_graph = [&](double at) {
            const double kink = -u_T / h_;
            const double low = (at > kink ? G : -G) + (at > 0 ? F : -F), high = (at < kink ? -G : G) + (at < 0 ? -F : F);
            return std::max({low - held, held - high, 0.0}) / impulse_;
        };
        double distance = off_graph(w_T);
        for (const double at : {0.0, -u_T / h_}) distance = std::min(distance, std::max(std::abs(w_T - at) / speed_, off_graph(at)));
        found.tangential = std::max(found.tangential, distance);

        found.impact_work = std::max(found.impact_work, p * w_N / (impulse_ * speed_));
        // friction's share is what the cohesion cannot hold
        const double friction = std::abs(held) <= G ? 0 : std::copysign(std::abs(held) - G, held);
        if (before == 0) found.friction_work = std::max(found.friction_work, -friction * w_T / (impulse_ * speed_));
    }

    const Model& model_;
    const State& begin_;
    double h_;
    SchemeOptions options_;
    double speed_ = 0, impulse_ = 0;
};

}  // namespace knap::tests
