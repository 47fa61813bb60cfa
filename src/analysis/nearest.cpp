#include "analysis/nearest.hpp"

#include "mesh/polygon.hpp"

#include <algorithm>
#include <tuple>

namespace knap {
namespace {

constexpr double equally_near = 0.05;  // [-] of an edge

enum Preference { free_from_start, on_support, between_parts, within };

Preference preference(const Model& model, const Interface& interface) {
    if (is_open_from_start(model, interface)) return free_from_start;
    if (interface.triangle[0] == rigid_support) return on_support;
    const std::vector<Index>& region = model.mesh.region;
    const bool joins_parts = interface.joint_law >= 0 || region[interface.triangle[0]] != region[interface.triangle[1]];
    return joins_parts ? between_parts : within;
}

}  // namespace

NearInterface nearest_interface(const Model& model, const Vec2& place) {
    const auto can_open = [&](const Interface& i) { return i.cracked || model.laws[i.law].breakable(); };
    const auto ends = [&](const Interface& i) {
        return std::pair(model.mesh.vertices[i.vertex[0]], model.mesh.vertices[i.vertex[1]]);
    };
    const auto distance = [&](const Interface& i) { return distance_to_segment(ends(i).first, ends(i).second, place); };
    double nearest = infinity;
    for (const Interface& i : model.interfaces)
        if (can_open(i)) nearest = std::min(nearest, distance(i));
    NearInterface found;
    std::tuple best{within, infinity};
    for (std::size_t k = 0; k < model.interfaces.size(); ++k) {
        const Interface& i = model.interfaces[k];
        if (!can_open(i) || distance(i) > nearest + equally_near * i.length) continue;
        const std::tuple rank{preference(model, i), (0.5 * (ends(i).first + ends(i).second) - place).norm()};
        if (found.interface < 0 || rank < best) best = rank, found = {static_cast<Index>(k), distance(i)};
    }
    return found;
}

std::string kind_of(const Model& model, const Interface& interface) {
    if (interface.triangle[0] == rigid_support) return "support";
    if (interface.cracked) return "pre-crack";
    if (interface.joint_law >= 0) return "joint";
    if (is_open_from_start(model, interface)) return "interface without cohesion";
    return preference(model, interface) == between_parts ? "boundary between materials" : "interface";
}

NearBoundary nearest_boundary(const Mesh& mesh, const Vec2& place) {
    NearBoundary nearest;
    for (const BoundaryEdge& edge : mesh.boundary_edges) {
        const Vec2 a = mesh.corner(edge.triangle, edge.side), along = mesh.side_vector(edge.triangle, edge.side);
        const Vec2 point = a + nearest_parameter(a, mesh.corner(edge.triangle, (edge.side + 1) % 3), place) * along;
        if (const double distance = (point - place).norm(); distance < nearest.distance)
            nearest = {point, distance, along.norm()};
    }
    return nearest;
}

}  // namespace knap
