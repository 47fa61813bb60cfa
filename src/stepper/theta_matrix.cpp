#include "stepper/theta_matrix.hpp"

#include <unsupported/Eigen/IterativeSolvers>

#include <algorithm>

namespace knap {
namespace {

constexpr Index few_unknowns = 1500;  // up to here LU is as fast

}  // namespace

void ThetaMatrix::set_pattern(const CornerPartition& partition, const std::vector<std::array<bool, 2>>& prescribed_of_node,
                              std::span<const PointTangent> points) {
    partition_ = partition;
    const Index n_nodes = partition.n_nodes();
    unknown_.assign(2 * n_nodes, -1);
    n_unknowns_ = 0;
    for (Index i = 0; i < n_nodes; ++i)
        for (int k = 0; k < 2; ++k)
            if (!prescribed_of_node[i][k]) unknown_[2 * i + k] = n_unknowns_++;

    // coupled nodes: those of a triangle, and those of a point
    const auto each_pair = [&](const auto& visit) {
        for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) visit(partition.node_of_corner[3 * t + i], partition.node_of_corner[3 * t + j]);
        for (const PointTangent& point : points) {
            if (point.before < 0 || point.after < 0) continue;
            visit(point.before, point.after);
            visit(point.after, point.before);
        }
    };
    std::vector<Index> count(n_nodes + 1, 0), row;
    each_pair([&](Index, Index column) { ++count[column + 1]; });
    for (Index i = 0; i < n_nodes; ++i) count[i + 1] += count[i];
    row.resize(count[n_nodes]);
    std::vector<Index> place(count.begin(), count.end() - 1);
    each_pair([&](Index r, Index column) { row[place[column]++] = r; });

    first_neighbour_.assign(n_nodes + 1, 0);
    neighbour_.clear();
    row_offset_.clear();
    const auto n_free = [&](Index node) { return (unknown_[2 * node] >= 0) + (unknown_[2 * node + 1] >= 0); };
    bulk_ = Sparse(n_unknowns_, n_unknowns_);
    std::vector<Index> outer(n_unknowns_ + 1, 0), inner;
    for (Index column = 0; column < n_nodes; ++column) {
        std::sort(row.begin() + count[column], row.begin() + count[column + 1]);
        Index offset = 0;
        for (Index i = count[column]; i < count[column + 1]; ++i) {
            if (i > count[column] && row[i] == row[i - 1]) continue;
            neighbour_.push_back(row[i]);
            row_offset_.push_back(offset);
            offset += n_free(row[i]);
        }
        first_neighbour_[column + 1] = static_cast<Index>(neighbour_.size());
        for (int k = 0; k < 2; ++k) {
            if (unknown_[2 * column + k] < 0) continue;
            for (Index e = first_neighbour_[column]; e < first_neighbour_[column + 1]; ++e)
                for (int r = 0; r < 2; ++r)
                    if (const Index unknown = unknown_[2 * neighbour_[e] + r]; unknown >= 0) inner.push_back(unknown);
            outer[unknown_[2 * column + k] + 1] = static_cast<Index>(inner.size());
        }
    }
    bulk_.resizeNonZeros(static_cast<Index>(inner.size()));
    std::copy(outer.begin(), outer.end(), bulk_.outerIndexPtr());
    std::copy(inner.begin(), inner.end(), bulk_.innerIndexPtr());

    triangle_entry_.resize(9 * model_.mesh.n_triangles());
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                triangle_entry_[9 * t + 3 * i + j] = entry_of(partition.node_of_corner[3 * t + i], partition.node_of_corner[3 * t + j]);
    analysed_ldlt_ = false;
}

Index ThetaMatrix::entry_of(Index row_node, Index column_node) const {
    const auto begin = neighbour_.begin() + first_neighbour_[column_node], end = neighbour_.begin() + first_neighbour_[column_node + 1];
    return static_cast<Index>(std::lower_bound(begin, end, row_node) - neighbour_.begin());
}

void ThetaMatrix::add_block(Sparse& matrix, Index e, Index column_node, const Eigen::Ref<const Eigen::Matrix2d>& block, double sign) const {
    const Index row_node = neighbour_[e];
    for (int k = 0; k < 2; ++k) {
        const Index column = unknown_[2 * column_node + k];
        if (column < 0) continue;
        double* value = matrix.valuePtr() + matrix.outerIndexPtr()[column] + row_offset_[e];
        for (int r = 0; r < 2; ++r)
            if (unknown_[2 * row_node + r] >= 0) *value++ += sign * block(r, k);
    }
}

void ThetaMatrix::set_bulk(double stiffness_factor, MassMatrix mass) {
    std::fill(bulk_.valuePtr(), bulk_.valuePtr() + bulk_.nonZeros(), 0.0);
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
        const Matrix6 A = mass_matrix(model_.corner_mass[3 * t], mass == MassMatrix::consistent) +
                          stiffness_factor * stiffness_matrix(model_.mesh, t, model_.materials[model_.mesh.region[t]], model_.plane, model_.thickness);
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                add_block(bulk_, triangle_entry_[9 * t + 3 * i + j], partition_.node_of_corner[3 * t + j], A.block<2, 2>(2 * i, 2 * j), 1);
    }
}

void ThetaMatrix::assemble(std::span<const PointTangent> points, Eigen::Matrix2d PointTangent::*block, Sparse& matrix) const {
    matrix = bulk_;
    for (const PointTangent& point : points) {
        const Index a = point.after, b = point.before;
        if (a >= 0) add_block(matrix, entry_of(a, a), a, point.*block, 1);
        if (b >= 0) add_block(matrix, entry_of(b, b), b, point.*block, 1);
        if (a < 0 || b < 0) continue;
        add_block(matrix, entry_of(a, b), b, point.*block, -1);
        add_block(matrix, entry_of(b, a), a, point.*block, -1);
    }
}

bool ThetaMatrix::factorise(std::span<const PointTangent> points) {
    symmetric_ = std::all_of(points.begin(), points.end(), [](const PointTangent& p) { return p.block == p.symmetric_block; });
    factorised_lu_ = false;
    if (n_unknowns_ == 0) return true;
    assemble(points, &PointTangent::symmetric_block, without_friction_);
    if (!symmetric_) assemble(points, &PointTangent::block, total_);
    if (!analysed_ldlt_) ldlt_.analyzePattern(without_friction_);
    analysed_ldlt_ = true;
    ldlt_.factorize(without_friction_);
    return ldlt_.info() == Eigen::Success && (ldlt_.vectorD().array() > 0).all();
}

namespace {

/// What Eigen's iterative solvers ask of a preconditioner: here a factor that exists already.
template <class Factor>
class KnownFactor {
public:
    using StorageIndex = Index;
    void use(const Factor& factor) { factor_ = &factor; }
    template <class Matrix> KnownFactor& analyzePattern(const Matrix&) { return *this; }
    template <class Matrix> KnownFactor& factorize(const Matrix&) { return *this; }
    template <class Matrix> KnownFactor& compute(const Matrix&) { return *this; }
    template <class Rhs> auto solve(const Rhs& b) const { return factor_->solve(b); }
    Eigen::ComputationInfo info() { return Eigen::Success; }

private:
    const Factor* factor_ = nullptr;
};

}  // namespace

Eigen::VectorXd ThetaMatrix::solve_unsymmetric(const Eigen::VectorXd& b) {
    if (!factorised_lu_ && n_unknowns_ > few_unknowns) {
        Eigen::GMRES<Sparse, KnownFactor<decltype(ldlt_)>> gmres;
        gmres.preconditioner().use(ldlt_);
        gmres.set_restart(60);
        gmres.setMaxIterations(60);
        gmres.setTolerance(1e-8);
        gmres.compute(total_);
        Eigen::VectorXd x = gmres.solve(b);
        if (gmres.info() == Eigen::Success && x.allFinite()) return x;
    }
    if (!factorised_lu_) {
        lu_.isSymmetric(true);
        lu_.setPivotThreshold(0.01);
        lu_.compute(total_);
        factorised_lu_ = true;
    }
    return lu_.solve(b);
}

void ThetaMatrix::solve(const std::vector<Vec2>& right_hand_side, std::vector<Vec2>& solution) {
    Eigen::VectorXd b(n_unknowns_), x(n_unknowns_);
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) b[unknown_[i]] = right_hand_side[i / 2][i % 2];
    if (n_unknowns_ > 0 && symmetric_) x = ldlt_.solve(b);
    if (n_unknowns_ > 0 && !symmetric_) x = solve_unsymmetric(b);
    solution.assign(right_hand_side.size(), Vec2::Zero());
    for (std::size_t i = 0; i < unknown_.size(); ++i)
        if (unknown_[i] >= 0) solution[i / 2][i % 2] = x[unknown_[i]];
}

}  // namespace knap
