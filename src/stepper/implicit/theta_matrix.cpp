#include "stepper/implicit/theta_matrix.hpp"

#include "base/reserve_capacity.hpp"
#include "stepper/implicit/implicit_bulk.hpp"

#include <algorithm>
#include <cmath>

namespace knap {

ThetaMatrix::ThetaMatrix(const Model& model, MassMatrix mass)
    : model_(model),
      mass_(mass),
      dissection_(dissect(model)),
      factor_(dissection_, 2 * static_cast<std::size_t>(model.mesh.n_corners())),
      points_of_leaf_(dissection_.parts.size(),
                      [&](const auto& visit) {
                          const Index n = static_cast<Index>(model.fan_points.size());
                          for (Index i = 0; i < n; ++i) visit(leaf_of_point(i), i);
                      }),
      eliminated_in_(2 * model.mesh.n_corners(), -1),
      block_(model.fan_points.size(), Eigen::Matrix2d::Zero()),
      kept_(model.fan_points.size(), 0),
      is_part_of_friction_(dissection_.parts.size(), 0),
      x_(2 * model.mesh.n_corners(), 0) {
    reserve_capacity(model.fan_points.size(), with_block_, friction_);
    parts_of_friction_.reserve(dissection_.parts.size());
}

Index ThetaMatrix::leaf_of_point(Index fan_point) const {
    const FanPoint& at = model_.fan_points[fan_point];
    return leaf_of_corner(at.before == rigid_support ? at.after : at.before);
}

bool ThetaMatrix::set(const CornerPartition& nodes, double stiffness_factor) {
    nodes_ = &nodes;
    const bool other_factor = stiffness_factor_ != stiffness_factor, other_nodes = active_ != nodes.active;
    if (other_factor) factor_.touch_all();
    stiffness_factor_ = stiffness_factor;
    for (std::size_t f = 0; other_nodes && f < model_.fans.size(); ++f)
        if (active_.empty() || active_[f] != nodes.active[f]) place_fan(model_.fans[f]);
    active_ = nodes.active;
    return other_factor || other_nodes;
}

/// An unknown is eliminated in the smallest part that holds all elements of its node: triangles, and points in their
/// leaf.
void ThetaMatrix::place_fan(const Fan& fan) {
    const std::span corners(&model_.fan_corners[fan.first_corner], fan.n_corners);
    const auto part_of = [&](Index node) -> Index& { return eliminated_in_[2 * nodes_->corner_of_node[node]]; };
    const auto add = [&](Index node, Index leaf) {
        Index& part = part_of(node);
        part = part < 0 ? leaf : dissection_.smallest_common(part, leaf);
    };
    for (const Index corner : corners) part_of(nodes_->node_of_corner[corner]) = -1;
    for (const Index corner : corners) {
        add(nodes_->node_of_corner[corner], leaf_of_corner(corner));
        factor_.touch(leaf_of_corner(corner));
    }
    for (Index i = fan.first_point; i < fan.first_point + fan.n_points; ++i)
        if (const PointSides at = nodes_->sides(model_, i); at.before >= 0 && at.after >= 0 && at.before != at.after)
            add(at.before, leaf_of_point(i)), add(at.after, leaf_of_point(i));
    for (const Index corner : corners) {
        const Index node = nodes_->node_of_corner[corner];
        eliminated_in_[2 * nodes_->corner_of_node[node] + 1] = part_of(node);
    }
}

void ThetaMatrix::add_elements(Index leaf, std::vector<Element>& elements) const {
    const Index n = model_.mesh.corners_per_triangle();
    for (const Index t : dissection_.triangles_of(dissection_.parts[leaf])) {
        Element& made = elements.emplace_back(2 * n);
        for (int i = 0; i < 2 * n; ++i) made.unknown[i] = unknown(nodes_->node_of_corner[n * t + i / 2], i % 2);
        made.matrix = theta_element(model_, t, stiffness_factor_, mass_);
    }
    for (const Index i : points_of_leaf_[leaf])
        if (const PointSides at = nodes_->sides(model_, i); at.before != at.after) add_point(at, block_[i], elements);
    for (const PointTangent& contact : contacts_)
        if (leaf_of_corner(contact.sides.leaf_corner) == leaf)
            add_point(contact.sides, contact.symmetric_block, elements);
}

void ThetaMatrix::add_point(const PointSides& sides, const Eigen::Matrix2d& block,
                            std::vector<Element>& elements) const {
    Element& made = elements.emplace_back(0);
    double weights[2];
    sides.for_each_node([&](Index node, double weight) {
        weights[made.n_unknowns / 2] = weight;
        for (int k = 0; k < 2; ++k) made.unknown[made.n_unknowns++] = unknown(node, k);
    });
    made.matrix.resize(made.n_unknowns, made.n_unknowns);
    for (int i = 0; i < made.n_unknowns / 2; ++i)
        for (int j = 0; j < made.n_unknowns / 2; ++j)
            made.matrix.block<2, 2>(2 * i, 2 * j) = weights[i] * weights[j] * block;
}

void ThetaMatrix::set_block(Index i, const Eigen::Matrix2d& block) {
    if (block_[i] == block) return;
    block_[i] = block;
    factor_.touch(leaf_of_point(i));
}

void ThetaMatrix::set_contacts(std::span<const PointTangent> points) {
    new_contacts_.clear();
    for (const PointTangent& point : points)
        if (point.sides.fan_point < 0) new_contacts_.push_back(point);
    for (std::size_t i = 0; i < std::max(contacts_.size(), new_contacts_.size()); ++i) {
        const bool before = i < contacts_.size(), after = i < new_contacts_.size();
        if (before && after && contacts_[i] == new_contacts_[i]) continue;
        if (before) factor_.touch(leaf_of_corner(contacts_[i].sides.leaf_corner));
        if (after) factor_.touch(leaf_of_corner(new_contacts_[i].sides.leaf_corner));
    }
    std::swap(contacts_, new_contacts_);
}

bool ThetaMatrix::factorise(const std::vector<PointTangent>& points) {
    friction_.clear();
    set_contacts(points);
    for (const Index i : with_block_) kept_[i] = 0;
    for (const PointTangent& point : points) {
        if (point.block != point.symmetric_block) friction_.push_back(point);
        if (point.sides.fan_point < 0) continue;
        set_block(point.sides.fan_point, point.symmetric_block);
        kept_[point.sides.fan_point] = 1;
    }
    for (const Index i : with_block_)
        if (!kept_[i]) set_block(i, Eigen::Matrix2d::Zero());
    with_block_.clear();
    for (const PointTangent& point : points)
        if (point.sides.fan_point >= 0) with_block_.push_back(point.sides.fan_point);
    return factor_.update(eliminated_in_,
                          [&](Index leaf, std::vector<Element>& elements) { add_elements(leaf, elements); });
}

bool ThetaMatrix::solve(const std::vector<Vec2>& right_side, std::vector<Vec2>& solution) {
    const auto each_unknown = [&](const auto& visit) {
        for (Index node = 0; node < nodes_->n_nodes(); ++node)
            for (int k = 0; k < 2; ++k)
                if (const Index u = unknown(node, k); u >= 0) visit(u, node, k);
    };
    each_unknown([&](Index u, Index node, int k) { x_[u] = right_side[node][k]; });
    if (is_symmetric()) factor_.solve(x_);
    else if (!solve_with_friction()) return false;
    solution.assign(right_side.size(), Vec2::Zero());
    each_unknown([&](Index u, Index node, int k) { solution[node][k] = x_[u]; });
    return std::ranges::all_of(x_, [](double x) { return std::isfinite(x); });  // no tolerance would find a NaN
}

void ThetaMatrix::find_parts_of_friction() {
    std::ranges::fill(is_part_of_friction_, 0);
    for (const PointTangent& point : friction_)
        point.sides.for_each_node(
            [&](Index node, double) { is_part_of_friction_[eliminated_in_[2 * nodes_->corner_of_node[node]]] = 1; });
    parts_of_friction_.clear();
    for (Index part = 0; part < static_cast<Index>(dissection_.parts.size()); ++part) {  // parents come later
        if (!is_part_of_friction_[part]) continue;
        parts_of_friction_.push_back(part);
        if (const Index above = dissection_.parts[part].parent; above >= 0) is_part_of_friction_[above] = 1;
    }
}

bool ThetaMatrix::solve_with_friction() {
    // A = S + G E G' with the factor of S known and E the friction that follows the contact impulses:
    //     x = S^-1 (b - G y),     y + E G' S^-1 G y = E G' S^-1 b
    // Only the last substitution leaves the parts of the dissection that know G.
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(friction_.size());
    const auto each_unknown = [&](Eigen::Index j, const auto& visit) {  // (unknown, component, weight)
        for (int k = 0; k < 2; ++k)
            friction_[j].sides.for_each_node([&](Index node, double weight) {
                if (is_free(node, k)) visit(unknown(node, k), k, weight);
            });
    };
    const auto friction_of = [&](const std::vector<double>& x, Eigen::Ref<Eigen::VectorXd> y) {  // y = E G' x
        for (Eigen::Index j = 0; j < n / 2; ++j) {
            Vec2 slip = Vec2::Zero();
            each_unknown(j, [&](Index u, int k, double weight) { slip[k] += weight * x[u]; });
            y.segment<2>(2 * j) = (friction_[j].block - friction_[j].symmetric_block) * slip;
        }
    };
    const auto subtract = [&](const Eigen::Ref<const Eigen::VectorXd>& y, std::vector<double>& x) {  // x -= G y
        for (Eigen::Index j = 0; j < n / 2; ++j)
            each_unknown(j, [&](Index u, int k, double weight) { x[u] -= weight * y[2 * j + k]; });
    };
    find_parts_of_friction();
    const auto product = [&](const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> A_y) {
        y_.assign(x_.size(), 0);
        subtract(y, y_);
        factor_.substitute_in(parts_of_friction_, y_);
        factor_.substitute_back_in(parts_of_friction_, y_);
        friction_of(y_, A_y);
        A_y = y - A_y;
    };
    factor_.substitute(x_);
    y_ = x_;
    factor_.substitute_back_in(parts_of_friction_, y_);
    if (friction_part_.size() < n) friction_part_.resize(2 * n);
    friction_of(y_, friction_part_.head(n));
    if (!gmres_.solve(std::cref(product), friction_part_.head(n), 60, 1e-8)) return false;  // cref: no copy
    y_.assign(x_.size(), 0);
    subtract(gmres_.solution(), y_);
    factor_.substitute_in(parts_of_friction_, y_);
    for (std::size_t u = 0; u < x_.size(); ++u) x_[u] += y_[u];
    factor_.substitute_back(x_);
    return true;
}

}  // namespace knap
