#pragma once
// The length of a Newton step d of the whole body, from the slope of the potential along it,
//
//     d . (r(w) + a M_hat d - H' q(w + a d)),
//
// which is monotone and piecewise linear in a where the problem is convex.
#include "stepper/implicit/condensed_system.hpp"

namespace knap {

class LineSearch {
public:
    explicit LineSearch(const Model& model);

    /// The zero of the slope, or 1 where that goes hardly too far. `system` has found the direction.
    double length(const CondensedSystem& system, const std::vector<ActivePoint>& points);
    /// At most 1, with points on soft springs whose multipliers move by a times `move` [N s]: its zero where the points
    /// change so much on the way that the step goes too far.
    double length_on_soft_springs(const CondensedSystem& system, const std::vector<ActivePoint>& points,
                                  const std::vector<Vec2>& move);

private:
    void begin(const CondensedSystem& system, const std::vector<ActivePoint>& points);
    template <class MultipliersOf>
    double slope(double a, const std::vector<ActivePoint>& points, const MultipliersOf& multipliers_of) const;

    double bulk_slope_ = 0, bulk_curvature_ = 0;  // [N m]
    std::vector<Vec2> turn_;                      // [m/s] per point: (N, T) of the direction
};

}  // namespace knap
