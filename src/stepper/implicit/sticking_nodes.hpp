#pragma once
// Sides of active fans that stick without a jump move as one, to the last bit: with the mean of the rates, which the solver leaves 1e-13 or so apart.
#include "model/model.hpp"
#include "stepper/implicit/active_point.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace knap {

class StickingNodes {
public:
    explicit StickingNodes(const Model& model);

    /// `fan_is_active` [0/1]: per fan; `active_point_of`: per fan point, into `points`, or -1; `prescribed` and `rate` [m/s]: per node.
    void merge(const std::vector<std::uint8_t>& fan_is_active, const std::vector<Index>& active_point_of, const std::vector<ActivePoint>& points,
               const std::vector<std::array<bool, 2>>& prescribed, std::vector<Vec2>& rate);

private:
    const Model& model_;
    std::vector<std::vector<Index>> clusters_;  // of nodes, of the fan that is joined
    std::vector<Index> other_;
};

}  // namespace knap
