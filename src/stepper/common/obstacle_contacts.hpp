#pragma once
// Where the body is near a rigid obstacle: the corners of its triangles, on the boundary and on faces that opened since, against the surface of
// each obstacle, and the corners of polygons against the inside of edges of its boundary, as they lie at the begin of the step. To be in contact, no more:
// the gap changes with the normal component of the relative velocity, which for a convex obstacle is never more than it does.
#include "model/state.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace knap {

/// A corner beside the surface of an obstacle; or a point between two corners beside a corner of it.
struct ObstacleContact {
    Index corner;
    Index fan;
    Index obstacle;
    Vec2 arm;     // [m] from the obstacle's origin to the contact
    Vec2 normal;  // out of the obstacle
    double gap;   // [m]
    Index beside = -1;       // the corner at the other end of the edge, and its fan
    Index fan_beside = -1;
    double share = 0;        // of the contact that is at `beside`; the rest is at `corner`

    bool is_on_edge() const { return beside >= 0; }
    /// Of the point of the body that is in contact, from a field of the corners.
    template <class OfCorner>
    Vec2 of_body(const OfCorner& of_corner) const {
        if (!is_on_edge()) return of_corner(corner);
        return (1 - share) * of_corner(corner) + share * of_corner(beside);
    }

    /// What is prescribed of the corner is mostly its motion along the surface. Beside a free obstacle the friction there would hardly have a definite value.
    bool is_led_along(const std::array<bool, 2>& prescribed) const {
        return (prescribed[0] && std::abs(normal.x()) < 0.5) || (prescribed[1] && std::abs(normal.y()) < 0.5);
    }
};

/// [m/s] of the obstacle at the contact.
inline Vec2 velocity_at(const Vec3& obstacle_velocity, const ObstacleContact& contact) { return velocity_at(obstacle_velocity, contact.arm); }

class ObstacleContacts {
public:
    explicit ObstacleContacts(const Model& model);

    /// All contacts that a step of h [s] may close: those at corners in the order of the fans, then those on edges.
    /// `end_velocity`: of the obstacles, as far as it is known before;
    /// `corner_force` [N]: what accelerates the corners, or nothing.
    void find(const State& begin, double h, const std::vector<Vec3>& end_velocity, const std::vector<Vec2>& corner_force);

    const std::vector<ObstacleContact>& all() const { return contacts_; }
    std::span<const ObstacleContact> of_fan(Index fan) const;  // at its corners
    std::span<const ObstacleContact> on_edges() const { return std::span(contacts_).subspan(n_at_corners_); }
    std::size_t n_at_corners() const { return n_at_corners_; }

    /// [0/1] per obstacle: it is free, and something may meet it. False where there is none.
    bool find_free(std::vector<std::uint8_t>& free) const;
    /// [N s, N s, N m s] of the body on each obstacle, from the impulse on the body at each contact, by its number in all().
    template <class ImpulseAt>
    void sum_wrenches(const ImpulseAt& impulse_at, std::vector<Vec3>& wrench) const {
        wrench.assign(model_.obstacles.size(), Vec3::Zero());
        for (std::size_t i = 0; i < contacts_.size(); ++i) wrench[contacts_[i].obstacle] -= wrench_of(impulse_at(i), contacts_[i].arm);
    }

private:
    struct Candidate {
        Index fan, corner;
        Index place;  // among those of its fan
    };
    void list_candidates(const State& begin);
    void add_pieces(Index fan, const State& begin);
    void find_on_edges(const State& begin, double h, const std::vector<Vec3>& end_velocity);
    void meet_edge(Index triangle, Index side, Index obstacle, const State& begin, double h, const Vec3& end_velocity);

    const Model& model_;
    std::vector<Candidate> boundary_;   // the corners at both ends of the fans on the boundary
    std::vector<double> corner_size_;   // [m] per corner: the shorter one of its two edges
    std::vector<Candidate> candidates_;
    std::vector<ObstacleContact> contacts_;
    std::size_t n_at_corners_ = 0;
};

}  // namespace knap
