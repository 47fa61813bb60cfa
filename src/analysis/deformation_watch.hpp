#pragma once
// Checks the assumptions of the kinematics: small rotations (unless they may be large), small strains, small slips
// between faces in contact, contact only between initial neighbours, and of obstacles with nodes and corners. The
// recorder calls it when the body has moved far enough, not at every step; obstacles among each other, which are few,
// at every step.
#include "model/obstacle_gap.hpp"
#include "model/state.hpp"

#include <map>
#include <optional>

namespace knap {

/// The largest value so far. NaN counts as the largest.
struct Extreme {
    double value = 0;
    Vec2 place = Vec2::Zero();  // [m]

    void add(double other, const Vec2& where) {
        if (!(other <= value)) value = other, place = where;
    }
    void serialize(auto& archive) { archive(value, place); }
};

class DeformationWatch {
public:
    explicit DeformationWatch(const Model& model);

    /// After a refinement of the mesh: sizes of the triangles, interfaces on supports.
    void renew();

    /// Rotation, or strain if rotations are large, change of area, slip: some ten nanoseconds per triangle.
    void look_at(const State& state);
    /// With large rotations: counts the full turns of triangles, of which none may turn by more than 90 degrees between
    /// two calls of this or look_at.
    void count_turns(const State& state);
    /// [deg] By which a triangle has turned, with its full turns, at the time of the last count.
    double turned(const State& state, Index triangle) const;
    /// Overlap: as expensive as some steps.
    void look_for_overlap(const State& state);

    /// Free obstacles that meet others, and supports.
    void look_at_obstacles(const State& state);

    /// Edges of the body in obstacles: as expensive as finding the contacts of a step.
    void look_into_obstacles(const State& state);

    /// [m] No vertex may move farther between two calls of look_at: a relative motion of two vertices by as much turns
    /// no triangle by more than 2 degrees; with large rotations it strains none by more than 20 %.
    double look_path() const { return look_path_; }
    /// [m] The same between two calls of look_for_overlap: a tenth of an edge.
    double search_path() const;
    /// [m] The same, of vertices and obstacles together, between two calls of look_into_obstacles: a twentieth of an
    /// edge or of half the width of an obstacle.
    double obstacle_path() const { return obstacle_path_; }
    /// [m/s] At most that of any point of an obstacle beside the body.
    double obstacle_speed(const State& state) const;
    bool has_obstacles() const { return !model_.obstacles.empty(); }

    const Extreme& rotation() const { return rotation_; }          // [deg] R of F = R U, of a triangle
    const Extreme& strain() const { return strain_; }              // [-] largest principal value of |E| of a triangle
    const Extreme& area_change() const { return area_change_; }    // [-] |det F - 1| of a triangle
    bool large_rotation() const { return model_.large_rotation; }  // strain is watched
    const Extreme& slip() const { return slip_; }        // [-] of a point under pressure, over the length of its edge
    const Extreme& overlap() const { return overlap_; }  // [m2] area covered twice; place in the deformed body
    const Extreme& obstacle_overlap() const { return obstacle_overlap_; }  // [m] depth
    const Extreme& obstacle_depth() const { return obstacle_depth_; }      // [-] EdgeInObstacle::part
    double triangle_area() const { return triangle_area_; }  // [m2] mean; where smaller, that of overlapping triangles
    double body_area() const { return body_area_; }          // [m2]
    /// [J] Rounding of 1/2 u'K u where n triangles have moved by u without strain: 8 sqrt(n) 2^-53 k u^2, k: E times
    /// the thickness; none with large rotations, which count from differences of u. `path` [m]: of the fastest point.
    double rounding_energy(double path) const;
    /// Place of a corner in the reference body; none for -1.
    std::optional<Vec2> place_of(Index corner) const {
        return corner < 0 ? std::nullopt : std::optional(model_.mesh.corner(corner));
    }

    void serialize(auto& archive) {
        archive(rotation_, strain_, area_change_, slip_, overlap_, obstacle_overlap_, obstacle_depth_, triangle_area_,
                displacement_, turns_);
    }

private:
    double straight_length(Index interface, int direction, double slip) const;

    /// The support edges that continue one in the directions -T and T.
    enum : Index { support_ends = -1, support_turns = -2 };
    std::map<Index, std::array<Index, 2>> next_on_support_;  // by interface: an interface, or one of these

    const Model& model_;
    double triangle_area_ = 0, body_area_ = 0, look_path_ = 0, obstacle_path_ = 0;
    double reach_ = 0;         // [m] no point of an obstacle beside the body is farther from its reference point
    double stiffest_ = 0;      // [Pa] largest E of the materials
    double displacement_ = 0;  // [m] largest at the last look
    struct Turns {
        std::int32_t full = 0;
        bool clockwise = false;  // the rest, within half a turn

        void serialize(auto& archive) { archive(full, clockwise); }
    };
    std::vector<Turns> turns_;  // per triangle, with large rotations
    Extreme rotation_, strain_, area_change_, slip_, overlap_, obstacle_overlap_, obstacle_depth_;
    std::vector<Obstacle> supports_;                    // which free obstacles meet
    std::vector<std::array<Index, 2>> obstacle_pairs_;  // obstacles, and behind them supports
};

}  // namespace knap
