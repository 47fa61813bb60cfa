#include "stepper/common/dashpots.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "model/selections.hpp"

#include <set>
#include <utility>

namespace knap {
namespace {

[[noreturn]] void refuse(const Mesh& mesh, const BoundaryEdge& edge, const char* cause) {
    throw UserError("contradiction", "boundary `" + mesh.boundary_names[edge.boundary] + "` absorbs waves, but " +
                                         cause + ", at " + place_text(mesh.corner(edge.triangle, edge.side)));
}

void add(const Model& model, const BoundaryEdge& edge, std::vector<Dashpot>& dashpots) {
    const Mesh& mesh = model.mesh;
    const Index first = mesh.corners_per_triangle() * edge.triangle, a = first + edge.side,
                b = first + (edge.side + 1) % 3;
    const auto is_led = [&](Index corner) {
        const PrescribedMotion* motion = model.motion_of(corner);
        return motion && motion->component[0] && motion->component[1];
    };
    if (is_led(a) && is_led(b)) refuse(mesh, edge, "a load prescribes its motion");
    const Elastic material = model.elastic(edge.triangle);
    const Vec2 along = mesh.side_vector(edge.triangle, edge.side);
    const Eigen::Matrix2d C = material.density * along.norm() * model.thickness *
                              material.wave_matrix(model.plane, -turned_left(along.normalized()));
    const double end = mesh.order == 1 ? 1. / 2 : 1. / 6;
    for (const Index corner : {a, b}) dashpots.push_back({model.fan_of_corner[corner], corner, end * C});
    const Index middle = first + 3 + edge.side;
    if (mesh.order == 2) dashpots.push_back({model.fan_of_corner[middle], middle, 4. / 6 * C});
}

}  // namespace

std::vector<Dashpot> dashpots_on(const Model& model, const std::vector<Selection>& boundaries) {
    std::vector<Dashpot> dashpots;
    const Mesh& mesh = model.mesh;
    std::set<std::size_t> edges;
    for (const Selection& selection : boundaries) {
        const std::vector<std::size_t> selected = selected_edges(mesh, selection);
        if (selected.empty())
            throw UserError("empty-selection", "an absorbing boundary, `" + selection.boundary +
                                                   (selection.box ? "` inside a box" : "`") +
                                                   ", selects nothing of the mesh");
        edges.insert(selected.begin(), selected.end());
    }
    if (edges.empty()) return dashpots;
    std::set<std::pair<Index, Index>> held;  // triangle and its vertex at the start of an edge on a support
    for (const Interface& interface : model.interfaces)
        if (interface.triangle[0] == rigid_support)
            for (const Index vertex : interface.vertex) held.emplace(interface.triangle[1], vertex);
    for (const std::size_t e : edges) {
        const BoundaryEdge& edge = mesh.boundary_edges[e];
        const auto& vertices = mesh.triangles[edge.triangle];
        if (held.contains({edge.triangle, vertices[edge.side]}) &&
            held.contains({edge.triangle, vertices[(edge.side + 1) % 3]}))
            refuse(mesh, edge, "a support holds it");
        add(model, edge, dashpots);
    }
    std::ranges::stable_sort(dashpots, {}, [](const Dashpot& d) { return std::pair(d.fan, d.corner); });
    std::size_t n = 0;  // a corner between two absorbing edges has both
    for (const Dashpot& dashpot : dashpots) {
        if (n > 0 && dashpots[n - 1].corner == dashpot.corner) dashpots[n - 1].C += dashpot.C;
        else dashpots[n++] = dashpot;
    }
    dashpots.resize(n, Dashpot{});
    return dashpots;
}

}  // namespace knap
