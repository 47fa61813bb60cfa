#include "stepper/explicit/touched_fan.hpp"

#include <algorithm>
#include <numeric>

namespace knap {

/// The parts of a fan move as rigid bodies: corners that points hold together which have not moved. Solved
/// jointly: a fan on a support, or with prescribed corners that may split, or one whose parts cannot stay as they are.
void find_parts(const Model& model, const VertexSolver& solver, TouchedFan& touched, const ExplicitStep& step,
                ThreadWorkspace& work) {
    const State& begin = step.begin;
    const Fan& fan = model.fans[touched.fan];
    const auto corners = model.corners(fan);
    const Index rank = begin.split_rank[touched.fan];
    std::vector<Index>& part = touched.part;
    part.assign(corners.size(), 0);
    touched.solved_jointly = solver.has_outer_forces(touched.fan);
    if (rank < 0) return;
    std::iota(part.begin(), part.end(), 0);
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model.points(fan)[j];
        if (point.on_support()) {
            touched.solved_jointly = true;
            continue;
        }
        const Index before = begin.node_of_corner[point.before], after = begin.node_of_corner[point.after];
        const bool together =
            begin.displacement[before] == begin.displacement[after] && begin.velocity[before] == begin.velocity[after];
        const bool held = unbreakable(model, point) || begin.points[begin.first_point[rank] + j].cohesion > 0;
        if (held && together)
            std::ranges::replace(part, part[place_among(corners, point.after)],
                                 part[place_among(corners, point.before)]);
    }
    const auto is_prescribed = [&](Index corner) { return model.motion_of(corner) != nullptr; };
    touched.solved_jointly = touched.solved_jointly || std::ranges::any_of(touched.corners, is_prescribed) ||
                             !may_be_stationary(model, rank, step, work.split.stationary);
}

void solve_jointly(TouchedFan& touched, const State& begin, std::vector<std::uint8_t>& splits) {
    touched.solved_jointly = true;
    splits[touched.fan] = begin.split_rank[touched.fan] < 0;
}

/// Whether the impulses on its corners leave the parts of a fan as they are.
bool keeps_its_parts(const Model& model, const TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work,
                     StepReport& report) {
    const Fan& fan = model.fans[touched.fan];
    const auto corners = model.corners(fan);
    if (const Index rank = step.begin.split_rank[touched.fan]; rank >= 0)
        return is_stationary(model, rank, step, work.split.stationary);
    const auto force_on = [&](Index i) -> Vec2 {
        return step.corner_force[corners[i]] + step.corner_impulse[corners[i]] / step.kick_time;
    };
    Vec2 force = Vec2::Zero();
    for (Index i = 0; i < fan.n_corners; ++i) force += force_on(i);
    ++report.bond_checks;
    return work.is_bonded(model, touched.fan, step.begin, step.mass, force_on, force);
}

/// The motion of a fan under the present impulses.
void solve_fan(const Model& model, const VertexSolver& solver, TouchedFan& touched, const ExplicitStep& step,
               VertexSolver::Workspace& work) {
    const auto corners = model.corners(model.fans[touched.fan]);
    touched.known.solution = solver.solve(touched.fan, step, work);
    std::swap(work.fan, touched.known.fan);
    touched.velocity.clear();
    for (const Index corner : touched.corners)
        touched.velocity.push_back(touched.known.fan.result.velocity[place_among(corners, corner)]);
}

/// One body for each part that contacts touch.
void add_parts(const Model& model, TouchedFan& touched, const ExplicitStep& step, ContactProblem& problem) {
    const Fan& fan = model.fans[touched.fan];
    const State& begin = step.begin;
    const auto corners = model.corners(fan);
    const auto part_of = [&](Index corner) { return touched.part[place_among(corners, corner)]; };
    for (std::size_t c = 0; c < touched.corners.size(); ++c) {
        const Index corner = touched.corners[c], own = part_of(corner);
        std::size_t same = 0;
        while (part_of(touched.corners[same]) != own) ++same;
        if (same < c) {
            touched.body.push_back(touched.body[same]);
            continue;
        }
        double mass = 0;
        Vec2 momentum = Vec2::Zero();
        for (Index i = 0; i < fan.n_corners; ++i) {
            if (touched.part[i] != own) continue;
            const double m = step.mass[fan.first_corner + i];
            mass += m;
            const Index node = begin.node_of_corner[corners[i]];
            momentum +=
                step.decay * m * begin.velocity[node] + step.mobility * step.kick_time * step.corner_force[corners[i]];
            if (step.carried != nullptr) momentum += m * step.carried[node];
        }
        Vec2 free = momentum / mass, mobility = Vec2::Constant(step.mobility / mass);
        if (const PrescribedMotion* motion = model.motion_of(corner)) {  // of the whole fan, which is bonded
            const Vec2 given =
                step.prescribed_velocity(model, *motion, begin.displacement[begin.node_of_corner[corner]]);
            for (int k = 0; k < 2; ++k)
                if (motion->component[k]) free[k] = given[k], mobility[k] = 0;
        }
        touched.body.push_back(problem.add_body(free, mobility));
    }
}

}  // namespace knap
