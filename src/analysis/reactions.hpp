#pragma once
// Forces and motions that drive a body: of every load that prescribes a motion, and of every obstacle.
#include "model/state.hpp"
#include "output/outputs.hpp"

namespace knap {

/// Reaction of one such load, or one obstacle.
struct Reaction {
    Vec2 force;         // [N] resultant on the body, mean over the last step; 0 in components that the load leaves free
    Vec2 displacement;  // [m] mean over the corners of the load; of an obstacle its own
    // of obstacles only:
    double moment = 0;  // [N m] on the body about the reference point of the obstacle, mean over the last step
    double angle = 0;   // [rad]
    Vec2 velocity = Vec2::Zero();  // [m/s]
    double spin = 0;               // [rad/s]
};

/// Columns of reactions.csv, after the name: of every load and obstacle that drives, then of every obstacle.
std::span<const Measure<Reaction>> driver_columns();
std::span<const Measure<Reaction>> obstacle_columns();

/// All columns of reactions.csv for such loads and obstacles.
std::vector<std::string> reaction_columns(const std::vector<std::string>& loads,
                                          const std::vector<std::string>& obstacles);

class Reactions {
public:
    explicit Reactions(const Model& model);

    /// After a refinement of the mesh.
    void renew();

    bool empty() const { return loads_.empty() && model_.obstacles.empty(); }
    /// The loads of the scenario that prescribe a motion of any corner: later loads may replace one everywhere.
    const std::vector<Index>& loads() const { return loads_; }

    /// [m] Mean place of the corners of a load, or start of an obstacle; in the order of at().
    const std::vector<Vec2>& places() const { return places_; }

    /// In the order of loads(), then of the obstacles.
    std::vector<Reaction> at(const State& state) const;

    /// After every step, for the largest forces.
    void after_step(const State& state);
    /// [N] Over all steps, of each load and obstacle in the order of at(): means over one step.
    const std::vector<double>& largest_forces() const { return largest_forces_; }

    void serialize(auto& archive) { archive(largest_forces_); }

    /// Names of loads and obstacles, in the order of at().
    std::vector<std::string> names() const;

    /// Columns and line of reactions.csv.
    std::vector<std::string> columns() const;
    std::vector<double> line(const State& state) const;

private:
    /// A prescribed component of the motion of a corner.
    struct Held {
        Index place;  // into loads_
        Index corner;
        int component;
    };

    /// [N] In the order of at().
    void sum_forces(const State& state, std::vector<Vec2>& forces) const;

    const Model& model_;
    std::vector<Index> loads_;
    std::vector<Held> held_;              // by place, then by corner
    std::vector<Vec2> places_;            // at the start
    std::vector<double> largest_forces_;  // [N]
    std::vector<Vec2> forces_;            // of a step
};

}  // namespace knap
