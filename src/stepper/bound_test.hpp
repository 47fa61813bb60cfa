#pragma once
// Does a fan in one piece stay bound? While its corners move as one, the impulses of its points follow by walking round the vertex; round a
// closed fan one 2-vector stays free, and the fan is bound if and only if some choice makes every point admissible (formulation: node binding).
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
    Vec2 least_norm_circulation(const Fan& fan, std::span<const Vec2> taken) const;
    void walk(const Fan& fan, std::span<const Vec2> taken, const Vec2& start);
    double smallest_slack(const Fan& fan, double time) const;

    const Model& model_;
    std::vector<Vec2> impulse_;
    std::vector<HalfPlane> planes_;
};

}  // namespace knap
