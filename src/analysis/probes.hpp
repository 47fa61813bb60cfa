#pragma once
// Displacement and velocity of chosen places, opening and cohesion of chosen interfaces, over time.
#include "analysis/corner_weights.hpp"
#include "model/state.hpp"
#include "output/outputs.hpp"

#include <string>
#include <vector>

namespace knap {

struct ProbeOptions {
    std::string name;
    Vec2 at;                 // [m]
    bool interface = false;  // an interface that can break, the one nearest to the place
};

/// Columns of probes.csv of a probe that watches a place, and of one that watches an interface, by the part behind its name.
std::span<const Output> place_columns();
std::span<const Output> interface_columns();

/// Those of one probe, by name.
std::vector<std::string> probe_columns(const ProbeOptions& probe);

class Probes {
public:
    /// Throws SimulationError where an interface is to be watched and none can break.
    Probes(const Model& model, const std::vector<ProbeOptions>& probes);

    bool empty() const { return probes_.empty(); }

    /// Columns and line of probes.csv: time, then of each probe u_x, u_y, v_x, v_y, or
    /// opening, slip [m] and cohesion, means over the two points of its interface.
    std::vector<std::string> columns() const;
    std::vector<double> line(const State& state) const;

private:
    struct Probe {
        std::string name;
        std::vector<CornerWeight> weights;  // of the corners that make up the place
        Index interface = -1;         // or this
    };
    const Model& model_;
    std::vector<Probe> probes_;
};

}  // namespace knap
