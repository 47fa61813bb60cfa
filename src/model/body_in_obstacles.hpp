#pragma once
// Edges of the body in rigid obstacles: what no contact (stepper/common/obstacle_contacts.hpp) stops, as what is held
// against a driven obstacle.
#include "model/state.hpp"

#include <functional>
#include <optional>

namespace knap {

struct EdgeInObstacle {
    Index obstacle;
    std::array<Index, 2> corner;  // the ends of the edge, the body to the left
    double length;                // [m] of the edge, now
    double depth;                 // [m] by which edge and obstacle would have to be moved apart
    Vec2 place;                   // [m] of the deepest point

    /// [-] Over the length of the edge, or half the width of the obstacle if that is less, so that neither passes the
    /// other unnoticed.
    /// A tenth of it in an obstacle with R_N, whose surface gives way.
    double part(const Obstacle& of) const {
        const bool gives_way =
            of.any_law([](const ContactLaw& law) { return law.rebound == ContactLaw::Rebound::of_bodies; });
        return (gives_way ? 0.1 : 1) * depth / std::min(length, of.outline.half_width());
    }
};

/// Edges of the boundary and faces that have come apart, of second order in two halves, in the obstacles they overlap:
/// in their present places, or without a state in those of the start.
void for_edges_in_obstacles(const Model& model, const State* state,
                            const std::function<void(const EdgeInObstacle&)>& visit);

/// The body lies in an obstacle at the start, or an obstacle in the body, by more than the rounding of given
/// coordinates: what lies deepest.
struct StartOverlap {
    Index obstacle;
    double depth;  // [m]
    Vec2 place;    // [m]
};
std::optional<StartOverlap> overlap_at_start(const Model& model);

/// What comes first on the way of a free obstacle, from its velocity and forces at the start until `end` [s]:
/// a support, which meets bodies alone where pieces are rigid; or an edge that is held along its normal and may slip,
/// where the friction of a free obstacle is not solved in implicit steps.
struct HeldAgainst {
    enum class What { edge, support };
    What what;
    Index obstacle;
    Vec2 place;  // [m] where they meet
};
std::vector<HeldAgainst> held_against_obstacles(const Model& model, double end);

}  // namespace knap
