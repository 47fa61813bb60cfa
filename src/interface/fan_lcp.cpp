#include "interface/fan_lcp.hpp"

#include "lcp/solvers.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

const FanLcpSolution& FanLcp::solve(const FanProblem& problem, const std::vector<InterfaceLaw>& laws, double speed) {
    problem_ = &problem;
    make_clusters();
    make_rows(laws, speed);
    const int n = static_cast<int>(rows_.size());
    M_.resize(n * n);
    for (std::vector<double>* list : {&q_, &z_, &w_}) list->resize(n);
    Eigen::Map<Eigen::MatrixXd> M(M_.data(), n, n);
    Eigen::Map<Eigen::VectorXd> q(q_.data(), n), z(z_.data(), n), w(w_.data(), n);
    for (int i = 0; i < n; ++i) {
        q[i] = constant(i);
        for (int j = 0; j < n; ++j) M(i, j) = coefficient(i, j);
    }
    found_.residual = 0;
    found_.solved = solve_lcp_by_lemke(M, q, z);
    if (!found_.solved) return found_;
    w.noalias() = M * z;
    w += q;
    if (n > 0) found_.residual = w.cwiseMin(z).cwiseAbs().maxCoeff();
    find_motion(z);
    return found_;
}

void FanLcp::make_clusters() {
    const Index n = static_cast<Index>(problem_->bodies.size());
    cluster_.clear();
    for (Index b = 0; b <= n; ++b) cluster_.push_back(b);
    for (const FanLink& link : problem_->links)
        if (link.unbreakable) {
            const Index a = cluster_of(link.before), b = cluster_of(link.after);
            std::replace(cluster_.begin(), cluster_.end(), std::min(a, b), std::max(a, b));
        }
    for (std::vector<Vec2>* list : {&mass_, &inverse_mass_, &free_velocity_}) list->assign(n + 1, Vec2::Zero());
    for (int k = 0; k < 2; ++k) {
        for (Index b = 0; b < n; ++b) {
            const FanBody& body = problem_->bodies[b];
            if (body.inverse_mass[k] == 0) continue;
            mass_[cluster_[b]][k] += 1 / body.inverse_mass[k];
            free_velocity_[cluster_[b]][k] += body.free_velocity[k] / body.inverse_mass[k];
        }
        for (Index c = 0; c < n; ++c) {
            if (mass_[c][k] == 0) continue;
            inverse_mass_[c][k] = 1 / mass_[c][k];
            free_velocity_[c][k] *= inverse_mass_[c][k];
        }
        for (Index b = 0; b < n; ++b)  // what is prescribed rules its cluster, and so does the support
            if (problem_->bodies[b].inverse_mass[k] == 0) {
                inverse_mass_[cluster_[b]][k] = 0;
                free_velocity_[cluster_[b]][k] = problem_->bodies[b].free_velocity[k];
            }
        inverse_mass_[cluster_[n]][k] = free_velocity_[cluster_[n]][k] = 0;
    }
}

void FanLcp::make_rows(const std::vector<InterfaceLaw>& laws, double speed) {
    double mass = 0;  // [kg] largest of the links
    unit_.assign(problem_->links.size(), 0.0);
    rows_.clear();
    for (Index i = 0; i < static_cast<Index>(problem_->links.size()); ++i) {
        const FanLink& link = problem_->links[i];
        if (link.unbreakable) continue;
        const Vec2 w = inverse_mass_[cluster_of(link.after)] + inverse_mass_[cluster_of(link.before)];
        unit_[i] = w.sum() > 0 ? std::sqrt(2 / w.sum()) : 1;
        mass = std::max(mass, unit_[i] * unit_[i]);
        if (laws[i].may_touch()) rows_.push_back({Row::Kind::contact, i, laws[i].bound(), 0, 0});
        for (const Staircase::Kink& kink : laws[i].staircase(laws[i].may_touch()).kinks()) {
            rows_.push_back({Row::Kind::forward, i, kink.rate, kink.cohesive, kink.friction});
            rows_.push_back({Row::Kind::backward, i, kink.rate, kink.cohesive, kink.friction});
            rows_.push_back({Row::Kind::slack, i, kink.rate, kink.cohesive, kink.friction});
        }
    }
    speed_ = speed * std::sqrt(mass);
}

void FanLcp::find_motion(const Eigen::Ref<const Eigen::VectorXd>& z) {
    const std::vector<FanLink>& links = problem_->links;
    std::vector<Vec2>& impulse = found_.impulse;
    impulse.assign(links.size(), Vec2::Zero());
    for (std::size_t i = 0; i < links.size(); ++i) impulse[i] = -links[i].cohesive * links[i].normal;
    for (int i = 0; i < static_cast<int>(rows_.size()); ++i)
        if (rows_[i].kind != Row::Kind::slack) impulse[rows_[i].link] += speed_ * unit_[rows_[i].link] * z[i] * direction(i);
    std::vector<Vec2>& velocity = mass_;  // of the clusters
    velocity = free_velocity_;
    for (std::size_t i = 0; i < links.size(); ++i) {
        const Index after = cluster_of(links[i].after), before = cluster_of(links[i].before);
        velocity[after] += inverse_mass_[after].cwiseProduct(impulse[i]);
        velocity[before] -= inverse_mass_[before].cwiseProduct(impulse[i]);
    }
    found_.velocity.clear();
    for (std::size_t b = 0; b < problem_->bodies.size(); ++b) found_.velocity.push_back(velocity[cluster_[b]]);
}

Vec2 FanLcp::direction(int row) const {
    const Vec2 normal = link(row).normal;
    if (rows_[row].kind == Row::Kind::contact) return normal;
    return rows_[row].kind == Row::Kind::forward ? turned_left(normal) : Vec2(-turned_left(normal));
}

/// a . V of the link of row i for an impulse at link j
double FanLcp::response(Index i, const Vec2& a, Index j, const Vec2& impulse) const {
    const Index after = cluster_of(problem_->links[i].after), before = cluster_of(problem_->links[i].before);
    Vec2 velocity = Vec2::Zero();
    const auto add = [&](Index cluster, double sign) {
        if (cluster == after) velocity += sign * inverse_mass_[cluster].cwiseProduct(impulse);
        if (cluster == before) velocity -= sign * inverse_mass_[cluster].cwiseProduct(impulse);
    };
    add(cluster_of(problem_->links[j].after), 1);
    add(cluster_of(problem_->links[j].before), -1);
    return a.dot(velocity);
}

double FanLcp::coefficient(int i, int j) const {
    const Row &row = rows_[i], &column = rows_[j];
    const bool same_sign = row.link == column.link && row.velocity == column.velocity && column.kind != Row::Kind::contact;
    if (row.kind == Row::Kind::slack) {
        if (column.kind == Row::Kind::slack || row.link != column.link) return 0;
        if (column.kind == Row::Kind::contact) return row.of_contact;
        return same_sign ? -1 : 0;
    }
    if (column.kind == Row::Kind::slack) return same_sign && row.kind != Row::Kind::contact ? 1 : 0;
    return unit_[row.link] * unit_[column.link] * response(row.link, direction(i), column.link, direction(j));
}

double FanLcp::constant(int i) const {
    const Row& row = rows_[i];
    const double unit = unit_[row.link];
    if (row.kind == Row::Kind::slack) return row.weight / (speed_ * unit);
    const Vec2 a = direction(i);
    double velocity = a.dot(free_velocity_[cluster_of(link(i).after)] - free_velocity_[cluster_of(link(i).before)]);
    for (Index j = 0; j < static_cast<Index>(problem_->links.size()); ++j)
        velocity += response(row.link, a, j, -problem_->links[j].cohesive * problem_->links[j].normal);
    return unit * (velocity - (row.kind == Row::Kind::backward ? -1 : 1) * row.velocity) / speed_;
}

}  // namespace knap
