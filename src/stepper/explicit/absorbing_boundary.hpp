#pragma once
// Absorbing boundaries: dashpots that take up waves as the body would if it went on (J. Lysmer and R. L. Kuhlemeyer,
// J. Eng. Mech. Div. ASCE 95, EM4 (1969) 859). Exact for plane waves of normal incidence; others return in part.
//
//     traction = -rho c_p v_n n - rho c_s v_t t
//     M (v+ - v) = k (F - C (v + v+)/2) + H' P          C: lumped at the corners of the boundary
//
// At the mean velocity they never give energy back and leave the stable step as it is.
#include "stepper/explicit/explicit_step.hpp"

#include <Eigen/Core>

#include <span>

namespace knap {

/// On a corner: the force -C v.
struct Dashpot {
    Index fan, corner;
    Eigen::Matrix2d C;  // [kg/s] symmetric
};

class AbsorbingBoundary {
public:
    /// Throws UserError where a selection is empty, and where a support holds or a motion leads the boundary.
    AbsorbingBoundary(const Model& model, const std::vector<Selection>& on);

    const std::vector<Dashpot>& dashpots() const { return dashpots_; }  // in the order of (fan, corner)

    /// Those on the corners of a fan, usually none.
    std::span<const Dashpot> of_fan(Index fan) const {
        if (dashpots_.empty()) return {};
        const auto found = std::ranges::equal_range(dashpots_, fan, {}, &Dashpot::fan);
        return {found.begin(), found.end()};
    }

    /// [m/s] v+ of a fan that moves as one under `impulse` [N s], with its dashpots; prescribed components as in
    /// `velocity`, that without dashpots.
    Vec2 end_velocity(Index fan, const ExplicitStep& step, const Vec2& impulse, const Vec2& velocity) const;
    /// [N] Of its dashpots at this velocity.
    Vec2 force_on_fan(Index fan, const Vec2& velocity) const;

    /// Whether a dashpot of the fan couples x and y: on a boundary that is oblique to them.
    bool is_oblique(Index fan) const {
        return std::ranges::any_of(of_fan(fan), [](const Dashpot& dashpot) { return dashpot.C(0, 1) != 0; });
    }

    /// The work of all dashpots in the step.
    void account(const ExplicitStep& step, StepReport& report) const;

private:
    void add(const BoundaryEdge& edge);

    const Model& model_;
    std::vector<Dashpot> dashpots_;
};

/// [N] Of the dashpot on a corner, if there is one, at this velocity.
Vec2 dashpot_force(Index corner, std::span<const Dashpot> dashpots, const Vec2& velocity);

}  // namespace knap
