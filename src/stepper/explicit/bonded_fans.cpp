// Fans in one piece: forces of the bulk and motion in one sweep over blocks of triangles, then the fans across borders of blocks; and which come apart.
#include "stepper/explicit/vertex_scheme.hpp"

#include "base/parallel.hpp"
#include "interface/self_stress.hpp"
#include "stepper/explicit/corner_motion.hpp"

#include <omp.h>

#include <algorithm>
#include <cstring>

namespace knap {
namespace {

/// Moves a node in one piece, and adds up what it does, in registers.
class NodeSums {
public:
    NodeSums(const State& begin, const FreeMotion& free, State& end)
        : begin_(begin), end_(end), h_(free.drift_time), change_(0.25 * (free.drift_time - begin.last_step)) {}

    [[gnu::always_inline]] void move(Index node, double mass, const Vec2& force, const Vec2& velocity) {
        const Vec2 u = begin_.displacement[node] + h_ * velocity;
        const double speed2 = velocity.squaredNorm();
        kinetic_ += 0.5 * mass * speed2;
        strain_ -= 0.5 * force.dot(u);
        step_change_work_ -= change_ * force.dot(velocity - begin_.velocity[node]);
        largest_speed2_ = std::max(largest_speed2_, speed2);
        end_.velocity[node] = velocity;
        end_.displacement[node] = u;
    }
    void add_to(StepReport& report) const {
        report.kinetic += kinetic_;
        report.strain += strain_;
        report.step_change_work += step_change_work_;
        report.largest_speed = std::max(report.largest_speed, largest_speed2_);
    }

private:
    const State& begin_;
    State& end_;
    double h_, change_;
    double kinetic_ = 0, strain_ = 0, step_change_work_ = 0, largest_speed2_ = 0;
};

}  // namespace

StepReport VertexScheme::sweep_blocks(const State& begin, const ExplicitBulk& bulk, FreeMotion& free, State& end) {
    const auto blocks = blocks_.blocks();
    return sum_over_blocks(blocks.size(), 1, partial_, [&](std::size_t b, std::size_t, StepReport& report) {
        Workspace& work = workspaces_[omp_get_thread_num()];
        bulk.find_forces(blocks[b].first, blocks[b].last, begin, work.force.data(), fan_is_candidate_);
        Vec2* kept = &free.corner_force[model_.mesh.corners_per_triangle() * blocks[b].first];
        for (const MeshBlocks::Corner c : blocks_.kept(blocks[b])) kept[c] = work.force[c];
        bulk.add_loads(blocks[b].first_load, blocks[b].last_load, free);
        advance_inner(blocks[b], begin, free, end, work, report);
    });
}

void VertexScheme::advance_inner(const MeshBlocks::Block& block, const State& begin, FreeMotion& free, State& end, Workspace& work, StepReport& report) {
    NodeSums sums(begin, free, end);
    Vec2* kept = &free.corner_force[model_.mesh.corners_per_triangle() * block.first];
    const auto keep = [&](const MeshBlocks::Corner* first, const MeshBlocks::Corner* last) {
        for (; first < last; ++first) kept[*first] = work.force[*first];
    };
    const MeshBlocks::Corner* corner = blocks_.corners(block);
    const auto inner = blocks_.inner(block);
    for (std::size_t i = 0; i < inner.size(); ++i) {
        constexpr std::size_t soon = 4;
        if (i + soon < inner.size() && fan_is_candidate_[inner[i + soon].fan]) InscribedCircles::prefetch(circles_.of_inner(corner));
        const MeshBlocks::BlockFan& fan = inner[i];
        const MeshBlocks::Corner *first = corner, *last = corner += fan.n_corners;
        if (const Index rank = begin.split_rank[fan.fan]; rank >= 0) {
            keep(first, last);
            if (fans_are_by_themselves()) advance_fan(rank, begin, free, end, work, report);
            continue;
        }
        Vec2 force = Vec2::Zero();
        for (const MeshBlocks::Corner* c = first; c < last; ++c) force += work.force[*c];
        if (fan_is_candidate_[fan.fan]) {
            fan_is_candidate_[fan.fan] = 0;
            const auto force_on = [&](Index c) -> const Vec2& { return work.force[first[c]]; };
            if (!InscribedCircles::hold(circles_.of_inner(first), fan.n_corners, force_on, force)) {
                work.required.resize(fan.n_corners);
                for (Index c = 0; c < fan.n_corners; ++c) work.required[c] = work.force[first[c]];
                if (!bonded_by_estimate(fan.fan, force, work.required)) {
                    keep(first, last);
                    if (!is_bonded(fan.fan, begin, free, work, report)) continue;
                }
            }
        }
        sums.move(fan.fan, fan.mass, force, begin.velocity[fan.fan] + free.kick_time / fan.mass * force);
    }
    sums.add_to(report);
}

/// Round a corner near an obstacle all corners are by themselves, until the fan solver says what holds them together.
void VertexScheme::part_from_obstacles(const State& begin) {
    for (const ObstacleContact& contact : contacts_.all())
        for (const Index f : {contact.fan, contact.fan_beside})
            if (f >= 0) splits_[f] = begin.split_rank[f] < 0;
}

StepReport VertexScheme::advance_bordering(const State& begin, const FreeMotion& free, State& end) {
    const auto blocks = blocks_.blocks();
    return sum_over_blocks(blocks.size(), 1, partial_, [&](std::size_t b, std::size_t, StepReport& report) {
        Workspace& work = workspaces_[omp_get_thread_num()];
        NodeSums sums(begin, free, end);
        const auto bordering = blocks_.bordering(blocks[b]);
        const Index* next = blocks_.bordering_corners(blocks[b]);
        for (std::size_t i = 0; i < bordering.size(); ++i) {
            constexpr std::size_t soon = 4;
            if (i + soon < bordering.size()) {
                __builtin_prefetch(&begin.velocity[bordering[i + soon].fan]);
                __builtin_prefetch(&begin.displacement[bordering[i + soon].fan]);
            }
            const auto& [mass, f, n_corners] = bordering[i];
            const Index* corner = next;
            next += n_corners;
            for (Index c = 0; c < n_corners; ++c) __builtin_prefetch(&free.corner_force[corner[c + MeshBlocks::look_ahead]]);
            if (splits_[f]) continue;
            if (const Index rank = begin.split_rank[f]; rank >= 0) {
                if (fans_are_by_themselves()) advance_fan(rank, begin, free, end, work, report);
                continue;
            }
            Vec2 force = Vec2::Zero();
            for (Index c = 0; c < n_corners; ++c) force += free.corner_force[corner[c]];
            if (fan_is_candidate_[f]) {
                fan_is_candidate_[f] = 0;
                const auto force_on = [&](Index c) -> const Vec2& { return free.corner_force[corner[c]]; };
                if (!InscribedCircles::hold(circles_.of_bordering(corner), n_corners, force_on, force)) {
                    work.required.resize(n_corners);
                    for (Index c = 0; c < n_corners; ++c) work.required[c] = free.corner_force[corner[c]];
                    if (!bonded_by_estimate(f, force, work.required) && !is_bonded(f, begin, free, work, report)) continue;
                }
            }
            Vec2 velocity = begin.velocity[f] + free.kick_time / mass * force;
            const PrescribedMotion* motion = prescribed_motion(model_, *corner);
            if (motion) {
                const Vec2 given = prescribed_velocity(*motion, begin.displacement[f], begin, free.drift_time);
                for (int k = 0; k < 2; ++k)
                    if (motion->component[k]) velocity[k] = given[k];
            }
            sums.move(f, mass, force, velocity);
            if (motion) account_drive(f, *motion, begin, free, force, end, report);
        }
        sums.add_to(report);
    });
}

void VertexScheme::account_drive(Index fan, const PrescribedMotion& motion, const State& begin, const FreeMotion& free, const Vec2& force, State& end,
                                 StepReport& report) const {
    const Vec2 before = begin.velocity[fan], after = end.velocity[fan];
    const Vec2 impulse = model_.fans[fan].mass * (after - before) - free.kick_time * force;
    Vec2& reaction = end.reaction[&motion - model_.prescribed.data()];
    for (int k = 0; k < 2; ++k) {
        if (!motion.component[k]) continue;
        report.external_work += 0.5 * impulse[k] * (after[k] + before[k]);
        reaction[k] = impulse[k] / free.kick_time;
    }
}

/// Forces between the corners of a fan in one piece, walked along the chain; round a closed one with the self-stress of least norm.
/// If these are admissible the fan is bonded; if not, others may be, and the exact test decides. `force` [N]: on the whole fan; `forces`: on its corners,
/// which then become what its points must give them.
bool VertexScheme::bonded_by_estimate(Index f, const Vec2& force, std::vector<Vec2>& forces) {
    const Fan& fan = model_.fans[f];
    if (fan.split_at_start || prescribed_motion(model_, model_.fan_corners[fan.first_corner])) return false;
    const FanPoint* point = model_.fan_points.data() + fan.first_point;
    const Vec2 acceleration = force / fan.mass;
    for (Index i = 0; i < fan.n_corners; ++i) forces[i] = mass_[fan.first_corner + i] * acceleration - forces[i];
    const auto required = [&](Index i) -> const Vec2& { return forces[i]; };

    const Vec2 first = least_norm_start(fan.n_points, fan.closed, required, [&](Index j) { return point[j].area; });
    return walk_chain(fan.n_points, fan.closed, first, required, [&](Index j, const Vec2& P) {
        const CohesiveLaw& law = model_.laws[point[j].law];
        return !law.breakable() || StrengthPolygon::at_rest(law, point[j].normal, law.sigma_c * point[j].area).smallest_slack(P) >= 0;
    });
}

bool VertexScheme::is_bonded(Index fan, const State& begin, const FreeMotion& free, Workspace& work, StepReport& report) {
    assemble_problem(fan, begin, free, work.problem);
    const FanSolution solution = work.solver.solve(work.problem);
    ++report.bond_checks;
    splits_[fan] = !solution.bonded;
    return solution.bonded;
}

void VertexScheme::release(const State& begin, State& end, StepReport& report) {
    const std::uint8_t *first = splits_.data(), *last = first + splits_.size();
    while (const void* found = first < last ? std::memchr(first, 1, last - first) : nullptr) {
        const Index f = static_cast<Index>(static_cast<const std::uint8_t*>(found) - splits_.data());
        first = splits_.data() + f + 1;
        splits_[f] = 0;
        end.displacement[f] = begin.displacement[f];
        split(model_, f, end);
        ++report.released;
    }
}

}  // namespace knap
