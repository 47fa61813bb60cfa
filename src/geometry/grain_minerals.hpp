#pragma once
// Which grain is of which mineral.
#include "geometry/mesh.hpp"

#include <cstdint>

namespace knap {

struct Mineral {
    Index region = 0;     // material index
    double fraction = 0;  // [-] of the area of the grains; the rest keeps the material it has
};

/// For the grains from number `first` on. Random, with the area fractions met as well as whole grains can: the largest grains first, each by lot with the odds of the areas
/// that are still missing, so size and mineral are independent.
void assign_minerals(Mesh& mesh, const std::vector<Mineral>& minerals, Index first, std::uint64_t seed);

}  // namespace knap
