#pragma once
// Every interface that breaks, as acoustic emission records the cracks of a rock: time, place, direction, length, and
// tension or shear.
//
// An interface breaks when the last of its points loses its cohesion. Its mode follows from the openings at which the
// points lost theirs: the part of sliding in the equivalent opening s = u_N + gamma |u_T| = delta_c,
//
//     shear = gamma |u_T| / s        mean over the interface; 0: opened, 1: slid
//
// If both openings grew in proportion, this is the part of the fracture energy that sliding consumed. Above 1/2 the
// break counts as a shear break.
#include "model/state.hpp"
#include "output/outputs.hpp"
#include "stepper/adapt/adaptation.hpp"

namespace knap {

/// An interface that broke: one line of breaks.csv.
struct Break {
    double time;    // [s]
    Vec2 middle;    // [m] reference
    double angle;   // [deg] of the edge
    double length;  // [m]
    double shear;   // [-]
    double energy;  // [J]
    Vec2 jump;      // [m] opening, and slip: of the side to the left of the edge's direction over the other one
};
std::span<const Measure<Break>> break_columns();

inline bool is_shear(double shear) { return shear > 0.5; }

class Breaks {
public:
    Breaks(const Model& model, const State& start);

    /// A line of break_columns() for each interface that has broken since the last call.
    std::vector<std::vector<double>> found(const State& now);

    /// After a refinement of the mesh, to which `now` belongs.
    void renumber(const State& now, const Renumbering& numbers);

    Index n_tensile() const { return n_tensile_; }
    Index n_shear() const { return n_shear_; }

    void serialize(auto& archive) { archive(settled_, n_broken_, shear_, n_tensile_, n_shear_); }

private:
    void settle(const State& state);

    const Model& model_;
    std::vector<std::uint8_t> settled_;   // per point: broken, or never had cohesion
    std::vector<std::uint8_t> n_broken_;  // per interface: its broken points
    std::vector<double> shear_;           // per interface: mean over its broken points, by area
    Index n_tensile_ = 0, n_shear_ = 0;
};

}  // namespace knap
