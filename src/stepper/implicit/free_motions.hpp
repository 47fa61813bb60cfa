#pragma once
// Rigid motions that neither a support nor a point resists, in steps so large that theta^2 h^2 K hides the inertia.
//
// Summed over such a motion N, the balance of an implicit step has no forces of the body, elastic or thermal:
//
//     N' [theta M (v+ - v) - theta h F - H' q] = 0                   linear and angular momentum of what is free
//
// In numbers these forces leave the rounding of theta^2 h^2 K w, which from some 1e4/omega on is no longer small beside
// M w. There they lose their resultants on the pieces (parts that bonded fans join, with rigid motions R), Newton's
// direction d gets the motion along N for which the sum vanishes, and M_hat more mass, which keeps it definite in spite
// of rounding and, with that motion, makes Newton's method no slower:
//
//     f <- f - M R (R' M R)^-1 R' f
//     d <- d + N (N' M N)^-1 (b - N' M d),     b = -N' [...] of the present rates
//
// N are those combinations of R that move no prescribed component, and no point in a direction in which its law has a
// slope.
#include "stepper/implicit/active_point.hpp"
#include "stepper/implicit/rigid_pieces.hpp"

#include <Eigen/Cholesky>

namespace knap {

class FreeMotions {
public:
    /// theta^2 h^2 times the largest K_ii/M_ii: a larger one hides the inertia.
    static constexpr double hidden = 1e8;
    /// Of theta^2 h^2 K_ii: the inertia that keeps M_hat definite.
    static constexpr double least_inertia = 1e-12;

    FreeMotions(const Model& model, const ImplicitBulk& bulk) : model_(model), bulk_(bulk) {}

    /// The pieces between these nodes, which must outlive their use here.
    void set(const CornerPartition& nodes);
    /// N by the present laws of these points. False: there is none.
    bool find(const std::vector<ActivePoint>& points);
    /// From the balance `impulse` [N s, per node] of the body at `rate`, without the points.
    void remove_resultants(const std::vector<Vec2>& rate, std::vector<Vec2>& impulse) const;
    /// Adds the motion along N to a change of `rate` [m/s, per node]. Returns the largest rate that it adds.
    double complete(const std::vector<ActivePoint>& points, const std::vector<Vec2>& rate,
                    std::vector<Vec2>& change) const;

private:
    struct Place {
        Index group = -1;  // pieces that points join
        Index first = 0;   // of its three motions in the group
    };
    struct Group {
        Eigen::Index n = 0;                    // rigid motions of its pieces
        Eigen::MatrixXd free;                  // N: of these, in each column, whose largest entry is 1
        Eigen::LDLT<Eigen::MatrixXd> inertia;  // N' M N
    };
    /// A rate as a sum over the motions of pieces.
    struct Term {
        Index piece;
        Eigen::Vector3d along;
    };

    void add_term(Index node, const Vec2& along, std::vector<Term>& terms) const;
    template <class Visit>  // (terms of a rate that is not free)
    void for_each_restraint(const std::vector<ActivePoint>& points, const Visit& visit) const;
    void find_free(Group& group, const Eigen::MatrixXd& restraints, const Eigen::MatrixXd& inertia) const;

    const Model& model_;
    const ImplicitBulk& bulk_;
    const CornerPartition* nodes_ = nullptr;
    std::vector<Index> piece_of_node_;
    RigidPieces rigid_;
    std::vector<Place> places_;  // per piece
    std::vector<Group> groups_;
    mutable std::vector<Vec2> of_corner_;
    mutable std::vector<Term> terms_;
};

}  // namespace knap
