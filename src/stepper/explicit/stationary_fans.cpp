#include "stepper/explicit/stationary_fans.hpp"

#include "interface/self_stress.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/explicit/corner_motion.hpp"

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

bool StationaryFans::find_parts(Index rank, const State& begin, double h, Workspace& work) const {
    if (cohesion_ != CohesionScheme::explicit_beta || rank >= static_cast<Index>(begin.split_fans.size())) return false;
    const Index f = begin.split_fans[rank];
    if (!contacts_.all().empty() && !(contacts_.on_edges().empty() && contacts_.of_fan(f).empty())) return false;
    const Fan& fan = model_.fans[f];
    work.node.resize(fan.n_corners), work.part.resize(fan.n_corners), work.is_open.resize(fan.n_points), work.bound.resize(fan.n_points);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const Index corner = model_.fan_corners[fan.first_corner + i];
        if (prescribed_motion(model_, corner)) return false;
        work.node[i] = begin.node_of_corner[corner];
    }
    const PointState* state = begin.points.data() + begin.first_point[rank];
    work.first_open = -1;
    work.part[0] = 0;
    Index part = 0;
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model_.fan_points[fan.first_point + j];
        if (point.before == rigid_support || point.after == rigid_support) return false;
        const CohesiveLaw& law = model_.laws[point.law];
        const Sides at(fan, j);
        const Vec2& u_after = begin.displacement[work.node[at.after]];
        const Vec2 u = u_after - begin.displacement[work.node[at.before]];
        const Vec2 v = begin.velocity[work.node[at.after]] - begin.velocity[work.node[at.before]];
        const bool held = law.breakable() && law.sigma_c > 0 && !point.cracked && state[j].cohesion > 0 && law.gamma > 0 && u.isZero(0) && v.isZero(0);
        const double u_N = point.normal.dot(u), v_N = point.normal.dot(v);
        const bool open = state[j].cohesion == 0 && law.restitution == 0 && u_N > rounding * u_after.cwiseAbs().maxCoeff() && u_N + h * v_N > 0;
        if (!held && !open) return false;
        work.is_open[j] = open;
        work.bound[j] = -std::max(u_N / h, v_N);
        if (open && work.first_open < 0) work.first_open = j;
        if (open && at.after > 0) ++part;
        work.part[at.after] = part;
    }
    if (fan.closed && !work.is_open[0])  // the last part goes on in the first
        for (Index i = fan.n_corners - 1; i > 0 && work.part[i] == part; --i) work.part[i] = 0;
    work.n_parts = part + 1;
    return true;
}

bool StationaryFans::advance(Index rank, const State& begin, const FreeMotion& free, State& end, Workspace& work, StepReport& report) const {
    if (!find_parts(rank, begin, free.drift_time, work)) return false;
    const Fan& fan = model_.fans[end.split_fans[rank]];
    const Index* corner = &model_.fan_corners[fan.first_corner];
    const double* corner_mass = &mass_[fan.first_corner];
    const FanPoint* point = model_.fan_points.data() + fan.first_point;
    const PointState* before = begin.points.data() + begin.first_point[rank];

    std::vector<Vec2>&required = work.required, &impulse = work.impulse, &velocity = work.velocity;
    required.resize(fan.n_corners), impulse.resize(fan.n_points);
    velocity.assign(work.n_parts, Vec2::Zero()), work.mass.assign(work.n_parts, 0);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const double inverse_mass = 1 / corner_mass[i], m = 1 / inverse_mass;
        required[i] = begin.velocity[work.node[i]] + free.kick_time * inverse_mass * free.corner_force[corner[i]];
        velocity[work.part[i]] += m * required[i];  // the momentum, until it is divided
        work.mass[work.part[i]] += m;
    }
    for (Index p = 0; p < work.n_parts; ++p)
        if (work.mass[p] > 0) velocity[p] *= 1 / work.mass[p];
    for (Index i = 0; i < fan.n_corners; ++i) required[i] = (velocity[work.part[i]] - required[i]) / (1 / corner_mass[i]);

    const auto strength = [&](Index j) { return free.kick_time * model_.laws[point[j].law].sigma_c * point[j].area * before[j].cohesion; };
    const bool all_round = fan.closed && work.first_open < 0;
    const Index start = fan.closed ? std::max(work.first_open, 0) : 0;
    LeastNormSelfStress least;
    Vec2 P = Vec2::Zero();
    for (Index k = 0; k < fan.n_points; ++k) {
        const Index j = start + k < fan.n_points ? start + k : start + k - fan.n_points;
        if (!fan.closed) P -= required[j];
        if (work.is_open[j]) P = Vec2::Zero();
        impulse[j] = P;
        if (all_round) least.add(1 / strength(j), P);
        if (fan.closed) P -= required[j];
    }
    const Vec2 around = least.c();
    for (Index j = 0; j < fan.n_points; ++j) {
        if (work.is_open[j]) {
            const Sides at(fan, j);
            const Vec2 after = velocity[work.part[at.after]] - velocity[work.part[at.before]];
            if (point[j].normal.dot(after) < work.bound[j]) return false;
        } else {
            impulse[j] += around;
            if (StrengthPolygon::at_rest(model_.laws[point[j].law], point[j].normal, strength(j)).smallest_slack(impulse[j]) < 0) return false;
        }
    }

    ++report.fan_solves, ++report.fan_iterations;
    for (Index i = 0; i < fan.n_corners; ++i) move_corner(corner[i], corner_mass[i], velocity[work.part[i]], begin, free, end, report);
    for (Index j = 0; j < fan.n_points; ++j) {
        const CohesiveLaw& law = model_.laws[point[j].law];
        PointState& state = end.points[end.first_point[rank] + j];
        state.cohesion = before[j].cohesion;
        account_rest(point[j], law, state.cohesion, report);  // held, or without the cohesion that feels an opening
        if (work.is_open[j]) {
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
