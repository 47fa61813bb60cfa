#include "analysis/specimen.hpp"

#include "base/error.hpp"

#include <array>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace knap {
namespace {

using Test = SpecimenOptions::Test;

bool drives(const GaugeEnd& end) { return end.kind == GaugeEnd::Kind::load || end.kind == GaugeEnd::Kind::obstacle; }

/// Place of a load or an obstacle in Reactions::at.
std::size_t driver_of(const Reactions& reactions, const GaugeEnd& end) {
    const std::vector<Index>& loads = reactions.loads();
    if (end.kind == GaugeEnd::Kind::obstacle) return loads.size() + end.number;
    const auto found = std::find(loads.begin(), loads.end(), end.number);
    if (found == loads.end()) throw UserError("specimen", "load" + std::to_string(end.number) + " prescribes no motion, or later loads replace it everywhere");
    return found - loads.begin();
}

/// The box round the body as it was.
Box extent(const Mesh& mesh) {
    Box box{mesh.vertices.front(), mesh.vertices.front()};
    for (const Vec2& x : mesh.vertices) box.low = box.low.cwiseMin(x), box.high = box.high.cwiseMax(x);
    return box;
}

}  // namespace

Gauge::Gauge(const Model& model, const Reactions& reactions, const GaugeEnds& ends, int axis, double size) : axis_(axis) {
    std::array<double, 2> at{};
    for (int i = 0; i < 2; ++i) {
        const GaugeEnd& end = ends[i];
        if (drives(end)) {
            ends_[i].driver = driver_of(reactions, end);
            at[i] = reactions.places()[ends_[i].driver][axis];
            continue;
        }
        ends_[i].weights = end.kind == GaugeEnd::Kind::boundary ? weights_along(model.mesh, end.boundary) : weights_at(model.mesh, end.at);
        if (ends_[i].weights.empty()) throw UserError("specimen", "the mesh has no boundary `" + end.boundary + "`");
        at[i] = mean_place(ends_[i].weights, model.mesh)[axis];
    }
    if (at[0] > at[1]) std::swap(at[0], at[1]), std::swap(ends_[0], ends_[1]);
    length_ = drives(ends[0]) || drives(ends[1]) ? size : at[1] - at[0];
    if (!(at[1] - at[0] > 1e-9 * size)) throw UserError("specimen", std::string("the ends of a gauge along ") + "xy"[axis] + " are at the same place along it");
}

double Gauge::End::travel(const State& state, const std::vector<Reaction>& reactions, int axis) const {
    return weights.empty() ? reactions[driver].displacement[axis] : mean_displacement(weights, state)[axis];
}

double Gauge::strain(const State& state, const std::vector<Reaction>& reactions) const {
    return (ends_[1].travel(state, reactions, axis_) - ends_[0].travel(state, reactions, axis_)) / length_;
}

Specimen::Specimen(const Model& model, const Reactions& reactions, const SpecimenOptions& options)
    : reactions_(reactions), options_(options), driver_(driver_of(reactions, options.driver)), sign_(options.test == Test::tension ? 1 : -1) {
    const Box box = extent(model.mesh);
    const int axis = options.axis, across = 1 - axis;
    const double height = options.height > 0 ? options.height : (box.high - box.low)[axis], width = options.width > 0 ? options.width : (box.high - box.low)[across];
    const double offset = reactions.places()[driver_][axis] - 0.5 * (box.low + box.high)[axis];
    if (std::abs(offset) <= 1e-9 * height) throw UserError("specimen", "what drives the specimen is in its middle, and so neither pulls nor pushes it as a whole");
    outwards_ = offset > 0 ? 1 : -1;
    strain_per_travel_ = 1 / height;
    stress_per_force_ = 1 / (width * model.thickness);
    if (options.test == Test::brazilian) stress_per_force_ = 2 / (std::numbers::pi * height * model.thickness);
    if (options.test == Test::bending) {
        stress_per_force_ = 3 * options.span / (2 * height * height * model.thickness);
        strain_per_travel_ = 6 * height / (options.span * options.span);
    }
    if (options.axial) axial_ = Gauge(model, reactions, *options.axial, axis, height);
    if (options.lateral) lateral_ = Gauge(model, reactions, *options.lateral, across, width);
}

std::span<const Output> stress_strain_columns() {
    static constexpr std::array columns{
        Output{"time", "s", "mean time of the steps since the line before, whose means stress and strains are"},
        Output{"stress", "Pa", "of the specimen, from the force of what drives it; positive as its test says"},
        Output{"axial_strain", "", "along the axis, positive as the stress"},
        Output{"lateral_strain", "", "across, same sign; with a lateral gauge"},
        Output{"volumetric_strain", "", "their sum, positive when the area shrinks; in compression"},
        Output{"tensile_breaks", "", "number of interfaces so far that broke more by opening than by sliding"},
        Output{"shear_breaks", "", "number of interfaces so far that broke more by sliding"},
    };
    return columns;
}

std::vector<std::string> Specimen::columns() const {
    std::vector<std::string> names{"time", "stress", "axial_strain"};
    if (options_.lateral) names.push_back("lateral_strain");
    if (options_.lateral && options_.test == Test::compression) names.push_back("volumetric_strain");
    return names;
}

StressStrain Specimen::at(const State& state) const {
    const std::vector<Reaction> reactions = reactions_.at(state);
    const Reaction& driver = reactions[driver_];
    const int axis = options_.axis;
    const double axial = options_.axial ? axial_.strain(state, reactions) : outwards_ * driver.displacement[axis] * strain_per_travel_;
    return {.stress = sign_ * outwards_ * driver.force[axis] * stress_per_force_,
            .axial = sign_ * axial,
            .lateral = options_.lateral ? sign_ * lateral_.strain(state, reactions) : 0};
}

void Specimen::begin(const State& start) {
    last_ = at(start);
    time_ = start.time;
}

void Specimen::after_step(const State& now) {
    // the force is the mean over the step already, strains are those of its ends
    const StressStrain end = at(now);
    const double h = now.time - time_;
    sum_.stress += h * end.stress;
    sum_.axial += h * 0.5 * (last_.axial + end.axial);
    sum_.lateral += h * 0.5 * (last_.lateral + end.lateral);
    time_sum_ += h * 0.5 * (time_ + now.time);
    duration_ += h;
    time_ = now.time;
    last_ = end;
}

std::vector<double> Specimen::line() {
    StressStrain mean = last_;
    double time = time_;
    if (duration_ > 0) {
        mean = {sum_.stress / duration_, sum_.axial / duration_, sum_.lateral / duration_};
        time = time_sum_ / duration_;
    }
    sum_ = {}, duration_ = time_sum_ = 0;
    std::vector<double> row{time, mean.stress + 0, mean.axial + 0};  // no minus zero
    if (options_.lateral) row.push_back(mean.lateral + 0);
    if (options_.lateral && options_.test == Test::compression) row.push_back(mean.axial + mean.lateral);
    return row;
}

}  // namespace knap
