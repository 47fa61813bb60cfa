#pragma once
// The only file that includes CGAL, whose Mesh_2 package is GPL: its constrained Delaunay triangulation and mesher, for
// the files of this folder that make meshes.
#include "mesh/mesh.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace knap::delaunay {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct Number {
    Index value = -1;  // also of the infinite vertex
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using FaceBase = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::Exact_predicates_tag>;
using Point = Kernel::Point_2;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

inline Point point(const Vec2& p) { return {p.x(), p.y()}; }
inline Vec2 position(const Vertex& v) { return {v->point().x(), v->point().y()}; }

}  // namespace knap::delaunay
