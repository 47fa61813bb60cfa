// Warnings about supports on their mesh.
#include "app/run/findings.hpp"

#include "base/formatted.hpp"
#include "model/selections.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double offset = 1e-3;  // [-] of the edge: where the other side of a face is looked for

bool in_triangle(const Mesh& mesh, Index t, const Vec2& x) {
    for (Index k = 0; k < 3; ++k)
        if (cross(mesh.side_vector(t, k), x - mesh.corner(t, k)) <= 0) return false;
    return true;
}

}  // namespace

/// A support without the name of a side takes all faces of its bodies, also those on which they touch each other.
std::vector<Diagnostic> findings_of_supports(const ReadResult& read, const Model& model) {
    const Mesh& mesh = model.mesh;
    std::vector<Diagnostic> found;
    for (std::size_t i = 0; i < read.scenario.supports.size() && mesh.parts.size() > 1; ++i) {
        const std::vector<std::size_t> edges = selected_edges(mesh, read.scenario.supports[i].on);
        const auto beyond = [&](std::size_t e) -> Vec2 {
            const auto& [triangle, side, boundary] = mesh.boundary_edges[e];
            const Vec2 along = mesh.side_vector(triangle, side);
            return mesh.corner(triangle, side) + 0.5 * along - offset * turned_left(along);
        };
        const auto touches = [&](std::size_t e) {
            const Vec2 x = beyond(e);
            return std::ranges::any_of(mesh.boundary_edges,
                                       [&](const BoundaryEdge& other) { return in_triangle(mesh, other.triangle, x); });
        };
        const auto n = std::ranges::count_if(edges, touches);
        if (n == 0) continue;
        const Vec2 x = beyond(*std::ranges::find_if(edges, touches));
        const std::string path = item("support", i) + ".on";
        found.push_back(read.at(path, {.severity = Diagnostic::Severity::warning,
                                       .code = "support-between",
                                       .message = formatted("`%s` takes %td faces on which bodies touch each other, as "
                                                            "at %s: the support is rigid and fixed there",
                                                            path.c_str(), n, place_text(x).c_str()),
                                       .note = "one side of the body or group, as { body = \"NAME\", boundary = "
                                               "\"bottom\" }, or a box"}));
    }
    return found;
}

}  // namespace knap
