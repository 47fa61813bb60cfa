#pragma once
// The matrix of an implicit step, M_hat = M + theta^2 h^2 K on the free components of the nodes, plus what the interface points add to it
// in their present states: factorised and solved. From one factor to the next only what changed is computed anew (frontal_factor.hpp).
#include "element/triangle_matrices.hpp"
#include "stepper/common/scheme_options.hpp"
#include "stepper/implicit/corner_partition.hpp"
#include "stepper/implicit/frontal_factor.hpp"
#include "stepper/implicit/gmres.hpp"

#include <Eigen/SparseLU>

#include <array>
#include <span>

namespace knap {

/// Change of the impulse on `after` (minus that on `before`) with their relative velocity: -block. Either may be -1: the support.
struct PointTangent {
    Index fan_point;                  // into Model::fan_points; -1: a contact with an obstacle, `before` is the support
    Index before, after;              // nodes
    Eigen::Matrix2d block;            // [kg]
    Eigen::Matrix2d symmetric_block;  // [kg] the same without the friction that follows the contact
    Index leaf_corner = -1;           // of a contact with an obstacle: a corner of its triangle
    Index beside = -1;                // of a contact between two corners: the node of the second one, and its share
    double share = 0;
};

class ThetaMatrix {
public:
    explicit ThetaMatrix(const Model& model);

    /// The nodes, and which of their components are prescribed.
    void set_nodes(const CornerPartition& partition, const std::vector<std::array<bool, 2>>& prescribed_of_node);
    /// M + stiffness_factor K.
    void set_bulk(double stiffness_factor, MassMatrix mass);

    /// False: without the friction that follows the contact it is not positive definite.
    bool factorise(const std::vector<PointTangent>& points);
    /// Per node; prescribed components of the right-hand side are not read, of the solution zero.
    /// With that friction by GMRES, the factor of the rest being its preconditioner; by LU where that fails.
    void solve(const std::vector<Vec2>& right_hand_side, std::vector<Vec2>& solution);

    bool is_symmetric() const { return friction_.empty(); }  // no friction follows a contact
    bool is_free(Index node, int component) const { return unknown(corner_of_node_[node], component) >= 0; }
    std::size_t n_nodes() const { return corner_of_node_.size(); }
    std::int64_t n_unknowns() const { return factor_.n_unknowns(); }
    std::int64_t n_entries() const { return factor_.n_entries(); }

private:
    /// Unknowns are numbered by the first corner of their node, so that they keep their numbers while other fans come apart.
    Index unknown(Index corner, int component) const { return free_[corner][component] ? 2 * node_name_[corner] + component : -1; }
    bool couples(const FanPoint& point) const;
    Index leaf_of_corner(Index corner) const { return dissection_.leaf_of_triangle[model_.mesh.triangle_of(corner)]; }
    Index leaf_of_point(Index fan_point) const;
    void find_places(const Fan& fan);
    void touch_fan(const Fan& fan);
    void hold(Index fan_point, const Eigen::Matrix2d& block);
    void hold_contacts(std::span<const PointTangent> points);
    void add_contact(const PointTangent& contact, std::vector<Element>& elements) const;
    void add_elements(Index leaf, std::vector<Element>& elements) const;
    bool solve_by_gmres();
    void solve_by_lu();

    const Model& model_;
    const Dissection dissection_;
    FrontalFactor factor_;
    std::vector<Index> first_point_of_leaf_, point_of_leaf_;  // fan points, by the part that they belong to
    std::vector<Index> corner_of_node_;
    std::vector<Index> node_name_;                 // per corner: a corner of its node, the same for all of them
    std::vector<std::array<bool, 2>> free_;        // per corner
    std::vector<Index> eliminated_in_;             // per unknown: part of the dissection
    double stiffness_factor_ = 0;
    MassMatrix mass_ = MassMatrix::lumped;
    std::vector<Eigen::Matrix2d> block_;           // per fan point [kg]: as it is in the factor
    std::vector<Index> holding_, held_before_;     // fan points whose block is not zero
    std::vector<Index> held_in_;                   // per fan point: the last round in which it was given
    Index round_ = 0;
    std::vector<PointTangent> contacts_;           // with obstacles, as they are in the factor
    std::vector<PointTangent> new_contacts_;
    std::vector<PointTangent> friction_;           // points whose blocks are not symmetric
    std::vector<double> x_, pulled_;               // per unknown
    Gmres gmres_;
    Eigen::VectorXd rubbing_;                      // two entries for each point of friction_
    std::vector<Index> lu_unknowns_;
    Eigen::SparseLU<Eigen::SparseMatrix<double, Eigen::ColMajor, Index>, Eigen::NaturalOrdering<Index>> lu_;
};

}  // namespace knap
