// Errors and warnings about supports, rigid obstacles and fluids on their mesh.
#include "app/check/findings.hpp"

#include "app/setup/setup.hpp"
#include "base/display_unit.hpp"
#include "base/formatted.hpp"
#include "model/body_in_obstacles.hpp"
#include "model/make_ground.hpp"
#include "model/obstacle_gap.hpp"
#include "model/selections.hpp"
#include "stepper/common/crack_forces.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>

namespace knap {
namespace {

constexpr double offset = 1e-3;  // [-] of the edge: where the other side of a face is looked for

constexpr double negligible = 1e-9;  // [-] of the size: obstacles that start in contact

std::string named(const Obstacle& obstacle, Index number) {
    return "`" + item("obstacle", number) + "` (" + obstacle.name + ")";
}

/// [m/s] At most that at which bodies and obstacles meet first: from their velocities at the start, and a fall through
/// the smallest gap to an obstacle. 0: nothing meets.
double speed_of_impact(const Scenario& scenario, const Model& model) {
    if (model.obstacles.empty() && !model.faces_meet()) return 0;
    std::vector<Vec2> others;  // velocities of obstacles and bodies
    for (const Obstacle& obstacle : model.obstacles) {
        Vec2 v = Vec2::Zero();
        for (int k = 0; k < 2; ++k)
            if (const Drive& drive = obstacle.drive[k]; obstacle.is_free(k)) v[k] = obstacle.initial_velocity[k];
            else if (drive.kind == Drive::Kind::velocity)
                for (const double factor : drive.history.value)
                    if (std::abs(drive.value * factor) > std::abs(v[k])) v[k] = drive.value * factor;
        others.push_back(v);
    }
    if (model.faces_meet())
        for (const MeshPart& part : model.mesh.parts)
            others.push_back(model.initial_velocity_of(model.mesh.corners_per_triangle() * part.first_triangle));
    double speed = 0, gap = infinity, pull = 0;  // [m/s], [m], [m/s2]
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        for (const Vec2& other : others) speed = std::max(speed, (model.initial_velocity_of(c) - other).norm());
    for (const Load& load : scenario.loads)
        if (load.kind == Load::Kind::acceleration) pull += load.vector().norm();
    for (const Obstacle& obstacle : model.obstacles) {
        const ObstacleSurface surface(obstacle.outline, obstacle.start);
        for (const BoundaryEdge& edge : model.mesh.boundary_edges)
            gap = std::min(gap, surface.distance_to(model.mesh.corner(edge.triangle, edge.side)).gap);
    }
    return std::hypot(speed, std::isfinite(gap) ? std::sqrt(2 * pull * std::max(gap, 0.0)) : 0);
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

std::vector<Diagnostic> findings_of_obstacles(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    const std::vector<Obstacle> supports = obstacles_of_ground(model);
    const auto n = static_cast<Index>(model.obstacles.size());
    for (const auto& [i, j] : obstacles_that_may_meet(model.obstacles, supports)) {
        const bool on_support = j >= n;
        const Obstacle &a = model.obstacles[i], &b = on_support ? supports[j - n] : model.obstacles[j];
        const auto [gap, place] = gap_between({a.outline, a.start}, {b.outline, b.start});
        const std::string both = named(a, i) + " and " + (on_support ? "the ground of a support" : named(b, j));
        const double size = place.norm() + std::sqrt(std::abs((b.is_free() ? b : a).outline.area()));
        if (gap < -negligible * size)
            found.push_back(
                read.at(item("obstacle", on_support ? i : j),
                        {.severity = Diagnostic::Severity::error,
                         .code = "obstacles-overlap",
                         .message = both + " overlap by " + readable(-gap, "m") + " at " + place_text(place),
                         .note = on_support ? "move it to the side on which the body stands: a support is ground "
                                              "behind its faces and `beyond`"
                                            : "move them apart, or give one of them a [[body]] instead"}));
    }
    for (const auto& [what, number, place] : held_against_obstacles(model, read.scenario.time.end)) {
        const Obstacle& obstacle = model.obstacles[number];
        const bool is_support = what == HeldAgainst::What::support;
        if (is_support ? !read.scenario.time.scheme.rigid.active()
                       : (!read.scenario.time.scheme.takes_implicit_steps() || obstacle.contact.friction == 0))
            continue;
        found.push_back(read.at(
            item("obstacle", number),
            {.severity = Diagnostic::Severity::error,
             .code = "held-against-obstacle",
             .message =
                 named(obstacle, number) + " comes first to " + (is_support ? "a support" : "an edge") + ", at " +
                 place_text(place) +
                 (is_support
                      ? ": with [rigid] a support meets bodies alone, and a free obstacle passes through it"
                      : ": it is held along its normal and may slip, and in implicit steps friction between it and a "
                        "free obstacle, whose pressure the body does not decide, is not solved"),
             .note = is_support ? "a fixed [[obstacle]] in its place, or no [rigid]"
                                : "bulk = \"explicit\"; hold the edge along its face, too; or friction = 0"}));
    }
    return found;
}

std::vector<Diagnostic> findings_of_impacts(const ReadResult& read, const Model& model, const StepPlan& plan) {
    const double step = plan.limits.changes() ? plan.limits.change.explicit_step : plan.limits.largest,
                 opening = plan.limits.critical_opening, V = speed_of_impact(read.scenario, model),
                 covered = V * step / opening;
    const bool is_explicit = plan.limits.changes() || !read.scenario.time.scheme.takes_implicit_steps();
    if (!is_explicit || !(covered > hard_impact)) return {};
    return {read.at("time", {.severity = Diagnostic::Severity::warning,
                             .code = "hard-impact",
                             .message = formatted(
                                 "bodies or obstacles meet at %s, which in a step of %s covers %.2g critical openings "
                                 "of %s: while points open by more than half of one in a step, steps are smaller, down "
                                 "to about %s, some %.2g times as many for that time",
                                 readable(V, "m/s").c_str(), readable(step, "s").c_str(), covered,
                                 readable(opening, "m").c_str(), readable(step / covered, "s", 2).c_str(), covered),
                             .note = formatted("nothing, if this is meant; time.step_cracking = \"%s\" keeps to such a "
                                               "step from the first loss of cohesion on",
                                               readable(step / covered, "s", 2).c_str())})};
}

namespace {

/// [-] Times the reciprocal number of edges of first order: what the volume of a straight crack under pressure lacks.
/// Measured in a body 20 times as long: 15, 9.0, 4.9, 3.1 % with 10, 20, 40, 80 edges; of second order 2.4, 1.2, 0.4,
/// 0 %.
constexpr double opening_lack = 1.8;

/// Cracked edges that a fluid has reached, all of one length.
double n_edges_of(const FluidMoment& start, const Model& model) {
    double length = 0, n = 0;  // of cracked edges
    for (const Interface& interface : model.interfaces)
        if (interface.cracked) length += interface.length, ++n;
    return n > 0 ? n * start.length / length : 0;
}

}  // namespace

/// A fluid may wait: at a joint that still holds, or at interfaces that may break where the body has no crack yet. That
/// it misses the cracks that are there is rarely meant.
std::vector<Diagnostic> findings_of_fluids(const ReadResult& read, const Model& model) {
    std::vector<Diagnostic> found;
    if (model.crack_fluids.empty()) return found;
    const bool has_cracks = std::ranges::any_of(model.interfaces, [](const Interface& i) { return bool{i.cracked}; });
    const std::vector<FluidMoment> start = CrackForces(model).moments(initial_state(model));
    for (std::size_t i = 0; i < start.size(); ++i) {
        const auto may_open_at_source = [&](std::size_t edge) {
            const bool is_joint = model.mesh.interior_edges[edge].joint >= 0;
            return (is_joint || (!has_cracks && model.laws[model.interfaces[edge].law].breakable())) &&
                   std::ranges::any_of(model.interfaces[edge].vertex,
                                       [&](Index v) { return model.crack_fluids[i].is_source[v] != 0; });
        };
        if (const double n = n_edges_of(start[i], model), too_little = opening_lack / n;
            n > 0 && model.mesh.order == 1 && model.crack_fluids[i].given.is_injected() && too_little > 0.05)
            found.push_back(read.at(
                item("pressure", i),
                {.severity = Diagnostic::Severity::warning,
                 .code = "coarse-crack",
                 .message =
                     formatted("the cracks that this fluid fills at t = 0 have %.0f edges of first order: under "
                               "its pressure they open by some %.2g %% too little (half of it where they begin at "
                               "a plane of symmetry), and the pressure of its volume is too large by as much",
                               n, 100 * too_little),
                 .note = "smaller edges along them, or order = 2 in [mesh], which leaves an eighth of it"}));
        const auto edges = std::views::iota(std::size_t{0}, model.mesh.interior_edges.size());
        if (start[i].length > 0 || std::ranges::any_of(edges, may_open_at_source)) continue;
        const std::string path = item("pressure", i);
        found.push_back(read.at(
            path, {.severity = Diagnostic::Severity::warning,
                   .code = "pressure-enters-nothing",
                   .message = "`" + path + "` presses on nothing at t = 0: no crack and no joint begins at its source" +
                              (has_cracks ? ", and the body has cracks elsewhere" : ", and nothing there can break"),
                   .note = "from = { boundary = \"...\" } or { box = [...] } where a [[domain.crack]] begins, or "
                           "joints = \"NAME\"; on the boundary itself: [[load]] with pressure"}));
    }
    return found;
}

}  // namespace knap
