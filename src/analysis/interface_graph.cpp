#include "analysis/interface_graph.hpp"

#include "model/state.hpp"

#include <algorithm>
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

std::vector<InterfaceStatus> interface_status(const Model& model, const State& state) {
    const Index order = model.mesh.order, n_points = model.points_per_interface();
    std::vector<InterfaceStatus> of_point(n_points * model.interfaces.size(), InterfaceStatus::intact);
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {  // points of bonded fans are intact
        const Fan& fan = model.fans[state.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k)
            of_point[model.fan_points[fan.first_point + k].point] =
                status_of(state.points[state.first_point[s] + k].cohesion);
    }
    std::vector<InterfaceStatus> status(order * model.interfaces.size());
    for (Index i = 0; i < static_cast<Index>(status.size()); ++i) {
        const Interface& interface = model.interfaces[i / order];
        const Index first = n_points * (i / order);  // of second order the third point, the middle, is in both halves
        const bool precrack = interface.cracked || model.laws[interface.law].sigma_c <= 0;
        status[i] = precrack     ? InterfaceStatus::precrack
                    : order == 1 ? status_of(of_point[first], of_point[first + 1])
                                 : status_of(of_point[first + i % 2], of_point[first + 2]);
    }
    return status;
}

}  // namespace knap
