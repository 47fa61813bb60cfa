#pragma once
// The second sufficient test of fans in one piece, for those that the stress criterion does not clear: do the reactions at its points stay within the circles that lie in
// their strength polygons? Round a closed fan with the self-stress of mean zero.
//
//     P_i = P_i-1 + f_i - (m_i/m) F,     |P_i| <= S_i rho_i                 (f_i: forces on the corners, F: their sum; m_i, m likewise the masses)
//
// Any self-stress proves that the fan holds (static theorem of limit analysis), so where this says yes the exact tests would. Of the candidate fans of the
// edge-cracked block it clears 98 in 100, from two numbers a corner that lie in the order of the sweep.
#include "stepper/explicit/mesh_blocks.hpp"

#include <limits>

namespace knap {

class InscribedCircles {
public:
    struct Place {
        double share;      // [-] m_i/m of a corner
        double strength2;  // [N2] of the point after it; infinite where there is none, negative where this test says nothing
    };

    InscribedCircles(const Model& model, const MeshBlocks& blocks);

    /// Of the fan that begins with this corner, in its place in the blocks.
    const Place* of_inner(const MeshBlocks::Corner* first) const { return places_.data() + (first - inner_); }
    const Place* of_bordering(const Index* first) const { return places_.data() + n_inner_ + (first - bordering_); }

    /// `force(i)` [N] on corner i of n, `total` on all. False: not known.
    template <class Force>
    static bool hold(const Place* place, Index n, const Force& force, const Vec2& total) {
        using Pair = Eigen::Array2d;  // x and y at once
        const Pair F = total;
        Pair P = Pair::Zero();
        if (place[n - 1].strength2 < std::numeric_limits<double>::infinity()) {
            for (Index i = 0; i < n; ++i) P -= (n - i) * (force(i).array() - place[i].share * F);
            P *= 1. / n;
        }
        for (Index i = 0; i < n; ++i) {
            P += force(i).array() - place[i].share * F;
            if (P.square().sum() > place[i].strength2) return false;
        }
        return true;
    }

    /// Asks for some places after this one before it is their turn.
    static void prefetch(const Place* place) {
        constexpr std::ptrdiff_t ahead = 24, a_line = 4;
        __builtin_prefetch(place + ahead);
        __builtin_prefetch(place + ahead + a_line);
    }

private:
    void add(const Model& model, const Fan& fan);

    const MeshBlocks::Corner* inner_;
    const Index* bordering_;
    std::size_t n_inner_ = 0;    // corners
    std::vector<Place> places_;  // of the inner corners of all blocks in their order, then of the bordering ones
};

}  // namespace knap
