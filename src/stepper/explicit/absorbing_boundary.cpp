#include "stepper/explicit/absorbing_boundary.hpp"

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "model/selections.hpp"

#include <Eigen/LU>

#include <set>
#include <utility>

namespace knap {
namespace {

[[noreturn]] void refuse(const Mesh& mesh, const BoundaryEdge& edge, const char* cause) {
    throw UserError("contradiction", "boundary `" + mesh.boundary_names[edge.boundary] + "` absorbs waves, but " +
                                         cause + ", at " + place_text(mesh.corner(edge.triangle, edge.side)));
}

}  // namespace

AbsorbingBoundary::AbsorbingBoundary(const Model& model, const std::vector<Selection>& on) : model_(model) {
    const Mesh& mesh = model.mesh;
    std::set<std::size_t> edges;
    for (const Selection& selection : on) {
        const std::vector<std::size_t> selected = selected_edges(mesh, selection);
        if (selected.empty())
            throw UserError("empty-selection", "an absorbing boundary, `" + selection.boundary +
                                                   (selection.box ? "` inside a box" : "`") +
                                                   ", selects nothing of the mesh");
        edges.insert(selected.begin(), selected.end());
    }
    if (edges.empty()) return;
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
        add(edge);
    }
    std::ranges::stable_sort(dashpots_, {}, [](const Dashpot& d) { return std::pair(d.fan, d.corner); });
    std::size_t n = 0;  // a corner between two absorbing edges has both
    for (const Dashpot& dashpot : dashpots_) {
        if (n > 0 && dashpots_[n - 1].corner == dashpot.corner) dashpots_[n - 1].C += dashpot.C;
        else dashpots_[n++] = dashpot;
    }
    dashpots_.resize(n, Dashpot{});
}

void AbsorbingBoundary::add(const BoundaryEdge& edge) {
    const Mesh& mesh = model_.mesh;
    const Index first = mesh.corners_per_triangle() * edge.triangle, a = first + edge.side,
                b = first + (edge.side + 1) % 3;
    const auto is_led = [&](Index corner) {
        const PrescribedMotion* motion = model_.motion_of(corner);
        return motion && motion->component[0] && motion->component[1];
    };
    if (is_led(a) && is_led(b)) refuse(mesh, edge, "a load prescribes its motion");
    const Elastic& material = model_.materials[mesh.region[edge.triangle]];
    const Vec2 along = mesh.side_vector(edge.triangle, edge.side), t = along.normalized(), n = -turned_left(t);
    const Eigen::Matrix2d C =
        material.density * along.norm() * model_.thickness *
        (material.dilatational_speed(model_.plane) * n * n.transpose() + material.shear_speed() * t * t.transpose());
    const double end = mesh.order == 1 ? 1. / 2 : 1. / 6;
    for (const Index corner : {a, b}) dashpots_.push_back({model_.fan_of_corner[corner], corner, end * C});
    const Index middle = first + 3 + edge.side;
    if (mesh.order == 2) dashpots_.push_back({model_.fan_of_corner[middle], middle, 4. / 6 * C});
}

Vec2 AbsorbingBoundary::end_velocity(Index f, const ExplicitStep& step, const Vec2& impulse,
                                     const Vec2& velocity) const {
    // (M + k/2 C) v+ = (M - k/2 C) v + k F; the damping belongs to both M
    const Fan& fan = model_.fans[f];
    const PrescribedMotion* motion = model_.motion_of(model_.corners(fan)[0]);
    Eigen::Matrix2d half = Eigen::Matrix2d::Zero();
    for (const Dashpot& dashpot : of_fan(f)) half += 0.5 * step.kick_time * dashpot.C;
    const Vec2 before = step.begin.velocity[f];
    Eigen::Matrix2d left = (1 + step.damping) * fan.mass * Eigen::Matrix2d::Identity() + half;
    Vec2 right = (1 - step.damping) * fan.mass * before - half * before + impulse;
    for (int k = 0; k < 2 && motion; ++k)
        if (motion->component[k]) left.row(k) = Vec2::Unit(k).transpose(), right[k] = velocity[k];
    return left.inverse() * right;
}

Vec2 AbsorbingBoundary::force_on_fan(Index fan, const Vec2& velocity) const {
    Vec2 force = Vec2::Zero();
    for (const Dashpot& dashpot : of_fan(fan)) force -= dashpot.C * velocity;
    return force;
}

void AbsorbingBoundary::account(const ExplicitStep& step, StepReport& report) const {
    for (const Dashpot& dashpot : dashpots_) {
        const Vec2 before = step.begin.velocity[step.begin.node_of_corner[dashpot.corner]],
                   after = step.end.velocity[step.end.node_of_corner[dashpot.corner]], mean = 0.5 * (before + after);
        report.radiated_work -= step.kick_time * mean.dot(dashpot.C * mean);
    }
}

Vec2 dashpot_force(Index corner, std::span<const Dashpot> dashpots, const Vec2& velocity) {
    const auto found = std::ranges::find(dashpots, corner, &Dashpot::corner);
    return found == dashpots.end() ? Vec2(Vec2::Zero()) : Vec2(-(found->C * velocity));
}

}  // namespace knap
