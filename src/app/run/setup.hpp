#pragma once
// From a scenario to a model, and what can be known of it before it runs.
#include "mesh/mesh_report.hpp"
#include "model/model.hpp"
#include "scenario/scenario.hpp"

namespace knap {

/// Throws ShapeError for a shape that cannot be meshed, EmptySelection for selections that select nothing.
Model build_model(const Scenario& scenario);

/// How well a mesh resolves the fracture of one law in one material, between two, or on a glued support. A support is the mirror of the
/// body: half of a body that would break with twice G_c.
struct Resolution {
    std::string material, law;
    double cohesive_length;  // [m] E' G_c/sigma_c^2
    double process_zone;     // [m] 9 pi/32 of it: a crack at rest (J. R. Rice 1968); shrinks as the crack gets faster
    double n_edges;          // edges along it, of those where cracks are to run
    double wave_speed;       // [m/s] dilatational, of the faster material
};
/// `mean_edge` [m]: of the mesh; finest_edge() is what it is held against.
std::vector<Resolution> judge_resolution(const Scenario& scenario, double mean_edge);

/// Steps [s] of an implicit cohesion for which Assumption 1 surely holds on a mesh of edges `edge` [m] that can break everywhere
/// (formulation: step size): h <= (0.43/theta) sqrt(l_coh/l) l/c. Larger ones may do too.
double assumption_1_step(const Resolution& resolution, double edge, double theta);

/// Mean length [m] of the interior edges.
double mean_edge(const Mesh& mesh);

/// The smallest distance [m] of interface points that is wanted anywhere, where cracks are to run: an edge, of order 2 half of one.
double finest_edge(const Scenario& scenario, double mean_edge);

std::vector<std::string> material_names(const Scenario& scenario);

/// What sets of inclusions and joints became, a line each: "  inclusions[0]  30 placed, 12.3 % of the area".
std::string random_sets_text(const Scenario& scenario);

/// [m/s] of the domain's first material.
double rayleigh_speed(const Scenario& scenario);

}  // namespace knap
