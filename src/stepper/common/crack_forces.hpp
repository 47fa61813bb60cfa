#pragma once
// Which interface points the fluids of Model::crack_fluids have reached, and their forces there. A fluid passes through
// an interface that is broken at all its points and presses on every broken point beside a vertex that it has reached,
//
//     f_after = p S N,     f_before = -p S N,     N in its present direction.
//
// With a process zone damaged interfaces and points count as broken ones. p is constant, a formula of place and time,
// or a table of the temperature at the point at the start of the step (ice); a gradient adds to it with the depth. An
// injected fluid has one unknown p, with the volume Q that has entered until t,
//
//     0 <= p  perp  C p + V(u) - Q(t) >= 0,     V = sum of S u_N over the points that it presses on.
//
// Its forces are p a with a = dV/du, so that their work on the body is the integral of p dV. In both schemes p is an
// unknown of the step (fluid_pressures.hpp).
//
// Cohesion is never restored, so the reached points only grow and follow from the present State alone.
#include "base/grouped.hpp"
#include "model/state.hpp"

namespace knap {

/// What is known of a fluid at a moment.
struct FluidMoment {
    double pressure = 0;     // [Pa] mean over the length that it has reached; of an injected one without the gradient
    double volume = 0;       // [m3] of the cracks that it has reached
    double injected = 0;     // [m3] that has entered since the start; 0 where the pressure is given
    double length = 0;       // [m] of the cracks and joints on which it presses, of one face
    double sharp_crack = 0;  // [m] of the cracks that it has entered, to the tips that a sharp crack would have
    double aperture = 0;     // [m] largest opening there
};

struct FluidBalance {
    double excess, scale;  // [m3] C p + V - Q, and the largest of these terms
};

class CrackForces {
public:
    explicit CrackForces(const Model& model);

    bool empty() const { return fluids_.empty(); }
    /// [N] In this state and for amplitudes 1, in the order of the points. A point whose sides are free faces (retired)
    /// has none: the fluid escapes. `time` [s]: of formulas; injected fluids have the pressure of the state, or that
    /// of `given` [Pa], which has one for each fluid.
    const std::vector<CornerLoad>& find(const State& state, double time, const std::vector<double>* given = nullptr);
    const std::vector<CornerLoad>& find(const State& state) { return find(state, state.time); }
    /// Likewise, at the points that the last find() has reached.
    const std::vector<CornerLoad>& find_there(const State& state, double time, const std::vector<double>* given);
    const std::vector<CornerLoad>& found() const { return forces_; }
    /// [Pa] With which they were found: of injected fluids; 0 for others.
    const std::vector<double>& injected_pressures() const { return pressure_; }
    std::vector<std::size_t> injected_fluids() const;
    /// [Pa] Per point, of all fluids at the time of the state.
    std::vector<double> pressures(const State& state);
    /// In the order of Model::crack_fluids.
    std::vector<FluidMoment> moments(const State& state);

    // of one injected fluid, at the points that the last find() has reached
    double volume(std::size_t fluid, const State& state) const;  // [m3] V
    double length(std::size_t fluid, const State& state) const;  // [m] of one face
    Vec2 place(std::size_t fluid, const State& state) const;     // [m] where it is widest
    /// [m4/kg] a' M^-1 a of corners that nothing holds.
    double mobility(std::size_t fluid, const State& state) const;
    /// With those from which it has escaped, in the order in which it came.
    std::span<const Index> reached_points(std::size_t fluid) const { return fluids_[fluid].points; }
    /// [m3/s] a' w with the rates w [m/s] of corners.
    template <class Rate>
    double volume_rate(std::size_t fluid, const State& of_frames, const Rate& rate_of) const;
    /// With this volume [m3] at this time, under the pressure of the last find().
    FluidBalance balance(std::size_t fluid, double volume, double time) const;
    double injected(std::size_t fluid, double time) const;  // [m3] Q
    double storage(std::size_t fluid) const { return model_.crack_fluids[fluid].given.storage * model_.thickness; }
    /// [Pa] of an injected fluid that fills `volume` [m3] at this time.
    double pressure(std::size_t fluid, double volume, double time) const {
        return std::max(0.0, (injected(fluid, time) - volume) / storage(fluid));
    }

private:
    struct Reached {
        std::vector<std::uint8_t> vertices;  // [0/1] per vertex
        std::vector<Index> points;           // ascending
        std::vector<std::uint8_t> is_point;  // [0/1] per point
        std::vector<std::uint8_t> is_open;   // [0/1] per point: broken, with a process zone damaged
    };
    void take_open(const State& state, bool damaged, Reached& reached, std::vector<Index>& taken) const;
    void follow(const State& state);
    void keep_apart() const;
    void enter(Index interface, Reached& reached) const;
    double sharp_crack(std::size_t fluid, const State& state) const;
    bool is_passable(Index interface, const Reached& reached) const;
    /// visit(point, offset [Pa]): every point on which a fluid presses, and what the gradient adds to its pressure.
    template <class Visit>
    void for_each_point(std::size_t fluid, const State& state, const Visit& visit) const;
    template <class Visit>
    void for_each_pressed(std::size_t fluid, const State& state, double time, double injected,
                          const Visit& visit) const;
    double shown_pressure(std::size_t fluid, const State& state) const;

    const Model& model_;
    Grouped<Index> interfaces_at_;  // per vertex
    std::vector<Reached> fluids_;   // in the order of Model::crack_fluids
    std::vector<Index> new_;        // points
    bool are_apart_ = false;        // what they had reached before the last follow()
    std::vector<CornerLoad> forces_;
    std::vector<double> pressure_;         // [Pa] of injected fluids in them
    mutable std::vector<Vec2> of_corner_;  // [m2] a, per corner, with injected fluids; zero between uses
};

template <class Rate>
double CrackForces::volume_rate(std::size_t fluid, const State& of_frames, const Rate& rate_of) const {
    double sum = 0;
    for_each_point(fluid, of_frames, [&](const FanPoint& point, double) {
        const Vec2 normal = point_frame(model_, of_frames, point).turned(point.normal);
        sum += point.area * normal.dot(rate_of(point.after) - rate_of(point.before));
    });
    return sum;
}

template <class Visit>
void CrackForces::for_each_point(std::size_t fluid, const State& state, const Visit& visit) const {
    const CrackPressure& given = model_.crack_fluids[fluid].given;
    for (const Index p : fluids_[fluid].points) {
        if (state.has_retired(p)) continue;
        const FanPoint& point = model_.fan_points[model_.fan_point_of[p]];
        visit(point, given.gradient == 0 ? 0 : given.gradient * (given.level - model_.mesh.corner(point.corner()).y()));
    }
}

}  // namespace knap
