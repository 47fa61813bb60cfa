#pragma once
// The requested mean edge length at a point (smallest in the refine boxes, growing linearly with the distance from
// them), and lines and arcs divided into pieces of that length. Vertices lie on the arc, so that areas converge at
// second order.
#include "mesh/polygon.hpp"

#include <cstdint>
#include <functional>
#include <optional>

namespace knap {

struct RefineBox {
    Vec2 low, high;  // [m]
    double size;     // [m] requested mean edge length inside
};

struct MeshOptions {
    double size = 0;                // [m] requested mean edge length, met within 5 %
    std::vector<RefineBox> refine;  // the smallest size wins where boxes overlap
    double grading = 0.3;           // [-] growth of the size per distance away from a refine box
    double min_angle = 20;          // [degree] requested smallest angle, at most 30
    std::uint64_t seed = 1;
};

class SizeField {
public:
    /// All sizes are multiplied by `factor`. `options` must outlive the field.
    SizeField(const MeshOptions& options, double factor) : options_(options), factor_(factor) {}

    double operator()(const Vec2& p) const;  // [m]
    double smallest() const;                 // [m]
    double largest() const { return factor_ * options_.size; }
    /// [-] Largest change of the size per distance.
    double slope() const { return options_.refine.empty() ? 0 : factor_ * options_.grading; }

private:
    const MeshOptions& options_;
    double factor_;
};

/// The length of a curve in local sizes, integrated by the midpoint rule, and its inverse.
class LengthInSizes {
public:
    /// `at(position)` is a point of the curve, position 0 to 1; `length` [m].
    LengthInSizes(double length, const SizeField& size, const std::function<Vec2(double)>& at);

    double total() const { return sum_.back(); }
    /// The position on the curve where the length in sizes is `target`. Targets must ascend from one call to the next.
    double position(double target);

private:
    std::vector<double> sum_{0.0};  // up to the end of each sample
    std::size_t sample_ = 1;
};

struct Arc {
    Vec2 centre;
    double radius;       // [m]
    double from, sweep;  // [rad] direction of its start from the centre; positive counterclockwise

    double length() const;           // [m]
    Vec2 at(double position) const;  // 0 its start, 1 its end
};

/// The arc from a over `through` to b; none where they lie on a line, to 1e-9 of their distance.
std::optional<Arc> arc_through(const Vec2& a, const Vec2& through, const Vec2& b);

/// Number of sides of an arc: its length in local mesh sizes, at least twelve for a full turn.
double sides_of(const Arc& arc, const SizeField& size);

/// Points on an arc, without its ends, that divide it into pieces of the local mesh size.
std::vector<Vec2> points_within(const Arc& arc, const SizeField& size);

/// A full circle, counterclockwise; equal sides where the size is uniform.
std::vector<Vec2> circle(const Vec2& centre, double radius, const SizeField& size);

}  // namespace knap
