#pragma once
// Adaptive refinement of the explicit bulk: between two steps, triangles become small where interfaces may break soon.
//
//     trigger     U = max over directions of t_N/sigma_c and (|t_T| + mu t_N)/((gamma + mu) sigma_c), of the mean
//                 stress of a triangle and the laws of its interfaces; in the one direction of an edge of a joint or
//                 between two materials, which keeps it; marked above `load`
//     requested      `size` within `margin` edges of everything marked, growing from there by `grading` per distance
//     may change  triangles whose vertices are all bonded; cracks keep their interfaces
//     transfer    old vertices keep u and v, new ones take them linearly from the old triangles; then each patch gets
//                 back momentum and energy that this cost it (refined_patches)
//     energy      what the patches could not take of the change of the leapfrog energy 1/2 v' M v + 1/2 u_n-1' K u_n is
//                 the work `adaptation`. Angular momentum is not kept: a correction would spin the patch.
//
// The step stays: no new triangle has a stable step below `smallest_step`.
//
// Sources: K. Park, G. Paulino, W. Celes, R. Espinha, Int. J. Numer. Meth. Engng. 92 (2012); D. Lahiri, J. Bonet,
// J. Peraire, A variationally consistent mesh adaptation method for explicit Lagrangian dynamics, Int. J. Numer. Meth.
// Engng. 72 (2007).
#include "mesh/refine.hpp"
#include "stepper/common/elastic_energy.hpp"

#include <optional>

namespace knap {

struct AdaptOptions {
    double size = 0;           // [m] mean edge length where interfaces may break; 0: the mesh does not change
    double load = 0.3;         // [-] U from which a triangle is marked
    double margin = 10;        // [edges of `size`] around what is marked
    double every = 150;        // steps between two looks
    double limit = 5e6;        // triangles; beyond it the mesh stays
    double coarse = 0;         // [m] largest edge length: mesh.size
    double grading = 0.3;      // [-] growth of the edge length per distance: mesh.grading
    double smallest_step = 0;  // [s] stable step of new triangles
    bool active() const { return size > 0; }
};

/// [-] U of a stress (xx, yy, xy) [Pa], over all directions or of edges across `normal`; 0 for a law that does not
/// break.
double load_factor(const Eigen::Vector3d& stress, const CohesiveLaw& law);
double load_factor(const Eigen::Vector3d& stress, const Vec2& normal, const CohesiveLaw& law);

/// [m] Stable step of the smallest triangle that a mesh of edge length `size` should have, of the fastest material.
double guaranteed_step(double size, const std::vector<Elastic>& materials, PlaneModel plane);

/// [m] Requested mean edge lengths per vertex. `also` [m]: a vertex that is marked, too.
std::vector<double> requested_sizes(const Model& model, const State& state, const AdaptOptions& options,
                                    const std::optional<Vec2>& also = {});

/// [0/1] Per fan: its edges are longer than 3/2 of `size` on average (Model::too_coarse: it may not split).
std::vector<std::uint8_t> coarse_fans(const Model& model, double size);

/// The numbers of a refined mesh for those of the mesh before.
struct Renumbering {
    std::vector<Index> vertex;           // of the new mesh, per vertex before
    std::vector<Index> interface;        // of the new model, per interface before; -1: divided or flipped
    std::vector<Index> triangle_before;  // per triangle of the new mesh, -1: new
};

struct AdaptedModel {
    Model model;
    State state;
    Renumbering numbers;
    LeapfrogEnergies energies;       // after it
    double angular_momentum_change;  // [kg m2/s] about the origin
};

/// Refinements of a run.
struct AdaptationCounts {
    std::int64_t batches = 0, largest_batch = 0;  // refinements, and most new triangles of one
    std::int64_t coarse_breaks = 0;               // at the end: vertices that came apart although they are coarse
    double angular_momentum = 0;                  // [kg m2/s] sum of its changes
    double cpu = 0;                               // [s]

    void serialize(auto& archive) { archive(batches, largest_batch, angular_momentum, cpu); }
};

/// Nothing where no triangle is too large. `seed`: of this batch.
std::optional<RefinedMesh> refined_mesh(const Model& model, const State& state, const AdaptOptions& options,
                                        const std::vector<double>& requested, std::uint64_t seed);

/// Model and state on that mesh. `input`: of the model, without its mesh.
AdaptedModel adapt(const Model& model, const State& state, const AdaptOptions& options, RefinedMesh refined,
                   ModelInput input);

}  // namespace knap
