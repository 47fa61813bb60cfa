#pragma once
// What the calibrations of toughness and strength share: a law of a scenario in a scenario of the program, as a sweep
// over seeds.
#include "app/commands.hpp"
#include "scenario/scenario.hpp"
#include "scenario/specimen_strength.hpp"

namespace knap {

/// A law in one material on the mesh of the scenario.
struct CalibratedLaw {
    const ReadResult& read;
    const NamedLaw& law;
    const NamedMaterial& material;
    LawWithin within;

    const Scenario& scenario() const { return read.scenario; }
    double plane_modulus() const { return material.elastic.plane_modulus(scenario().plane); }
    /// [m] Of a crack at rest.
    double process_zone() const { return law.law.process_zone(plane_modulus()); }
    /// [m] The finest edge that the scenario requests.
    double edge() const { return law.law.steep_zone(plane_modulus()) / within.meshed.edges; }
};

/// "[x, y]"
std::string pair_text(double x, double y);
/// "={ density = ..., E = ..., nu = ... }"
std::string matter_text(const CalibratedLaw& of);
/// "={ ... }": the law with this sigma_c and G_c, without random strength and what belongs to temperatures.
std::string law_text(const CalibratedLaw& of, double sigma_c, double G_c);
/// "plane strain"
std::string model_text(const Scenario& scenario);

/// The finished sweep of a scenario of the program; none if it was interrupted.
std::optional<Ensemble> calibration_sweep(const std::string& scenario, const std::vector<std::string>& set,
                                          const BatchOptions& batch, const std::string& name);

/// Rows of a table, in its text; empty if interrupted. `warning`: what the user should know about them.
struct Calibration {
    std::string table, warning;
};
Calibration calibrate_toughness(const std::vector<CalibratedLaw>& laws, const CalibrateOptions& options);
Calibration calibrate_strength(const std::vector<CalibratedLaw>& laws, const CalibrateOptions& options);

}  // namespace knap
