#include "stepper/explicit/stationary_fans.hpp"

#include "base/tolerance.hpp"
#include "law/interface_law.hpp"
#include "law/self_stress.hpp"
#include "stepper/common/point_work.hpp"

namespace knap {
namespace {

/// The corners on both sides of point j, by their places in the fan.
struct Sides {
    Sides(const Fan& fan, Index j) : after(fan.closed ? j : j + 1), before(after > 0 ? after - 1 : fan.n_corners - 1) {}
    Index after, before;
};

/// Finds the corners that move as one. False: some point is neither held nor freely open, or a corner is driven.
bool find_parts(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work) {
    const State& begin = step.begin;
    const Fan& fan = model.fans[begin.split_fans[rank]];
    const PointState* state = begin.points.data() + begin.first_point[rank];
    const double factor = begin.strength_factor(begin.split_fans[rank]);
    const auto corners = model.corners(fan);
    const auto points = model.points(fan);
    work.node.resize(fan.n_corners), work.part.resize(fan.n_corners);
    work.is_open.resize(fan.n_points), work.bound.resize(fan.n_points), work.normal.resize(fan.n_points);
    work.strength.resize(fan.n_points);
    for (Index i = 0; i < fan.n_corners; ++i) {
        if (model.motion_of(corners[i])) return false;
        work.node[i] = begin.node_of_corner[corners[i]];
    }
    for (Index j = 0; j < fan.n_points; ++j)
        work.normal[j] = step.frame(model, begin.split_fans[rank], j).turned(points[j].normal);
    work.first_open = -1;
    work.part[0] = 0;
    Index part = 0;
    for (Index j = 0; j < fan.n_points; ++j) {
        if (points[j].on_support()) return false;
        const CohesiveLaw& law = law_of(model, step.begin, points[j]);
        const Sides at(fan, j);
        const Vec2& u_after = begin.displacement[work.node[at.after]];
        const Vec2 u = u_after - begin.displacement[work.node[at.before]];
        const Vec2 v = begin.velocity[work.node[at.after]] - begin.velocity[work.node[at.before]];
        const bool held = state[j].cohesion > 0 && u.isZero(0) && v.isZero(0) && law.breakable() && law.sigma_c > 0 &&
                          !points[j].cracked && law.ramp(state[j].cohesion, state[j].largest_opening) == 0 &&
                          law.gamma > 0;
        const Vec2& normal = work.normal[j];
        const double u_N = normal.dot(u), v_N = normal.dot(v),
                     touching = geometric_rounding * u_after.cwiseAbs().maxCoeff();  // [m]
        const bool open =
            state[j].cohesion == 0 && law.restitution == 0 && u_N > touching && u_N + step.drift_time * v_N > 0;
        const bool retired = begin.has_retired(points[j].point);
        if (!held && !open && !retired) return false;
        work.is_open[j] = open || retired;
        work.strength[j] = step.kick_time * law.sigma_c * (points[j].area * factor) * state[j].cohesion;
        work.bound[j] = open && !retired
                            ? contact_bound_explicit(u_N, v_N, law.restitution, step.drift_time, touching).rate
                            : -infinity;
        if (work.is_open[j] && work.first_open < 0) work.first_open = j;
        if (work.is_open[j] && at.after > 0) ++part;
        work.part[at.after] = part;
    }
    if (fan.closed && !work.is_open[0])  // the last part continues in the first
        for (Index i = fan.n_corners - 1; i > 0 && work.part[i] == part; --i) work.part[i] = 0;
    work.n_parts = part + 1;
    return true;
}

}  // namespace

bool may_be_stationary(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work) {
    return rank < static_cast<Index>(step.begin.split_fans.size()) &&  // else it is split in this step
           find_parts(model, rank, step, work);
}

bool is_stationary(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work) {
    if (!may_be_stationary(model, rank, step, work)) return false;
    const State& begin = step.begin;
    const Fan& fan = model.fans[begin.split_fans[rank]];
    const auto corners = model.corners(fan);
    const auto points = model.points(fan);
    const double* mass = &step.mass[fan.first_corner];

    // V = sum m_i v_i_free / sum m_i per part; each corner must get m_i (V - v_i_free) from its points
    std::vector<Vec2>&required = work.required, &impulse = work.impulse, &velocity = work.velocity;
    required.resize(fan.n_corners), impulse.resize(fan.n_points);
    velocity.assign(work.n_parts, Vec2::Zero()), work.mass.assign(work.n_parts, 0);
    for (Index i = 0; i < fan.n_corners; ++i) {
        const double inverse_mass = step.mobility / mass[i], m = 1 / inverse_mass;
        required[i] = step.damped(work.node[i]) + step.kick_time * inverse_mass * step.corner_force[corners[i]];
        if (!step.corner_impulse.empty()) required[i] += inverse_mass * step.corner_impulse[corners[i]];
        velocity[work.part[i]] += m * required[i];  // the momentum, until it is divided
        work.mass[work.part[i]] += m;
    }
    for (Index p = 0; p < work.n_parts; ++p)
        if (work.mass[p] > 0) velocity[p] *= 1 / work.mass[p];
    for (Index i = 0; i < fan.n_corners; ++i)
        required[i] = (velocity[work.part[i]] - required[i]) / (step.mobility / mass[i]);

    // P_after = P_before - m_i (V - v_i_free)
    const bool all_round = fan.closed && work.first_open < 0;
    const Index start = fan.closed ? std::max(work.first_open, 0) : 0;
    LeastNormSelfStress least;
    Vec2 P = Vec2::Zero();
    for (Index k = 0; k < fan.n_points; ++k) {
        const Index j = start + k < fan.n_points ? start + k : start + k - fan.n_points;
        if (!fan.closed) P -= required[j];
        if (work.is_open[j]) P = Vec2::Zero();
        impulse[j] = P;
        if (all_round) least.add(1 / work.strength[j], P);
        if (fan.closed) P -= required[j];
    }
    const Vec2 self_stress = least.c();
    for (Index j = 0; j < fan.n_points; ++j) {
        if (work.is_open[j]) {
            const Sides at(fan, j);
            const Vec2 rate = velocity[work.part[at.after]] - velocity[work.part[at.before]];
            if (work.normal[j].dot(rate) < work.bound[j]) return false;
        } else {
            impulse[j] += self_stress;
            const CohesiveLaw& law = law_of(model, step.begin, points[j]);
            if (StrengthPolygon::at_rest(law, work.normal[j], work.strength[j], step.kick_time * points[j].area)
                    .smallest_slack(impulse[j]) < 0)
                return false;
        }
    }
    return true;
}

bool advance_stationary(const Model& model, Index rank, const ExplicitStep& step, StationaryWorkspace& work,
                        StepReport& report) {
    if (!is_stationary(model, rank, step, work)) return false;
    State& end = step.end;
    const Fan& fan = model.fans[end.split_fans[rank]];
    const auto corners = model.corners(fan);
    const auto points = model.points(fan);
    const double *mass = &step.mass[fan.first_corner], factor = end.strength_factor(end.split_fans[rank]);
    const PointState* before = step.begin.points.data() + step.begin.first_point[rank];
    ++report.fan_solves, ++report.fan_iterations;
    for (Index i = 0; i < fan.n_corners; ++i) {
        NodeMotion motion(step);
        motion.move(work.node[i], end.node_of_corner[corners[i]], mass[i], step.corner_force[corners[i]],
                    work.velocity[work.part[i]]);
        motion.add_to(report);
    }
    for (Index j = 0; j < fan.n_points; ++j) {
        PointState& state = end.points[end.first_point[rank] + j];
        state = before[j];
        state.traction.setZero();
        const CohesiveLaw& law = law_of(model, step.begin, points[j]);
        account_rest(points[j], law, points[j].area * factor, state.cohesion,
                     law.ramp(state.cohesion, state.largest_opening), report);
        if (work.is_open[j]) {
            if (step.begin.has_retired(points[j].point)) continue;
            const Vec2 jump = end.displacement_of(points[j].after) - end.displacement_of(points[j].before);
            report.penetration = std::max(report.penetration, -work.normal[j].dot(jump));
        } else {
            const Vec2& P = work.impulse[j];
            const double C = work.strength[j], contact = std::max(0.0, work.normal[j].dot(P) + C);
            state.traction = Vec2(contact - C, turned_left(work.normal[j]).dot(P)) / (step.kick_time * points[j].area);
        }
    }
    return true;
}

}  // namespace knap
