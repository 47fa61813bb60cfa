#pragma once
// Mass that moves to the triangles that limit the explicit step from their neighbours (time.mass_scaling). The stable
// step of a free triangle grows like the square root of its mass, and slivers at joints hold so little that a hundred
// times of it would be lost in the body. Added mass would be inertia without weight, or change the weight: here
// what one material fills between borders keeps its mass, and its centre within a few triangles, so that weight,
// momentum and the fall of a body are what they are, and all schemes have the same masses. Borders are what bears no
// tension from the start (cracks, laws with sigma_c = 0) and outlines of later excavations. A block that breaks out
// along edges which still bear keeps what moved over them.
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
/// without a border between them. `cuts`: polygons which will be excavated. The model needs no fans yet.
MassScaling scale_masses(const Model& model, const std::vector<double>& steps,
                         const std::vector<std::vector<Vec2>>& cuts, double most, double least_gain = 1.001);

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
