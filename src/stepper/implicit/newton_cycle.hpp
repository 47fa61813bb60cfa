#pragma once
// Newton's method on piecewise linear laws that has come to a cycle: with the multipliers fixed a step depends on the
// rates alone, so an iterate that returns, with the same pieces and the same residual, returns for ever.
// (R. P. Brent, BIT 20, 1980: compared with the iterate at the last power of two.)
#include "base/reserve_capacity.hpp"
#include "stepper/implicit/active_point.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace knap {

class NewtonCycle {
public:
    explicit NewtonCycle(std::size_t max_points) { reserve_capacity(max_points, pieces_); }

    void begin() { norm_ = -1; }
    /// The iterate of step i, with the norm of its residual, has been there.
    bool returns(int i, double norm, const std::vector<ActivePoint>& points) {
        if (std::abs(norm - norm_) <= rounding * norm_ &&
            std::ranges::equal(points, pieces_, {}, [](const ActivePoint& point) { return point.response.state; }))
            return true;
        if (!std::has_single_bit(static_cast<unsigned>(i)) || i < first_kept) return false;
        norm_ = norm;
        pieces_.clear();
        for (const ActivePoint& point : points) pieces_.push_back(point.response.state);
        return false;
    }

private:
    // cycles repeat their residuals to 1e-10, with friction to 1e-2 of what GMRES leaves of a direction
    static constexpr double rounding = 1e-9;
    static constexpr int first_kept = 16;  // swept steps are over

    double norm_ = -1;
    std::vector<std::uint32_t> pieces_;
};

}  // namespace knap
