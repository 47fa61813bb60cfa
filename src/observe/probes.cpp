#include "observe/probes.hpp"

#include "base/error.hpp"
#include "bulk/quadratic_triangles.hpp"

#include <limits>

namespace knap {
namespace {

/// Barycentric coordinates of a place in a triangle.
Eigen::Vector3d barycentric(const Mesh& mesh, Index t, const Vec2& place) {
    const Vec2 a = mesh.corner(t, 0), ab = mesh.corner(t, 1) - a, ac = mesh.corner(t, 2) - a, ap = place - a;
    const double area = cross(ab, ac), b = cross(ap, ac) / area, c = cross(ab, ap) / area;
    return {1 - b - c, b, c};
}

/// Of corner k at barycentric coordinates l.
double shape_function(Index order, Index k, const Eigen::Vector3d& l) {
    if (order == 1) return l[k];
    const double bubble = 27 * l[0] * l[1] * l[2];
    const double quadratic = k < 3 ? l[k] * (2 * l[k] - 1) : k < 6 ? 4 * l[k - 3] * l[(k - 2) % 3] : 0;
    return quadratic + bubble_weight[k] * bubble;
}

Index nearest_vertex(const Mesh& mesh, const Vec2& place) {
    Index nearest = 0;
    for (std::size_t v = 1; v < mesh.vertices.size(); ++v)
        if ((mesh.vertices[v] - place).squaredNorm() < (mesh.vertices[nearest] - place).squaredNorm()) nearest = static_cast<Index>(v);
    return nearest;
}

/// The interface that can break whose middle is nearest to a place.
Index interface_near(const Model& model, const ProbeOptions& probe) {
    Index nearest = -1;
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < model.interfaces.size(); ++i) {
        const Interface& interface = model.interfaces[i];
        if (interface.cracked || !model.laws[interface.law].breakable()) continue;
        const Vec2 middle = 0.5 * (model.mesh.vertices[interface.vertex[0]] + model.mesh.vertices[interface.vertex[1]]);
        const double d = (middle - probe.at).squaredNorm();
        if (d < distance) distance = d, nearest = static_cast<Index>(i);
    }
    if (nearest < 0) throw SimulationError("probe `" + probe.name + "` watches an interface, and none can break");
    return nearest;
}

/// Opening, slip [m] and cohesion: mean over an interface.
Eigen::Vector3d mean_of_interface(const Model& model, const State& state, Index interface) {
    const Index n = model.points_per_interface();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Index p = n * interface; p < n * (interface + 1); ++p) {
        const double part = model.fan_points[model.fan_point_of[p]].area / (model.interfaces[interface].length * model.thickness);
        const Vec2 jump = opening(model, state, p);
        sum += part * Eigen::Vector3d(jump.x(), jump.y(), cohesion(model, state, p));
    }
    return sum;
}

}  // namespace

/// As the displacement is in the triangle that the place lies in, so that it stays the same place on every mesh; the mean of all of them on an
/// edge or at a vertex. Outside of the body the nearest vertex.
std::vector<Probes::Weight> Probes::weights_at(const Mesh& mesh, const Vec2& place) {
    int n_triangles = 0;
    const auto found_at = [&](const Vec2& point) {
        std::vector<Weight> weights;
        for (Index t = 0; t < mesh.n_triangles(); ++t) {
            const Eigen::Vector3d parts = barycentric(mesh, t, point);
            if (parts.minCoeff() < -1e-9) continue;
            ++n_triangles;
            for (Index k = 0; k < mesh.corners_per_triangle(); ++k)
                weights.push_back({mesh.corners_per_triangle() * t + k, shape_function(mesh.order, k, parts)});
        }
        return weights;
    };
    std::vector<Weight> weights = found_at(place);
    if (weights.empty()) weights = found_at(mesh.vertices[nearest_vertex(mesh, place)]);
    for (Weight& weight : weights) weight.part /= n_triangles;
    return weights;
}

Probes::Probes(const Model& model, const std::vector<ProbeOptions>& probes) : model_(model) {
    for (const ProbeOptions& probe : probes) {
        if (probe.interface) probes_.push_back({.name = probe.name, .interface = interface_near(model, probe)});
        else probes_.push_back({.name = probe.name, .weights = weights_at(model.mesh, probe.at)});
    }
}

std::vector<std::string> Probes::columns() const {
    std::vector<std::string> names{"time"};
    for (const Probe& probe : probes_) {
        const bool vertex = probe.interface < 0;
        for (const char* quantity : vertex ? std::vector{"_u_x", "_u_y", "_v_x", "_v_y"} : std::vector{"_opening", "_slip", "_cohesion"})
            names.push_back(probe.name + quantity);
    }
    return names;
}

std::vector<double> Probes::line(const State& state) const {
    std::vector<double> row{state.time};
    for (const Probe& probe : probes_) {
        if (probe.interface >= 0) {
            const Eigen::Vector3d mean = mean_of_interface(model_, state, probe.interface);
            row.insert(row.end(), {mean[0], mean[1], mean[2]});
            continue;
        }
        Vec2 u = Vec2::Zero(), v = Vec2::Zero();
        for (const Weight& weight : probe.weights) {
            u += weight.part * state.displacement[state.node_of_corner[weight.corner]];
            v += weight.part * state.velocity[state.node_of_corner[weight.corner]];
        }
        row.insert(row.end(), {u.x(), u.y(), v.x(), v.y()});
    }
    return row;
}

}  // namespace knap
