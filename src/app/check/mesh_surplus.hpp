#pragma once
// What the mesh adds to cracks that choose their paths along its edges, as the tables of the program have it.
#include "scenario/read_scenario.hpp"

#include <string>

namespace knap {

/// For each law within a material: what cracks cost over G_c, and slow structures bear over what they bear along a
/// given path, with either coupling; and which of them fits the run.
std::string mesh_surplus_text(const ReadResult& read);

}  // namespace knap
