#include "stepper/implicit/step_lcp_body.hpp"

#include "base/union_find.hpp"
#include "element/triangle_matrices.hpp"

#include <cmath>
#include <numeric>

namespace knap {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

PartedBody::Matrix stiffness_of_corners(const Model& model) {
    Triplets entries;
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const ElementMatrix K = stiffness_matrix(model.mesh, t, model.materials[model.mesh.region[t]], model.plane, model.thickness);
        const Index n = static_cast<Index>(K.rows());
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) entries.emplace_back(n * t + i, n * t + j, K(i, j));
    }
    PartedBody::Matrix K(2 * model.mesh.n_corners(), 2 * model.mesh.n_corners());
    K.setFromTriplets(entries.begin(), entries.end());
    return K;
}

PartedBody::Matrix mass_of_corners(const Model& model, MassMatrix kind) {
    Triplets entries;
    const ElementMatrix& parts = mass_matrix(model.mesh.order, kind);
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t)
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) {
                if (parts(i, j) == 0) continue;
                for (Index k = 0; k < 2; ++k) entries.emplace_back(2 * (n * t + i) + k, 2 * (n * t + j) + k, parts(i, j) * model.triangle_mass(t));
            }
    PartedBody::Matrix M(2 * model.mesh.n_corners(), 2 * model.mesh.n_corners());
    M.setFromTriplets(entries.begin(), entries.end());
    return M;
}

Eigen::VectorXd of_corners(const State& state, const std::vector<Vec2>& of_node) {
    Eigen::VectorXd all(2 * state.node_of_corner.size());
    for (std::size_t c = 0; c < state.node_of_corner.size(); ++c) all.segment<2>(2 * c) = of_node[state.node_of_corner[c]];
    return all;
}

/// [N] F_theta
Eigen::VectorXd load(const Model& model, double time, double h, double theta) {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * model.mesh.n_corners());
    for (const CornerLoad& load : model.corner_loads) {
        const TimeFunction& history = model.histories[load.history];
        force.segment<2>(2 * load.corner) += (theta * history(time + h) + (1 - theta) * history(time)) * load.force;
    }
    return force;
}

}  // namespace

PartedBody::PartedBody(const Model& model, const State& begin, double h, const SchemeOptions& options)
    : theta_(options.theta), velocity_(of_corners(begin, begin.velocity)) {
    join(model);
    prescribe(model, begin, h, theta_);
    number_unknowns();
    const Matrix M = mass_of_corners(model, options.mass), K = stiffness_of_corners(model);
    const double k = theta_ * h;
    factorise(M + k * k * K);

    // known components change their velocity by v+ - v and their displacement by h w, whatever w and v+ have to do with each other
    Eigen::VectorXd inertia = velocity_;
    for (Eigen::Index i = 0; i < inertia.size(); ++i)
        if (is_known_[i]) inertia[i] = -theta_ * (known_velocity_[i] - velocity_[i]);
    const Eigen::VectorXd displacement = of_corners(begin, begin.displacement);
    free_rate_ = known_rate_ + response(M * inertia - k * (K * (displacement + k * known_rate_)) + k * load(model, begin.time, h, theta_));
}

void PartedBody::join(const Model& model) {
    UnionFind corners(model.mesh.n_corners() + 1), triangles(model.mesh.n_triangles());  // the last corner stands for the support
    const auto member = [&](Index corner) { return corner == rigid_support ? model.mesh.n_corners() : corner; };
    for (const FanPoint& point : model.fan_points) {
        if (point.cracked || model.laws[point.law].breakable()) continue;
        corners.join(member(point.before), member(point.after));
        if (point.before != rigid_support && point.after != rigid_support) triangles.join(model.mesh.triangle_of(point.before), model.mesh.triangle_of(point.after));
    }
    leader_.resize(model.mesh.n_corners());
    part_of_triangle_.resize(model.mesh.n_triangles());
    const Index support = corners.find(model.mesh.n_corners());
    for (Index c = 0; c < model.mesh.n_corners(); ++c) leader_[c] = corners.find(c) == support ? rigid_support : corners.find(c);
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) part_of_triangle_[t] = triangles.find(t);
}

void PartedBody::prescribe(const Model& model, const State& begin, double h, double theta) {
    const Index n = 2 * model.mesh.n_corners();
    is_known_.assign(n, 0);
    known_rate_ = known_velocity_ = Eigen::VectorXd::Zero(n);
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        if (leader_[c] == rigid_support) is_known_[2 * c] = is_known_[2 * c + 1] = 1;
        if (leader_[c] == rigid_support || model.prescribed.empty() || model.prescribed_of_corner[c] < 0) continue;
        const PrescribedMotion& motion = model.prescribed[model.prescribed_of_corner[c]];
        for (Index k = 0; k < 2; ++k) {
            if (!motion.component[k]) continue;
            const Index i = 2 * leader_[c] + k;  // prescribed components propagate to all joined corners
            const double displacement = begin.displacement[begin.node_of_corner[c]][k];
            const PrescribedRate given = motion.rate(k, model.histories, displacement, {.begin = begin.time, .h = h, .theta = theta});
            is_known_[i] = 1;
            known_rate_[i] = given.rate;
            known_velocity_[i] = given.end_velocity;
        }
    }
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        if (leader_[c] == rigid_support) continue;
        for (Index k = 0; k < 2; ++k) {
            const Index i = 2 * c + k, from = 2 * leader_[c] + k;
            is_known_[i] = is_known_[from];
            known_rate_[i] = known_rate_[from];
            known_velocity_[i] = known_velocity_[from];
        }
    }
}

void PartedBody::number_unknowns() {
    std::vector<Index> order(part_of_triangle_.size());  // part by part
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return part_of_triangle_[a] < part_of_triangle_[b]; });
    std::vector<Eigen::Index> number(is_known_.size(), -1);
    const Index n_per_triangle = static_cast<Index>(is_known_.size() / part_of_triangle_.size());
    Eigen::Index n = 0, last_part = -1;
    Triplets entries;
    for (const Index t : order) {
        if (part_of_triangle_[t] != last_part) parts_.emplace_back().first = n;
        last_part = part_of_triangle_[t];
        for (Index i = n_per_triangle * t; i < n_per_triangle * (t + 1); ++i) {
            if (is_known_[i]) continue;
            Eigen::Index& unknown = number[2 * leader_[i / 2] + i % 2];
            if (unknown < 0) unknown = n++;
            entries.emplace_back(i, unknown, 1.0);
        }
        parts_.back().n = n - parts_.back().first;
    }
    expand_.resize(is_known_.size(), n);
    expand_.setFromTriplets(entries.begin(), entries.end());
}

void PartedBody::factorise(const Matrix& M_hat) {
    const Matrix all = expand_.transpose() * M_hat * expand_;
    for (Part& part : parts_)
        if (part.n > 0) part.factor.compute(all.block(part.first, part.first, part.n, part.n));
}

Eigen::VectorXd PartedBody::freedom(const Matrix& H) const {
    const Matrix on_unknowns = H * expand_;
    return (on_unknowns.cwiseProduct(on_unknowns) * Eigen::VectorXd::Ones(on_unknowns.cols())).cwiseSqrt();
}

PartedBody::Matrix PartedBody::delassus(const Matrix& H) const {
    const Matrix on_unknowns = H * expand_;
    Triplets entries;
    std::vector<Eigen::Index> place(H.rows(), -1);
    for (const Part& part : parts_) {
        std::vector<Eigen::Index> jumps;  // that this part takes part in
        for (Eigen::Index j = part.first; j < part.first + part.n; ++j)
            for (Matrix::InnerIterator entry(on_unknowns, j); entry; ++entry) {
                Eigen::Index& at = place[entry.row()];
                if (at >= 0) continue;
                at = static_cast<Eigen::Index>(jumps.size());
                jumps.push_back(entry.row());
            }
        const Eigen::Index n = static_cast<Eigen::Index>(jumps.size());
        Eigen::MatrixXd H_part = Eigen::MatrixXd::Zero(n, part.n);
        for (Eigen::Index j = 0; j < part.n; ++j)
            for (Matrix::InnerIterator entry(on_unknowns, part.first + j); entry; ++entry) H_part(place[entry.row()], j) = entry.value();
        for (const Eigen::Index jump : jumps) place[jump] = -1;
        if (n == 0) continue;
        const Eigen::MatrixXd W = H_part * part.factor.solve(H_part.transpose());
        for (Eigen::Index i = 0; i < n; ++i)
            for (Eigen::Index j = 0; j < n; ++j) entries.emplace_back(jumps[i], jumps[j], 0.5 * (W(i, j) + W(j, i)));
    }
    Matrix W(H.rows(), H.rows());
    W.setFromTriplets(entries.begin(), entries.end());
    return W;
}

Eigen::VectorXd PartedBody::response(const Eigen::VectorXd& impulse) const {
    const Eigen::VectorXd b = expand_.transpose() * impulse;
    Eigen::VectorXd x(b.size());
    for (const Part& part : parts_)
        if (part.n > 0) x.segment(part.first, part.n) = part.factor.solve(b.segment(part.first, part.n));
    return expand_ * x;
}

Eigen::VectorXd PartedBody::end_velocity(const Eigen::VectorXd& rate) const {
    Eigen::VectorXd end = (rate - (1 - theta_) * velocity_) / theta_;
    for (Eigen::Index i = 0; i < end.size(); ++i)
        if (is_known_[i]) end[i] = known_velocity_[i];
    return end;
}

}  // namespace knap
