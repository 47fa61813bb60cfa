// Fans that came apart, closed again and rest as a whole: two thirds of all that came apart in the edge-cracked block, where cohesion fell a little beside
// the crack. Every point of such a fan is closed and at the kink of its friction and of its cohesion at once, so that the one linear system of the fan
// solver (interfaces/fan_solver.hpp) is: one velocity for all corners, the impulses by walking the chain, the circulation of least norm.
//
//     V = sum m_i v_i_free / sum m_i,     P_after = P_before - m_i (V - v_i_free)
//
// With the operations in the solver's order the bits are the solver's. What these impulses do not hold is the solver's business.
#include "stepper/vertex_scheme.hpp"

#include "interfaces/circulation.hpp"

#include <algorithm>

namespace knap {

/// No opening, no relative velocity, nothing beside the fan that acts on it, and no point that only touches.
bool VertexScheme::rests(Index rank, const State& begin) const {
    if (options_.cohesion != CohesionScheme::explicit_beta || rank >= static_cast<Index>(begin.split_fans.size())) return false;
    const Index f = begin.split_fans[rank];
    const Fan& fan = model_.fans[f];
    const Index* corner = &model_.fan_corners[fan.first_corner];
    const Vec2 &u = begin.displacement[f], &v = begin.velocity[f];  // of the first corner
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index node = begin.node_of_corner[corner[i]];
        if (begin.displacement[node] != u || begin.velocity[node] != v || prescribed_motion(corner[i])) return false;
    }
    const PointState* state = begin.points.data() + begin.first_point[rank];
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model_.fan_points[fan.first_point + j];
        const CohesiveLaw& law = model_.laws[point.law];
        const bool held = law.breakable() && law.sigma_c > 0 && !point.cracked && state[j].cohesion > 0 && law.gamma > 0;
        if (!held || point.before == ground || point.after == ground) return false;
    }
    return contacts_.all().empty() || (contacts_.on_edges().empty() && contacts_.of_fan(f).empty());
}

/// False: the fan does not rest, or does not so stay in one piece.
bool VertexScheme::advance_resting(Index rank, const State& begin, const FreeMotion& free, State& end, Workspace& work, StepReport& report) const {
    if (!rests(rank, begin)) return false;
    const Index f = end.split_fans[rank];
    const Fan& fan = model_.fans[f];
    const Index* corner = &model_.fan_corners[fan.first_corner];
    const double* corner_mass = &mass_[fan.first_corner];
    const FanPoint* point = model_.fan_points.data() + fan.first_point;
    const Index first_point = end.first_point[rank];

    std::vector<Vec2>&taken = work.taken, &impulse = work.impulse;
    taken.resize(fan.n_corners), impulse.resize(fan.n_points);
    Vec2 momentum = Vec2::Zero();
    double mass = 0;
    for (Index i = 0; i < fan.n_corners; ++i) {
        const double inverse_mass = 1 / corner_mass[i], m = 1 / inverse_mass;
        taken[i] = begin.velocity[f] + free.kick_time * inverse_mass * free.corner_force[corner[i]];
        momentum += m * taken[i];
        mass += m;
    }
    const Vec2 velocity = momentum * (1 / mass);
    for (Index i = 0; i < fan.n_corners; ++i) taken[i] = (velocity - taken[i]) / (1 / corner_mass[i]);

    LeastNormCirculation least;
    const auto strength = [&](Index j) {
        return free.kick_time * model_.laws[point[j].law].sigma_c * point[j].area * begin.points[begin.first_point[rank] + j].cohesion;
    };
    walk_chain(fan.n_points, fan.closed, Vec2::Zero(), [&](Index i) -> const Vec2& { return taken[i]; }, [&](Index j, const Vec2& P) {
        impulse[j] = P;
        if (fan.closed) least.add(1 / strength(j), P);
        return true;
    });
    const Vec2 around = least.c();
    for (Index j = 0; j < fan.n_points; ++j) {
        impulse[j] += around;
        const double C = strength(j);
        if (StrengthPolygon::at_rest(model_.laws[point[j].law], point[j].normal, C).smallest_slack(impulse[j]) < 0) return false;
    }

    ++report.fan_solves, ++report.fan_iterations;
    for (Index i = 0; i < fan.n_corners; ++i) move_corner(fan.first_corner + i, velocity, begin, free, end, report);
    for (Index j = 0; j < fan.n_points; ++j) {
        const CohesiveLaw& law = model_.laws[point[j].law];
        const double C = strength(j), S = point[j].area, contact = std::max(0.0, point[j].normal.dot(impulse[j]) + C);
        PointState& state = end.points[first_point + j];
        state.cohesion = begin.points[begin.first_point[rank] + j].cohesion;
        state.traction = Vec2(contact - C, turned_left(point[j].normal).dot(impulse[j])) / (free.kick_time * S);
        report.surface += S * law.surface_energy(state.cohesion, 0, 0);
    }
    return true;
}

}  // namespace knap
