#include "stepper/implicit/step_lcp.hpp"

#include "interface/interface_law.hpp"
#include "stepper/implicit/corner_partition.hpp"
#include "stepper/implicit/step_lcp_body.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

constexpr double bond_is_gone = 1e-12;  // [-] cohesion below it is none
constexpr double rounding = 1e-12;      // relative

/// A point that can come apart, at the begin of the step.
struct Point {
    const FanPoint* at;
    const CohesiveLaw* law;
    Vec2 opening, rate;           // [m], [m/s] (N, T)
    double cohesion;              // [-]
    ContactBound contact;
};

class StepLcpMaker {
public:
    StepLcpMaker(const Model& model, const State& begin, double h, const SchemeOptions& options)
        : model_(model), begin_(begin), h_(h), theta_(options.theta), implicit_beta_(options.cohesion == CohesionScheme::implicit_beta) {
        step_.body = std::make_shared<PartedBody>(model, begin, h, options);
        find_points();
        make_jumps();
        lay_out();
    }

    StepLcp made() {
        const int n = step_.layout.size();
        known_ = Eigen::VectorXd::Zero(n);
        step_.known_impulse = Eigen::VectorXd::Zero(2 * model_.n_points());
        if (implicit_beta_)
            add_cohesion();
        else
            add_frozen_cohesion();
        add_contacts();
        if (step_.layout.tangential) add_tangential_cohesion();

        const auto matrix = [](Eigen::Index rows, Eigen::Index columns, const Triplets& entries) {
            LcpMatrix made(rows, columns);
            made.setFromTriplets(entries.begin(), entries.end());
            return made;
        };
        // the rates of the points, and with them the rows: rows_of_rate (w_free + theta W P) + coupling z + known
        const LcpMatrix rows_of_rate = matrix(n, 2 * model_.n_points(), rows_of_rate_);
        step_.impulse_of_z = matrix(2 * model_.n_points(), n, impulse_of_z_);
        const Sparse W = theta_ * step_.body->delassus(step_.jump);
        const LcpMatrix of_impulse = rows_of_rate * W;
        step_.problem.M = matrix(n, n, coupling_) + LcpMatrix(of_impulse * step_.impulse_of_z);
        step_.problem.M.makeCompressed();
        step_.problem.q = known_ + rows_of_rate * (step_.jump * step_.body->free_rate()) + of_impulse * step_.known_impulse;
        return std::move(step_);
    }

private:
    void find_points() {
        points_.resize(model_.n_points());
        for (const FanPoint& at : model_.fan_points) {
            Point& point = points_[at.point];
            const auto velocity = [&](Index corner) -> Vec2 {
                return corner == rigid_support ? Vec2::Zero() : begin_.velocity[begin_.node_of_corner[corner]];
            };
            const Vec2 jump = velocity(at.after) - velocity(at.before);
            point = {.at = &at,
                     .law = &model_.laws[at.law],
                     .opening = opening(model_, begin_, at.point),
                     .rate = {at.normal.dot(jump), turned_left(at.normal).dot(jump)},
                     .cohesion = cohesion(model_, begin_, at.point),
                     .contact = {}};
            if (at.cracked || point.law->sigma_c == 0 || point.cohesion < bond_is_gone) point.cohesion = 0;
            point.contact = contact_bound_theta(point.opening.x(), point.rate.x(), point.law->restitution_at(point.cohesion), h_, theta_, touching_gap(model_, begin_, at));
        }
    }

    void lay_out() {
        StepLcpLayout& layout = step_.layout;
        layout.implicit_beta = implicit_beta_;
        for (const Interface& edge : model_.interfaces) {
            const CohesiveLaw& law = model_.laws[edge.law];
            if (!edge.cracked && !law.breakable()) continue;
            layout.friction = layout.friction || law.friction > 0;
            layout.tangential = layout.tangential || (!edge.cracked && law.sigma_c > 0 && law.gamma > 0);
        }
        const Eigen::VectorXd freedom = step_.body->freedom(step_.jump);
        for (Point& point : points_) {
            if (unbreakable(model_, *point.at)) continue;
            if (freedom[2 * point.at->point] < rounding) point.contact.may_touch = false;  // driven on both sides: no contact stops that
            if (point.contact.may_touch) layout.contacts.push_back(point.at->point);
            if (point.cohesion == 0) continue;
            layout.cohesive.push_back(point.at->point);
            const bool lands = !point.contact.may_touch || point.opening.x() + h_ * point.contact.rate < -rounding * point.law->delta_c();
            if (implicit_beta_ && lands) layout.landing.push_back(point.at->point);
        }
    }

    void make_jumps() {
        Triplets entries;
        for (const Point& point : points_) {
            if (unbreakable(model_, *point.at)) continue;
            const Vec2 axis[2] = {point.at->normal, turned_left(point.at->normal)};
            for (int d = 0; d < 2; ++d)
                for (int k = 0; k < 2; ++k) {
                    if (point.at->after != rigid_support) entries.emplace_back(2 * point.at->point + d, 2 * point.at->after + k, axis[d][k]);
                    if (point.at->before != rigid_support) entries.emplace_back(2 * point.at->point + d, 2 * point.at->before + k, -axis[d][k]);
                }
        }
        step_.jump.resize(2 * model_.n_points(), 2 * model_.mesh.n_corners());
        step_.jump.setFromTriplets(entries.begin(), entries.end());
    }

    void couple(int row, int column, double value) { coupling_.emplace_back(row, column, value); }
    /// Component d (0 normal, 1 tangential) of the rate of a point in a row, and of its impulse in an unknown.
    void take_rate(int row, Index point, int d, double factor) { rows_of_rate_.emplace_back(row, 2 * point + d, factor); }
    void give_impulse(int unknown, Index point, int d, double factor) { impulse_of_z_.emplace_back(2 * point + d, unknown, factor); }

    void add_cohesion() {
        const StepLcpLayout& at = step_.layout;
        for (int i = 0; i < at.m(); ++i) {
            const Index p = at.cohesive[i];
            const Point& point = points_[p];
            const double S = point.at->area, strength = point.law->sigma_c;
            const int bond = at.bond(i), beta = at.beta(i);
            couple(bond, beta, -theta_ / S);
            known_[bond] = theta_ * point.cohesion;
            couple(beta, bond, theta_ / S);
            couple(beta, beta, theta_ * strength * point.law->delta_c() / S);
            known_[beta] = -theta_ * strength * point.law->delta_c();
            if (at.tangential) couple(beta, at.offset(i), theta_ * strength * point.law->gamma);
            const auto landing = std::lower_bound(at.landing.begin(), at.landing.end(), p);
            if (landing != at.landing.end() && *landing == p) {
                const int o = at.opening(static_cast<int>(landing - at.landing.begin()));
                couple(beta, o, theta_ * strength);
                couple(o, o, 1);
                take_rate(o, p, 0, -h_);
                known_[o] = -point.opening.x();
            } else {
                take_rate(beta, p, 0, theta_ * strength * h_);
                known_[beta] += theta_ * strength * point.opening.x();
            }
            give_impulse(beta, p, 0, -h_ * strength * theta_);
            step_.known_impulse[2 * p] = -h_ * strength * (1 - theta_) * S * point.cohesion;
        }
    }

    void add_frozen_cohesion() {
        for (const Index p : step_.layout.cohesive)
            step_.known_impulse[2 * p] = -h_ * points_[p].at->area * points_[p].law->sigma_c * points_[p].cohesion;
    }

    void add_contacts() {
        const StepLcpLayout& at = step_.layout;
        for (int k = 0; k < at.c(); ++k) {
            const Index p = at.contacts[k];
            take_rate(at.normal(k), p, 0, 1);
            known_[at.normal(k)] = -points_[p].contact.rate;
            give_impulse(at.normal(k), p, 0, 1);
            if (!at.friction) continue;
            couple(at.slip_rate(k), at.normal(k), points_[p].law->friction);
            for (int side = 0; side < 2; ++side) {
                const double sign = side == 0 ? 1 : -1;
                take_rate(at.slip(k) + side, p, 1, sign);
                couple(at.slip(k) + side, at.slip_rate(k), 1);
                couple(at.slip_rate(k), at.slip(k) + side, -1);
                give_impulse(at.slip(k) + side, p, 1, sign);
            }
        }
    }

    void add_tangential_cohesion() {
        const StepLcpLayout& at = step_.layout;
        for (int i = 0; i < at.m(); ++i) {
            const Point& point = points_[at.cohesive[i]];
            const double traction = point.law->gamma * point.law->sigma_c, known_part = implicit_beta_ ? 1 - theta_ : 1;
            if (implicit_beta_) couple(at.offset(i), at.beta(i), theta_ * traction);
            known_[at.offset(i)] = traction * known_part * point.at->area * point.cohesion;
            for (int side = 0; side < 2; ++side) {
                const int row = at.tangent(i) + side;
                const double sign = side == 0 ? 1 : -1;
                take_rate(row, at.cohesive[i], 1, sign * h_);
                known_[row] = sign * point.opening.y();
                couple(row, at.offset(i), 1);
                couple(at.offset(i), row, -1);
                give_impulse(row, at.cohesive[i], 1, sign * h_);
            }
        }
    }

    const Model& model_;
    const State& begin_;
    double h_, theta_;
    bool implicit_beta_;
    std::vector<Point> points_;  // by their number
    Triplets rows_of_rate_, impulse_of_z_, coupling_;
    Eigen::VectorXd known_;
    StepLcp step_;
};

}  // namespace

StepLcp step_lcp(const Model& model, const State& begin, double h, const SchemeOptions& options) {
    return StepLcpMaker(model, begin, h, options).made();
}

StepLcpEnd recover(const StepLcp& step, const Model& model, const State& begin, double h, const Eigen::VectorXd& z) {
    const StepLcpLayout& at = step.layout;
    const Eigen::VectorXd P = step.impulse_of_z * z + step.known_impulse;
    const Eigen::VectorXd rate = step.body->rate(step.jump.transpose() * P);
    const Eigen::VectorXd velocity = step.body->end_velocity(rate), jump = step.jump * rate;
    StepLcpEnd end;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        end.rate.push_back(rate.segment<2>(2 * c));
        end.velocity.push_back(velocity.segment<2>(2 * c));
    }
    for (Index p = 0; p < model.n_points(); ++p) {
        const FanPoint& point = model.fan_points[model.fan_point_of[p]];
        const CohesiveLaw& law = model.laws[point.law];
        end.opening.push_back(opening(model, begin, p) + h * jump.segment<2>(2 * p));
        end.impulse.push_back(P.segment<2>(2 * p));
        const double before = cohesion(model, begin, p);
        if (unbreakable(model, point))
            end.cohesion.push_back(1);
        else if (point.cracked || law.sigma_c == 0 || before < bond_is_gone)
            end.cohesion.push_back(0);
        else
            end.cohesion.push_back(law.next_cohesion(before, end.opening[p].x(), end.opening[p].y()));
    }
    end.contact.assign(model.n_points(), 0);
    for (int k = 0; k < at.c(); ++k) end.contact[at.contacts[k]] = z[at.normal(k)];
    if (at.implicit_beta)
        for (int i = 0; i < at.m(); ++i)
            end.cohesion[at.cohesive[i]] = z[at.beta(i)] / model.fan_points[model.fan_point_of[at.cohesive[i]]].area;
    return end;
}

}  // namespace knap
