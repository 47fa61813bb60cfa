#pragma once
// What lies nearest to a place: the interface that a probe watches, the point of the boundary where a place outside the
// body is measured.
#include "model/model.hpp"

#include <string>

namespace knap {

/// An interface near a place, by the distance of the place from the edge, not from its middle.
struct NearInterface {
    Index interface = -1;  // -1: no interface of the model can open
    double distance = 0;   // [m]
};

/// Nearest of all interfaces that can open: pre-cracks, supports, and edges whose law can break. Among those equally
/// near (within a twentieth of an edge, as round a vertex) a pre-crack or one without cohesion, else a support, else a
/// joint or a boundary between two materials, else the one whose middle is nearest.
NearInterface nearest_interface(const Model& model, const Vec2& place);

/// "pre-crack", "support", "joint", "boundary between materials", "interface without cohesion" or "interface".
std::string kind_of(const Model& model, const Interface& interface);

/// No cohesion from the start: its two sides move apart from each other.
inline bool is_open_from_start(const Model& model, const Interface& interface) {
    return interface.cracked || model.laws[interface.law].sigma_c <= 0;
}

/// The boundary of the body near a place.
struct NearBoundary {
    Vec2 point = Vec2::Zero();             // [m] on an edge of the boundary
    double distance = infinity, edge = 0;  // [m] from the place; length of that edge
};
NearBoundary nearest_boundary(const Mesh& mesh, const Vec2& place);

}  // namespace knap
