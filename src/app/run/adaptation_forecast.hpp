#pragma once
// What refinement during a run ([adapt]) will save, foreseen before the run.
#include "mesh/mesh.hpp"
#include "scenario/scenario.hpp"

#include <string>
#include <vector>

namespace knap {

/// The numbers of triangles to expect of [adapt]. Two parts ask for small triangles:
///
///     loads     a coarse elastic body under the loads of the scenario, with its initial cracks but without new ones,
///               shows where stresses exceed adapt.load of the strength until a crack would have crossed the body;
///               more than half of the body: all of it, as in the run
///     cracks    each initial crack, or else one, crosses the body along its longer side at half the Rayleigh speed,
///               from the time at which the tip of the coarse body reaches the toughness, and leaves a strip
///
/// `gain` is compared with that of runs in scenarios/BENCHMARKS.md.
struct AdaptationForecast {
    double crack = 0;                               // [m] advance of all cracks
    double mean = 0, at_end = 0;                    // triangles, over the steps of the run and at its end
    double uniform = 0;                             // triangles of a uniform mesh of adapt.size
    double by_loads = 0;                            // triangles that loads alone ask for at the end
    double gain() const { return uniform / mean; }  // [-] triangle-steps of the uniform mesh over those of the run
};
/// `mesh`: the one at the start.
AdaptationForecast forecast(const Scenario& scenario, const Mesh& mesh);

/// Replaces [adapt] by a uniform mesh of its size where the forecast on the coarse mesh finds no gain; the reason, or
/// nothing. A later end of the run finds no larger gain.
std::string replace_where_it_does_not_pay(Scenario& scenario, const Mesh& coarse);

/// [-] Triangles of a random mesh of mean edge length `size` [m] over an area [m2], measured.
double n_triangles_of(double area, double size);

/// A mesh that will have the sizes [m] given at its vertices.
struct FutureMesh {
    double area = 0, fine = 0;  // [m2] of all, and of what has the smallest size
    double n = 0;               // triangles

    /// So much is to be fine that all is refined at once.
    bool is_mostly_fine() const { return fine > 0.5 * area; }
};
FutureMesh future_mesh(const Mesh& mesh, const std::vector<double>& sizes, double smallest);

}  // namespace knap
