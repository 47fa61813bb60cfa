#pragma once
// Does a fan in one piece stay bonded, and with which impulses? The test of interface/self_stress.hpp on the fans of a model.
#include "interface/self_stress.hpp"
#include "model/model.hpp"

#include <span>
#include <vector>

namespace knap {

class BondCheck {
public:
    explicit BondCheck(const Model& model) : model_(model) {}

    /// `required` [N s]: per corner of the fan, in its order: what its points must give it. `time` [s]: strengths are sigma_c S time.
    bool holds(Index fan, std::span<const Vec2> required, double time);
    /// [N s] per point of the fan, on `after`, of the last test; admissible if it held, else of the largest smallest slack.
    const std::vector<Vec2>& impulses() const { return impulse_; }

private:
    const Model& model_;
    std::vector<Vec2> impulse_;
    std::vector<HalfPlane> planes_;
};

}  // namespace knap
