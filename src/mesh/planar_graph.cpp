#include "mesh/planar_graph.hpp"

namespace knap {

std::string GraphSegment::part_name() const {
    if (crack >= 0) return concatenated("cracks[", crack, "]");
    if (region >= 0) return concatenated("regions[", region, "]");
    return ring > 0 ? concatenated("holes[", ring - 1, "]") : "outer";
}

}  // namespace knap
