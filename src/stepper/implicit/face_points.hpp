#pragma once
// Free faces that meet, as points of an implicit step: a vertex and a point of an edge (contact/face_contacts.hpp), in
// their places at the start of the step. The step must not turn them, so this is for the search of an equilibrium,
// which ends where nothing moves. The faces have no restitution.
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
    /// The same, after a step that led to these rates. True: faces met that were not found before.
    bool lacked(const State& begin, double h, const std::vector<Vec2>& corner_rate);
    bool may_meet() const { return faces_.has_value(); }  // the model has contact between free faces
    std::size_t size() const { return faces_ ? faces_->all().size() : 0; }

    Vec2 force_before(std::size_t i) const { return {faces_->all()[i].contact, faces_->all()[i].tangential}; }  // [N]
    /// With its law over the step; all but the mass.
    ActivePoint point(std::size_t i, const StepContext& step, const CornerPartition& nodes) const;
    /// Of all.
    const std::vector<PointSides>& sides(const CornerPartition& nodes);
    /// On the corners of the body: `impulse` [N s] on the edge, the opposite on the vertex.
    void add_impulse(std::size_t i, const Vec2& impulse, std::vector<Vec2>& of_corner) const;
    /// State::face_contacts of a search has forces [N], since steps grow.
    void store(std::span<const ActivePoint> points, double kick, State& end) const;

private:
    double touching_gap(const State& begin, const FaceContact& contact) const;
    PointSides sides_of(const FaceContact& contact, const CornerPartition& nodes) const;

    const Model& model_;
    std::optional<FaceContacts> faces_;  // with contact between free faces
    const CohesiveLaw law_;              // without cohesion
    std::vector<PointSides> sides_;
    std::vector<std::array<Index, 2>> before_;
};

}  // namespace knap
