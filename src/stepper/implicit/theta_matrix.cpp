#include "stepper/implicit/theta_matrix.hpp"

#include "base/room.hpp"

#include <algorithm>

namespace knap {
namespace {

/// The nodes of a point with their weights in its relative velocity.
std::array<std::pair<Index, double>, 3> sides(const PointTangent& point) {
    return {std::pair(point.after, 1 - point.share), std::pair(point.before, -1.0), std::pair(point.beside, point.share)};
}

}  // namespace

ThetaMatrix::ThetaMatrix(const Model& model) : model_(model), dissection_(dissect(model)), factor_(dissection_) {
    const Index n_points = static_cast<Index>(model.fan_points.size()), n_corners = model.mesh.n_corners();
    node_name_.assign(n_corners, -1);
    free_.assign(n_corners, {false, false});
    eliminated_in_.assign(2 * n_corners, -1);
    x_.assign(2 * n_corners, 0);
    block_.assign(n_points, Eigen::Matrix2d::Zero());
    held_in_.assign(n_points, 0);
    make_room(n_corners, corner_of_node_);
    make_room(n_points, holding_, held_before_, friction_);

    first_point_of_leaf_.assign(dissection_.parts.size() + 1, 0);
    for (Index i = 0; i < n_points; ++i) ++first_point_of_leaf_[leaf_of_point(i) + 1];
    for (std::size_t part = 0; part < dissection_.parts.size(); ++part) first_point_of_leaf_[part + 1] += first_point_of_leaf_[part];
    point_of_leaf_.resize(n_points);
    std::vector<Index> place(first_point_of_leaf_.begin(), first_point_of_leaf_.end() - 1);
    for (Index i = 0; i < n_points; ++i) point_of_leaf_[place[leaf_of_point(i)]++] = i;
}

Index ThetaMatrix::leaf_of_point(Index fan_point) const {
    const FanPoint& point = model_.fan_points[fan_point];
    return leaf_of_corner(point.before == rigid_support ? point.after : point.before);
}

bool ThetaMatrix::couples(const FanPoint& point) const {
    return point.before != rigid_support && point.after != rigid_support && node_name_[point.before] != node_name_[point.after];
}

void ThetaMatrix::set_nodes(const CornerPartition& partition, const std::vector<std::array<bool, 2>>& prescribed_of_node) {
    corner_of_node_ = partition.corner_of_node;
    for (const Fan& fan : model_.fans) {
        bool same = true;
        for (Index i = fan.first_corner; i < fan.first_corner + fan.n_corners; ++i) {
            const Index corner = model_.fan_corners[i], node = partition.node_of_corner[corner];
            const std::array<bool, 2> free{!prescribed_of_node[node][0], !prescribed_of_node[node][1]};
            same = same && node_name_[corner] == corner_of_node_[node] && free_[corner] == free;
            node_name_[corner] = corner_of_node_[node];
            free_[corner] = free;
        }
        if (same) continue;
        find_places(fan);
        touch_fan(fan);
    }
}

void ThetaMatrix::find_places(const Fan& fan) {
    // eliminated in the smallest part that holds all elements of the node: its triangles, and its points with those of their leaf
    const std::span corners(&model_.fan_corners[fan.first_corner], fan.n_corners);
    const auto belongs = [&](Index corner, Index leaf) {
        for (int k = 0; k < 2; ++k) {
            Index& part = eliminated_in_[2 * node_name_[corner] + k];
            part = part < 0 ? leaf : dissection_.smallest_common(part, leaf);
        }
    };
    for (const Index corner : corners)
        for (int k = 0; k < 2; ++k) eliminated_in_[2 * node_name_[corner] + k] = -1;
    for (const Index corner : corners) belongs(corner, leaf_of_corner(corner));
    for (Index i = fan.first_point; i < fan.first_point + fan.n_points; ++i) {
        const FanPoint& point = model_.fan_points[i];
        if (couples(point)) belongs(point.before, leaf_of_point(i)), belongs(point.after, leaf_of_point(i));
    }
}

void ThetaMatrix::touch_fan(const Fan& fan) {
    for (Index i = fan.first_corner; i < fan.first_corner + fan.n_corners; ++i) factor_.touch(leaf_of_corner(model_.fan_corners[i]));
}

void ThetaMatrix::set_bulk(double stiffness_factor, MassMatrix mass) {
    if (stiffness_factor_ != stiffness_factor || mass_ != mass) factor_.touch_all();
    stiffness_factor_ = stiffness_factor;
    mass_ = mass;
}

void ThetaMatrix::add_elements(Index leaf, std::vector<Element>& elements) const {
    const Index n = model_.mesh.corners_per_triangle();
    const ElementMatrix& parts = mass_matrix(model_.mesh.order, mass_);
    for (const Index t : dissection_.triangles_of(dissection_.parts[leaf])) {
        Element& made = elements.emplace_back();
        made.n_unknowns = 2 * n;
        for (int i = 0; i < 2 * n; ++i) made.unknown[i] = unknown(n * t + i / 2, i % 2);
        made.matrix = stiffness_factor_ * stiffness_matrix(model_.mesh, t, model_.materials[model_.mesh.region[t]], model_.plane, model_.thickness);
        const double mass = model_.triangle_mass(t);
        for (Index i = 0; i < n; ++i)
            for (Index j = 0; j < n; ++j) made.matrix.block<2, 2>(2 * i, 2 * j).diagonal().array() += parts(i, j) * mass;
    }
    for (Index i = first_point_of_leaf_[leaf]; i < first_point_of_leaf_[leaf + 1]; ++i) {
        const FanPoint& point = model_.fan_points[point_of_leaf_[i]];
        const bool on_support = point.before == rigid_support || point.after == rigid_support;
        if (!on_support && !couples(point)) continue;
        Element& made = elements.emplace_back();
        const Eigen::Matrix2d& D = block_[point_of_leaf_[i]];
        made.n_unknowns = on_support ? 2 : 4;
        const Index first = point.before == rigid_support ? point.after : point.before;
        for (int k = 0; k < made.n_unknowns; ++k) made.unknown[k] = unknown(k < 2 ? first : point.after, k % 2);
        made.matrix.resize(4, 4);
        made.matrix.topLeftCorner<2, 2>() = made.matrix.block<2, 2>(2, 2) = D;
        made.matrix.block<2, 2>(0, 2) = made.matrix.block<2, 2>(2, 0) = -D;
    }
    for (const PointTangent& contact : contacts_)
        if (leaf_of_corner(contact.leaf_corner) == leaf) add_contact(contact, elements);
}

void ThetaMatrix::add_contact(const PointTangent& contact, std::vector<Element>& elements) const {
    Element& made = elements.emplace_back();
    const double weight[2] = {1 - contact.share, contact.share};
    const int n = contact.beside < 0 ? 1 : 2;
    made.n_unknowns = 2 * n;
    made.matrix.resize(2 * n, 2 * n);
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < 2; ++k) made.unknown[2 * i + k] = unknown(corner_of_node_[i == 0 ? contact.after : contact.beside], k);
        for (int j = 0; j < n; ++j) made.matrix.block<2, 2>(2 * i, 2 * j) = weight[i] * weight[j] * contact.symmetric_block;
    }
}

void ThetaMatrix::hold(Index i, const Eigen::Matrix2d& block) {
    if (block_[i] == block) return;
    block_[i] = block;
    factor_.touch(leaf_of_point(i));
}

void ThetaMatrix::hold_contacts(std::span<const PointTangent> points) {
    std::vector<PointTangent>& contacts = new_contacts_;
    contacts.clear();
    for (const PointTangent& point : points)
        if (point.fan_point < 0) contacts.push_back(point);
    const auto touch_where_other = [&](const std::vector<PointTangent>& some, const std::vector<PointTangent>& others) {
        const auto same = [](const PointTangent& a, const PointTangent& b) {
            return a.leaf_corner == b.leaf_corner && a.after == b.after && a.beside == b.beside && a.share == b.share && a.symmetric_block == b.symmetric_block;
        };
        for (std::size_t i = 0; i < some.size(); ++i)
            if (i >= others.size() || !same(some[i], others[i])) factor_.touch(leaf_of_corner(some[i].leaf_corner));
    };
    touch_where_other(contacts_, contacts);
    touch_where_other(contacts, contacts_);
    std::swap(contacts_, new_contacts_);
}

bool ThetaMatrix::factorise(const std::vector<PointTangent>& points) {
    ++round_;
    std::swap(holding_, held_before_);
    holding_.clear();
    friction_.clear();
    hold_contacts(points);
    for (const PointTangent& point : points) {
        if (point.block != point.symmetric_block) friction_.push_back(point);
        if (point.fan_point < 0) continue;
        hold(point.fan_point, point.symmetric_block);
        held_in_[point.fan_point] = round_;
        holding_.push_back(point.fan_point);
    }
    for (const Index i : held_before_)
        if (held_in_[i] != round_) hold(i, Eigen::Matrix2d::Zero());
    lu_unknowns_.clear();
    return factor_.update(eliminated_in_, [&](Index leaf, std::vector<Element>& elements) { add_elements(leaf, elements); });
}

bool ThetaMatrix::solve_by_gmres() {
    // A = S + G E G' with the factor of S known, E the friction that follows the contacts, G' the relative velocities of their points:
    //     x = S^-1 (b - G y),     y + E G' S^-1 G y = E G' S^-1 b
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(friction_.size());
    const auto each_unknown = [&](Eigen::Index j, const auto& visit) {  // (unknown, component, weight)
        for (int k = 0; k < 2; ++k)
            for (const auto& [node, weight] : sides(friction_[j]))
                if (node >= 0 && is_free(node, k)) visit(unknown(corner_of_node_[node], k), k, weight);
    };
    const auto rubbing = [&](const std::vector<double>& x, Eigen::Ref<Eigen::VectorXd> y) {  // y = E G' x
        for (Eigen::Index j = 0; j < n / 2; ++j) {
            Vec2 slip = Vec2::Zero();
            each_unknown(j, [&](Index u, int k, double sign) { slip[k] += sign * x[u]; });
            y.segment<2>(2 * j) = (friction_[j].block - friction_[j].symmetric_block) * slip;
        }
    };
    const auto subtract = [&](const Eigen::Ref<const Eigen::VectorXd>& y, std::vector<double>& x) {  // x - G y
        for (Eigen::Index j = 0; j < n / 2; ++j) each_unknown(j, [&](Index u, int k, double sign) { x[u] -= sign * y[2 * j + k]; });
    };
    const auto product = [&](const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> A_y) {
        pulled_.assign(x_.size(), 0);
        subtract(y, pulled_);
        factor_.solve(pulled_);
        rubbing(pulled_, A_y);
        A_y = y - A_y;
    };
    pulled_ = x_;
    factor_.solve(pulled_);
    if (rubbing_.size() < n) rubbing_.resize(2 * n);
    rubbing(pulled_, rubbing_.head(n));
    if (!gmres_.solve(std::cref(product), rubbing_.head(n), 60, 1e-8)) return false;  // cref: nothing is copied
    subtract(gmres_.solution(), x_);
    factor_.solve(x_);
    return true;
}

void ThetaMatrix::solve_by_lu() {
    if (lu_unknowns_.empty()) {
        lu_unknowns_ = factor_.unknowns();
        std::vector<Index> place(eliminated_in_.size(), -1);
        for (std::size_t i = 0; i < lu_unknowns_.size(); ++i) place[lu_unknowns_[i]] = static_cast<Index>(i);
        std::vector<Element> elements;
        for (std::size_t part = 0; part < dissection_.parts.size(); ++part)
            if (dissection_.parts[part].is_leaf()) add_elements(static_cast<Index>(part), elements);
        for (const PointTangent& point : friction_) {
            Element& made = elements.emplace_back();
            made.n_unknowns = 6;
            made.matrix.resize(6, 6);
            const auto ends = sides(point);
            for (int i = 0; i < 3; ++i) {
                for (int k = 0; k < 2; ++k) made.unknown[2 * i + k] = ends[i].first < 0 ? -1 : unknown(corner_of_node_[ends[i].first], k);
                for (int j = 0; j < 3; ++j) made.matrix.block<2, 2>(2 * i, 2 * j) = ends[i].second * ends[j].second * (point.block - point.symmetric_block);
            }
        }
        std::vector<Eigen::Triplet<double, Index>> entries;
        for (const Element& e : elements)
            for (int i = 0; i < e.n_unknowns; ++i)
                for (int j = 0; j < e.n_unknowns; ++j)
                    if (e.unknown[i] >= 0 && e.unknown[j] >= 0) entries.emplace_back(place[e.unknown[i]], place[e.unknown[j]], e.matrix(i, j));
        const Index n = static_cast<Index>(lu_unknowns_.size());
        Eigen::SparseMatrix<double, Eigen::ColMajor, Index> whole(n, n);
        whole.setFromTriplets(entries.begin(), entries.end());
        lu_.isSymmetric(true);
        lu_.setPivotThreshold(0.01);
        lu_.compute(whole);
    }
    Eigen::VectorXd b(lu_unknowns_.size());
    for (std::size_t i = 0; i < lu_unknowns_.size(); ++i) b[static_cast<Eigen::Index>(i)] = x_[lu_unknowns_[i]];
    const Eigen::VectorXd x = lu_.solve(b);
    for (std::size_t i = 0; i < lu_unknowns_.size(); ++i) x_[lu_unknowns_[i]] = x[static_cast<Eigen::Index>(i)];
}

void ThetaMatrix::solve(const std::vector<Vec2>& right_hand_side, std::vector<Vec2>& solution) {
    const auto each_unknown = [&](const auto& visit) {
        for (std::size_t node = 0; node < corner_of_node_.size(); ++node)
            for (int k = 0; k < 2; ++k)
                if (const Index u = unknown(corner_of_node_[node], k); u >= 0) visit(u, node, k);
    };
    each_unknown([&](Index u, std::size_t node, int k) { x_[u] = right_hand_side[node][k]; });
    if (is_symmetric()) factor_.solve(x_);
    else if (!lu_unknowns_.empty() || !solve_by_gmres()) solve_by_lu();
    solution.assign(right_hand_side.size(), Vec2::Zero());
    each_unknown([&](Index u, std::size_t node, int k) { solution[node][k] = x_[u]; });
}

}  // namespace knap
