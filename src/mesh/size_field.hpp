#pragma once
// The requested mean edge length at a point (smallest in the refined places, growing linearly with the distance from
// them), and lines and arcs divided into pieces of that length. Vertices lie on the arc, so that areas converge at
// second order.
#include "mesh/polygon.hpp"

#include <cstdint>
#include <functional>
#include <optional>

namespace knap {

/// A place with a mesh size of its own: a box, or a strip along a polyline, all within half its width of the line.
struct RefinedPlace {
    Box box;                      // the place, or a box around the strip
    double size;                  // [m] requested mean edge length inside
    std::vector<Segment> line{};  // of a strip
    double half_width = 0;        // [m] of the strip

    double distance(const Vec2& p) const;  // [m] 0 inside
    double area() const;                   // [m2] of a strip about, as if it were straight
    double perimeter() const;              // [m] likewise
};

/// At least one point is needed.
RefinedPlace refined_strip(const std::vector<Vec2>& points, double width, double size);

struct MeshOptions {
    double size = 0;                   // [m] requested mean edge length, met within 5 %
    std::vector<RefinedPlace> refine;  // the smallest size wins where places overlap
    double grading = 0.3;              // [-] growth of the size per distance away from a refined place
    double min_angle = 20;             // [degree] requested smallest angle, at most 30
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
