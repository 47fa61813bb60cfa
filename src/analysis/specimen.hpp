#pragma once
// A body as the specimen of a rock test: stress from the force of its driver, strains from gauges.
//
//     test          stress                       axial strain           positive in
//     compression   P/(width t)                  gauge                  compression
//     tension       P/(width t)                  gauge                  tension
//     brazilian     2 P/(pi D t), D = height     gauge                  compression (stress: tension in the centre)
//     bending       3 P span/(2 height^2 t)      6 height d/span^2      travel d towards the body
//
// P: force of the driver along the axis; t: thickness of the body. A gauge measures the change of the distance of two
// places along its axis over that distance: boundaries (mean along them), points, or the driver (its travel over height
// or width). A line has means over all steps since the last line, since the force of a single step oscillates with the
// mesh; force and strains then belong to the same time. The strength and the other numbers of the summary are those of
// a curve of its own, of means over `window`, so that they do not depend on the lines that are written.
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "base/every.hpp"
#include "output/history_csv.hpp"

namespace knap {

struct GaugeEnd {
    enum class Kind { boundary, place, load, obstacle };
    Kind kind = Kind::boundary;
    std::string boundary;    // name of a boundary
    Vec2 at = Vec2::Zero();  // [m] a place
    Index number = 0;        // of a load or an obstacle
};
using GaugeEnds = std::array<GaugeEnd, 2>;

struct SpecimenOptions {
    enum class Test { compression, tension, brazilian, bending };
    Test test = Test::compression;
    int axis = 1;                      // 0: x, 1: y
    GaugeEnd driver;                   // a load or an obstacle, whose reaction is the force
    double height = 0, width = 0;      // [m] of the specimen along the axis and across it; 0: those of the body
    double span = 0;                   // [m] of a beam
    std::optional<GaugeEnds> axial;    // none: the travel of the driver
    std::optional<GaugeEnds> lateral;  // none: no lateral strain
    std::array<double, 2> modulus_between{0.4, 0.6};  // parts of the peak
    double window = 0;                                // [s] of the means of the curve
};

/// [Pa] The stress at which interfaces of one law in all directions break in this test: sigma_c, under (uniaxial)
/// compression Coulomb's law with the cohesion (gamma + mu) sigma_c, gamma sigma_c of the norm. NaN in bending, where
/// the size decides.
double strength_by_law(SpecimenOptions::Test test, const CohesiveLaw& law);

/// The distance of two places. An end at a driver moves with it.
class Gauge {
public:
    Gauge() = default;
    Gauge(const Model& model, const Reactions& reactions, const GaugeEnds& ends, int axis, double size);

    /// Positive when the places have moved apart.
    double strain(const State& state, const std::vector<Reaction>& reactions) const;

private:
    struct End {
        CornerMean mean;
        std::size_t driver = 0;  // into Reactions::at, if the mean is empty
    };
    std::array<End, 2> ends_;  // the lower one first
    int axis_ = 0;
    double length_ = 1;  // [m]
};

/// One line of stress_strain.csv: stress [Pa] and strains, and numbers of breaks so far.
struct SpecimenMoment {
    double time = 0;  // [s]
    double stress = 0, axial = 0, lateral = 0;
    Index n_tensile = 0, n_shear = 0;

    void serialize(auto& archive) { archive(time, stress, axial, lateral); }
};
/// All columns, and those of one specimen: lateral and volumetric strain need a lateral gauge.
std::span<const Measure<SpecimenMoment>> stress_strain_columns();
std::vector<Measure<SpecimenMoment>> stress_strain_columns(const SpecimenOptions& options);

class Specimen {
public:
    /// Throws UserError for a driver without prescribed motion, or a gauge without length.
    Specimen(const Model& model, const Reactions& reactions, const SpecimenOptions& options);
    /// The model has changed: by a refined mesh, or an excavation.
    void renew(const Model& model);

    /// At the start of the run, then after every step.
    void begin(const State& start);
    void after_step(const State& now);

    /// Means since the last line; the values of the moment where no step was made since.
    std::vector<double> line(Index n_tensile, Index n_shear) { return lines_.end(columns_, last_, n_tensile, n_shear); }
    /// After a step, with the numbers of breaks so far: ends a window of the curve that is over.
    void end_window(const State& now, Index n_tensile, Index n_shear);
    /// Stress over strain until now, with the columns of a line.
    History curve(Index n_tensile, Index n_shear) const;

    void serialize(auto& archive) { archive(last_, lines_, windows_, window_ends_, curve_); }

private:
    /// Integrals over time.
    struct Mean {
        SpecimenMoment sum;
        double duration = 0;  // [s]

        /// The values of a line, of `last` where there was no step; the next one starts here.
        std::vector<double> end(std::span<const Measure<SpecimenMoment>> columns, const SpecimenMoment& last,
                                Index n_tensile, Index n_shear);
        void serialize(auto& archive) { archive(sum, duration); }
    };
    SpecimenMoment at(const State& state) const;

    const Reactions& reactions_;
    SpecimenOptions options_;
    Every window_ends_;  // of the curve
    std::vector<Measure<SpecimenMoment>> columns_;
    std::size_t driver_;  // into Reactions::at
    double outwards_;     // direction from the middle of the body to the driver, along the axis
    double stress_per_force_, strain_per_travel_, sign_;
    Vec2 size_;  // [m]
    Gauge axial_, lateral_;
    SpecimenMoment last_;                     // at the end of the last step
    Mean lines_, windows_;                    // since the last line and the last window
    std::vector<std::vector<double>> curve_;  // a line for each window
};

}  // namespace knap
