#pragma once
// The body as a few points know it: the Schur complement S of its matrix A without points on the unknowns R along which
// they act, and the points on it,
//
//     S = ((A^-1)_RR)^-1,        (S + G D G') d = b.
//
// S is dense, and stays while neither the nodes nor the size of the step change (slow loading of a body whose points
// are contacts with obstacles, or few cracks). Newton's steps on the points then leave the factor of the body alone,
// and friction, which makes D unsymmetric, needs no iteration.
#include "stepper/implicit/corner_partition.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <span>

namespace knap {

/// A point in A: the impulse on `after` changes by -block times the change of the relative velocity.
struct PointTangent {
    PointSides sides;
    Eigen::Matrix2d block;            // [kg]
    Eigen::Matrix2d symmetric_block;  // [kg] the same without the friction that follows the contact impulse
    bool operator==(const PointTangent&) const = default;
};

/// The sides of a point, and the components (x, y) of its impulses.
struct ActingPoint {
    PointSides sides;
    std::array<bool, 2> along;
};

class ReducedMatrix {
public:
    static constexpr Eigen::Index max_size = 192;  // unknowns
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_size, max_size>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_size, 1>;

    /// Of bodies of up to `n_nodes` nodes.
    explicit ReducedMatrix(std::size_t n_nodes);

    /// Another S follows, or none.
    void forget() { nodes_.clear(), unknowns_.clear(); }
    /// R has all that these points need. `nodes` are those of its S.
    bool knows(std::span<const ActingPoint> points, const CornerPartition& nodes) const;
    /// R becomes what these points need. False: nothing, or too much to pay.
    bool set_unknowns(std::span<const ActingPoint> points, const CornerPartition& nodes);
    const std::vector<Index>& nodes() const { return nodes_; }        // of the points
    const std::vector<Index>& unknowns() const { return unknowns_; }  // R: 2 node + component
    bool has(Index node) const { return has_node_[node]; }
    bool has(Index node, int k) const { return place_[2 * node + k] >= 0; }
    /// S from (A^-1)_RR. False: rounding leaves it indefinite, or too far from the body: large steps of a body that
    /// only its points hold, whose motion as a whole is 1e8 times as compliant as its strains.
    bool set_compliance(const Matrix& compliance);
    bool is_accurate() const { return is_accurate_; }

    /// False: S + G D G' without the friction that follows the contact impulses is not positive definite.
    bool factorise(std::span<const PointTangent> points);
    void solve(const std::vector<Vec2>& right_side, std::vector<Vec2>& solution) const;
    /// S times a motion of the nodes; zero in other components.
    void multiply(const std::vector<Vec2>& motion, std::vector<Vec2>& impulse) const;
    /// G' (S + G D G')^-1 G of `points` between the nodes, with the symmetric blocks. False: not positive definite.
    bool find_compliance(std::span<const PointSides> points, Eigen::Ref<Eigen::MatrixXd> compliance);

private:
    Eigen::Index size() const { return static_cast<Eigen::Index>(unknowns_.size()); }
    template <class BlockOf>
    void add_points(std::span<const PointTangent> points, const BlockOf& block_of);
    Vector at_unknowns(const std::vector<Vec2>& of_node) const;
    void scatter(const Vector& x, std::vector<Vec2>& of_node) const;
    bool factorise_symmetric(std::span<const PointTangent> points);

    std::vector<Index> nodes_, unknowns_, place_;  // place_: per 2 node + component, in R or -1
    std::vector<std::uint8_t> has_node_;           // [0/1] per node of the body
    std::span<const PointTangent> points_;         // in the factor; the caller keeps them
    bool is_accurate_ = false, is_symmetric_ = true, has_cholesky_ = false;
    Matrix S_, with_points_;          // [kg]
    Eigen::LLT<Matrix> cholesky_;     // of the symmetric blocks
    Eigen::PartialPivLU<Matrix> lu_;  // of all
};

}  // namespace knap
