#pragma once
// Displacement and velocity of chosen places of a body over time.
#include "model/state.hpp"

#include <string>
#include <vector>

namespace knap {

struct ProbeOptions {
    std::string name;
    Vec2 at;  // [m] the vertex nearest to it is watched
};

class Probes {
public:
    Probes(const Model& model, const std::vector<ProbeOptions>& probes);

    bool empty() const { return probes_.empty(); }

    /// Columns and line of probes.csv: time, then u_x, u_y, v_x, v_y of each probe; means over the corners round its vertex.
    std::vector<std::string> columns() const;
    std::vector<double> line(const State& state) const;

private:
    struct Probe {
        std::string name;
        std::vector<Index> corners;  // round the vertex
    };
    std::vector<Probe> probes_;
};

}  // namespace knap
