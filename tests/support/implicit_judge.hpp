#pragma once
// An independent judge of one implicit step: it evaluates the equations of stepper/implicit/implicit_scheme.hpp, point by point and corner by
// corner, and shares no code with what found the solution. Corners that unbreakable points join are judged together: nothing is known of
// the impulses between them.
#include "element/elastic_forces.hpp"
#include "element/triangle_matrices.hpp"
#include "lcp/solvers.hpp"
#include "stepper/implicit/step_lcp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace knap::tests {

/// Worst violations, relative to the scales of the step.
struct ImplicitVerdict {
    double balance = 0;                         // of momentum
    double contact = 0;                         // 0 <= p perp w_N - c >= 0
    double cohesion = 0;                        // beta+ against the law
    double normal = 0;                          // P_N against p and beta_theta
    double tangential = 0;                      // P_T against the signs of u_T+ and w_T
    double impact_work = 0, friction_work = 0;  // largest of a single point; should be <= 0
    double worst() const {
        return std::max({balance, contact, cohesion, normal, tangential, impact_work, friction_work});
    }
};

class ImplicitJudge {
public:
    ImplicitJudge(const Model& model, const State& begin, double h, const SchemeOptions& options)
        : model_(model), begin_(begin), h_(h), options_(options) {}

    ImplicitVerdict verdict(const StepLcpEnd& end) {
        set_scales(end);
        ImplicitVerdict found;
        found.balance = grouped(missing(end)).cwiseAbs().maxCoeff() / impulse_;
        for (const FanPoint& point : model_.fan_points)
            if (!unbreakable(point)) judge(point, end, found);
        return found;
    }

    double speed_scale() const { return speed_; }  // [m/s] of the step that was judged last

    /// Impulses that make the balance hold with the rates and velocities of `end`, each within what its law allows at these rates: of a
    /// solution they exist, though round a vertex they need not be unique. Fills end.contact and end.impulse with the nearest there are.
    void explain(StepLcpEnd& end) {
        set_scales(end);
        for (Vec2& P : end.impulse) P.setZero();
        const Eigen::VectorXd needed = -grouped(missing(end)) / impulse_;  // what the points have to give
        // unknowns >= 0 of a point: p; friction f+, f-, the rest of mu p; what of the tangential cohesion's 2 G is used from -G on, its
        // rest; what of the normal cohesion an overlap takes
        std::vector<std::array<int, 7>> place(model_.n_points());
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::VectorXd b = needed;
        int n = 0, n_rows = static_cast<int>(needed.size());
        const auto add_row = [&](double value) {
            b.conservativeResize(n_rows + 1);
            b[n_rows] = value;
            return n_rows++;
        };
        const double near = 1e-9 * speed_;
        for (const FanPoint& point : model_.fan_points) {
            auto& at = place[point.point];
            at.fill(-1);
            if (unbreakable(point)) continue;
            const Passage passage = passage_of(point, end);
            const double sign_w = std::abs(passage.w_T) <= near ? 0 : std::copysign(1, passage.w_T);
            const double sign_u = std::abs(passage.sign_u_T) <= near * h_ ? 0 : std::copysign(1, passage.sign_u_T);
            const double mu = model_.laws[point.law].friction, G = passage.tangential_strength / impulse_;
            const Eigen::VectorXd N = grouped(pushed(point, point.normal)),
                                  T = grouped(pushed(point, turned_left(point.normal)));
            const auto add = [&](const Eigen::VectorXd& push) {
                for (Eigen::Index i = 0; i < push.size(); ++i)
                    if (push[i] != 0) entries.emplace_back(static_cast<int>(i), n, push[i]);
                return n++;
            };
            const double pull = passage.strength / impulse_, o = passage.overlap.value_or(-infinity);
            if (o < near * h_) b.head(needed.size()) += N * pull;
            if (std::abs(o) < near * h_) {  // what the overlap takes of it
                at[6] = add(N);
                const int limit = add_row(pull);
                entries.emplace_back(limit, at[6], 1.0);
                entries.emplace_back(limit, n++, 1.0);
            }
            if (passage.bound && passage.w_N - *passage.bound <= near) {
                at[0] = add(N - mu * sign_w * T);
                if (sign_w == 0 && mu > 0) {
                    at[1] = add(T), at[2] = add(-T), at[3] = n++;
                    const int row = add_row(0);
                    for (const int i : {1, 2, 3}) entries.emplace_back(row, at[i], 1.0);
                    entries.emplace_back(row, at[0], -mu);
                }
            }
            if (sign_u != 0 || G == 0) {
                b.head(needed.size()) += G * sign_u * T;
                continue;
            }
            b.head(needed.size()) += G * T;
            at[4] = add(T), at[5] = n++;
            const int row = add_row(2 * G);
            for (const int i : {4, 5}) entries.emplace_back(row, at[i], 1.0);
        }
        // least squares: min |A x - b|, x >= 0
        Eigen::SparseMatrix<double> A(n_rows, n);
        A.setFromTriplets(entries.begin(), entries.end());
        const Eigen::VectorXd x = solve_by_lemke({LcpMatrix(A.transpose() * A), -(A.transpose() * b)}).z;
        for (const FanPoint& point : model_.fan_points) {
            if (unbreakable(point)) continue;
            const Passage passage = passage_of(point, end);
            const auto value = [&](int i) {
                return place[point.point][i] < 0 ? 0 : impulse_ * x[place[point.point][i]];
            };
            const bool sticks = place[point.point][1] >= 0, uncrossed = place[point.point][4] >= 0;
            const double p = value(0), mu = model_.laws[point.law].friction;
            const double friction = sticks                          ? value(1) - value(2)
                                    : std::abs(passage.w_T) <= near ? 0
                                                                    : -std::copysign(mu * p, passage.w_T);
            const double cohesive = uncrossed ? value(4) - passage.tangential_strength
                                    : passage.sign_u_T == 0
                                        ? 0
                                        : -std::copysign(passage.tangential_strength, passage.sign_u_T);
            end.contact[point.point] = p;
            const double unpulled = passage.overlap && *passage.overlap >= near * h_ ? passage.strength : value(6);
            end.impulse[point.point] = {p - passage.strength + unpulled, friction + cohesive};
        }
    }

private:
    /// A point over the step, at the rates of `end`.
    struct Passage {
        std::optional<double> bound;  // [m/s] c, of a point that may touch
        double w_N, w_T, u_T;
        double reach, sign_u_T;         // [s] after which the slip decides the sign of the cohesion, [m] that slip
        double cohesion, end_cohesion;  // [-] before, and by the law
        double strength, tangential_strength;  // [N s] h S sigma_c beta_theta, times gamma
        std::optional<double> overlap;         // [m] -u_N in the middle of the step, of a ramp that may overlap there
    };

    Passage passage_of(const FanPoint& point, const StepLcpEnd& end) const {
        const CohesiveLaw& law = model_.laws[point.law];
        const double theta = options_.theta;
        const Vec2 n = point.normal, t = turned_left(n);
        const Vec2 u = displacement(point.after) - displacement(point.before),
                   V = velocity(point.after) - velocity(point.before),
                   w = rate(end, point.after) - rate(end, point.before);
        const double u_N = point.gap + n.dot(u), approach = std::max(-n.dot(V), 0.0);
        const double scale =
            displacement(point.after).norm() + displacement(point.before).norm() + point.gap + law.delta_c();
        Passage made{.w_N = n.dot(w), .w_T = t.dot(w), .u_T = t.dot(u)};
        made.cohesion = point.cracked || law.sigma_c == 0 ? 0 : knap::cohesion(model_, begin_, point.point);
        const PointState* known = state_of(model_, begin_, point.point);
        const double kappa = known ? law.ramp(made.cohesion, known->largest_opening) : 0;
        made.reach = kappa > 0 ? theta * h_ : h_;
        made.sign_u_T = made.u_T + made.reach * made.w_T;
        const bool touches = u_N <= 1e-11 * scale;
        const double e = made.cohesion > 0 ? 0 : law.restitution;  // restitution is for faces without cohesion
        if (touches) made.bound = -(1 - theta * (1 + e)) * approach;
        else if (e == 0) made.bound = std::min(-u_N / h_, -(1 - theta) * approach);
        if (driven(point)) made.bound.reset();
        made.end_cohesion =
            made.cohesion > 0 ? law.next_cohesion(made.cohesion, u_N + h_ * made.w_N, made.u_T + h_ * made.w_T, h_) : 0;
        const bool implicit = options_.cohesion == CohesionScheme::implicit_beta;
        double beta = implicit ? theta * made.end_cohesion + (1 - theta) * made.cohesion : made.cohesion;
        if (kappa > 0)
            beta *= std::min(1.0, law.equivalent_opening(u_N + made.reach * made.w_N, made.sign_u_T) / kappa);
        if (kappa > 0 && (!made.bound || u_N + made.reach * *made.bound < -1e-12 * law.delta_c()))
            made.overlap = -(u_N + made.reach * made.w_N);
        made.strength = made.cohesion > 0 ? h_ * point.area * law.sigma_c * beta : 0;
        made.tangential_strength = law.gamma * made.strength;
        return made;
    }

    /// A unit impulse of the point along `direction`, per corner.
    std::vector<Vec2> pushed(const FanPoint& point, const Vec2& direction) const {
        std::vector<Vec2> made(model_.mesh.n_corners(), Vec2::Zero());
        if (point.after != rigid_support) made[point.after] += direction;
        if (point.before != rigid_support) made[point.before] -= direction;
        return made;
    }

    void set_scales(const StepLcpEnd& end) {
        speed_ = impulse_ = std::numeric_limits<double>::min();
        double mass = 0;
        for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
            speed_ = std::max({speed_, velocity(c).norm(), end.rate[c].norm(), end.velocity[c].norm()});
            mass = std::max(mass, model_.corner_mass[c]);
        }
        for (const FanPoint& point : model_.fan_points) {
            if (unbreakable(point)) continue;
            const double strength = h_ * point.area * (point.cracked ? 0 : model_.laws[point.law].sigma_c);
            impulse_ = std::max({impulse_, end.impulse[point.point].norm(), strength});
            speed_ = std::max(speed_,
                              strength / model_.corner_mass[point.after == rigid_support ? point.before : point.after]);
        }
        impulse_ = std::max(impulse_, mass * speed_);
    }

    bool unbreakable(const FanPoint& point) const { return !point.cracked && !model_.laws[point.law].breakable(); }
    Vec2 velocity(Index corner) const {
        return corner == rigid_support ? Vec2::Zero() : begin_.velocity[begin_.node_of_corner[corner]];
    }
    Vec2 displacement(Index corner) const {
        return corner == rigid_support ? Vec2::Zero() : begin_.displacement[begin_.node_of_corner[corner]];
    }
    static Vec2 rate(const StepLcpEnd& end, Index corner) {
        return corner == rigid_support ? Vec2::Zero() : end.rate[corner];
    }
    bool prescribed(Index corner, int k) const {
        return !model_.prescribed.empty() && model_.prescribed_of_corner[corner] >= 0 &&
               model_.prescribed[model_.prescribed_of_corner[corner]].component[k];
    }

    /// Both sides are, in the direction of the normal: no contact can stop that.
    bool driven(const FanPoint& point) const {
        for (int k = 0; k < 2; ++k)
            for (const Index corner : {point.before, point.after})
                if (std::abs(point.normal[k]) > 1e-12 && corner != rigid_support && !prescribed(corner, k))
                    return false;
        return true;
    }

    /// [N s] per corner: what would have to act besides.
    std::vector<Vec2> missing(const StepLcpEnd& end) const {
        const double theta = options_.theta;
        const Index n = model_.mesh.n_corners();
        std::vector<Vec2> at_theta(n), left(n, Vec2::Zero());
        std::vector<Index> itself(n);
        for (Index c = 0; c < n; ++c) at_theta[c] = displacement(c) + theta * h_ * rate(end, c), itself[c] = c;
        std::vector<std::uint8_t> candidate(model_.fans.size());
        ElasticForces(model_.mesh, model_.materials, model_.plane, model_.thickness)
            .evaluate(at_theta, itself, left, candidate);
        for (Vec2& force : left) force *= h_;
        for (const CornerLoad& load : model_.corner_loads) {
            const TimeFunction& history = model_.histories[load.history];
            left[load.corner] += h_ * history.over_step(begin_.time, begin_.time + h_, theta) * load.force;
        }
        for (const FanPoint& point : model_.fan_points) {
            if (unbreakable(point)) continue;
            const Vec2 P =
                end.impulse[point.point].x() * point.normal + end.impulse[point.point].y() * turned_left(point.normal);
            if (point.after != rigid_support) left[point.after] += P;
            if (point.before != rigid_support) left[point.before] -= P;
        }
        for (Index c = 0; c < n; ++c) {
            const Vec2 change = end.velocity[c] - velocity(c);
            const Index t = model_.mesh.triangle_of(c), first = c - model_.mesh.place_in_triangle(c);
            const ElementMatrix& parts = mass_matrix(model_.mesh.order, options_.mass);
            for (Index k = 0; k < parts.rows(); ++k)
                left[first + k] -= parts(k, c - first) * model_.triangle_mass(t) * change;
        }
        // the right side of the balance less its left side
        return left;
    }

    /// Sums over the corners that move together, of the components that are not prescribed.
    Eigen::VectorXd grouped(const std::vector<Vec2>& of_corner) const {
        const Index n = model_.mesh.n_corners();
        std::vector<Index> group(n);
        std::vector<std::array<bool, 2>> known(n);
        for (Index c = 0; c < n; ++c) group[c] = c, known[c] = {prescribed(c, 0), prescribed(c, 1)};
        for (const FanPoint& point : model_.fan_points) {
            if (!unbreakable(point)) continue;
            if (point.before == rigid_support || point.after == rigid_support) {
                known[group[point.before == rigid_support ? point.after : point.before]] = {true, true};
                continue;
            }
            const Index from = group[point.before], to = group[point.after];
            for (int k = 0; k < 2; ++k) known[to][k] = known[to][k] || known[from][k];
            std::replace(group.begin(), group.end(), from, to);
        }
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(2 * n);
        for (Index c = 0; c < n; ++c)
            for (int k = 0; k < 2; ++k)
                if (!known[group[c]][k]) sum[2 * group[c] + k] += of_corner[c][k];
        return sum;
    }

    void judge(const FanPoint& point, const StepLcpEnd& end, ImplicitVerdict& found) const {
        const CohesiveLaw& law = model_.laws[point.law];
        const Passage passage = passage_of(point, end);
        const double p = end.contact[point.point], w_N = passage.w_N, w_T = passage.w_T;
        const Vec2& P = end.impulse[point.point];
        const double contact = passage.bound ? std::min(p / impulse_, (w_N - *passage.bound) / speed_) : p / impulse_;
        const double unit = passage.cohesion > 0 ? std::max(1.0, h_ * speed_ / law.delta_c()) : 1;
        found.contact = std::max(found.contact, std::abs(contact));
        found.cohesion = std::max(found.cohesion, std::abs(end.cohesion[point.point] - passage.end_cohesion) / unit);
        const double pull = p - P.x(), full = passage.strength;  // no cohesion pulls an overlap
        double off = std::abs(pull - full) / impulse_;
        if (const std::optional<double>& o = passage.overlap; o && *o >= -1e-9 * speed_ * h_) {
            const double between = std::max({-pull, pull - full, 0.0}) / impulse_;
            off = std::min(*o >= 0 ? std::abs(pull) / impulse_ : off,
                           std::max(between, std::abs(*o) / (passage.reach * speed_)));
        }
        found.normal = std::max(found.normal, off);

        // -P_T in G sgn(u_T+) + mu p sgn(w_T): distance of (w_T, P_T) from the graph
        const double G = passage.tangential_strength, F = friction_of(point, std::max(p, 0.0)), held = -P.y(),
                     crossing = -passage.u_T / passage.reach;
        const auto off_graph = [&](double at) {
            const double low = (at > crossing ? G : -G) + (at > 0 ? F : -F),
                         high = (at < crossing ? -G : G) + (at < 0 ? -F : F);
            return std::max({low - held, held - high, 0.0}) / impulse_;
        };
        double distance = off_graph(w_T);
        for (const double at : {0.0, crossing})
            distance = std::min(distance, std::max(std::abs(w_T - at) / speed_, off_graph(at)));
        found.tangential = std::max(found.tangential, distance);

        found.impact_work = std::max(found.impact_work, p * w_N / (impulse_ * speed_));
        if (passage.cohesion == 0)
            found.friction_work = std::max(found.friction_work, P.y() * w_T / (impulse_ * speed_));
    }

    /// [N s] mu p, or the lowest line of a friction over pressure.
    double friction_of(const FanPoint& point, double p) const {
        const CohesiveLaw& law = model_.laws[point.law];
        if (!law.over_pressure) return law.friction * p;
        double lowest = infinity;
        for (const FrictionLine& line : law.over_pressure->lines())
            lowest = std::min(lowest, line.slope * p + line.offset * h_ * point.area);
        return lowest;
    }

    const Model& model_;
    const State& begin_;
    double h_;
    SchemeOptions options_;
    double speed_ = 0, impulse_ = 0;
};

}  // namespace knap::tests
