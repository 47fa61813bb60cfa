#pragma once
// Tresca's law at single points of the active set (active_set.hpp): their friction is bounded by
// contact impulses that follow from step to step with a delay.
//
// A point whose local matrix is no P-matrix because of friction changes its piece for ever: closed, its impulse is a
// tension; open, its sides overlap. In rubble that rests three to ten points of thousands do so, and no step length
// ends it. Bounded by the impulse of the step before, their friction lets them settle; once no point changes its piece
// any more, it follows the contact impulse again. Points with cohesion never lag: where they soften, too, their cycles
// go on (granite).
#include "stepper/implicit/active_point.hpp"

#include <vector>

namespace knap {

class LaggedFriction {
public:
    explicit LaggedFriction(std::size_t max_points);

    void begin(std::size_t n_points);
    /// A point has changed its piece.
    void count_change(std::size_t point) { ++n_changes_[point]; }
    /// After each look at the pieces. True: they have settled, and friction follows again at all points.
    bool settles(std::size_t n_changed, std::vector<ActivePoint>& points);
    /// Points that go on to change their pieces lag from now on. False: there are no more of them.
    bool hold_back_cycling(std::vector<ActivePoint>& points);
    void hold_back_all(std::vector<ActivePoint>& points);
    /// After a step: the bounds of friction follow the contact impulses.
    void advance(std::vector<ActivePoint>& points) const;
    /// Friction follows at all points. True: it did not at some.
    bool end(std::vector<ActivePoint>& points);

    bool is_used() const { return n_lagging_ > 0; }

private:
    void hold_back(ActivePoint& point);

    std::vector<int> n_changes_;  // of pieces per point, since few points change
    int n_lagging_ = 0, n_quiet_ = 0;
};

}  // namespace knap
