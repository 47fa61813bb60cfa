#pragma once
// Mass that moves to the triangles that limit the explicit step from their neighbours (time.mass_scaling). The stable
// step of a free triangle grows like the square root of its mass, and slivers at joints hold so little that a hundred
// times of it would be lost in the body. Added mass would be inertia without weight, or change the weight: here
// what one material fills between cracks without a law keeps its mass, and its centre within a few triangles, so that
// weight, momentum and the fall of a body are what they are, and all schemes have the same masses. Joints are no
// borders, open ones neither: blocks that they part share their masses.
#include "model/model.hpp"

#include <optional>

namespace knap {

struct MassScaling {
    std::vector<double> factor;  // [-] per triangle, of its mass; empty: nothing moves
    double gain = 1;             // [-] of the stable step
    double moved = 0;            // [-] part of the mass of the body
};

/// The largest stable step for which at most the part `most` of the mass moves, if it is at least `least_gain` of the
/// smallest of `steps`, the stable steps without scaling. A triangle gives a quarter of its mass at most, and no more
/// than leaves it that step; what one needs comes from the nearest triangles that give, `reach` edges away at most,
/// without a crack of the start between them.
MassScaling scale_masses(const Mesh& mesh, const std::vector<Elastic>& materials, PlaneModel plane,
                         const std::vector<double>& steps, double most, double least_gain = 1.001);

/// What a model has of it.
struct MovedMass {
    double gain, moved;          // as in MassScaling
    Index n_heavier, n_lighter;  // triangles
    struct Place {
        Vec2 centroid;  // [m]
        double factor;  // [-] of its mass
    };
    std::vector<Place> heaviest;  // triangles, ten at most
};
std::optional<MovedMass> moved_mass(const Model& model);

/// [s] Of every free triangle, with the masses that it has.
std::vector<double> stable_steps(const Model& model);

}  // namespace knap
