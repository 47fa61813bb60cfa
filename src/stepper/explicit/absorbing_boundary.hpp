#pragma once
// Absorbing boundaries (stepper/common/dashpots.hpp) in the explicit scheme, at the mean velocity of the step.
#include "stepper/common/dashpots.hpp"
#include "stepper/explicit/explicit_step.hpp"

namespace knap {

class AbsorbingBoundary {
public:
    AbsorbingBoundary(const Model& model, const std::vector<Selection>& on)
        : model_(model), dashpots_(dashpots_on(model, on)) {}

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
    const Model& model_;
    std::vector<Dashpot> dashpots_;
};

/// [N] Of the dashpot on a corner, if there is one, at this velocity.
Vec2 dashpot_force(Index corner, std::span<const Dashpot> dashpots, const Vec2& velocity);

}  // namespace knap
