#pragma once
// The matrices of an implicit step with a crack that runs: M_hat = M + theta^2 h^2 K and the blocks of the interface points, for both
// sides.
#include "model/model.hpp"
#include "stepper/implicit/theta_matrix.hpp"

#include <Eigen/SparseCore>

#include <string>
#include <vector>

namespace knap {

using SparseMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;

/// A scenario's model and the nodes that its crack splits, one after the other.
struct CrackedBody {
    std::string name;
    Model model;
    double stiffness_factor;  // [s2] theta^2 h^2
    MassMatrix mass;
    std::vector<Index> path;  // fans, in the order in which they come apart
};

CrackedBody cracked_body(const std::string& scenario, const std::string& mesh_size, int n_split);

/// A state of the crack: the first `n_split` fans of the path have come apart; `stronger` of their points hold on more.
struct Setting {
    Setting(const CrackedBody& body, Index n_split, Index n_stronger = 0);

    CornerPartition partition;
    std::vector<PointTangent>
        points;  // two of three points of fans that have come apart, and of the glue that still holds
    std::vector<Vec2> right_hand_side() const;
    Eigen::VectorXd as_vector(const std::vector<Vec2>& of_node) const;  // free components, in the order of matrix()
    std::vector<Index> unknown;                                         // per node and component, or -1
    Index n_unknowns = 0;
};

/// The entries of M_hat of every triangle: a sum of them, for a clock.
double element_matrices(const CrackedBody& body);
/// The whole matrix (both triangles), of the free components in the order of the nodes.
SparseMatrix assembled(const CrackedBody& body, const Setting& setting);

}  // namespace knap
