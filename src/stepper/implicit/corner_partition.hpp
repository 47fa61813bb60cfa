#pragma once
// Which corners share a node in the equations of an implicit step. A fan that is bonded is one node; an active one falls apart at every
// interface that can break. (The State knows more nodes: a fan that once came apart has one per corner there for ever.)
#include "model/model.hpp"

#include <cstdint>
#include <vector>

namespace knap {

struct CornerPartition {
    std::vector<Index> node_of_corner;
    std::vector<Index> corner_of_node;  // one of its corners
    Index n_nodes() const { return static_cast<Index>(corner_of_node.size()); }
};

/// A point that holds for good: its law cannot break and it is no crack.
inline bool unbreakable(const Model& model, const FanPoint& point) { return !point.cracked && !model.laws[point.law].breakable(); }

/// Nodes are numbered fan by fan, those of a fan one after the other. What `partition` was is overwritten; its memory is used again.
void partition_corners(const Model& model, const std::vector<std::uint8_t>& fan_is_active, CornerPartition& partition);

}  // namespace knap
