#include "observe/probes.hpp"

#include "base/error.hpp"

#include <limits>

namespace knap {
namespace {

/// All corners of the vertex nearest to a place.
std::vector<Index> corners_near(const Mesh& mesh, const Vec2& place) {
    Index nearest = -1;
    double distance = std::numeric_limits<double>::infinity();
    for (Index c = 0; c < mesh.n_corners(); ++c) {
        const double d = (mesh.corner(c / 3, c % 3) - place).squaredNorm();
        if (d < distance) distance = d, nearest = mesh.triangles[c / 3][c % 3];
    }
    std::vector<Index> corners;
    for (Index c = 0; c < mesh.n_corners(); ++c)
        if (mesh.triangles[c / 3][c % 3] == nearest) corners.push_back(c);
    return corners;
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

}  // namespace

Probes::Probes(const Model& model, const std::vector<ProbeOptions>& probes) : model_(model) {
    for (const ProbeOptions& probe : probes) {
        if (probe.interface) probes_.push_back({.name = probe.name, .interface = interface_near(model, probe)});
        else probes_.push_back({.name = probe.name, .corners = corners_near(model.mesh, probe.at)});
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
        if (const Index p = 2 * probe.interface; p >= 0) {
            const Vec2 jump = 0.5 * (opening(model_, state, p) + opening(model_, state, p + 1));
            row.insert(row.end(), {jump.x(), jump.y(), 0.5 * (cohesion(model_, state, p) + cohesion(model_, state, p + 1))});
            continue;
        }
        Vec2 u = Vec2::Zero(), v = Vec2::Zero();
        for (const Index c : probe.corners) {
            u += state.displacement[state.node_of_corner[c]];
            v += state.velocity[state.node_of_corner[c]];
        }
        const double n = static_cast<double>(probe.corners.size());
        row.insert(row.end(), {u.x() / n, u.y() / n, v.x() / n, v.y() / n});
    }
    return row;
}

}  // namespace knap
