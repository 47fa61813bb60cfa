#pragma once
// The crack graph's view of a model and its state.
#include "analysis/crack_graph.hpp"

#include <vector>

namespace knap {

struct Model;
struct State;

/// All interfaces of the model; of order 2 their halves, 2 i and 2 i + 1, with the middles as further vertices.
/// A vertex is on the boundary when one of its edges is free, not on a support.
InterfaceGraph interface_graph(const Model& model);

/// One status per interface, or half of one; only fans that came apart are looked at.
std::vector<InterfaceStatus> interface_status(const Model& model, const State& state);

}  // namespace knap
