#include "stepper/implicit/implicit_bulk.hpp"

#include "base/room.hpp"
#include "element/triangle_matrices.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

ImplicitBulk::ImplicitBulk(const Model& model, const SchemeOptions& options)
    : model_(model), options_(options), forces_(model.mesh, model.materials, model.plane, model.thickness) {
    corner_stiffness_.resize(model.mesh.n_corners());
    const Index n = model.mesh.corners_per_triangle();
    for (Index t = 0; t < model.mesh.n_triangles(); ++t) {
        const ElementMatrix K = stiffness_matrix(model.mesh, t, model.materials[model.mesh.region[t]], model.plane, model.thickness);
        for (Index k = 0; k < n; ++k) corner_stiffness_[n * t + k] = 0.5 * (K(2 * k, 2 * k) + K(2 * k + 1, 2 * k + 1));
    }
    force_.resize(model.mesh.n_corners());
    make_room(model.mesh.n_corners(), partition_.corner_of_node, displacement_, velocity_, prescribed_, prescribed_rate_, prescribed_end_, moved_, end_, change_);
    make_room(model.histories.size(), amplitude_);
}

double ImplicitBulk::corner_mass(Index corner) const {
    if (options_.mass == MassMatrix::lumped) return model_.corner_mass[corner];
    const Index k = model_.mesh.place_in_triangle(corner);
    return mass_matrix(model_.mesh.order, options_.mass)(k, k) * model_.triangle_mass(model_.mesh.triangle_of(corner));
}

void ImplicitBulk::begin_step(const State& begin, double h) {
    begin_ = &begin;
    h_ = h;
    load_.assign(model_.mesh.n_corners(), Vec2::Zero());
    amplitude_.clear();
    for (const TimeFunction& history : model_.histories)
        amplitude_.push_back(options_.theta * history(begin.time + h) + (1 - options_.theta) * history(begin.time));
    for (const CornerLoad& load : model_.corner_loads) load_[load.corner] += amplitude_[load.history] * load.force;
}

void ImplicitBulk::set_partition(const CornerPartition& partition, std::vector<Vec2>& rate) {
    partition_ = partition;
    const Index n = partition.n_nodes();
    for (std::vector<Vec2>* of_node : {&displacement_, &velocity_, &rate}) of_node->resize(n);
    for (std::vector<Vec2>* of_node : {&prescribed_rate_, &prescribed_end_}) of_node->assign(n, Vec2::Zero());
    prescribed_.assign(n, {false, false});
    const double theta = options_.theta;
    for (Index i = 0; i < n; ++i) {
        const Index corner = partition.corner_of_node[i], node = begin_->node_of_corner[corner];
        displacement_[i] = begin_->displacement[node];
        velocity_[i] = rate[i] = begin_->velocity[node];
        const Index which = model_.prescribed_of_corner[corner];
        if (which < 0) continue;
        const PrescribedMotion& motion = model_.prescribed[which];
        for (int k = 0; k < 2; ++k) {
            if (!motion.component[k]) continue;
            prescribed_[i][k] = true;
            const PrescribedRate given = motion.rate(k, model_.histories, displacement_[i][k], {.begin = begin_->time, .h = h_, .theta = theta});
            rate[i][k] = prescribed_rate_[i][k] = given.rate;
            prescribed_end_[i][k] = given.end_velocity;
        }
    }
    for (const FanPoint& point : model_.fan_points) {  // glued to the support for good
        if ((point.before != rigid_support && point.after != rigid_support) || !unbreakable(model_, point)) continue;
        const Index node = partition.node_of_corner[point.before == rigid_support ? point.after : point.before];
        prescribed_[node] = {true, true};
        prescribed_rate_[node] = prescribed_end_[node] = rate[node] = Vec2::Zero();
    }
    // what the parts of the balance are made of: differences below their rounding mean nothing
    largest_impulse_ = 0;
    begin_force_.resize(force_.size());
    elastic(displacement_, begin_force_);
    for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
        const double momentum = model_.corner_mass[c] * velocity_[partition.node_of_corner[c]].norm();
        const double carried = velocity_[partition.node_of_corner[c]].norm() * theta * theta * h_ * h_ * corner_stiffness_[c];
        largest_impulse_ = std::max({largest_impulse_, momentum, theta * h_ * begin_force_[c].norm(), theta * h_ * load_[c].norm(), 1e-2 * carried});
    }
    for (Index i = 0; i < n; ++i) {
        const double moved = prescribed_[i][0] || prescribed_[i][1] ? prescribed_rate_[i].norm() : 0;
        const Index c = partition.corner_of_node[i];
        largest_impulse_ = std::max(largest_impulse_, moved * (model_.corner_mass[c] + theta * theta * h_ * h_ * corner_stiffness_[c]));
    }
}

Vec2 ImplicitBulk::end_velocity(Index node, const Vec2& rate) const {
    Vec2 end = (rate - (1 - options_.theta) * velocity_[node]) / options_.theta;
    for (int k = 0; k < 2; ++k)
        if (prescribed_[node][k]) end[k] = prescribed_end_[node][k];
    return end;
}

void ImplicitBulk::elastic(const std::vector<Vec2>& displacement, std::vector<Vec2>& force) const {
    forces_.evaluate(displacement, partition_.node_of_corner, force, unused_);
}

void ImplicitBulk::add_mass_times(const std::vector<Vec2>& of_node, double factor, std::vector<Vec2>& of_corner) const {
    const Index* node = partition_.node_of_corner.data();
    if (options_.mass == MassMatrix::lumped) {
        for (Index c = 0; c < model_.mesh.n_corners(); ++c) of_corner[c] += factor * model_.corner_mass[c] * of_node[node[c]];
        return;
    }
    const ElementMatrix& parts = mass_matrix(model_.mesh.order, options_.mass);
    const Index n = model_.mesh.corners_per_triangle();
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        const double m = factor * model_.triangle_mass(t);
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) of_corner[n * t + i] += parts(i, j) * m * of_node[node[n * t + j]];
    }
}

void ImplicitBulk::bulk_impulse(const std::vector<Vec2>& rate, std::vector<Vec2>& of_corner) const {
    const double theta = options_.theta;
    // K u and K w apart: what cancels in K u, of a body far from where it began, must not blur the equation of w
    elastic(rate, force_);
    of_corner.resize(force_.size());
    for (std::size_t c = 0; c < force_.size(); ++c) of_corner[c] = -theta * h_ * (begin_force_[c] + load_[c] + theta * h_ * force_[c]);
    moved_.resize(rate.size());
    for (std::size_t i = 0; i < rate.size(); ++i)
        moved_[i] = prescribed_[i][0] || prescribed_[i][1] ? Vec2(theta * (end_velocity(static_cast<Index>(i), rate[i]) - velocity_[i]))
                                                           : Vec2(rate[i] - velocity_[i]);
    add_mass_times(moved_, 1, of_corner);
}

void ImplicitBulk::sum_to_nodes(const std::vector<Vec2>& of_corner, std::vector<Vec2>& of_node) const {
    of_node.assign(partition_.n_nodes(), Vec2::Zero());
    for (std::size_t c = 0; c < of_corner.size(); ++c) of_node[partition_.node_of_corner[c]] += of_corner[c];
}

void ImplicitBulk::apply_matrix(const std::vector<Vec2>& direction, std::vector<Vec2>& of_node) const {
    elastic(direction, force_);
    for (Vec2& f : force_) f *= -options_.theta * options_.theta * h_ * h_;
    add_mass_times(direction, 1, force_);
    sum_to_nodes(force_, of_node);
}

void ImplicitBulk::account(const std::vector<Vec2>& rate, const std::vector<Vec2>& residual_impulse, StepReport& report) const {
    const double theta = options_.theta;
    const Index n = partition_.n_nodes();
    const auto half_product = [&](const std::vector<Vec2>& of_corner, const std::vector<Vec2>& of_node) {
        double sum = 0;
        for (std::size_t c = 0; c < of_corner.size(); ++c) sum += 0.5 * of_corner[c].dot(of_node[partition_.node_of_corner[c]]);
        return sum;
    };
    std::vector<Vec2>&end = end_, &change = change_, &momentum = momentum_;
    end.resize(n), change.resize(n);
    momentum.assign(force_.size(), Vec2::Zero());
    for (Index i = 0; i < n; ++i) {
        end[i] = end_velocity(i, rate[i]);
        change[i] = end[i] - velocity_[i];
        moved_[i] = displacement_[i] + h_ * rate[i];
        report.largest_speed = std::max(report.largest_speed, end[i].norm());
    }
    add_mass_times(end, 1, momentum);
    report.kinetic += half_product(momentum, end);
    elastic(moved_, force_);
    report.strain -= half_product(force_, moved_);

    momentum.assign(force_.size(), Vec2::Zero());
    add_mass_times(change, 1, momentum);
    if (theta > 0.5) {
        report.scheme_dissipation += 2 * (theta - 0.5) * half_product(momentum, change);
        for (Index i = 0; i < n; ++i) moved_[i] = h_ * rate[i];
        elastic(moved_, force_);
        report.scheme_dissipation -= 2 * (theta - 0.5) * half_product(force_, moved_);
    }
    for (std::size_t c = 0; c < load_.size(); ++c) report.external_work += h_ * load_[c].dot(rate[partition_.node_of_corner[c]]);

    // what is prescribed works with its reaction; where its end velocity is not the theta scheme's, it also does the work on the mass
    std::vector<Vec2>& gained = moved_;
    sum_to_nodes(momentum, gained);
    for (Index i = 0; i < n; ++i)
        for (int k = 0; k < 2; ++k) {
            if (!prescribed_[i][k]) continue;
            const double beside = rate[i][k] - 0.5 * (end[i][k] + velocity_[i][k]) - (theta - 0.5) * change[i][k];
            report.external_work += residual_impulse[i][k] / theta * rate[i][k] - beside * gained[i][k];
        }
}

}  // namespace knap
