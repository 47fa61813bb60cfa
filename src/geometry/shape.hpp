#pragma once
// What is to be meshed: an outer ring, holes, cracks (polylines) and regions, all in metres.
#include "base/vec.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace knap {

/// A closed polygon, counterclockwise or clockwise, without its first point repeated.
struct Ring {
    std::vector<Vec2> points;     // [m]
    std::vector<Index> boundary;  // per side points[i] -> points[i+1]: index into Shape::boundary_names
};

/// A polyline along which mesh edges have no cohesion from the start, or those of a joint set a law of their own.
struct Crack {
    std::vector<Vec2> points;  // [m]
    Index joint = -1;          // number of the joint set whose law acts; -1 = no cohesion
};

/// A part of the domain with a material of its own. Later regions lie over earlier ones; what no region covers has tag 0.
struct Region {
    std::vector<Vec2> points;  // [m], closed polygon
    Index tag = 0;             // material index
};

struct Shape {
    Ring outer;
    std::vector<Ring> holes;
    std::vector<Crack> cracks;
    std::vector<Region> regions;
    std::vector<std::string> boundary_names;
};

/// A shape that cannot be meshed. `part` names the offender as in Shape: "outer", "holes[0]", "cracks[1]", "regions[0]", "size".
class ShapeError : public std::runtime_error {
public:
    ShapeError(std::string offending_part, const std::string& message) : std::runtime_error(message), part(std::move(offending_part)) {}
    std::string part;
};

/// A closed polygon of `n` sides on a circle, counterclockwise.
std::vector<Vec2> circle(const Vec2& centre, double radius, int n);

/// Throws ShapeError unless rings are simple polygons that do not touch each other, holes lie inside the outer ring, regions are simple
/// polygons, and every part has a length or an area. Cracks may begin on a border, cross each other, and reach out of the body: what
/// lies outside is cut off, and a crack with nothing inside is an error. Says nothing about mesh sizes (see triangulate).
void check_shape(const Shape& shape);

}  // namespace knap
