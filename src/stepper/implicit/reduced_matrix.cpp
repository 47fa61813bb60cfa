#include "stepper/implicit/reduced_matrix.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <utility>

namespace knap {
namespace {

constexpr double max_condition = 1e4;         // of (A^-1)_RR: S has its rounding times this number
constexpr double operations_per_node = 1600;  // of the body: what a dense factor may cost beside a sparse one

bool is_positive(const Eigen::Matrix2d& block) {
    return block(0, 0) >= 0 && block(1, 1) >= 0 && block.determinant() >= 0;
}

/// visit(node, its components that are free and along which a point acts)
template <class Visit>
void each_node(std::span<const ActingPoint> points, const CornerPartition& nodes, const Visit& visit) {
    for (const ActingPoint& point : points)
        point.sides.for_each_node([&](Index node, const auto&) {
            const std::array<bool, 2>& prescribed = nodes.prescribed[node];
            const bool both = !point.sides.lever.isZero(0) && (point.along[0] || point.along[1]);
            const auto acts = [&](int k) { return (point.along[k] || both) && !prescribed[k]; };
            visit(node, std::array{acts(0), acts(1)});
        });
}

}  // namespace

ReducedMatrix::ReducedMatrix(std::size_t n_nodes) {
    reserve_capacity(2 * n_nodes, place_, unknowns_);
    reserve_capacity(n_nodes, nodes_, has_node_);
}

bool ReducedMatrix::knows(std::span<const ActingPoint> points, const CornerPartition& nodes) const {
    if (unknowns_.empty()) return false;
    bool all = true;
    each_node(points, nodes, [&](Index node, const std::array<bool, 2>& needed) {
        all = all && has(node) && (!needed[0] || has(node, 0)) && (!needed[1] || has(node, 1));
    });
    return all;
}

bool ReducedMatrix::set_unknowns(std::span<const ActingPoint> points, const CornerPartition& nodes) {
    forget();
    place_.assign(2 * nodes.n_nodes(), -1), has_node_.assign(nodes.n_nodes(), 0);
    each_node(points, nodes, [&](Index node, const std::array<bool, 2>& needed) {
        if (!std::exchange(has_node_[node], 1)) nodes_.push_back(node);
        for (Index i = 2 * node; i < 2 * node + 2; ++i)
            if (needed[i % 2] && std::exchange(place_[i], 0) < 0) unknowns_.push_back(i);
    });
    const double n = static_cast<double>(size());
    if (unknowns_.empty() || size() > max_size || n * n * n > operations_per_node * nodes.n_nodes()) {
        forget();
        return false;
    }
    std::ranges::sort(nodes_);
    std::ranges::sort(unknowns_);
    for (std::size_t i = 0; i < unknowns_.size(); ++i) place_[unknowns_[i]] = static_cast<Index>(i);
    return true;
}

bool ReducedMatrix::set_compliance(const Matrix& compliance) {
    is_accurate_ = false;
    cholesky_.compute(compliance);
    if (cholesky_.info() != Eigen::Success) return false;
    S_.setIdentity(size(), size());
    cholesky_.solveInPlace(S_);
    S_ = (0.5 * (S_ + S_.transpose())).eval();
    return is_accurate_ = compliance.norm() * S_.norm() <= max_condition;
}

template <class BlockOf>
void ReducedMatrix::add_points(std::span<const PointTangent> points, const BlockOf& block_of) {
    with_points_ = S_;
    const auto place = [&](Index node) { return std::array{place_[2 * node], place_[2 * node + 1]}; };
    for (const PointTangent& point : points) point.sides.add_block(block_of(point), place, with_points_);
}

bool ReducedMatrix::factorise_symmetric(std::span<const PointTangent> points) {
    add_points(points, [](const PointTangent& point) -> const Eigen::Matrix2d& { return point.symmetric_block; });
    cholesky_.compute(with_points_);
    return has_cholesky_ = cholesky_.info() == Eigen::Success;
}

bool ReducedMatrix::factorise(std::span<const PointTangent> points) {
    points_ = points;
    has_cholesky_ = false;
    is_symmetric_ = std::ranges::all_of(points, [](const PointTangent& p) { return p.block == p.symmetric_block; });
    const bool surely_positive =
        std::ranges::all_of(points, [](const PointTangent& p) { return is_positive(p.symmetric_block); });
    if ((is_symmetric_ || !surely_positive) && !factorise_symmetric(points)) return false;
    if (is_symmetric_) return true;
    add_points(points, [](const PointTangent& point) -> const Eigen::Matrix2d& { return point.block; });
    lu_.compute(with_points_);
    return true;
}

ReducedMatrix::Vector ReducedMatrix::at_unknowns(const std::vector<Vec2>& of_node) const {
    Vector x(size());
    for (Eigen::Index i = 0; i < size(); ++i) x[i] = of_node[unknowns_[i] / 2][unknowns_[i] % 2];
    return x;
}

void ReducedMatrix::scatter(const Vector& x, std::vector<Vec2>& of_node) const {
    for (const Index node : nodes_) of_node[node].setZero();
    for (Eigen::Index i = 0; i < size(); ++i) of_node[unknowns_[i] / 2][unknowns_[i] % 2] = x[i];
}

void ReducedMatrix::solve(const std::vector<Vec2>& right_side, std::vector<Vec2>& solution) const {
    Vector x = at_unknowns(right_side);
    if (is_symmetric_) cholesky_.solveInPlace(x);
    else x = lu_.solve(x).eval();
    scatter(x, solution);
}

void ReducedMatrix::multiply(const std::vector<Vec2>& motion, std::vector<Vec2>& impulse) const {
    scatter(S_.lazyProduct(at_unknowns(motion)), impulse);
}

bool ReducedMatrix::find_compliance(std::span<const PointSides> points, Eigen::Ref<Eigen::MatrixXd> compliance) {
    if (!has_cholesky_ && !factorise_symmetric(points_)) return false;
    const auto each_unknown = [&](std::size_t j, const auto& visit) {  // of component j % 2 of point j / 2
        points[j / 2].for_each_node([&](Index node, const auto& weight) {
            const Vec2 of_motion = transposed(weight) * Vec2(Vec2::Unit(static_cast<Eigen::Index>(j % 2)));
            for (Index k = 0; k < 2; ++k)
                if (const Index i = place_[2 * node + k]; i >= 0 && of_motion[k] != 0) visit(i, of_motion[k]);
        });
    };
    for (std::size_t j = 0; j < 2 * points.size(); ++j) {
        Vector x = Vector::Zero(size());
        each_unknown(j, [&](Index i, double weight) { x[i] += weight; });
        cholesky_.solveInPlace(x);
        for (std::size_t i = 0; i < 2 * points.size(); ++i) {
            double jump = 0;
            each_unknown(i, [&](Index unknown, double weight) { jump += weight * x[unknown]; });
            compliance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = jump;
        }
    }
    return true;
}

}  // namespace knap
