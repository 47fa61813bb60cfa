// Fans that came apart and now rest in parts that move as one: where cohesion fell a little beside the crack and the points closed again (two thirds of all in
// the edge-cracked block), or where the crack went through and its faces fly freely (half of the others). Every point of such a fan is either held, that is
// closed and at the kink of its friction and of its cohesion at once, or open without cohesion. So the one linear system of the fan solver
// (interface/fan_solver.hpp) is: one velocity for each part, the impulses by walking the chain from an open point on; where none is open, with the
// self-stress of least norm.
//
//     V = sum m_i v_i_free / sum m_i,     P_after = P_before - m_i (V - v_i_free),     P = 0 where it is open
//
// With the operations in the solver's order the bits of the motion are the solver's. What these impulses do not hold, or what closes, is the solver's business.
#include "stepper/explicit/vertex_scheme.hpp"

#include "interface/self_stress.hpp"
#include "stepper/common/point_work.hpp"

#include <algorithm>

namespace knap {
namespace {

constexpr double rounding = 1e-9;  // of a displacement: what opens less may as well touch

/// The corners on both sides of a point, by their places in the fan.
struct Sides {
    Sides(const Fan& fan, Index j) : after(fan.closed ? j : j + 1), before(after > 0 ? after - 1 : fan.n_corners - 1) {}
    Index after, before;
};

}  // namespace

/// Which corners move as one. False: the fan has points that are neither held nor freely open, or something acts on it from beside.
bool VertexScheme::find_parts(Index rank, const State& begin, double h, StationaryFan& stationary) const {
    if (options_.cohesion != CohesionScheme::explicit_beta || rank >= static_cast<Index>(begin.split_fans.size())) return false;
    const Index f = begin.split_fans[rank];
    if (!contacts_.all().empty() && !(contacts_.on_edges().empty() && contacts_.of_fan(f).empty())) return false;
    const Fan& fan = model_.fans[f];
    stationary.node.resize(fan.n_corners), stationary.part.resize(fan.n_corners), stationary.is_open.resize(fan.n_points), stationary.bound.resize(fan.n_points);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index corner = model_.fan_corners[fan.first_corner + i];
        if (prescribed_motion(corner)) return false;
        stationary.node[i] = begin.node_of_corner[corner];
    }
    const PointState* state = begin.points.data() + begin.first_point[rank];
    stationary.first_open = -1;
    stationary.part[0] = 0;
    Index part = 0;
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model_.fan_points[fan.first_point + j];
        if (point.before == ground || point.after == ground) return false;
        const CohesiveLaw& law = model_.laws[point.law];
        const Sides at(fan, j);
        const Vec2& u_after = begin.displacement[stationary.node[at.after]];
        const Vec2 u = u_after - begin.displacement[stationary.node[at.before]];
        const Vec2 v = begin.velocity[stationary.node[at.after]] - begin.velocity[stationary.node[at.before]];
        const bool held = law.breakable() && law.sigma_c > 0 && !point.cracked && state[j].cohesion > 0 && law.gamma > 0 && u.isZero(0) && v.isZero(0);
        const double u_N = point.normal.dot(u), v_N = point.normal.dot(v);
        const bool open = state[j].cohesion == 0 && law.restitution == 0 && u_N > rounding * u_after.cwiseAbs().maxCoeff() && u_N + h * v_N > 0;
        if (!held && !open) return false;
        stationary.is_open[j] = open;
        stationary.bound[j] = -std::max(u_N / h, v_N);
        if (open && stationary.first_open < 0) stationary.first_open = j;
        if (open && at.after > 0) ++part;
        stationary.part[at.after] = part;
    }
    if (fan.closed && !stationary.is_open[0])  // the last part goes on in the first
        for (Index i = fan.n_corners - 1; i > 0 && stationary.part[i] == part; --i) stationary.part[i] = 0;
    stationary.n_parts = part + 1;
    return true;
}

/// False: the fan does not rest, or does not so stay in its parts.
bool VertexScheme::advance_stationary(Index rank, const State& begin, const FreeMotion& free, State& end, Workspace& work, StepReport& report) const {
    StationaryFan& stationary = work.stationary;
    if (!find_parts(rank, begin, free.drift_time, stationary)) return false;
    const Fan& fan = model_.fans[end.split_fans[rank]];
    const Index* corner = &model_.fan_corners[fan.first_corner];
    const double* corner_mass = &mass_[fan.first_corner];
    const FanPoint* point = model_.fan_points.data() + fan.first_point;
    const PointState* before = begin.points.data() + begin.first_point[rank];

    std::vector<Vec2>&required = work.required, &impulse = work.impulse, &velocity = stationary.velocity;
    required.resize(fan.n_corners), impulse.resize(fan.n_points);
    velocity.assign(stationary.n_parts, Vec2::Zero()), stationary.mass.assign(stationary.n_parts, 0);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const double inverse_mass = 1 / corner_mass[i], m = 1 / inverse_mass;
        required[i] = begin.velocity[stationary.node[i]] + free.kick_time * inverse_mass * free.corner_force[corner[i]];
        velocity[stationary.part[i]] += m * required[i];  // the momentum, until it is divided
        stationary.mass[stationary.part[i]] += m;
    }
    for (Index p = 0; p < stationary.n_parts; ++p)
        if (stationary.mass[p] > 0) velocity[p] *= 1 / stationary.mass[p];
    for (Index i = 0; i < fan.n_corners; ++i) required[i] = (velocity[stationary.part[i]] - required[i]) / (1 / corner_mass[i]);

    const auto strength = [&](Index j) { return free.kick_time * model_.laws[point[j].law].sigma_c * point[j].area * before[j].cohesion; };
    const bool all_round = fan.closed && stationary.first_open < 0;
    const Index start = fan.closed ? std::max(stationary.first_open, 0) : 0;
    LeastNormSelfStress least;
    Vec2 P = Vec2::Zero();
    for (Index k = 0; k < fan.n_points; ++k) {
        const Index j = start + k < fan.n_points ? start + k : start + k - fan.n_points;
        if (!fan.closed) P -= required[j];
        if (stationary.is_open[j]) P = Vec2::Zero();
        impulse[j] = P;
        if (all_round) least.add(1 / strength(j), P);
        if (fan.closed) P -= required[j];
    }
    const Vec2 around = least.c();
    for (Index j = 0; j < fan.n_points; ++j) {
        if (stationary.is_open[j]) {
            const Sides at(fan, j);
            const Vec2 after = velocity[stationary.part[at.after]] - velocity[stationary.part[at.before]];
            if (point[j].normal.dot(after) < stationary.bound[j]) return false;
        } else {
            impulse[j] += around;
            if (StrengthPolygon::at_rest(model_.laws[point[j].law], point[j].normal, strength(j)).smallest_slack(impulse[j]) < 0) return false;
        }
    }

    ++report.fan_solves, ++report.fan_iterations;
    for (Index i = 0; i < fan.n_corners; ++i) move_corner(fan.first_corner + i, velocity[stationary.part[i]], begin, free, end, report);
    for (Index j = 0; j < fan.n_points; ++j) {
        const CohesiveLaw& law = model_.laws[point[j].law];
        PointState& state = end.points[end.first_point[rank] + j];
        state.cohesion = before[j].cohesion;
        account_rest(point[j], law, state.cohesion, report);  // held, or without the cohesion that feels an opening
        if (stationary.is_open[j]) {
            const Sides at(fan, j);
            const auto displacement = [&](Index i) -> const Vec2& { return end.displacement[end.node_of_corner[corner[i]]]; };
            const double u_N = point[j].normal.dot(displacement(at.after) - displacement(at.before));
            state.traction = Vec2::Zero();
            report.penetration = std::max(report.penetration, -u_N);
        } else {
            const double C = strength(j), contact = std::max(0.0, point[j].normal.dot(impulse[j]) + C);
            state.traction = Vec2(contact - C, turned_left(point[j].normal).dot(impulse[j])) / (free.kick_time * point[j].area);
        }
    }
    return true;
}

}  // namespace knap
