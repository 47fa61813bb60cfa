#pragma once
// How far a run is from what it presumes: small rotations, small changes of shape, small slips of what is in contact, contact of neighbours only. Looked at when
// the body has moved far enough since the last time (Recorder), not at every step; it remembers the largest of each and its place.
#include "model/state.hpp"

#include <optional>
#include <vector>

namespace knap {

/// The largest so far. A value that is no number is the largest of all.
struct Extreme {
    double value = 0;
    Vec2 place = Vec2::Zero();  // [m]

    void meet(double other, const Vec2& where) {
        if (!(other <= value)) value = other, place = where;
    }
    template <class Archive>
    void serialize(Archive& archive) { archive(value, place); }
};

class DeformationWatch {
public:
    explicit DeformationWatch(const Model& model);

    /// Rotation, change of area, slip: some ten nanoseconds a triangle.
    void look_at(const State& state);
    /// Overlap: dearer.
    void look_for_overlap(const State& state);

    /// [m] The path on which no vertex must go between two looks: relative to each other two vertices turn no triangle by more than 2 degrees on it.
    double look_path() const { return look_path_; }
    /// [m] Likewise between two searches for overlap: a tenth of an edge.
    double search_path() const;

    const Extreme& rotation() const { return rotation_; }        // [deg] of a triangle: the rotation in the polar decomposition of its deformation gradient
    const Extreme& area_change() const { return area_change_; }  // [-] of a triangle, det F - 1, its absolute value
    const Extreme& slip() const { return slip_; }                // [edges] of a point that is pressed, over the length of its edge
    const Extreme& overlap() const { return overlap_; }          // [m2] area that triangles cover twice; the place is that of the deformed body
    double triangle_area() const { return triangle_area_; }      // [m2] the mean; of those that lie over each other where these are smaller
    std::optional<Vec2> place_of(Index corner) const { return corner < 0 ? std::nullopt : std::optional(model_.mesh.corner(corner)); }  // of -1: none
    double body_area() const { return body_area_; }              // [m2]

    template <class Archive>
    void serialize(Archive& archive) { archive(rotation_, area_change_, slip_, overlap_, triangle_area_); }

private:
    void look_at_triangles(const State& state);
    void look_at_points(const State& state);
    void measure_supports();
    double beyond_support(Index interface, double slip) const;

    /// How far a point on a support may slide before the support turns away from it [m], backward and forward along T.
    struct StraightReach {
        Index interface;
        double backward, forward;
    };

    const Model& model_;
    std::vector<StraightReach> straight_;  // in the order of the interfaces
    double triangle_area_ = 0, body_area_ = 0, look_path_ = 0;
    Extreme rotation_, area_change_, slip_, overlap_;
};

}  // namespace knap
