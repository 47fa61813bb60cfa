#include "analysis/specimen.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace knap {
namespace {

using Test = SpecimenOptions::Test;

bool drives(const GaugeEnd& end) { return end.kind == GaugeEnd::Kind::load || end.kind == GaugeEnd::Kind::obstacle; }

/// Place of a load or an obstacle in Reactions::at.
std::size_t driver_of(const Reactions& reactions, const GaugeEnd& end) {
    const std::vector<Index>& loads = reactions.loads();
    if (end.kind == GaugeEnd::Kind::obstacle) return loads.size() + end.number;
    const auto found = std::ranges::find(loads, end.number);
    if (found == loads.end())
        throw UserError("specimen", "load" + std::to_string(end.number) +
                                        " prescribes no motion, or later loads replace it everywhere");
    return found - loads.begin();
}

}  // namespace

double strength_by_law(SpecimenOptions::Test test, const CohesiveLaw& law) {
    if (test == SpecimenOptions::Test::bending) return std::numeric_limits<double>::quiet_NaN();
    if (test != SpecimenOptions::Test::compression) return law.sigma_c;
    return law.compressive_strength().stress;
}

Gauge::Gauge(const Model& model, const Reactions& reactions, const GaugeEnds& ends, int axis, double size)
    : axis_(axis) {
    std::array<double, 2> at{};
    for (int i = 0; i < 2; ++i) {
        const GaugeEnd& end = ends[i];
        if (drives(end)) {
            ends_[i].driver = driver_of(reactions, end);
            at[i] = reactions.places()[ends_[i].driver][axis];
            continue;
        }
        ends_[i].mean = end.kind == GaugeEnd::Kind::boundary ? CornerMean(model.mesh, end.boundary)
                                                             : CornerMean(model.mesh, end.at);
        if (ends_[i].mean.empty()) throw UserError("specimen", "the mesh has no boundary `" + end.boundary + "`");
        at[i] = ends_[i].mean.place(model.mesh)[axis];
    }
    if (at[0] > at[1]) std::swap(at[0], at[1]), std::swap(ends_[0], ends_[1]);
    length_ = drives(ends[0]) || drives(ends[1]) ? size : at[1] - at[0];
    if (!(at[1] - at[0] > 1e-9 * size))
        throw UserError("specimen", std::string("the two ends of the gauge along ") + "xy"[axis] +
                                        " have the same coordinate along it; they must be apart");
}

double Gauge::strain(const State& state, const std::vector<Reaction>& reactions) const {
    const auto travel = [&](const End& end) {
        return end.mean.empty() ? reactions[end.driver].displacement[axis_] : end.mean.displacement(state)[axis_];
    };
    return (travel(ends_[1]) - travel(ends_[0])) / length_;
}

Specimen::Specimen(const Model& model, const Reactions& reactions, const SpecimenOptions& options)
    : reactions_(reactions),
      options_(options),
      window_ends_(options.window),
      columns_(stress_strain_columns(options)),
      driver_(driver_of(reactions, options.driver)),
      sign_(options.test == Test::tension ? 1 : -1) {
    const Box box = bounding_box(model.mesh.vertices);
    const int axis = options.axis, across = 1 - axis;
    const double height = options.height > 0 ? options.height : box.extent()[axis],
                 width = options.width > 0 ? options.width : box.extent()[across];
    const double offset = reactions.places()[driver_][axis] - 0.5 * (box.low + box.high)[axis];
    if (std::abs(offset) <= 1e-9 * height)
        throw UserError("specimen",
                        "the driver is in the middle of the specimen, so it neither pulls nor pushes it as a whole");
    outwards_ = offset > 0 ? 1 : -1;
    strain_per_travel_ = 1 / height;
    stress_per_force_ = 1 / (width * model.thickness);
    if (options.test == Test::brazilian) stress_per_force_ = 2 / (std::numbers::pi * height * model.thickness);
    if (options.test == Test::bending) {
        stress_per_force_ = 3 * options.span / (2 * height * height * model.thickness);
        strain_per_travel_ = 6 * height / (options.span * options.span);
    }
    size_[axis] = height, size_[across] = width;
    renew(model);
}

void Specimen::renew(const Model& model) {
    const int axis = options_.axis;
    if (options_.axial) axial_ = Gauge(model, reactions_, *options_.axial, axis, size_[axis]);
    if (options_.lateral) lateral_ = Gauge(model, reactions_, *options_.lateral, 1 - axis, size_[1 - axis]);
}

std::span<const Measure<SpecimenMoment>> stress_strain_columns() {
    using M = SpecimenMoment;
    static constexpr Measure<M> columns[] = {
        {"time", "s", "mean time of the steps since the last line; stress and strains are means over these steps",
         [](const M& m) { return m.time; }},
        {"stress", "Pa", "stress of the specimen from the force of its driver; the test defines its sign",
         [](const M& m) { return m.stress; }},
        {"axial_strain", "", "strain along the axis, with the sign of the stress", [](const M& m) { return m.axial; }},
        {"lateral_strain", "", "strain across the axis, with the same sign; only with a lateral gauge",
         [](const M& m) { return m.lateral; }},
        {"volumetric_strain", "",
         "axial + lateral strain, positive when the area shrinks; only in compression with a lateral gauge",
         [](const M& m) { return m.axial + m.lateral; }},
        {"tensile_breaks", "", "number of interfaces that broke more by opening than by sliding, so far",
         [](const M& m) { return double(m.n_tensile); }},
        {"shear_breaks", "", "number of interfaces that broke more by sliding than by opening, so far",
         [](const M& m) { return double(m.n_shear); }}};
    return columns;
}

std::vector<Measure<SpecimenMoment>> stress_strain_columns(const SpecimenOptions& options) {
    const auto all = stress_strain_columns();
    std::vector<Measure<SpecimenMoment>> columns(all.begin(), all.end());
    std::erase_if(columns, [&](const Output& column) {
        const bool volumetric = column.name == "volumetric_strain";
        if (!volumetric && column.name != "lateral_strain") return false;
        return !options.lateral || (volumetric && options.test != Test::compression);
    });
    return columns;
}

SpecimenMoment Specimen::at(const State& state) const {
    const std::vector<Reaction> reactions = reactions_.at(state);
    const Reaction& driver = reactions[driver_];
    const int axis = options_.axis;
    const double axial =
        options_.axial ? axial_.strain(state, reactions) : outwards_ * driver.displacement[axis] * strain_per_travel_;
    return {.time = state.time,
            .stress = sign_ * outwards_ * driver.force[axis] * stress_per_force_,
            .axial = sign_ * axial,
            .lateral = options_.lateral ? sign_ * lateral_.strain(state, reactions) : 0};
}

void Specimen::begin(const State& start) {
    last_ = at(start);
    curve_ = {windows_.end(columns_, last_, 0, 0)};
    window_ends_.start(start.time);
}

void Specimen::after_step(const State& now) {
    const SpecimenMoment end = at(now);
    const double h = end.time - last_.time;
    for (Mean* mean : {&lines_, &windows_}) {
        SpecimenMoment& sum = mean->sum;
        sum.time += h * 0.5 * (last_.time + end.time);
        sum.stress += h * end.stress;  // forces are means over the step already
        sum.axial += h * 0.5 * (last_.axial + end.axial);
        sum.lateral += h * 0.5 * (last_.lateral + end.lateral);
        mean->duration += h;
    }
    last_ = end;
}

std::vector<double> Specimen::Mean::end(std::span<const Measure<SpecimenMoment>> columns, const SpecimenMoment& last,
                                        Index n_tensile, Index n_shear) {
    SpecimenMoment mean = last;
    if (const double d = duration; d > 0) mean = {sum.time / d, sum.stress / d, sum.axial / d, sum.lateral / d};
    mean.n_tensile = n_tensile, mean.n_shear = n_shear;
    sum = {}, duration = 0;
    return values_of<SpecimenMoment>(columns, mean);
}

void Specimen::end_window(const State& now, Index n_tensile, Index n_shear) {
    if (window_ends_.advance_if_due(now.time)) curve_.push_back(windows_.end(columns_, last_, n_tensile, n_shear));
}

History Specimen::curve(Index n_tensile, Index n_shear) const {
    History curve{.columns = names_of<SpecimenMoment>(columns_), .rows = curve_};
    if (Mean rest = windows_; rest.duration > 0) curve.rows.push_back(rest.end(columns_, last_, n_tensile, n_shear));
    return curve;
}

}  // namespace knap
