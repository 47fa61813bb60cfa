#pragma once
// The crack graph's view of a model and its state.
#include "observe/crack_graph.hpp"

#include <vector>

namespace knap {

struct Model;
struct State;

/// All interfaces of the model. A vertex is on the boundary when one of its edges is free, not on a foundation.
InterfaceGraph interface_graph(const Model& model);

/// One status per interface; only fans that came apart are looked at.
std::vector<InterfaceStatus> interface_status(const Model& model, const State& state);

}  // namespace knap
