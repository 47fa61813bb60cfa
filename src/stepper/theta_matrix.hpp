#pragma once
// The matrix of an implicit step, M_hat = M + theta^2 h^2 K on the free components of the nodes, plus what the interface points add to it
// in their present states: factorised and solved.
#include "bulk/triangle_matrices.hpp"
#include "stepper/corner_partition.hpp"
#include "stepper/scheme_options.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <array>
#include <span>

namespace knap {

/// Change of the impulse on `after` (minus that on `before`) with their relative velocity: -block. Either may be -1: the ground.
struct PointTangent {
    Index before, after;              // nodes
    Eigen::Matrix2d block;            // [kg]
    Eigen::Matrix2d symmetric_block;  // [kg] the same without the friction that follows the contact
};

class ThetaMatrix {
public:
    using Sparse = Eigen::SparseMatrix<double, Eigen::ColMajor, Index>;

    explicit ThetaMatrix(const Model& model) : model_(model) {}

    /// Numbers the components that are free and finds where the triangles' and points' entries go. `points`: their nodes.
    void set_pattern(const CornerPartition& partition, const std::vector<std::array<bool, 2>>& prescribed_of_node,
                     std::span<const PointTangent> points);
    /// M + stiffness_factor K.
    void set_bulk(double stiffness_factor, MassMatrix mass);

    /// False: without the friction that follows the contact it is not positive definite.
    bool factorise(std::span<const PointTangent> points);
    /// Per node; prescribed components of the right-hand side are not read, of the solution zero.
    /// With that friction by GMRES, the factor of the rest being its preconditioner (Y. Saad, M. Schultz 1986); by LU where that fails.
    void solve(const std::vector<Vec2>& right_hand_side, std::vector<Vec2>& solution);

    Index n_unknowns() const { return n_unknowns_; }
    bool is_symmetric() const { return symmetric_; }  // no friction follows a contact
    Index unknown(Index node, int component) const { return unknown_[2 * node + component]; }  // or -1

private:
    void assemble(std::span<const PointTangent> points, Eigen::Matrix2d PointTangent::*block, Sparse& matrix) const;
    Eigen::VectorXd solve_unsymmetric(const Eigen::VectorXd& b);
    void add_block(Sparse& matrix, Index entry, Index column_node, const Eigen::Ref<const Eigen::Matrix2d>& block, double sign) const;
    Index entry_of(Index row_node, Index column_node) const;  // into neighbour_

    const Model& model_;
    CornerPartition partition_;
    std::vector<Index> unknown_;          // 2 per node
    Index n_unknowns_ = 0;
    std::vector<Index> first_neighbour_;  // per node, into neighbour_
    std::vector<Index> neighbour_;        // coupled nodes, ascending
    std::vector<Index> row_offset_;       // per neighbour: its rows begin so far down the column
    std::vector<Index> triangle_entry_;   // 9 per triangle: neighbour entry of (row corner, column corner)
    Sparse bulk_, total_, without_friction_;
    bool symmetric_ = true;
    bool analysed_ldlt_ = false, factorised_lu_ = false;
    Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<Index>> ldlt_;
    Eigen::SparseLU<Sparse, Eigen::NaturalOrdering<Index>> lu_;
};

}  // namespace knap
