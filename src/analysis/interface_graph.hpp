#pragma once
// The graph in which cracks are found: all interfaces of a body as edges, with the status of each.
#include "output/frame.hpp"

namespace knap {

/// Constant during a run but for the boundary, which an excavation changes.
struct InterfaceGraph {
    std::vector<Vec2> vertices;              // [m]
    std::vector<std::uint8_t> on_boundary;   // per vertex: on the free boundary, where a crack ends
    std::vector<std::array<Index, 2>> ends;  // per interface: its two vertices
    std::vector<double> length;              // [m] per interface
};

/// With second order the halves of an interface are edges, 2 i and 2 i + 1, and the middles are further vertices.
/// A vertex is on the boundary when one of its edges is free, i.e. not on a support.
InterfaceGraph interface_graph(const Model& model);

/// The status of every edge of that graph: damaged below cohesion 1 at one of its points, broken at 0 at both.
std::vector<InterfaceStatus> interface_status(const Model& model, const State& state);

struct EdgeStatus {
    Index edge;
    InterfaceStatus status;
};

/// Follows the statuses of all edges from step to step, at a few nanoseconds per point of the split fans.
class StatusWatch {
public:
    explicit StatusWatch(const Model& model) : model_(model) {}
    /// The edges with a point whose status has changed since the last call, ascending; at first all of them.
    const std::vector<EdgeStatus>& changed(const State& now);
    /// The model has become another one.
    void renew() { of_point_.clear(); }

private:
    const Model& model_;
    std::vector<InterfaceStatus> of_point_;  // per point of the fans, in their order; empty: not known
    std::vector<EdgeStatus> changed_;
};

}  // namespace knap
