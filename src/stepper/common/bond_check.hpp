#pragma once
// Whether a fan stays bonded, and with which impulses at its points. The tests are tried in the order of their cost,
// each exact where it says yes; the last two are here, for both schemes:
//
//     1, 2  stress criterion, inscribed circles: cheap, in the order of the explicit sweep (explicit/bond_criteria.hpp)
//     3     estimate: the impulses with the self-stress of least norm are admissible
//     4     exact test: those with the best self-stress are admissible (law/self_stress.hpp)
#include "law/self_stress.hpp"
#include "model/state.hpp"

#include <span>
#include <vector>

namespace knap {

class BondCheck {
public:
    explicit BondCheck(const Model& model) : model_(&model) {}

    /// `required` [N s]: per corner of the fan, the impulse that its points must give it. Strengths are
    /// sigma_c S time at the temperatures of `begin`; `time` [s].
    bool is_bonded(Index fan, const State& begin, std::span<const Vec2> required, double time);
    /// [-] U >= 0: the smallest factor on the cohesive strengths with which the fan stays bonded. All its breakable
    /// points need a strength.
    double utilisation(Index fan, const State& begin, std::span<const Vec2> required, double time);
    /// [N s] Where the impulses of the last fan, at the same state, differ by less at every point, the exact test finds
    /// them admissible, too. Negative: outside of the convex part of the norm's domain that this test has.
    double margin(Index fan, const State& begin, double time);
    /// [N s] per point of the last fan, on `after`; admissible if it is bonded, else with the largest smallest slack.
    const std::vector<Vec2>& impulses() const { return impulse_; }

private:
    /// Test 4, of a closed fan. A function of its own, so that the estimate, which is asked first, stays small.
    [[gnu::noinline]] bool find_best(const Fan& fan, const State& begin, std::span<const Vec2> required, double time,
                                     const Vec2& least_norm);

    const Model* model_;
    std::vector<Vec2> impulse_;
    std::vector<HalfPlane> planes_;
};

}  // namespace knap
