#pragma once
// Free faces that meet, as points of an implicit step: a vertex and a point of an edge (contact/face_contacts.hpp).
// Which ones meet, and the gap g, are those of the start of the step; with large rotations normal n and share s are
// those of the middle of the step. g times the length of the edge is quadratic in the places, so
//
//     g+ - g = h n . (w_i - (1 - s) w_a - s w_b)
//
// but for the strain of the edge. The slip is that of the edge where the vertex is (PointSides::lever), so the impulses
// on the three have no resultant, and no moment about their places in the middle of the step.
#include "stepper/contact/face_contacts.hpp"
#include "stepper/implicit/active_point.hpp"

#include <optional>
#include <span>

namespace knap {

class FacePoints {
public:
    explicit FacePoints(const Model& model);

    /// Those that may meet in a step of h [s] with these rates [m/s, per corner]. False: they move too far in it.
    bool find(const State& begin, double h, const std::vector<Vec2>& corner_rate);
    /// Why, where find() was false.
    void reject(StepReport& report) const;
    /// The same, after a step that led to these rates. True: faces met that were not found before.
    bool lacked(const State& begin, double h, const std::vector<Vec2>& corner_rate);
    bool may_meet() const { return faces_.has_value(); }  // the model has contact between free faces
    std::size_t size() const { return rows_.size(); }
    /// Large rotations: normals and shares in the middle of a step of h [s] with these rates [m/s, per corner].
    void turn(const State& begin, double h, const std::vector<Vec2>& corner_rate);
    /// [-] By which the row of this point has turned since it was made.
    double change(std::size_t i, const ActivePoint& point) const;

    Vec2 force_before(std::size_t i, const State& begin) const;  // [N]
    /// With its law over the step; all but the mass.
    ActivePoint point(std::size_t i, const StepContext& step, const CornerPartition& nodes) const;
    /// Of all.
    const std::vector<PointSides>& sides(const CornerPartition& nodes);
    /// On the corners of the body: `impulse` [N s] on the edge, the opposite on the vertex.
    void add_impulse(std::size_t i, const Vec2& impulse, std::vector<Vec2>& of_corner) const;
    /// State::face_contacts of a search, which has small rotations, has forces [N], since steps grow.
    void store(std::span<const ActivePoint> points, const StepContext& step, State& end, StepReport& report) const;

private:
    struct Row : FaceContact {
        Eigen::Matrix2d lever = Eigen::Matrix2d::Zero();  // [-] PointSides::lever; zero with small rotations
    };
    /// Zero on the ground, which does not move, else that of the corner.
    Vec2 unless_ground(Index corner, const auto& of_corner) const {
        return model_.ground_at(corner) ? Vec2(Vec2::Zero()) : Vec2(of_corner(corner));
    }
    double touching_gap(const State& begin, const FaceContact& contact) const;
    PointSides sides_of(const Row& contact, const CornerPartition& nodes) const;

    const Model& model_;
    std::optional<FaceContacts> faces_;  // with contact between free faces
    std::vector<Row> rows_;              // that may meet
    const CohesiveLaw law_;              // without cohesion
    std::vector<PointSides> sides_;
    std::vector<std::array<Index, 2>> before_;
};

}  // namespace knap
