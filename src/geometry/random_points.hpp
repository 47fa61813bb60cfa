#pragma once
// Random points for a mesh without preferred directions: jittered along lines, and Poisson discs (no two points nearer than a local
// radius, and hardly room for one more) over the body. The Delaunay triangles of such points have angles of about 30 to 120 degree and
// edges of 1 to 2 radii. Source: M. Ebeida, S. Mitchell, A. Davidson, A. Patney, P. Knupp, J. Owens, "Efficient and good Delaunay
// meshes from random points", Computer-Aided Design 43 (2011) 1506.
#include "base/random.hpp"
#include "geometry/shape.hpp"
#include "geometry/size_field.hpp"

namespace knap {

/// The inner points that cut a-b into pieces of 1 to 1.42 radii.
std::vector<Vec2> points_along(const Vec2& a, const Vec2& b, const SizeField& radius, Random& random);

/// Points inside the body that keep the distance `radius` from each other and from the points given on its lines.
std::vector<Vec2> poisson_points(const Shape& shape, const std::vector<Vec2>& on_lines, const SizeField& radius, Random& random);

}  // namespace knap
