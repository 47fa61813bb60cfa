#pragma once
// Every interface that breaks, as acoustic emission counts the cracks of a rock: when, where, in which direction, how long, in tension or in shear.
//
// An interface breaks when the last of its points loses its cohesion. The mode is read from the openings at which the points lost theirs: the part
// of the equivalent opening s = u_N + gamma |u_T| = delta_c that is sliding,
//
//     shear = gamma |u_T| / s        mean over the interface; 0: opened, 1: slid
//
// which is the part of the fracture energy that sliding took, where both openings grew in proportion. Above 1/2 it is a shear break.
#include "model/state.hpp"
#include "output/frame.hpp"
#include "output/outputs.hpp"

#include <vector>

namespace knap {

/// An interface that broke: what a line of breaks.csv is about.
struct Break {
    double time;    // [s]
    Vec2 middle;    // [m] in the body as it was
    double angle;   // [deg] of the edge
    double length;  // [m]
    double shear;   // [-]
    double energy;  // [J]
};
std::span<const Measure<Break>> break_columns();

class Breaks {
public:
    Breaks(const Model& model, const State& start);

    /// A line of break_columns() for each interface that is broken now and was not before.
    std::vector<std::vector<double>> found(const State& now);

    Index n_tensile() const { return n_tensile_; }
    Index n_shear() const { return n_shear_; }

    template <class Archive>
    void serialize(Archive& archive) { archive(settled_, n_broken_, shear_, n_tensile_, n_shear_); }

private:
    /// Notes the point `k` of a split fan as broken; whether its interface is, with it.
    bool note(const State& now, const FanPoint& point);
    std::vector<double> line(double time, Index interface) const;

    const Model& model_;
    std::vector<std::uint8_t> settled_;   // per point, as in Model::fan_points: broken, or never had cohesion
    std::vector<std::uint8_t> n_broken_;  // per interface: its broken points
    std::vector<double> shear_;           // per interface: mean over its broken points, by area
    Index n_tensile_ = 0, n_shear_ = 0;
};

/// Whether a line of breaks.csv is of a shear break.
inline bool is_shear(double shear) { return shear > 0.5; }

}  // namespace knap
