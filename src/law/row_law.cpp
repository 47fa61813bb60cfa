#include "law/row_law.hpp"

#include <Eigen/LU>

namespace knap {

/// The zero of P - project(Q), Q = P - r V, linearised: P - slope (P - r V) = project(Q) - slope Q.
RowLaw::Tangent RowLaw::tangent(const Vec2& V, const Vec2& P, double r) const {
    const Vec2 Q = P - r * V;
    const Projection at = project(Q, r);
    return {r * at.slope, Eigen::Matrix2d::Identity() - at.slope, at.impulse - at.slope * Q};
}

/// Newton's steps as long as they halve what P misses, else steps of the projection itself, a contraction where the law
/// is associated.
Vec2 RowLaw::impulse(const Eigen::Matrix2d& W, const Vec2& free, const Vec2& guess) const {
    constexpr int most = 100;
    const double r = 1 / W.trace();
    const auto projected = [&](const Vec2& P) { return project(P - r * (free + W * P), r).impulse; };
    Vec2 P = guess, next = projected(P);
    for (int i = 0; i < most && next != P; ++i) {
        const Tangent at = tangent(free + W * P, P, r);
        const Vec2 step = (at.of_rate * W + at.of_impulse).partialPivLu().solve(at.right - at.of_rate * free);
        const Vec2 after = projected(step);
        if ((after - step).norm() <= 0.5 * (next - P).norm()) P = step, next = after;
        else if (const Vec2 further = projected(next); (further - next).norm() < (next - P).norm())
            P = next, next = further;
        else break;  // rounding
    }
    return next;
}

}  // namespace knap
