#pragma once
// A body as the specimen of a rock test: stress from the reaction of what drives it, strains from gauges.
//
//     test          stress                            axial strain            positive in
//     compression   P/(width t)                       gauge                   compression
//     tension       P/(width t)                       gauge                   tension
//     brazilian     2 P/(pi D t), D = height          gauge                   compression of the disc (the stress is the tension in its middle)
//     bending       3 P span/(2 height^2 t)           6 height d/span^2       travel d towards the body
//
// P: force of the driver along the axis; t: thickness of the body. A gauge is the change of the distance of two places along its axis over that
// distance: boundaries (the mean along them), probes, or what drives (its travel, over height or width). Stress and strains of a line are means over the
// time since the line before, of all steps: forces of single steps ring, and both means belong to the same time.
#include "analysis/corner_weights.hpp"
#include "analysis/reactions.hpp"
#include "output/outputs.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace knap {

struct GaugeEnd {
    enum class Kind { boundary, place, load, obstacle };
    Kind kind = Kind::boundary;
    std::string boundary;   // name of a boundary
    Vec2 at = Vec2::Zero(); // [m] a place
    Index number = 0;       // of a load or an obstacle
};
using GaugeEnds = std::array<GaugeEnd, 2>;

struct SpecimenOptions {
    enum class Test { compression, tension, brazilian, bending };
    Test test = Test::compression;
    int axis = 1;                      // 0: x, 1: y
    GaugeEnd driver;                   // a load or an obstacle: whose reaction is the force
    double height = 0, width = 0;      // [m] of the specimen along the axis and across; 0: those of the body
    double span = 0;                   // [m] of a beam
    std::optional<GaugeEnds> axial;    // none: the travel of the driver
    std::optional<GaugeEnds> lateral;  // none: no lateral strain
    std::array<double, 2> modulus_between{0.4, 0.6};  // parts of the peak
};

/// Two places and what their distance was. An end that drives is followed by its travel.
class Gauge {
public:
    Gauge() = default;
    Gauge(const Model& model, const Reactions& reactions, const GaugeEnds& ends, int axis, double size);

    /// Positive when they have moved apart.
    double strain(const State& state, const std::vector<Reaction>& reactions) const;

private:
    struct End {
        std::vector<CornerWeight> weights;
        std::size_t driver = 0;  // into Reactions::at, without weights
        double travel(const State& state, const std::vector<Reaction>& reactions, int axis) const;
    };
    std::array<End, 2> ends_;  // the lower one first
    int axis_ = 0;
    double length_ = 1;  // [m]
};

/// Stress [Pa] and strains [-] at a moment, or means of them.
struct StressStrain {
    double stress = 0, axial = 0, lateral = 0;
};

/// All columns that stress_strain.csv may have; of lateral gauges, compression and breaks only where there are such.
std::span<const Output> stress_strain_columns();

class Specimen {
public:
    /// Throws UserError for a driver that drives nothing, or a gauge without length.
    Specimen(const Model& model, const Reactions& reactions, const SpecimenOptions& options);

    /// time, stress, axial_strain; with a lateral gauge lateral_strain and in compression volumetric_strain, their sum (the change of area, positive when it
    /// shrinks).
    std::vector<std::string> columns() const;

    /// At the start of the run, then after every step.
    void begin(const State& start);
    void after_step(const State& now);

    /// The means since the line before; of the moment where no step was made since.
    std::vector<double> line();

    template <class Archive>
    void serialize(Archive& archive) {
        archive(time_, duration_, time_sum_);
        for (StressStrain* of : {&last_, &sum_}) archive(of->stress, of->axial, of->lateral);
    }

private:
    StressStrain at(const State& state) const;

    const Reactions& reactions_;
    SpecimenOptions options_;
    std::size_t driver_ = 0;  // into Reactions::at
    double outwards_ = 1;     // direction from the middle of the body to the driver, along the axis
    double stress_per_force_ = 1, strain_per_travel_ = 1, sign_ = 1;
    Gauge axial_, lateral_;
    StressStrain last_;       // at the end of the last step
    StressStrain sum_;        // over time since the last line
    double time_ = 0, duration_ = 0, time_sum_ = 0;
};

}  // namespace knap
