#pragma once
// Sweeps of Gauss-Seidel over contacts of rigid bodies with Coulomb friction, which nonlinear conjugate gradients
// accelerate (M. Silcowitz, S. Niebe, K. Erleben, The Visual Computer 26, 2010, 893):
//
//     P' = sweep(P_k),     r_k = P' - P_k,     beta = |r_k|^2/|r_k-1|^2, norms of r.W r with the own blocks
//     P_k+1 = P' + beta d_k-1,     d_k = r_k + beta d_k-1;     where beta > 1: P_k+1 = P', d_k = 0
//
// The last step is a sweep alone, so that the impulses lie in their cones. Contacts that are open take part in every
// eighth sweep and in the last one.
#include "nonsmooth/cluster_contact.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace knap {

class BodySweeps {
public:
    /// Contacts without cohesion or couplings of their own; `own` [1/kg]: their blocks of W.
    void read(const std::vector<ClusterContact>& contacts, const std::vector<ClusterBody>& bodies,
              const std::vector<ClusterTerm>& terms, const std::vector<Eigen::Matrix2d>& own);
    /// Until no rate changes by more than `change` [m/s]; the impulses go into the contacts. How many sweeps it took.
    int run(double change, int max_sweeps, std::vector<ClusterContact>& contacts);

private:
    struct Part {  // of a contact, on a body
        Index body;
        Vec3 along_N, along_T;  // V += (along_N . c, along_T . c) of the change c of its velocities
        Vec3 by_N, by_T;        // c += P_N by_N + P_T by_T
    };
    struct Row {
        Vec2 free;                // [m/s]
        double W_NN, W_TN, W_TT;  // [1/kg] own block
        bool may_touch;
        double bound;                   // [m/s] of V_N+
        std::array<double, 2> kinks;    // [m/s] of V_T+, ascending, each with half of the friction
        double friction;                // [-]
        Vec2 impulse, step, direction;  // [N s] P, r, d
        Index first_part, last_part;
    };
    struct Change {
        double largest = 0, norm2 = 0;  // [m/s] of a rate by the impulse of its own contact; [J] |r|^2
    };
    Change sweep(const std::vector<Index>& rows);
    void solve(Row& row, Change& change);
    static double tangential(const Row& row, double p, double free);

    std::vector<Row> rows_;
    std::vector<Part> parts_;
    std::vector<Index> all_, closed_;               // rows: with an impulse or a change in the last sweep over all
    std::vector<Vec3> change_, start_, direction_;  // [m/s, m/s, rad/s] of the bodies: c, before the sweep, by d
};

}  // namespace knap
