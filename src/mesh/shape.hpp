#pragma once
// The shape to be meshed: an outer ring, holes, cracks (polylines) and regions, all in metres.
#include "base/text.hpp"
#include "mesh/polygon.hpp"

#include <optional>
#include <stdexcept>

namespace knap {

/// A closed polygon in either sense of rotation.
struct Ring {
    std::vector<Vec2> points;     // [m]
    std::vector<Index> boundary;  // per side points[i] -> points[i+1]: index into Shape::boundary_names
};

/// A polyline along which mesh edges have no cohesion from the start, or the law of a joint set.
struct Crack {
    std::vector<Vec2> points;  // [m]
    Index joint = -1;          // number of the joint set whose law acts; -1 = no cohesion
};

/// A part of the body with a material of its own. Later regions cover earlier ones.
struct Region {
    std::vector<Vec2> points;  // [m], closed polygon
    Index tag = 0;             // material index
    bool only_line = false;    // the mesh follows its border, and the material is that of what it covers
};

struct Shape {
    Ring outer;
    std::vector<Ring> holes;
    std::vector<Crack> cracks;
    std::vector<Region> regions;
    Index tag = 0;  // material index outside all regions
    std::vector<std::string> boundary_names;
    double snap = 0;  // [m] ends of cracks that are nearer to lines are joined to them, shorter pieces are left out

    /// True in the outer ring and in no hole.
    bool contains(const Vec2& p) const;
    double area() const;       // [m2] of the outer ring without the holes
    double tolerance() const;  // [m] points nearer than this are the same point: 1e-6 of the diagonal
};

/// Turns a shape about a point by an angle [rad].
void turn(Shape& shape, const Vec2& about, double angle);
/// Moves a shape by a vector [m].
void move(Shape& shape, const Vec2& by);

struct ShapeOverlap {
    double depth;  // [m] of a point of one shape below the border of the other
    Vec2 place;    // [m] that point
};
/// Where two shapes lie in each other by more than `tolerance` [m]; shapes that touch do not. The deepest of a few
/// places: the depth is at least half of the largest one along a straight side within a convex shape.
std::optional<ShapeOverlap> overlap(const Shape& a, const Shape& b, double tolerance);

/// What is wrong with a part of a shape, named as in Shape: "outer", "holes[0]", "cracks[1]", "regions[0]", "size".
struct ShapeFault {
    std::string part, text;
};

/// A shape that cannot be meshed; the message is that of the first fault.
class ShapeError : public std::runtime_error {
public:
    /// The text is the parts of the message one after the other.
    template <class... Parts>
    explicit ShapeError(std::string offending_part, const Parts&... message)
        : ShapeError({ShapeFault{std::move(offending_part), concatenated(message...)}}) {}
    explicit ShapeError(std::vector<ShapeFault> found)
        : std::runtime_error(found.front().text), faults(std::move(found)) {}
    std::vector<ShapeFault> faults;  // at least one
    const std::string& part() const { return faults.front().part; }
};

}  // namespace knap
