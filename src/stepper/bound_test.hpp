#pragma once
// Does a fan in one piece stay bound, and with which impulses? The test of interfaces/circulation.hpp on the fans of a model.
#include "interfaces/circulation.hpp"
#include "model/model.hpp"

#include <span>
#include <vector>

namespace knap {

class BoundTest {
public:
    explicit BoundTest(const Model& model) : model_(model) {}

    /// `taken` [N s]: per corner of the fan, in its order: what its points must give it. `time` [s]: strengths are sigma_c S time.
    bool holds(Index fan, std::span<const Vec2> taken, double time);
    /// [N s] per point of the fan, on `after`, of the last test; admissible if it held, else of the largest smallest slack.
    const std::vector<Vec2>& impulses() const { return impulse_; }

private:
    const Model& model_;
    std::vector<Vec2> impulse_;
    std::vector<HalfPlane> planes_;
};

}  // namespace knap
