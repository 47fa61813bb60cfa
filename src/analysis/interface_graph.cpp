#include "analysis/interface_graph.hpp"

#include "analysis/nearest.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace knap {

InterfaceGraph interface_graph(const Model& model) {
    const Mesh& mesh = model.mesh;
    std::set<std::pair<Index, Index>> on_support;  // edges by their vertices
    InterfaceGraph graph;
    graph.vertices = mesh.vertices;
    for (const Interface& i : model.interfaces) {
        if (mesh.order == 1) {
            graph.ends.push_back(i.vertex);
            graph.length.push_back(i.length);
        } else {
            const Index middle = static_cast<Index>(graph.vertices.size());
            graph.vertices.push_back(0.5 * (mesh.vertices[i.vertex[0]] + mesh.vertices[i.vertex[1]]));
            graph.ends.insert(graph.ends.end(), {{i.vertex[0], middle}, {middle, i.vertex[1]}});
            graph.length.insert(graph.length.end(), 2, 0.5 * i.length);
        }
        if (i.triangle[0] == rigid_support || i.triangle[1] == rigid_support)
            on_support.insert(std::minmax(i.vertex[0], i.vertex[1]));
    }
    graph.on_boundary.assign(graph.vertices.size(), 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        const auto& vertex = mesh.triangles[edge.triangle];
        const Index a = vertex[edge.side], b = vertex[(edge.side + 1) % 3];
        if (!on_support.contains(std::minmax(a, b))) graph.on_boundary[a] = graph.on_boundary[b] = 1;
    }
    return graph;
}

namespace {

/// `of_point(p)`: the status of a point.
template <class OfPoint>
InterfaceStatus status_of_edge(const Model& model, Index edge, const OfPoint& of_point) {
    const Index order = model.mesh.order, i = edge / order, first = model.points_per_interface() * i;
    const Interface& interface = model.interfaces[i];
    if (is_open_from_start(model, interface)) return InterfaceStatus::precrack;
    if (order == 1) return status_of(of_point(first), of_point(first + 1));
    return status_of(of_point(first + edge % 2), of_point(first + 2));  // the third point is in both halves
}

}  // namespace

std::vector<InterfaceStatus> interface_status(const Model& model, const State& state) {
    std::vector<InterfaceStatus> of_point(model.n_points(), InterfaceStatus::intact);
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {  // points of bonded fans are intact
        const Fan& fan = model.fans[state.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k)
            of_point[model.fan_points[fan.first_point + k].point] =
                status_of(state.points[state.first_point[s] + k].cohesion);
    }
    std::vector<InterfaceStatus> status(model.mesh.order * model.interfaces.size());
    for (Index e = 0; e < static_cast<Index>(status.size()); ++e)
        status[e] = status_of_edge(model, e, [&](Index p) { return of_point[p]; });
    return status;
}

const std::vector<EdgeStatus>& StatusWatch::changed(const State& now) {
    const bool is_known = !of_point_.empty();
    if (!is_known) of_point_.assign(model_.fan_points.size(), InterfaceStatus::intact);
    std::vector<Index> edges;
    const Index order = model_.mesh.order;
    for (std::size_t s = 0; s < now.split_fans.size(); ++s) {
        const Fan& fan = model_.fans[now.split_fans[s]];
        const PointState* point = &now.points[now.first_point[s]];
        for (Index k = fan.first_point; k < fan.first_point + fan.n_points; ++k, ++point) {
            const InterfaceStatus status = status_of(point->cohesion);
            if (of_point_[k] == status) continue;
            of_point_[k] = status;
            const Index first = order * model_.interface_of(model_.fan_points[k].point);
            for (Index half = 0; half < order && is_known; ++half) edges.push_back(first + half);
        }
    }
    changed_.clear();
    if (is_known) {
        std::ranges::sort(edges);
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    } else {
        edges.resize(order * model_.interfaces.size());
        std::iota(edges.begin(), edges.end(), 0);
    }
    const auto of_point = [&](Index p) {
        const Index k = model_.fan_point_of[p];
        return k < 0 ? InterfaceStatus::intact : of_point_[k];
    };
    for (const Index e : edges) changed_.push_back({e, status_of_edge(model_, e, of_point)});
    return changed_;
}

}  // namespace knap
