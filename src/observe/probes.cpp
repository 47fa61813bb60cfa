#include "observe/probes.hpp"

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

}  // namespace

Probes::Probes(const Model& model, const std::vector<ProbeOptions>& probes) {
    for (const ProbeOptions& probe : probes) probes_.push_back({probe.name, corners_near(model.mesh, probe.at)});
}

std::vector<std::string> Probes::columns() const {
    std::vector<std::string> names{"time"};
    for (const Probe& probe : probes_)
        for (const char* quantity : {"_u_x", "_u_y", "_v_x", "_v_y"}) names.push_back(probe.name + quantity);
    return names;
}

std::vector<double> Probes::line(const State& state) const {
    std::vector<double> row{state.time};
    for (const Probe& probe : probes_) {
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
