#pragma once
// From a scenario to a model, and what can be known of it before it runs.
#include "geometry/mesh_report.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"

namespace knap {

/// Throws ShapeError for a shape that cannot be meshed, UserError for selections that select nothing.
Model build_model(const Scenario& scenario);

/// Step [s] and number of steps that the scenario's [time] means for a model with this stable step.
struct StepPlan {
    double step;           // [s] h
    std::int64_t n_steps;
    double stable_step;    // [s] of the worst free triangle
};
/// Throws UserError when the scenario asks for a step beyond the stable one.
StepPlan plan_steps(const Scenario& scenario, double stable_step, double until);

/// How well a mesh resolves the fracture of one law in one material.
struct Resolution {
    std::string material, law;
    double cohesive_length;  // [m] E' G_c/sigma_c^2
    double process_zone;     // [m] 9 pi/32 of it: a crack at rest (J. R. Rice 1968); shrinks as the crack gets faster
    double n_edges;          // mean edges along it
};
/// `mean_edge` [m]: of the part of the mesh that matters (the smallest wanted size).
std::vector<Resolution> judge_resolution(const Scenario& scenario, double mean_edge);

/// Mean length [m] of the interior edges.
double mean_edge(const Mesh& mesh);

/// The smallest edge length [m] that is wanted anywhere: where cracks are to run.
double finest_edge(const Scenario& scenario, double mean_edge);

/// [m/s] of the domain's first material.
double rayleigh_speed(const Scenario& scenario);

}  // namespace knap
