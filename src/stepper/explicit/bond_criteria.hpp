#pragma once
// Cheap sufficient criteria for bonded fans; what they do not clear goes to BondCheck. A point holds every reaction
// up to its sure strength S sigma_c min(1, (gamma + mu)/sqrt(1 + mu^2)), the radius of the circle inscribed in its
// strength polygon (min(1, gamma) of the half ellipse). Any self-stress with admissible reactions proves that the fan
// is bonded (static theorem of limit analysis).
//
// 1. Stress criterion. With |sigma|_F <= s in all its triangles, a fan that moves as one has the reactions
//    R_j = sum_i a_ji f_i (walk round the vertex, least-norm self-stress), |f_i| <= s L_i (force_of_unit_stress). It is
//    bonded if s <= min_j sure strength_j / sum_i |a_ji| L_i.
// 2. Inscribed circles. The reactions of the actual forces f_i on the corners, round a closed fan with the self-stress
//    of zero mean,
//        P_i = P_i-1 + f_i - (m_i/m) F,     F = sum f_i,     m = sum m_i,
//    are below the sure strengths. It clears 98 of 100 candidates in the edge-cracked block, from two numbers per
//    corner.
//
// 3. Last proof. Where BondCheck found admissible reactions R_j of forces f_i, those of the forces f_i + d_i with the
//    same R before the first corner differ by sum_(i <= j) (m_i/m sum d - d_i), whose length is at most sum_i |d_i|: so
//    the fan is bonded while that is less than the distance of all R_j from the bounds of their strengths.
#include "stepper/explicit/absorbing_boundary.hpp"

#include <limits>
#include <memory>
#include <vector>

namespace knap {

/// [Pa^2] per fan: bonded while |sigma|_F^2 does not exceed it. Infinite for a fan that cannot split in a step,
/// negative for one that is loaded or driven and must always be tested.
std::vector<double> stress_thresholds(const Model& model, std::span<const Dashpot> dashpots = {});

struct InscribedCircle {
    double share;      // [-] m_i/m of a corner
    double strength2;  // [N2] of the point after it; infinite where there is none, negative in a driven fan
};

/// Appends those of the corners of a fan.
void add_inscribed_circles(const Model& model, const Fan& fan, std::vector<InscribedCircle>& circles);

/// `circle`, of n corners; `force(i)` [N] on corner i, `total` on all. False: not known.
template <class Force>
bool within_inscribed_circles(const InscribedCircle* circle, Index n, const Force& force, const Vec2& total) {
    using Pair = Eigen::Array2d;  // x and y at once
    const Pair F = total;
    Pair P = Pair::Zero();
    if (circle[n - 1].strength2 < infinity) {
        for (Index i = 0; i < n; ++i) P -= (n - i) * (force(i).array() - circle[i].share * F);
        P *= 1. / n;
    }
    for (Index i = 0; i < n; ++i) {
        P += force(i).array() - circle[i].share * F;
        if (P.square().sum() > circle[i].strength2) return false;
    }
    return true;
}

/// The forces that BondCheck held last in each fan, of strengths and normals that stay: small rotations, no laws that
/// follow the temperature. Different fans may be asked and kept at once.
class BondProofs {
public:
    explicit BondProofs(const Model& model)
        : model_(model),
          lasts_(!model.large_rotation && !model.laws_follow_temperature),
          force_(std::make_unique_for_overwrite<Eigen::Vector2f[]>(model.fan_corners.size())),
          margin_(model.fans.size(), 0) {}

    /// `force(i)` [N] on corner i of fan f. False: not known.
    template <class Force>
    bool hold(Index f, const Force& force) const {
        const Fan& fan = model_.fans[f];
        double moved = 0;  // [N]
        for (Index i = 0; i < fan.n_corners && moved < margin_[f]; ++i)
            moved += (force(i) - force_[fan.first_corner + i].template cast<double>()).template lpNorm<1>();
        return moved < margin_[f];
    }
    /// `margin` [N] of `force`.
    template <class Force>
    void keep(Index f, const Force& force, double margin) {
        if (!lasts_) return;
        const Fan& fan = model_.fans[f];
        constexpr double precision = std::numeric_limits<float>::epsilon();  // far above that of the walk round the fan
        double rounding = 0;                                                 // [N]
        for (Index i = 0; i < fan.n_corners; ++i) {
            force_[fan.first_corner + i] = force(i).template cast<float>();
            rounding += precision * force(i).template lpNorm<1>();
        }
        margin_[f] = static_cast<float>(std::max(0.0, (1 - precision) * margin - rounding));
    }

private:
    const Model& model_;
    bool lasts_;
    // [N] of the corners of fans that were proven, in the order of Model::fan_corners; others are not set
    std::unique_ptr<Eigen::Vector2f[]> force_;
    std::vector<float> margin_;  // [N] per fan; zero: no proof
};

}  // namespace knap
