#pragma once
// What the mesh adds to cracks that choose their paths along its edges, as the tables of the program have it.
#include "app/setup/step_plan.hpp"
#include "scenario/read_scenario.hpp"

#include <string>

namespace knap {

/// For each law within a material: what cracks cost over G_c, and structures bear over what they bear along a given
/// path, with either coupling; that of the nearest row, and what it has in another way, where the tables have none for
/// the law; and which coupling fits the run.
std::string mesh_surplus_text(const ReadResult& read, const Mesh& mesh, const StepPlan& plan);

}  // namespace knap
