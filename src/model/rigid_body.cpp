#include "model/rigid_body.hpp"

#include <cmath>
#include <numbers>

namespace knap {

double FrozenBody::Piece::size() const { return std::sqrt(4 * area / std::numbers::pi); }

double FrozenBody::Piece::edge() const { return std::sqrt(4 / std::numbers::sqrt3 * area / n_triangles); }

}  // namespace knap
