#pragma once
// Quality of a mesh: counts, angles, lengths, and how straight a crack may run along its edges.
// Path ratio: J. J. Rimoli, J. J. Rojas, "Meshing strategies for the alleviation of mesh-induced effects in cohesive
// element models", Int. J. Fract. 193 (2015) 29.
#include "mesh/mesh.hpp"

#include <array>

namespace knap {

struct MeshReport {
    Index n_triangles = 0, n_vertices = 0;
    Index n_interior_edges = 0, n_boundary_edges = 0, n_cracked_edges = 0;

    double area = 0;                                            // [m2]
    double smallest_edge = 0, mean_edge = 0, largest_edge = 0;  // [m]
    double smallest_angle = 0, largest_angle = 0;               // [degree]
    double mean_smallest_angle = 0;                             // [degree] over the smallest of each triangle
    std::array<double, 3> smallest_angle_percentiles{};         // [degree] 1, 10 and 50 % of the triangles lie below
    double smallest_altitude = 0;                               // [m]

    /// Shortest path along edges / straight distance - 1, mean over random pairs of vertices about `path_reach` apart,
    /// per direction 0, 7.5, ... 172.5 degree. Both ends of a path cost something extra, so this falls a little with
    /// the reach.
    static constexpr int n_directions = 24;
    std::array<double, n_directions> path_excess{};  // [-]
    double mean_path_excess = 0;                     // [-] over all directions
    double path_excess_spread = 0;                   // [-] standard deviation over the directions
    double far_path_excess = 0;  // [-] mean growth of the path per distance - 1, from half to full reach
    double path_reach = 0;       // [m] mean over the pairs
    Index n_paths = 0;           // pairs; 0 when the mesh is too small for a path ratio
};

/// `mesh` needs its edges.
MeshReport judge(const Mesh& mesh);

}  // namespace knap
