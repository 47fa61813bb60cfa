#pragma once
// What it takes to drive a body: resultant force and mean displacement of every load that prescribes a motion, and of every obstacle.
#include "model/state.hpp"
#include "output/outputs.hpp"

#include <string>
#include <vector>

namespace knap {

/// What one load drives, or an obstacle in contact.
struct Reaction {
    Vec2 force;         // [N] resultant on the body, mean over the last step; 0 in components that this load leaves free
    Vec2 displacement;  // [m] mean over the corners that it holds; of an obstacle its own
};

/// Columns of reactions.csv after the time: of every load and obstacle that drives, then of every obstacle; by the part behind its name.
std::span<const Output> driver_columns();
std::span<const Output> obstacle_columns();

/// The names of all of them for such loads and obstacles.
std::vector<std::string> reaction_columns(const std::vector<std::string>& loads, const std::vector<std::string>& obstacles);

class Reactions {
public:
    explicit Reactions(const Model& model);

    bool empty() const { return loads_.empty() && model_.obstacles.empty(); }
    /// Which loads of the scenario prescribe the motion of anything; one that later ones replace everywhere does not.
    const std::vector<Index>& loads() const { return loads_; }

    /// Where a load takes hold, mean over the corners, or where an obstacle is at the start [m]; in the order of at().
    const std::vector<Vec2>& places() const { return places_; }

    /// In the order of loads(), then of the obstacles.
    std::vector<Reaction> at(const State& state) const;

    /// Names of loads and obstacles, in the order of at().
    std::vector<std::string> names() const;

    /// Columns and line of reactions.csv.
    std::vector<std::string> columns() const;
    std::vector<double> line(const State& state) const;

private:
    /// A component of the motion of a corner.
    struct Held {
        Index place;   // into loads_
        Index corner;
        int component;
    };

    const Model& model_;
    std::vector<Index> loads_;
    std::vector<Held> held_;
    std::vector<Eigen::Vector2i> n_held_;  // per load and component: corners held
    std::vector<Vec2> places_;
};

}  // namespace knap
