#include "stepper/implicit/theta_matrix.hpp"

#include "base/reserve_capacity.hpp"
#include "stepper/implicit/implicit_bulk.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr std::size_t max_half_entries = 1'000'000;  // of find_compliance()
constexpr Eigen::Index half_rows_at_once = 64;       // likewise: their product needs no memory of its own
// [-] Of a direction with friction: the next step of Newton's method takes what is left, and an accurate one of pieces
// that are not yet the right ones is in vain.
constexpr double accurate_direction = 1e-6;

}  // namespace

ThetaMatrix::ThetaMatrix(const Model& model, MassMatrix mass, std::span<const Dashpot> dashpots, PieceFrames* frames)
    : model_(model),
      mass_(mass),
      dashpots_(dashpots),
      frames_(frames),
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
      reduced_(std::make_unique<ReducedMatrix>(model.mesh.n_corners())),
      is_marked_(dissection_.parts.size(), 0),
      x_(2 * model.mesh.n_corners(), 0),
      y_(x_.size(), 0) {
    assert(std::ranges::is_sorted(dashpots, {}, &Dashpot::corner));
    reserve_capacity(model.fan_points.size(), with_block_, friction_, points_);
    reserve_capacity(4 * model.fan_points.size(), entries_of_friction_);  // two sides, x and y
    reserve_capacity(dissection_.parts.size(), parts_of_friction_, near_parts_, far_parts_, local_parts_, path_,
                     reduced_parts_);
    reserve_capacity(model.mesh.n_corners(), near_nodes_, far_nodes_, condensed_, reduced_impulse_);
    reserve_capacity(2 * model.mesh.n_corners(), local_unknowns_, reduced_unknowns_);
    reserve_capacity(ReducedMatrix::max_size, reduced_points_);
    half_.reserve(std::min(max_half_entries, 240 * static_cast<std::size_t>(model.mesh.n_corners())));
    far_part_.reserve(x_.size());
}

Index ThetaMatrix::leaf_of_point(Index fan_point) const {
    const FanPoint& at = model_.fan_points[fan_point];
    return leaf_of_corner(at.before == rigid_support ? at.after : at.before);
}

ElementMatrix ThetaMatrix::element(Index triangle) const {
    ElementMatrix M_hat = theta_element(model_, triangle, stiffness_factor_, mass_, mass_factor_);
    if (frames_) {
        const Rotation& A = frames_->of_triangle(triangle);
        turn_blocks({A, A, A}, M_hat);
    }
    if (!dashpots_.empty()) add_dashpots(model_, triangle, dashpots_, std::sqrt(stiffness_factor_), M_hat);
    return M_hat;
}

/// Along the axes of its nodes. Where dashpots act these are x and y.
ElementMatrix ThetaMatrix::element_in_frames(Index triangle) const {
    if (!frames_) return element(triangle);
    ElementMatrix M_hat = theta_element(model_, triangle, stiffness_factor_, mass_, mass_factor_);
    if (frames_->is_turned(triangle)) turn_blocks(frames_->along_nodes(triangle), M_hat);
    if (!dashpots_.empty()) add_dashpots(model_, triangle, dashpots_, std::sqrt(stiffness_factor_), M_hat);
    return M_hat;
}

/// True: blocks along the axes of the nodes changed.
bool ThetaMatrix::touch_frames() {
    if (!frames_) return false;
    const std::vector<Index> changed = frames_->take_changed();
    for (const Index t : changed) factor_.touch(dissection_.leaf_of_triangle[t]);
    for (const Index i : with_block_) factor_.touch(leaf_of_point(i));
    for (const PointTangent& contact : contacts_) factor_.touch(leaf_of_corner(contact.sides.leaf_corner));
    return !changed.empty() || !points_.empty();
}

double ThetaMatrix::largest_free(const std::vector<Vec2>& of_node, Index node) const {
    double largest = 0;
    for (int k = 0; k < 2; ++k)
        if (const double a = std::abs(of_node[node][k]); is_free(node, k))
            largest = a < infinity ? std::max(largest, a) : infinity;
    return largest;
}

bool ThetaMatrix::set(const CornerPartition& nodes, double stiffness_factor, double mass_factor,
                      std::span<const PointSides> meetings) {
    nodes_ = &nodes;
    const bool other_factor = stiffness_factor_ != stiffness_factor || mass_factor_ != mass_factor;
    bool other_nodes = active_ != nodes.active;
    if (other_factor) factor_.touch_all();
    stiffness_factor_ = stiffness_factor, mass_factor_ = mass_factor;
    const auto same_nodes = [](const PointSides& a, const PointSides& b) {
        return a.before == b.before && a.after == b.after && a.second_node == b.second_node &&
               a.before_too == b.before_too && a.leaf_corner == b.leaf_corner;
    };
    const bool others_meet = !std::ranges::equal(meetings_, meetings, same_nodes) || (other_nodes && !meetings.empty());
    for (std::size_t f = 0; (other_nodes || others_meet) && f < model_.fans.size(); ++f)
        if (others_meet || active_.empty() || active_[f] != nodes.active[f]) place_fan(model_.fans[f]);
    if (others_meet) place_meetings(meetings), other_nodes = true;
    active_ = nodes.active;
    const bool other_frames = touch_frames();
    set_all_near();
    if (other_factor || other_nodes) reduced_->forget();
    return other_factor || other_nodes || other_frames;
}

void ThetaMatrix::set_all_near() {
    is_reduced_ = false;
    near_parts_.resize(dissection_.parts.size());
    near_nodes_.resize(nodes_->n_nodes());
    std::iota(near_parts_.begin(), near_parts_.end(), 0);
    std::iota(near_nodes_.begin(), near_nodes_.end(), 0);
    far_parts_.clear(), far_nodes_.clear();
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

/// The contact is an element of the leaf of its edge.
void ThetaMatrix::place_meetings(std::span<const PointSides> meetings) {
    meetings_.assign(meetings.begin(), meetings.end());
    for (const PointSides& sides : meetings)
        sides.for_each_node([&](Index node, const auto&) {
            Index* part = &eliminated_in_[2 * nodes_->corner_of_node[node]];
            part[0] = part[1] = dissection_.smallest_common(part[0], leaf_of_corner(sides.leaf_corner));
        });
}

void ThetaMatrix::add_elements(Index leaf, std::vector<Element>& elements) const {
    const Index n = model_.mesh.corners_per_triangle();
    for (const Index t : dissection_.triangles_of(dissection_.parts[leaf])) {
        Element& made = elements.emplace_back(2 * n);
        for (int i = 0; i < 2 * n; ++i) made.unknown[i] = unknown(nodes_->node_of_corner[n * t + i / 2], i % 2);
        made.matrix = element_in_frames(t);
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
    Index nodes[4];
    sides.for_each_node([&](Index node, const auto&) {
        nodes[made.n_unknowns / 2] = node;
        for (int k = 0; k < 2; ++k) made.unknown[made.n_unknowns++] = unknown(node, k);
    });
    made.matrix.resize(made.n_unknowns, made.n_unknowns);
    int i = 0, j = 0;
    sides.for_each_node([&](Index, const auto& of_row) {
        j = 0;
        sides.for_each_node([&](Index, const auto& of_column) {
            made.matrix.block<2, 2>(i, j) = between(of_row, block, of_column), j += 2;
        });
        i += 2;
    });
    for (int i = 0; frames_ && i < made.n_unknowns / 2; ++i)
        for (int j = 0; j < made.n_unknowns; ++j) {
            auto column = made.matrix.block<2, 1>(2 * i, j);
            column = in_frame(nodes[i], column);
        }
    for (int i = 0; frames_ && i < made.n_unknowns / 2; ++i)
        for (int j = 0; j < made.n_unknowns; ++j) {
            auto row = made.matrix.block<1, 2>(j, 2 * i);
            row = in_frame(nodes[i], row.transpose()).transpose();
        }
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
    factor_of_ = is_reduced_ ? FactorOf::near_nodes : FactorOf::body;
    if (!is_reduced_) return factorise_body(points);
    points_ = points;
    return reduced_->factorise(points_);
}

bool ThetaMatrix::factorise_body(const std::vector<PointTangent>& points) {
    points_ = points;
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

template <class Visit>  // (unknown, node, component)
void ThetaMatrix::each_unknown(const std::vector<Index>& nodes, const Visit& visit) const {
    for (const Index node : nodes)
        for (int k = 0; k < 2; ++k)
            if (const Index u = unknown(node, k); u >= 0) visit(u, node, k);
}

/// (unknown, component in x and y, weight)
template <class Visit>
void ThetaMatrix::each_unknown(const PointTangent& point, const Visit& visit) const {
    for (int k = 0; k < 2; ++k)
        point.sides.for_each_node([&](Index node, const auto& weight) {
            for_each_part_of_jump(node, k, weight, [&](Index u, double part) { visit(u, k, part); });
        });
}

/// visit(unknown, its part) of component k of a relative motion, by the motion of a node.
template <class Visit>
void ThetaMatrix::for_each_part_of_jump(Index node, int k, double weight, const Visit& visit) const {
    for_each_part(node, k, [&](Index u, double part) { visit(u, part * weight); });
}

template <class Visit>
void ThetaMatrix::for_each_part_of_jump(Index node, int k, const Eigen::Matrix2d& weight, const Visit& visit) const {
    for (int l = 0; l < 2; ++l) for_each_part_of_jump(node, l, weight(k, l), visit);
}

/// visit(unknown, its part) of a unit vector at a node along x or y.
template <class Visit>
void ThetaMatrix::for_each_part(Index node, int k, const Visit& visit) const {
    if (!frames_) {
        if (is_free(node, k)) visit(unknown(node, k), 1);
        return;
    }
    const Vec2 parts = in_frame(node, Vec2::Unit(k));
    for (int i = 0; i < 2; ++i)
        if (parts[i] != 0 && is_free(node, i)) visit(unknown(node, i), parts[i]);
}

/// Vectors along the axes of the unknowns become those along x and y.
void ThetaMatrix::turn_out(const std::vector<Index>& nodes, std::vector<Vec2>& of_node) const {
    if (!frames_) return;
    for (const Index node : nodes)
        if (is_free(node, 0) && is_free(node, 1)) of_node[node] = out_of_frame(node, of_node[node]);
}

void ThetaMatrix::find_marked_parts(std::vector<Index>& parts) {
    parts.clear();
    for (Index part = 0; part < static_cast<Index>(dissection_.parts.size()); ++part) {  // parents come later
        if (!is_marked_[part]) continue;
        parts.push_back(part);
        if (const Index above = dissection_.parts[part].parent; above >= 0) is_marked_[above] = 1;
    }
}

template <class Points, class SidesOf>
void ThetaMatrix::find_parts(const Points& points, const SidesOf& sides_of, std::vector<Index>& parts) {
    std::ranges::fill(is_marked_, 0);
    for (const auto& point : points)
        sides_of(point).for_each_node(
            [&](Index node, const auto&) { is_marked_[eliminated_in_[2 * nodes_->corner_of_node[node]]] = 1; });
    find_marked_parts(parts);
}

/// All nodes of a triangle are eliminated in its leaf or above.
void ThetaMatrix::set_near(const std::vector<PointSides>& points) {
    is_reduced_ = false;
    std::ranges::fill(is_marked_, 0);
    for (const PointSides& point : points)
        point.for_each_node([&](Index node, const auto&) {
            const Fan& fan = model_.fans[model_.fan_of_corner[nodes_->corner_of_node[node]]];
            for (Index i = fan.first_corner; i < fan.first_corner + fan.n_corners; ++i)
                is_marked_[leaf_of_corner(model_.fan_corners[i])] = 1;
        });
    find_marked_parts(near_parts_);
    far_parts_.clear(), near_nodes_.clear(), far_nodes_.clear();
    for (Index part = 0; part < static_cast<Index>(dissection_.parts.size()); ++part)
        if (!is_marked_[part]) far_parts_.push_back(part);
    for (Index node = 0; node < nodes_->n_nodes(); ++node)
        (is_marked_[eliminated_in_[2 * nodes_->corner_of_node[node]]] ? near_nodes_ : far_nodes_).push_back(node);
}

bool ThetaMatrix::set_reduced(const std::vector<ActingPoint>& points) {
    set_all_near();
    const bool known = reduced_->knows(points, *nodes_);
    if (!known && !reduced_->set_unknowns(points, *nodes_)) return false;
    if (known && !reduced_->is_accurate()) return false;
    const bool body_alone = known && with_block_.empty() && contacts_.empty();
    if (!body_alone) factor_of_ = FactorOf::none;
    if (!body_alone && !factorise_body({})) {
        reduced_->forget();
        return false;
    }
    if (!known && !find_reduced_matrix()) return false;
    std::swap(near_parts_, far_parts_);
    near_nodes_ = reduced_->nodes();
    for (Index node = 0; node < nodes_->n_nodes(); ++node)
        if (!reduced_->has(node)) far_nodes_.push_back(node);
    condensed_.resize(nodes_->n_nodes()), reduced_impulse_.resize(nodes_->n_nodes());
    return is_reduced_ = true;
}

/// All nodes are near; the factor is that of the body without points.
bool ThetaMatrix::find_reduced_matrix() {
    const std::vector<Index>& unknowns = reduced_->unknowns();
    reduced_points_.clear();
    for (const Index i : unknowns) reduced_points_.push_back({.fan_point = -1, .before = -1, .after = i / 2});
    const Eigen::Index n = static_cast<Eigen::Index>(unknowns.size());
    ReducedMatrix::Matrix compliance(n, n);
    const bool found = find_compliance(
        reduced_points_, std::identity{}, [&](Eigen::Index j) { return unknowns[j] % 2; }, compliance);
    if (!found || !reduced_->set_compliance(compliance)) return false;
    reduced_parts_ = local_parts_, reduced_unknowns_ = local_unknowns_;
    return true;
}

// With O the far unknowns and R the near ones, A = L L' and b the impulse:
//     y_O = L_OO^-1 b_O,    b_R - L_RO y_O    condensed;    change_O = -L_OO^-T (y_O + L_RO' change_R)
// The blocks of points change neither L_OO nor L_RO.
// Reduced, with the factor of all unknowns and S = ((A^-1)_RR)^-1:
//     y = L^-1 b,    g = S (L^-T y)_R    condensed;    change_O = (L^-T (L^-1 (g + S change_R) - y))_O
void ThetaMatrix::condense(std::vector<Vec2>& impulse) {
    if (far_parts_.empty()) return;
    each_unknown(far_nodes_, [&](Index u, Index node, int k) { x_[u] = in_frame(node, impulse[node])[k]; });
    each_unknown(near_nodes_, [&](Index u, Index node, int k) { x_[u] = in_frame(node, impulse[node])[k]; });
    factor_.substitute(far_parts_, x_);
    far_part_ = x_;
    if (is_reduced_) factor_.substitute_back(reduced_parts_, x_);
    each_unknown(near_nodes_, [&](Index u, Index node, int k) { impulse[node][k] = x_[u]; });
    turn_out(near_nodes_, impulse);
    if (!is_reduced_) return;
    reduced_->multiply(impulse, impulse);
    each_unknown(near_nodes_, [&](Index, Index node, int k) { condensed_[node][k] = impulse[node][k]; });
}

void ThetaMatrix::add_change_of_far_nodes(const std::vector<Vec2>& change, std::vector<Vec2>& rate) {
    if (far_parts_.empty()) return;
    each_unknown(far_nodes_, [&](Index u, Index, int) { x_[u] = -far_part_[u]; });
    if (is_reduced_) {
        factor_.set_zero(reduced_parts_, y_);
        reduced_->multiply(change, reduced_impulse_);
        each_unknown(near_nodes_, [&](Index u, Index node, int k) {
            x_[u] = -far_part_[u], y_[u] = condensed_[node][k] + reduced_impulse_[node][k];
        });
        factor_.substitute(reduced_parts_, y_);
        for (const Index u : reduced_unknowns_) x_[u] += y_[u];
    } else {
        each_unknown(near_nodes_, [&](Index u, Index node, int k) { x_[u] = in_frame(node, change[node])[k]; });
    }
    factor_.substitute_back(far_parts_, x_);
    if (frames_)
        for (const Index node : far_nodes_) rate[node] += at_node(x_, node);
    else each_unknown(far_nodes_, [&](Index u, Index node, int k) { rate[node][k] += x_[u]; });
    if (!is_reduced_) return;
    each_unknown(near_nodes_, [&](Index u, Index node, int k) {
        if (!reduced_->has(node, k)) rate[node][k] += x_[u];
    });
}

bool ThetaMatrix::solve(const std::vector<Vec2>& right_side, std::vector<Vec2>& solution) {
    if (is_reduced_) {
        solution.resize(nodes_->n_nodes());
        reduced_->solve(right_side, solution);
        return std::ranges::all_of(near_nodes_, [&](Index node) { return solution[node].allFinite(); });
    }
    each_unknown(near_nodes_, [&](Index u, Index node, int k) { x_[u] = in_frame(node, right_side[node])[k]; });
    if (!is_symmetric()) {
        if (!solve_with_friction()) return false;
    } else {
        factor_.substitute(near_parts_, x_);
        factor_.substitute_back(near_parts_, x_);
    }
    solution.resize(nodes_->n_nodes());
    for (const Index node : near_nodes_) solution[node].setZero();
    bool finite = true;  // no tolerance would find a NaN
    each_unknown(near_nodes_, [&](Index u, Index node, int k) {
        solution[node][k] = x_[u];
        finite = finite && std::isfinite(x_[u]);
    });
    turn_out(near_nodes_, solution);
    return finite;
}

void ThetaMatrix::bulk_part(const std::vector<Vec2>& right_side, const std::vector<Vec2>& solution,
                            std::vector<Vec2>& impulse) const {
    impulse.resize(nodes_->n_nodes());
    if (is_reduced_) return reduced_->multiply(solution, impulse);
    for (const Index node : near_nodes_) impulse[node] = right_side[node];
    for (const PointTangent& point : points_)
        point.sides.add_force(-point.symmetric_block * point.sides.jump(solution), impulse);
    // of the friction that follows the contact impulses: what the solution took for it
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(friction_.size());
    for (Eigen::Index j = 0; j < n / 2; ++j)
        friction_[j].sides.add_force(-gmres_.solution().segment<2>(2 * j), impulse);
}

bool ThetaMatrix::find_compliance(std::span<const PointSides> points, Eigen::Ref<Eigen::MatrixXd> compliance) {
    if (is_reduced_) return reduced_->find_compliance(points, compliance);
    return find_compliance(
        points, [](Eigen::Index j) { return j / 2; }, [](Eigen::Index j) { return j % 2; }, compliance);
}

/// Of component component_of(j) of point point_of(j), in succession. With A = L L':   G' A^-1 G = (L^-1 G)' (L^-1 G).
template <class PointOf, class ComponentOf>
bool ThetaMatrix::find_compliance(std::span<const PointSides> points, const PointOf& point_of,
                                  const ComponentOf& component_of, Eigen::Ref<Eigen::MatrixXd> compliance) {
    find_parts(points, std::identity{}, local_parts_);
    local_unknowns_.clear();
    each_unknown(near_nodes_, [&](Index u, Index, int) {
        if (is_marked_[eliminated_in_[u]]) local_unknowns_.push_back(u);
    });
    const Eigen::Index n = compliance.cols(), n_rows = static_cast<Eigen::Index>(local_unknowns_.size());
    if (static_cast<std::size_t>(n * n_rows) > half_.capacity()) return false;
    half_.resize(n * n_rows);
    Eigen::Map<Eigen::MatrixXd> half(half_.data(), n_rows, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const std::size_t point = point_of(j);
        const int k = static_cast<int>(component_of(j));
        if (j == 0 || point_of(j - 1) != point_of(j)) find_parts(points.subspan(point, 1), std::identity{}, path_);
        factor_.set_zero(local_parts_, y_);
        points[point].for_each_node([&](Index node, const auto& weight) {
            for_each_part_of_jump(node, k, weight, [&](Index u, double part) { y_[u] += part; });
        });
        factor_.substitute(path_, y_);
        for (Eigen::Index i = 0; i < n_rows; ++i) half(i, j) = y_[local_unknowns_[i]];
    }
    compliance.setZero();
    auto lower = compliance.selfadjointView<Eigen::Lower>();
    for (Eigen::Index i = 0; i < n_rows; i += half_rows_at_once)
        lower.rankUpdate(half.middleRows(i, std::min(half_rows_at_once, n_rows - i)).transpose());
    compliance.triangularView<Eigen::StrictlyUpper>() = compliance.transpose();
    return true;
}

/// G of solve_with_friction(), whose products are many.
void ThetaMatrix::find_entries_of_friction() {
    entries_of_friction_.clear();
    for (std::size_t j = 0; j < friction_.size(); ++j)
        each_unknown(friction_[j], [&](Index unknown, int k, double weight) {
            entries_of_friction_.push_back({unknown, static_cast<Index>(2 * j) + k, weight});
        });
}

bool ThetaMatrix::solve_with_friction() {
    // A = S + G E G' with the factor of S known and E the friction that follows the contact impulses:
    //     x = S^-1 (b - G y),     y + E G' S^-1 G y = E G' S^-1 b
    // Only the last substitution leaves the parts of the dissection that know G.
    const Eigen::Index n = 2 * static_cast<Eigen::Index>(friction_.size());
    find_entries_of_friction();
    const auto friction_of = [&](const std::vector<double>& x, Eigen::Ref<Eigen::VectorXd> y) {  // y = E G' x
        y.setZero();
        for (const EntryOfFriction& at : entries_of_friction_) y[at.component] += at.weight * x[at.unknown];
        for (Eigen::Index j = 0; j < n / 2; ++j) {
            const Vec2 slip = y.segment<2>(2 * j);
            y.segment<2>(2 * j) = (friction_[j].block - friction_[j].symmetric_block) * slip;
        }
    };
    const auto subtract = [&](const Eigen::Ref<const Eigen::VectorXd>& y, std::vector<double>& x) {  // x -= G y
        for (const EntryOfFriction& at : entries_of_friction_) x[at.unknown] -= at.weight * y[at.component];
    };
    find_parts(
        friction_, [](const PointTangent& point) -> const PointSides& { return point.sides; }, parts_of_friction_);
    const auto product = [&](const Eigen::Ref<const Eigen::VectorXd>& y, Eigen::Ref<Eigen::VectorXd> A_y) {
        factor_.set_zero(parts_of_friction_, y_);
        subtract(y, y_);
        factor_.substitute(parts_of_friction_, y_);
        factor_.substitute_back(parts_of_friction_, y_);
        friction_of(y_, A_y);
        A_y = y - A_y;
    };
    factor_.substitute(near_parts_, x_);
    each_unknown(near_nodes_, [&](Index u, Index, int) { y_[u] = x_[u]; });
    factor_.substitute_back(parts_of_friction_, y_);
    if (friction_part_.size() < n) friction_part_.resize(2 * n);
    friction_of(y_, friction_part_.head(n));
    if (!gmres_.solve(std::cref(product), friction_part_.head(n), 60, accurate_direction))
        return false;  // cref: no copy
    factor_.set_zero(near_parts_, y_);
    subtract(gmres_.solution(), y_);
    factor_.substitute(parts_of_friction_, y_);
    each_unknown(near_nodes_, [&](Index u, Index, int) { x_[u] += y_[u]; });
    factor_.substitute_back(near_parts_, x_);
    return true;
}

}  // namespace knap
