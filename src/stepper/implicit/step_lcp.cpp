#include "stepper/implicit/step_lcp.hpp"

#include "base/union_find.hpp"
#include "lcp/scaling.hpp"
#include "lcp/solvers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace knap {
namespace {

constexpr double rounding = 1e-12;  // [-] relative

}  // namespace

StepLcp::StepLcp(const Model& model, const State& begin, double h, const SchemeOptions& options)
    : model_(model),
      step_{{.h = h, .theta = options.theta, .implicit_beta = options.cohesion == CohesionScheme::implicit_beta},
            &begin},
      bulk_(model, options.mass) {
    partition_corners(model, std::vector<std::uint8_t>(model.fans.size(), 1), nodes_);
    bulk_.begin_step(step_);
    factorise(options.mass);
    make_points();
    lay_out();

    const int n = size_, n_jumps = 2 * model.n_points();
    constant_ = Eigen::VectorXd::Zero(n);
    known_impulse_ = Eigen::VectorXd::Zero(n_jumps);
    add_cohesion();
    add_contacts();
    if (tangential_) add_tangential_cohesion();

    // rows = rows_of_rate (H w_free + theta W P) + coupling z + constant
    const auto matrix = [](Eigen::Index rows, Eigen::Index columns, const Triplets& entries) {
        LcpMatrix made(rows, columns);
        made.setFromTriplets(entries.begin(), entries.end());
        return made;
    };
    Eigen::VectorXd free_jump(n_jumps);
    for (Index p = 0; p < model.n_points(); ++p) free_jump.segment<2>(2 * p) = points_[p].across(free_rate_);
    const LcpMatrix rows_of_rate = matrix(n, n_jumps, rows_of_rate_);
    impulse_of_z_ = matrix(n_jumps, n, impulse_of_unknown_);
    const Matrix W = step_.theta * delassus();
    const LcpMatrix of_impulse = rows_of_rate * W;
    problem_.M = matrix(n, n, coupling_) + LcpMatrix(of_impulse * impulse_of_z_);
    problem_.M.makeCompressed();
    problem_.q = constant_ + rows_of_rate * free_jump + of_impulse * known_impulse_;
}

void StepLcp::factorise(MassMatrix mass) {
    const Index n = model_.mesh.corners_per_triangle();
    const auto node = [&](Index triangle, Index k) { return nodes_.node_of_corner[n * triangle + k]; };
    UnionFind parts(nodes_.n_nodes());
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
        for (Index k = 1; k < n; ++k) parts.join(node(t, 0), node(t, k));
    std::vector<Index> order(nodes_.n_nodes());  // part by part
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](Index i) { return parts.find(i); });
    unknown_.assign(2 * nodes_.n_nodes(), -1);
    Index n_unknowns = 0;
    for (const Index i : order) {
        if (parts.find(i) == i) parts_.emplace_back().first = n_unknowns;
        for (int k = 0; k < 2; ++k)
            if (!nodes_.prescribed[i][k]) unknown_[2 * i + k] = n_unknowns++;
        parts_.back().n = n_unknowns - parts_.back().first;
    }

    Triplets entries;
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        const ElementMatrix M_hat = theta_element(model_, t, step_.stiffness_factor(), mass);
        for (Index i = 0; i < 2 * n; ++i)
            for (Index j = 0; j < 2 * n; ++j) {
                const Index row = unknown_[2 * node(t, i / 2) + i % 2], column = unknown_[2 * node(t, j / 2) + j % 2];
                if (row >= 0 && column >= 0) entries.emplace_back(row, column, M_hat(i, j));
            }
    }
    Matrix M_hat(n_unknowns, n_unknowns);
    M_hat.setFromTriplets(entries.begin(), entries.end());
    for (Part& part : parts_)
        if (part.n > 0) part.factor.compute(M_hat.block(part.first, part.first, part.n, part.n));

    // w_free = w_0 - M_hat^-1 r(w_0) with the prescribed rates in w_0
    std::vector<Vec2> of_corner, of_node;
    bulk_.set_nodes(nodes_, std::vector<Vec2>(model_.mesh.n_corners(), Vec2::Zero()), free_rate_);
    bulk_.impulse(free_rate_, of_corner);
    bulk_.sum_to_nodes(of_corner, of_node);
    Eigen::VectorXd needed(n_unknowns);
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) needed[unknown_[i]] = of_node[i / 2][i % 2];
    const Eigen::VectorXd change = response(needed);
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) free_rate_[i / 2][i % 2] -= change[unknown_[i]];
}

void StepLcp::make_points() {
    points_.resize(model_.n_points());
    Triplets entries;
    for (std::size_t f = 0; f < model_.fans.size(); ++f)
        for (Index j = 0; j < model_.fans[f].n_points; ++j) {
            const Index i = model_.fans[f].first_point + j, p = model_.fan_points[i].point;
            points_[p] = interface_point(model_, step_, nodes_, static_cast<Index>(f), i);
            if (unbreakable(model_, model_.fan_points[i])) continue;
            const Vec2 axis[2] = {points_[p].normal, turned_left(points_[p].normal)};
            points_[p].sides.for_each_node([&](Index node, double weight) {
                for (int d = 0; d < 2; ++d)
                    for (int k = 0; k < 2; ++k)
                        if (const Index u = unknown_[2 * node + k]; u >= 0)
                            entries.emplace_back(2 * p + d, u, weight * axis[d][k]);
            });
        }
    H_.resize(2 * model_.n_points(), static_cast<Index>(parts_.back().first + parts_.back().n));
    H_.setFromTriplets(entries.begin(), entries.end());
}

void StepLcp::lay_out() {
    for (const FanPoint& at : model_.fan_points) {
        const CohesiveLaw& law = model_.laws[at.law];
        if (unbreakable(model_, at)) continue;
        friction_ = friction_ || law.friction > 0;
        tangential_ = tangential_ || (!at.cracked && law.sigma_c > 0 && law.gamma > 0);
    }
    for (Index p = 0; p < model_.n_points(); ++p) {
        const PointLaw& law = points_[p].law;
        if (unbreakable(model_, model_.fan_points[points_[p].sides.fan_point])) continue;
        if (law.contact.may_touch) contacts_.push_back(p);
        if (law.cohesion == 0) continue;
        cohesive_.push_back(p);
        const double end_at_bound = law.u_N + step_.h * law.contact.rate;
        const bool lands = !law.contact.may_touch || end_at_bound < -rounding * law.material->delta_c();
        if (step_.implicit_beta && lands) landing_.push_back(p);
    }
    const auto group = [&](std::size_t n) { return std::exchange(size_, size_ + static_cast<int>(n)); };
    const std::size_t m = cohesive_.size(), c = contacts_.size();
    loss_ = group(step_.implicit_beta ? m : 0);
    beta_ = group(step_.implicit_beta ? m : 0);
    normal_ = group(c);
    slip_ = group(friction_ ? 2 * c : 0);
    slip_rate_ = group(friction_ ? c : 0);
    tangent_ = group(tangential_ ? 2 * m : 0);
    offset_ = group(tangential_ ? m : 0);
    opening_ = group(landing_.size());
}

/// Two unknowns r+, r- >= 0 of a tangential force r+ - r-, with |r| <= the bound whose row is `bound`; rows: the
/// unknown of that row plus and minus (factor w_T + constant).
void StepLcp::add_sign(int first, int bound, Index point, double factor, double constant) {
    for (const int sign : {1, -1}) {
        const int row = first + (sign < 0);
        rows_of_rate_.emplace_back(row, 2 * point + 1, sign * factor);
        constant_[row] = sign * constant;
        coupling_.emplace_back(row, bound, 1);
        coupling_.emplace_back(bound, row, -1);
        impulse_of_unknown_.emplace_back(2 * point + 1, row, sign * factor);
    }
}

void StepLcp::add_cohesion() {
    const double theta = step_.theta, h = step_.h;
    for (int i = 0; i < static_cast<int>(cohesive_.size()); ++i) {
        const Index p = cohesive_[i];
        const PointLaw& law = points_[p].law;
        const double S = model_.fan_points[points_[p].sides.fan_point].area, strength = law.material->sigma_c;
        if (!step_.implicit_beta) {
            known_impulse_[2 * p] = -h * S * strength * law.cohesion;
            continue;
        }
        const int loss = loss_ + i, beta = beta_ + i;
        coupling_.emplace_back(loss, beta, -theta / S);
        constant_[loss] = theta * law.cohesion;
        coupling_.emplace_back(beta, loss, theta / S);
        coupling_.emplace_back(beta, beta, theta * strength * law.material->delta_c() / S);
        constant_[beta] = -theta * strength * law.material->delta_c();
        if (tangential_) coupling_.emplace_back(beta, offset_ + i, theta * strength * law.material->gamma);
        const auto landing = std::ranges::lower_bound(landing_, p);
        if (landing != landing_.end() && *landing == p) {
            const int o = opening_ + static_cast<int>(landing - landing_.begin());
            coupling_.emplace_back(beta, o, theta * strength);
            coupling_.emplace_back(o, o, 1);
            rows_of_rate_.emplace_back(o, 2 * p, -h);
            constant_[o] = -law.u_N;
        } else {
            rows_of_rate_.emplace_back(beta, 2 * p, theta * strength * h);
            constant_[beta] += theta * strength * law.u_N;
        }
        impulse_of_unknown_.emplace_back(2 * p, beta, -h * strength * theta);
        known_impulse_[2 * p] = -h * strength * (1 - theta) * S * law.cohesion;
    }
}

void StepLcp::add_contacts() {
    for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) {
        const Index p = contacts_[k];
        rows_of_rate_.emplace_back(normal_ + k, 2 * p, 1);
        constant_[normal_ + k] = -points_[p].law.contact.rate;
        impulse_of_unknown_.emplace_back(2 * p, normal_ + k, 1);
        if (!friction_) continue;
        coupling_.emplace_back(slip_rate_ + k, normal_ + k, points_[p].law.friction);
        add_sign(slip_ + 2 * k, slip_rate_ + k, p, 1, 0);
    }
}

void StepLcp::add_tangential_cohesion() {
    for (int i = 0; i < static_cast<int>(cohesive_.size()); ++i) {
        const Index p = cohesive_[i];
        const PointLaw& law = points_[p].law;
        const double S = model_.fan_points[points_[p].sides.fan_point].area;
        const double traction = law.material->gamma * law.material->sigma_c;
        if (step_.implicit_beta) coupling_.emplace_back(offset_ + i, beta_ + i, step_.theta * traction);
        constant_[offset_ + i] = traction * (step_.implicit_beta ? 1 - step_.theta : 1) * S * law.cohesion;
        add_sign(tangent_ + 2 * i, offset_ + i, p, step_.h, law.u_T);
    }
}

StepLcp::Matrix StepLcp::delassus() const {
    Triplets entries;
    std::vector<Index> place(H_.rows(), -1);
    for (const Part& part : parts_) {
        std::vector<Index> jumps;  // of this part
        for (Eigen::Index j = part.first; j < part.first + part.n; ++j)
            for (Matrix::InnerIterator entry(H_, j); entry; ++entry)
                if (Index& at = place[entry.row()]; at < 0)
                    at = static_cast<Index>(jumps.size()), jumps.push_back(static_cast<Index>(entry.row()));
        const Index n = static_cast<Index>(jumps.size());
        Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, part.n);
        for (Eigen::Index j = 0; j < part.n; ++j)
            for (Matrix::InnerIterator entry(H_, part.first + j); entry; ++entry)
                H(place[entry.row()], j) = entry.value();
        for (const Index jump : jumps) place[jump] = -1;
        if (n == 0) continue;
        const Eigen::MatrixXd W = H * part.factor.solve(H.transpose());
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) entries.emplace_back(jumps[i], jumps[j], 0.5 * (W(i, j) + W(j, i)));
    }
    Matrix W(H_.rows(), H_.rows());
    W.setFromTriplets(entries.begin(), entries.end());
    return W;
}

Eigen::VectorXd StepLcp::response(const Eigen::VectorXd& impulse) const {
    Eigen::VectorXd x(impulse.size());
    for (const Part& part : parts_)
        if (part.n > 0) x.segment(part.first, part.n) = part.factor.solve(impulse.segment(part.first, part.n));
    return x;
}

StepLcpEnd StepLcp::end(const Eigen::VectorXd& z) const {
    const Eigen::VectorXd P = impulse_of_z_ * z + known_impulse_, change = response(H_.transpose() * P);
    std::vector<Vec2> rate = free_rate_;
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) rate[i / 2][i % 2] += step_.theta * change[unknown_[i]];
    StepLcpEnd end;
    for (const Index node : nodes_.node_of_corner) {
        end.rate.push_back(Vec2(rate[node]));
        end.velocity.push_back(bulk_.end_velocity(node, rate[node]));
    }
    for (Index p = 0; p < model_.n_points(); ++p) {
        const PointLaw& law = points_[p].law;
        const Vec2 u = Vec2(law.u_N, law.u_T) + step_.h * points_[p].across(rate);
        const bool breaks = !unbreakable(model_, model_.fan_points[points_[p].sides.fan_point]);
        end.opening.push_back(u);
        end.impulse.push_back(P.segment<2>(2 * p));
        end.cohesion.push_back(breaks ? law.material->next_cohesion(law.cohesion, u.x(), u.y()) : 1);
    }
    end.contact.assign(model_.n_points(), 0);
    for (int k = 0; k < static_cast<int>(contacts_.size()); ++k) end.contact[contacts_[k]] = z[normal_ + k];
    for (int i = 0; i < static_cast<int>(cohesive_.size()) && step_.implicit_beta; ++i)
        end.cohesion[cohesive_[i]] = z[beta_ + i] / model_.fan_points[points_[cohesive_[i]].sides.fan_point].area;
    return end;
}

std::optional<StepLcpEnd> StepLcp::solve() const {
    const ScaledLcp scaled = equilibrated(problem_);
    const LcpSolution found = solve_by_default(scaled.problem, {.exhaustive = false});
    if (found.status != LcpStatus::solved) return std::nullopt;
    return end(scaled.original_z(found.z));
}

}  // namespace knap
