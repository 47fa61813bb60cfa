#pragma once
// The nodes of a State: which it has, and in which order.
#include "model/state.hpp"

namespace knap {

/// Gives `end` memory and the partition of `begin`. `end` may be any earlier state of the same run; if it is the state
/// of the step before, only the fans that split since are copied.
void copy_partition(const Model& model, const State& begin, State& end);

/// Fans split anywhere in the body, and State appends their nodes and points. If more than one in sixteen is out of
/// order, this sorts the split fans in the order of the sweep over the blocks, so that what a block reads of them is
/// contiguous: 5 % of the time of a body larger than the cache. `before` is overwritten; its memory is used again.
void order_split_fans(const Model& model, State& state, State& before);

}  // namespace knap
