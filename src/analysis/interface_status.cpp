#include "analysis/interface_status.hpp"

#include "model/model.hpp"
#include "model/state.hpp"

#include <algorithm>
#include <utility>

namespace knap {

InterfaceGraph interface_graph(const Model& model) {
    const Mesh& mesh = model.mesh;
    std::vector<std::pair<Index, Index>> on_support;  // edges by their vertices
    InterfaceGraph graph;
    graph.vertices = mesh.vertices;
    graph.ends.reserve(model.interfaces.size());
    graph.length.reserve(model.interfaces.size());
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
        if (i.triangle[0] == rigid_support || i.triangle[1] == rigid_support) on_support.push_back(std::minmax(i.vertex[0], i.vertex[1]));
    }
    std::sort(on_support.begin(), on_support.end());
    graph.on_boundary.assign(graph.vertices.size(), 0);
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        const auto& corners = mesh.triangles[edge.triangle];
        const Index a = corners[edge.side], b = corners[(edge.side + 1) % 3];
        if (std::binary_search(on_support.begin(), on_support.end(), std::pair<Index, Index>(std::minmax(a, b)))) continue;
        graph.on_boundary[a] = graph.on_boundary[b] = 1;
    }
    return graph;
}

std::vector<InterfaceStatus> interface_status(const Model& model, const State& state) {
    const Index order = model.mesh.order;
    std::vector<InterfaceStatus> status(order * model.interfaces.size(), InterfaceStatus::intact);
    std::vector<std::uint8_t> n_broken_points(status.size(), 0);
    for (std::size_t i = 0; i < status.size(); ++i) {
        const Interface& interface = model.interfaces[i / order];
        if (interface.cracked || model.laws[interface.law].sigma_c <= 0) status[i] = InterfaceStatus::precrack;
    }
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const Fan& fan = model.fans[state.split_fans[s]];
        for (Index k = 0; k < fan.n_points; ++k) {
            const double cohesion = state.points[state.first_point[s] + k].cohesion;
            const Index point = model.fan_points[fan.first_point + k].point, interface = model.interface_of(point);
            const Index place = point % model.points_per_interface();  // of order 2 the middle is in both halves
            for (Index i = order * interface; i < order * (interface + 1); ++i) {
                if (cohesion >= 1 || status[i] == InterfaceStatus::precrack) continue;
                if (order == 2 && place < 2 && i % 2 != place) continue;
                if (cohesion <= 0) ++n_broken_points[i];
                status[i] = n_broken_points[i] == 2 ? InterfaceStatus::broken : InterfaceStatus::damaged;
            }
        }
    }
    return status;
}

}  // namespace knap
