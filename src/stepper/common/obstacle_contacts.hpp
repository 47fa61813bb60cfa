#pragma once
// Contact points of the body with rigid obstacles, as they lie at the start of a step: corners of triangles against the
// surface of each obstacle; and the insides of edges, of the boundary and of faces that opened since, against corners
// of polygons and arcs of discs. The gap changes with the normal component of the relative velocity; for a convex
// obstacle this is an upper bound of the approach.
#include "model/state.hpp"
#include "stepper/common/contact_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace knap {

/// A corner of the body at the surface of an obstacle, or (on an edge) a point between two corners at a corner or an
/// arc of it.
struct ObstacleContact {
    Index corner;
    Index fan;
    Index obstacle;
    Vec2 arm;                  // [m] from the origin of the obstacle to the contact
    Vec2 normal;               // out of the obstacle
    double gap;                // [m]
    Index second_corner = -1;  // the corner at the other end of the edge, and its fan
    Index second_fan = -1;
    double share = 0;  // [-] of the contact that belongs to `second_corner`; the rest belongs to `corner`

    bool is_on_edge() const { return second_corner >= 0; }
    /// Interpolates a field of the corners at the contact.
    template <class OfCorner>
    Vec2 of_body(const OfCorner& of_corner) const {
        if (!is_on_edge()) return of_corner(corner);
        return (1 - share) * of_corner(corner) + share * of_corner(second_corner);
    }
    /// Mainly the motion along the surface is prescribed. At a free obstacle the friction would then hardly have a
    /// definite value.
    bool is_led_along(const std::array<bool, 2>& prescribed) const {
        return (prescribed[0] && std::abs(normal.x()) < 0.5) || (prescribed[1] && std::abs(normal.y()) < 0.5);
    }
};

/// [m/s] of the obstacle at the contact.
inline Vec2 velocity_at(const Vec3& obstacle_velocity, const ObstacleContact& contact) {
    return velocity_at(obstacle_velocity, contact.arm);
}

/// The impulses [N s] of the step before; zero where a contact was none. Contacts come in the same order in most steps,
/// so the one behind the last that was found is tried first: a corner in a valley of a terrain has one for each side.
/// Others are looked up by their corner, since most contacts of pieces that fly by had none and a scan would be
/// quadratic: of several the next one round the list.
class ImpulsesBefore {
public:
    /// `by_corner` is room that lasts from step to step.
    ImpulsesBefore(const State& begin, std::vector<std::size_t>& by_corner)
        : all_(begin.obstacle_contacts), by_corner_(by_corner) {
        by_corner_.clear();
    }
    Vec2 next(const ObstacleContact& contact) {
        const auto is_same = [&](std::size_t i) {
            return all_[i].corner == contact.corner && all_[i].second_corner == contact.second_corner &&
                   all_[i].obstacle == contact.obstacle;
        };
        std::size_t found = next_;
        if (found == all_.size() || !is_same(found)) {
            if (by_corner_.empty()) sort_by_corner();
            const auto corner = [&](std::size_t i) { return all_[i].corner; };
            found = all_.size();
            for (auto at = std::ranges::lower_bound(by_corner_, contact.corner, {}, corner);
                 at != by_corner_.end() && corner(*at) == contact.corner; ++at)
                if (is_same(*at) && *at + 1 != next_ && (found == all_.size() || (found < next_ && *at >= next_)))
                    found = *at;
        }
        if (found == all_.size()) return Vec2::Zero();
        next_ = found + 1;
        return {all_[found].contact, all_[found].tangential};
    }

private:
    void sort_by_corner() {
        by_corner_.resize(all_.size());
        std::iota(by_corner_.begin(), by_corner_.end(), std::size_t(0));
        std::ranges::sort(by_corner_, {}, [&](std::size_t i) { return std::pair(all_[i].corner, i); });
    }

    const std::vector<ObstacleContactState>& all_;
    std::vector<std::size_t>& by_corner_;  // empty until it is needed
    std::size_t next_ = 0;
};

class ObstacleContacts {
public:
    explicit ObstacleContacts(const Model& model);

    /// From the next search on contacts of the rigid pieces of the state: of corners where they protrude. Null: of a
    /// deformable body.
    void set_pieces(SharedFrozenBody body) { body_ = std::move(body), pieces_.clear(); }

    /// All contacts that may close in a step of h [s]: first those at corners in the order of the fans, then those on
    /// edges. `end_velocity`: of the obstacles, without the contacts; `corner_force` [N]: that accelerates the corners,
    /// may be empty; `added`: to the velocities of rigid pieces in the step.
    void find(const State& begin, double h, const std::vector<Vec3>& end_velocity,
              const std::vector<Vec2>& corner_force, AddedRates added = {});

    /// Of a rigid piece beside an obstacle with ends or corners that it may reach in the step.
    const LargestMotion& passing() const { return passing_; }
    const std::vector<ObstacleContact>& all() const { return contacts_; }
    /// What acts at a contact.
    const ContactLaw& law_of(const ObstacleContact& contact, const State& begin) const {
        return model_.obstacles[contact.obstacle].law_at(contact.arm, begin.obstacles[contact.obstacle].pose.angle);
    }
    std::size_t n_at_corners() const { return n_at_corners_; }
    std::span<const ObstacleContact> on_edges() const { return std::span(contacts_).subspan(n_at_corners_); }
    /// At corners of the fan.
    std::span<const ObstacleContact> of_fan(Index fan) const {
        const auto first = contacts_.begin(), last = first + static_cast<std::ptrdiff_t>(n_at_corners_);
        return {std::ranges::lower_bound(first, last, fan, {}, &ObstacleContact::fan),
                std::ranges::upper_bound(first, last, fan, {}, &ObstacleContact::fan)};
    }

    /// [N s, N s, N m s] of the body on each obstacle; impulse_at(i): on the body at contact i of all().
    template <class ImpulseAt>
    void sum_wrenches(const ImpulseAt& impulse_at, std::vector<Vec3>& wrench) const {
        wrench.assign(model_.obstacles.size(), Vec3::Zero());
        for (std::size_t i = 0; i < contacts_.size(); ++i)
            wrench[contacts_[i].obstacle] -= wrench_of(impulse_at(i), contacts_[i].arm);
    }

private:
    struct Candidate {
        Index fan, corner;
        Index place;  // in the order of the candidates of its fan

        std::int64_t order() const { return (std::int64_t(fan) << 32) + place; }
    };
    struct Found {
        std::pair<std::int64_t, std::size_t> order;  // of its candidate, and among the contacts of that
        ObstacleContact contact;
    };
    /// The edge of the body to the left of a to b; of second order half of it.
    struct Edge {
        Index a, b;    // corners
        double depth;  // [m] largest penetration: that of a corner which meets this edge and not the opposite one
    };
    /// Bounds of the motion of an obstacle, start and end of the step together, and of the place of a polygon.
    struct AtMost {
        double speed, spin;  // [m/s], [rad/s]
        Vec2 low, high;      // [m] infinite of other outlines

        bool may_reach(const Vec2& x, double reach) const {
            return x.x() - reach <= high.x() && x.x() + reach >= low.x() && x.y() - reach <= high.y() &&
                   x.y() + reach >= low.y();
        }
    };
    /// What all obstacles ask of a corner of the body.
    struct MovingCorner {
        Index corner, fan;
        Vec2 x, v;
        double size;           // [m] corner_size_
        double kicked;         // [m/s] by its force
        double nearest, most;  // [m] near_contact of its size, [m/s] at least its speed and what its force adds
    };
    /// A rigid piece: its corners and edges, in candidates_ and piece_edges_.
    struct Piece {
        std::size_t first_corner = 0, last_corner = 0, first_edge = 0, last_edge = 0;
        double longest_edge = 0;  // [m]
    };
    template <class Visit>
    void visit_pieces(Index fan, const State& begin, const Visit& visit) const;
    void read_pieces(const State& begin);
    void find_of_pieces(const State& begin, double h, const std::vector<Vec3>& end_velocity);
    double kick_of(Index corner) const;
    double travel_of(Index piece, Index obstacle, const State& begin, double h) const;
    MovingCorner moving(const Candidate& at, const State& begin, double h, const std::vector<Vec2>& corner_force) const;
    void find_at_corner(const MovingCorner& at, Index obstacle, const State& begin, double h,
                        const std::vector<Vec3>& end_velocity);
    void add_edges(Index triangle, Index side, std::vector<Edge>& edges) const;
    void add_open_faces(Index fan, const State& begin);
    void find_on_edge(const Edge& edge, const Vec2& x_a, Index obstacle, const State& begin, double h);
    void find_on_arc(const Edge& edge, const PlacedEdge& at, Index obstacle, const State& begin, double h);
    void find_at_corners_of(const Edge& edge, const PlacedEdge& at, Index obstacle, const State& begin, double h);
    void find_at_corner_of(const Edge& edge, const PlacedEdge& at, Index obstacle, std::size_t corner,
                           const State& begin, double h);
    bool is_in_front_of_next(const Edge& edge, const PlacedEdge& at, const Vec2& x, const State& begin) const;
    void add_on_edge(const ObstacleContact& contact, double length, const State& begin, double h);
    Vec2 place(Index corner, const State& begin) const { return place_of(model_, begin, corner); }
    bool is_carried(Index corner, double gap, const State& begin) const;
    bool meets_beside(Index fan, Index obstacle, const Vec2& x, const SurfaceDistance& distance,
                      const State& begin) const;

    const Model& model_;
    std::vector<Candidate> boundary_;        // the corners at both ends of the fans on the boundary
    std::vector<Edge> edges_, open_faces_;   // of the boundary; of faces that came apart
    std::vector<Index> next_, previous_;     // per corner: the corner at the other end of the edge of the boundary that
                                             // leaves or enters it, or -1
    double longest_edge_ = 0;                // [m]
    std::vector<double> corner_size_;        // [m] per corner: distance to the nearest other corner of its triangle
    std::vector<Candidate> candidates_;      // of rigid pieces
    std::vector<Found> found_;               // at corners of a deformable body, in a search
    SharedFrozenBody body_;                  // null: a deformable one
    std::vector<Piece> pieces_;              // of rigid ones, once they are read
    std::vector<Edge> piece_edges_;          // piece by piece
    std::vector<double> kicks_;              // [m/s] of pieces in this step: at most, of any place in them
    std::vector<Vec2> starts_;               // [m] of edges, in a search
    std::vector<ObstacleSurface> surfaces_;  // in their places at the start of the step
    std::vector<AtMost> at_most_;            // likewise
    std::vector<Vec3> predicted_;  // [m/s, m/s, rad/s] of the obstacles over the step: of free components that
                                   // of its start, since what carries them takes their forces
    std::vector<ObstacleContact> contacts_;
    std::size_t n_at_corners_ = 0;
    LargestMotion passing_;
};

}  // namespace knap
