#pragma once
// Some pieces of the body as a body of its own, with numbers of its own: a step of it costs what it has, whatever the
// rest has. Of first order, without supports, prescribed motions, heat, fluids and excavations.
#include "model/state.hpp"

#include <span>

namespace knap {

struct PartOfBody {
    Model model;
    std::vector<Index> triangles;         // of the whole, ascending, per triangle of the part
    std::vector<Index> triangle_of_part;  // per triangle of the whole, or -1
    std::vector<Index> interfaces;        // of the whole, per interface of the part

    Index in_whole(Index corner) const { return 3 * triangles[corner / 3] + corner % 3; }
    Index in_part(Index corner) const {  // or -1
        const Index t = triangle_of_part[corner / 3];
        return t < 0 ? -1 : 3 * t + corner % 3;
    }
};

/// A part of this model can be a body of its own.
bool may_be_parted(const Model& model);

/// `triangles`: of whole pieces, ascending. Edges that they had in common with others become edges of the boundary.
/// Order of triangles, vertices and interfaces stays.
PartOfBody part_of(const Model& model, std::span<const Index> triangles);

/// The motion, cohesion and contacts of the part; a state of rest of the leapfrog (last_step = 0).
State state_of_part(const Model& model, const State& state, const PartOfBody& part);

/// Places, velocities, cohesion and retirement of the part into a state of the whole; its contacts are left out.
void write_back(const PartOfBody& part, const State& of_part, const Model& model, State& state);

}  // namespace knap
