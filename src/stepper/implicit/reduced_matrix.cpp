#include "stepper/implicit/reduced_matrix.hpp"

#include "base/reserve_capacity.hpp"

#include <algorithm>
#include <utility>

namespace knap {
namespace {

constexpr double operations_per_node = 1600;  // of the body: what a dense factor may cost beside a sparse one

bool is_positive(const Eigen::Matrix2d& block) {
    return block(0, 0) >= 0 && block(1, 1) >= 0 && block.determinant() >= 0;
}

}  // namespace

ReducedMatrix::ReducedMatrix(std::size_t n_nodes) {
    reserve_capacity(n_nodes, nodes_, place_);
    is_free_.reserve(max_size);
}

bool ReducedMatrix::knows(std::span<const PointSides> points) const {
    bool all = !nodes_.empty();
    for (const PointSides& point : points)
        point.for_each_node([&](Index node, double) { all = all && place_[node] >= 0; });
    return all;
}

bool ReducedMatrix::set_nodes(std::span<const PointSides> points, const CornerPartition& nodes) {
    forget();
    place_.assign(nodes.n_nodes(), -1);
    for (const PointSides& point : points)
        point.for_each_node([&](Index node, double) {
            if (std::exchange(place_[node], 0) < 0) nodes_.push_back(node);
        });
    const double n = static_cast<double>(size());
    if (nodes_.empty() || size() > max_size || n * n * n > operations_per_node * nodes.n_nodes()) {
        forget();
        return false;
    }
    std::ranges::sort(nodes_);
    is_free_.clear();
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        place_[nodes_[i]] = static_cast<Index>(i);
        for (int k = 0; k < 2; ++k) is_free_.push_back(!nodes.prescribed[nodes_[i]][k]);
    }
    return true;
}

bool ReducedMatrix::set_compliance(const Matrix& compliance) {
    with_points_ = compliance;
    for (Eigen::Index i = 0; i < size(); ++i)
        if (!is_free_[i]) with_points_(i, i) = 1;
    cholesky_.compute(with_points_);
    if (cholesky_.info() != Eigen::Success) {
        forget();
        return false;
    }
    S_.setIdentity(size(), size());
    cholesky_.solveInPlace(S_);
    S_ = (0.5 * (S_ + S_.transpose())).eval();
    return true;
}

template <class BlockOf>
void ReducedMatrix::add_points(std::span<const PointTangent> points, const BlockOf& block_of) {
    with_points_ = S_;
    for (const PointTangent& point : points)
        point.sides.for_each_node([&](Index a, double weight_a) {
            point.sides.for_each_node([&](Index b, double weight_b) {
                with_points_.block<2, 2>(2 * place_[a], 2 * place_[b]) += weight_a * weight_b * block_of(point);
            });
        });
    for (Eigen::Index i = 0; i < size(); ++i) {
        if (is_free_[i]) continue;
        with_points_.row(i).setZero();
        with_points_.col(i).setZero();
        with_points_(i, i) = 1;
    }
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

/// Zero in prescribed components.
ReducedMatrix::Vector ReducedMatrix::at_nodes(const std::vector<Vec2>& of_node) const {
    Vector x(size());
    for (Eigen::Index i = 0; i < size(); ++i) x[i] = is_free_[i] ? of_node[nodes_[i / 2]][i % 2] : 0;
    return x;
}

void ReducedMatrix::solve(const std::vector<Vec2>& right_side, std::vector<Vec2>& solution) const {
    Vector x = at_nodes(right_side);
    if (is_symmetric_) cholesky_.solveInPlace(x);
    else x = lu_.solve(x).eval();
    for (Eigen::Index i = 0; i < size(); ++i) solution[nodes_[i / 2]][i % 2] = x[i];
}

void ReducedMatrix::multiply(const std::vector<Vec2>& motion, std::vector<Vec2>& impulse) const {
    const Vector product = S_.lazyProduct(at_nodes(motion));
    for (Eigen::Index i = 0; i < size(); ++i) impulse[nodes_[i / 2]][i % 2] = is_free_[i] ? product[i] : 0;
}

bool ReducedMatrix::find_compliance(std::span<const PointSides> points, Eigen::Ref<Eigen::MatrixXd> compliance) {
    if (!has_cholesky_ && !factorise_symmetric(points_)) return false;
    for (std::size_t j = 0; j < 2 * points.size(); ++j) {
        Vector x = Vector::Zero(size());
        points[j / 2].for_each_node([&](Index node, double weight) {
            const Eigen::Index i = 2 * place_[node] + static_cast<Eigen::Index>(j % 2);
            if (is_free_[i]) x[i] += weight;
        });
        cholesky_.solveInPlace(x);
        for (std::size_t i = 0; i < points.size(); ++i) {
            Vec2 jump = Vec2::Zero();
            points[i].for_each_node(
                [&](Index node, double weight) { jump += weight * x.segment<2>(2 * place_[node]); });
            compliance.block<2, 1>(2 * static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = jump;
        }
    }
    return true;
}

}  // namespace knap
