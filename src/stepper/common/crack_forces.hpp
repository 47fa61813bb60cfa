#pragma once
// Which interface points the fluids of Model::crack_fluids have reached, and their forces there. A fluid passes through
// an interface that is broken at all its points and presses on every broken point beside a vertex that it has reached,
//
//     f_after = p S N,     f_before = -p S N,     N in its present direction.
//
// p is constant, or a table of the temperature at the point at the start of the step (ice).
//
// Cohesion is never restored, so the reached points only grow and follow from the present State alone.
#include "base/grouped.hpp"
#include "model/state.hpp"

namespace knap {

class CrackForces {
public:
    explicit CrackForces(const Model& model);

    bool empty() const { return fluids_.empty(); }
    /// [N] In this state and for amplitudes 1, in the order of the points. A point whose sides are free faces (retired)
    /// has none: the fluid escapes.
    const std::vector<CornerLoad>& find(const State& state);
    const std::vector<CornerLoad>& found() const { return forces_; }
    /// [Pa] Per point, of all fluids at the time of the state.
    std::vector<double> pressures(const State& state);
    /// [m] Length of the cracks and joints on which each fluid presses, of one face.
    std::vector<double> wetted(const State& state);

private:
    struct Reached {
        std::vector<std::uint8_t> vertices;  // [0/1] per vertex
        std::vector<Index> points;           // ascending
        std::vector<std::uint8_t> is_point;  // [0/1] per point
    };
    void take_broken(const State& state);
    template <class Visit>
    void for_each_pressed(const State& state, const Visit& visit);
    void enter(Index interface, Reached& reached);
    bool is_passable(Index interface) const;

    const Model& model_;
    Grouped<Index> interfaces_at_;         // per vertex
    std::vector<Reached> fluids_;          // in the order of Model::crack_fluids
    std::vector<std::uint8_t> is_broken_;  // [0/1] per point
    std::vector<Index> new_;               // points
    std::vector<CornerLoad> forces_;
};

}  // namespace knap
