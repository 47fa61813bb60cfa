#include "analysis/probes.hpp"

#include "base/error.hpp"

#include <array>
#include <limits>

namespace knap {
namespace {

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

Probes::Probes(const Model& model, const std::vector<ProbeOptions>& probes) : model_(model) {
    for (const ProbeOptions& probe : probes) {
        if (probe.interface) probes_.push_back({.name = probe.name, .interface = interface_near(model, probe)});
        else probes_.push_back({.name = probe.name, .weights = weights_at(model.mesh, probe.at)});
    }
}

std::span<const Output> place_columns() {
    static constexpr std::array columns{Output{"_u_x", "m", "displacement of a place"}, Output{"_u_y", "m", "likewise"}, Output{"_v_x", "m/s", "velocity of a place"},
                                        Output{"_v_y", "m/s", "likewise"}};
    return columns;
}

std::span<const Output> interface_columns() {
    static constexpr std::array columns{Output{"_opening", "m", "opening of an interface, mean over its points"}, Output{"_slip", "m", "slip, likewise"},
                                        Output{"_cohesion", "", "beta, likewise: 1 intact, 0 broken"}};
    return columns;
}

std::vector<std::string> probe_columns(const ProbeOptions& probe) {
    std::vector<std::string> names;
    for (const Output& column : probe.interface ? interface_columns() : place_columns()) names.push_back(probe.name + std::string(column.name));
    return names;
}

std::vector<std::string> Probes::columns() const {
    std::vector<std::string> names{"time"};
    for (const Probe& probe : probes_)
        for (const std::string& column : probe_columns({.name = probe.name, .at = {}, .interface = probe.interface >= 0})) names.push_back(column);
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
        const Vec2 u = mean_displacement(probe.weights, state), v = mean_velocity(probe.weights, state);
        row.insert(row.end(), {u.x(), u.y(), v.x(), v.y()});
    }
    return row;
}

}  // namespace knap
