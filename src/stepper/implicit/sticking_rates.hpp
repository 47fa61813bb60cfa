#pragma once
// Nodes of a fan that stick to each other move as one to the last bit: with the mean of their rates, which the solver
// leaves about 1e-13 apart.
#include "stepper/implicit/active_point.hpp"

#include <span>

namespace knap {

class StickingRates {
public:
    explicit StickingRates(const Model& model);

    /// `points`: of fans, those of one in succession.
    void merge(std::span<const ActivePoint> points, const CornerPartition& nodes, std::vector<Vec2>& rate);

private:
    std::vector<std::vector<Index>> clusters_;  // nodes that stick to each other, of one fan
};

}  // namespace knap
