#pragma once
// From a scenario to a model, and properties of both that are known before a run.
#include "app/setup/step_plan.hpp"
#include "mesh/mesh_report.hpp"
#include "model/make_model.hpp"
#include "record/recorder.hpp"
#include "record/run_record.hpp"
#include "scenario/scenario.hpp"

namespace knap {

/// All of it but the mesh.
ModelInput model_input(const Scenario& scenario);
/// Throws ShapeError for a shape that cannot be meshed, EmptySelection for selections that select nothing.
Model build_model(const Scenario& scenario);

/// strength_by_law of the specimen and the first law that acts within a material and may break.
LawStrength law_strength(const Scenario& scenario);

/// Options of the recorder of a run, with its works and those of the runs from which it starts.
RecorderOptions recorder_options(const Scenario& scenario, const Model& model, const RareWorks& works,
                                 const std::filesystem::path& directory, bool resumes, bool continues_other_run);

/// A record of all that is known before the first step but the command and its times.
RunRecord record_of(const Scenario& scenario, const Model& model, const StepPlan& plan);

/// How well a mesh resolves the fracture of one law in one material, between two, or on a glued support. A support
/// mirrors the body: it is one half of a body that would break with 2 G_c.
struct Resolution {
    std::string material, law;
    double cohesive_length;  // [m] E' G_c/sigma_c^2
    double process_zone;     // [m] 9 pi/32 of it: a crack at rest (J. R. Rice 1968); shorter for a faster crack
    double n_edges;          // edges along its steep part, where cracks are expected
    double wave_speed;       // [m/s] dilatational, of the faster material
    double steepness;        // [-] steepest slope of the softening over that of linear softening
    bool anywhere;           // within one material: cracks may run along all edges

    /// [m] The part in which the traction falls fastest; a mesh that does not resolve it breaks edge by edge.
    double steep_zone() const { return process_zone / steepness; }
};
/// Resolution of the pairs of materials with a common interface in the mesh; compared with Scenario::finest_edge().
std::vector<Resolution> judge_resolution(const Scenario& scenario, const Mesh& mesh);

/// [m] Of each crack inside a body, as drawn and after snap; of lines that lie on each other one counts.
struct CrackLengths {
    explicit CrackLengths(Shape shape);
    std::vector<double> drawn, after;
};

/// The sets of inclusions and joints, and what the snap of a body did, a line each: "  inclusions[0]  30 placed, 12.3 %
/// of the area".
std::string placed_sets_text(const Scenario& scenario, const Mesh& mesh);

/// [m/s] Of the domain's first material.
double rayleigh_speed(const Scenario& scenario);

}  // namespace knap
