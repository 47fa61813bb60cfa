#pragma once
// Refines a mesh where triangles are larger than requested, between two steps of a run. Only triangles that may change
// are replaced; all others stay as they are. Old vertices stay, too, and random points are put between them, as in the
// first mesh:
//
//     patch       the triangles that may change and are too large: circumradius above 1.25 Poisson radii, or 1.1 at the
//                 smallest requested size, since no later patch makes them smaller
//     lines       edges on borders, between materials and on joints are divided on the straight line; edges to
//                 triangles that do not change stay whole
//     points      darts at random places of the old triangles, a Poisson radius from all vertices
//     Delaunay    circumcentres (Shewchuk 2002) of triangles that are still too large or too flat
//     relax       vertices within the patch, a few old ones among them, move where a triangle is too small for the step
//                 or too flat; what is then still not allowed stays as it was
//
// Source of the idea, insertion of points with a transfer of the fields to the new mesh: K. Park, G. Paulino, W. Celes,
// R. Espinha, Adaptive mesh refinement and coarsening for cohesive zone modeling of dynamic fracture, Int. J. Numer.
// Meth. Engng. 92 (2012).
#include "mesh/mesh.hpp"

#include <functional>
#include <optional>

namespace knap {

struct Refinement {
    std::span<const double> size;          // [m] per vertex: the requested mean edge length, linear between vertices
    std::span<const std::uint8_t> frozen;  // [0/1] per triangle: it must not change
    /// A new triangle is allowed: else its vertices are left out again. Without: all are.
    std::function<bool(const Mesh& mesh, Index triangle)> allowed;
    std::uint64_t seed = 1;
};

/// Where the values at a vertex come from: a vertex of the mesh before, or, where it is new or has moved, means over
/// the corners of a triangle of the mesh before.
struct VertexOrigin {
    Index vertex = -1;    // of the mesh before, or -1: a new one
    Index triangle = -1;  // of the mesh before, or -1: at the place of `vertex`
    std::array<double, 3> weight{};
};

struct RefinedMesh {
    Mesh mesh;
    std::vector<Index> triangle_before;  // per triangle: that of the mesh before, with the same corners; -1: a new one
    std::vector<VertexOrigin> origin;    // per vertex
};

/// Nothing where no triangle is too large or none can be refined. Bodies, or what else shares no edge, are refined each
/// by itself, so they may touch, and their triangles stay consecutive; of one piece, no two vertices are at one place.
/// The mesh has first order. The same bits for the same input.
std::optional<RefinedMesh> refined(const Mesh& mesh, const Refinement& requested);

/// The parts of `before` in a mesh to which it was refined.
std::vector<MeshPart> refined_parts(const Mesh& before, const Mesh& after);

/// [m] Radius of the circle through the corners of a triangle.
double circumradius(const Mesh& mesh, Index triangle);

}  // namespace knap
