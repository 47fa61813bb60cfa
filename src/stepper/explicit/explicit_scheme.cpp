#include "stepper/explicit/explicit_scheme.hpp"

#include "base/parallel.hpp"
#include "base/reserve_capacity.hpp"
#include "element/triangle_matrices.hpp"
#include "stepper/common/fluid_pressures.hpp"
#include "stepper/explicit/partition.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <type_traits>

namespace knap {
namespace {

constexpr std::size_t split_fans_in_a_block = 8;
constexpr std::size_t prefetch_distance = 4;  // fans ahead, to prefetch

}  // namespace

ExplicitScheme::ExplicitScheme(const Model& model, const SchemeOptions& options)
    : model_(model),
      options_(options),
      forces_(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation),
      crack_forces_(model),
      incubation_(model),
      absorbing_(model, options.absorbing),
      free_pieces_(model, options, absorbing_.dashpots()),
      blocks_(make_blocks(model, absorbing_.dashpots())),
      obstacle_step_(model, absorbing_.dashpots()),
      solver_(model, options, obstacle_step_, absorbing_),
      obstacles_(model, obstacle_step_),
      amplitude_(model.histories.size()),
      velocity_factor_(model.histories.size()),
      corner_force_(model.mesh.n_corners() + 1, Vec2::Zero()),  // the last: BlockFans::no_force
      elastic_energy_(blocks_.size()),
      fan_is_candidate_(model.fans.size(), 0),
      bond_proofs_(model),
      splits_(model.fans.size(), 0),
      workspaces_(omp_get_max_threads(), ThreadWorkspace(model)) {
    if (model.faces_meet() || !model.obstacles.empty()) {
        corner_impulse_.assign(model.mesh.n_corners(), Vec2::Zero());
        contacts_.emplace(model, solver_, obstacle_step_, corner_impulse_);
    }
    if (model.has_injected_fluids()) corner_rate_.assign(model.mesh.n_corners(), Vec2::Zero());
    if (model.heat) {
        thermal_.emplace(model.mesh, model.materials, model.plane, model.thickness, model.large_rotation);
        thermal_->set_stress_criterion(stress_thresholds(model, absorbing_.dashpots()), model.fan_of_corner);
    } else {
        forces_.set_stress_criterion(stress_thresholds(model, absorbing_.dashpots()), model.fan_of_corner);
    }
    if (std::ranges::any_of(model.materials, &Elastic::has_viscosity))
        no_viscous_stress_.assign(viscous_components * (model.mesh.order == 1 ? 1 : 3) * model.mesh.n_triangles(), 0);
    for (const Index corner : model.fan_corners) mass_.push_back(model.corner_mass[corner]);
    for (std::size_t f = 0; f < model.fans.size() && !model.prescribed.empty(); ++f) {
        const PrescribedMotion* motion = model.motion_of(model.corners(model.fans[f])[0]);
        drive_of_fan_.push_back(motion ? static_cast<Index>(drives_.size()) : -1);
        if (motion) drives_.push_back(*motion);
    }
    for (ThreadWorkspace& work : workspaces_) {
        work.force.resize(model.mesh.corners_per_triangle() * blocks_.front().last + 1, Vec2::Zero());
        VertexSolver::Workspace& split = work.split;  // more corners and points than most vertices have
        reserve_capacity(16, work.required, split.stationary.required, split.stationary.impulse);
        for (SolvedFan* fan : {&split.fan, &split.kept})
            reserve_capacity(16, fan->problem.bodies, fan->problem.links, fan->result.velocity, fan->result.links);
    }
}

StepReport ExplicitScheme::step(const State& begin, double h, State& end) {
    const double damping = 0.25 * (begin.last_step + h) * options_.damping;
    const ExplicitStep step{.begin = begin,
                            .end = end,
                            .drift_time = h,
                            .kick_time = 0.5 * (begin.last_step + h),
                            .mass = mass_,
                            .corner_force = corner_force_,
                            .damping = damping,
                            .obstacle_damping = options_.damping_of == DampingOf::motion ? damping : 0,
                            .large_rotation = model_.large_rotation,
                            .corner_impulse = corner_impulse_,
                            .velocity_factor = velocity_factor_,
                            .frames = find_frames(begin),
                            .carried = free_pieces_.carried(begin, damping, end.free_pieces)};
    copy_partition(model_, begin, end);  // fans that were split before are split at the end, too
    end.viscous_stress.resize(no_viscous_stress_.size());
    for (std::size_t i = 0; i < amplitude_.size(); ++i) {
        const TimeFunction& history = model_.histories[i];
        amplitude_[i] = history.over_kick(begin.time, begin.last_step, h);
        velocity_factor_[i] = prescribed_rate(false, 1, history, 0, ExplicitStep::times_of(begin, h)).rate;
    }
    StepReport report;
    // rows of src/README.md, Explicit step. First: fans in contact and those whose incubation is due are candidates
    if (contacts_) {
        contacts_->begin(step, report);
        for (const Index f : contacts_->fans()) fan_is_candidate_[f] = 1;
    }
    incubation_.mark_due_fans(begin, fan_is_candidate_);
    // rows 1 to 3, and 5 and 6 of fans that were split before, for the fans inside blocks of triangles
    report += sweep_blocks(step);
    // row 1: the pressure of fluids in cracks; contacts with obstacles
    crack_forces_.find(begin, begin.time, begin.fluid_pressure.empty() ? nullptr : &begin.fluid_pressure);
    add_crack_forces(1);
    if (contacts_) find_obstacle_contacts(step);
    if (model_.has_injected_fluids()) settle_fluids(step, report);
    // rows 2 and 3, 5 and 6 for all other fans: on several blocks, with loads, prescribed motion or obstacles
    report += sweep_bordering(step);
    // row 5 for all fans that contacts couple: the impulses of contacts, and the rates of free obstacles
    if (contacts_) contacts_->solve(step, splits_, workspaces_, report);
    // row 4
    release(step, report);
    // row 3 for bonded fans whose contacts reach beyond them
    if (contacts_) advance_bonded_contacts(step, report);
    // rows 5 and 6 for the fans that split in this step; with contacts for all
    report += advance_remaining_split_fans(step);
    // the motion of obstacles; energies and works
    obstacles_.finish(step, contacts_ ? &*contacts_ : nullptr, report);
    if (contacts_) contacts_->finish(step, report);
    report += account_loads(step);
    if (model_.large_rotation) account_rotation(step, report);
    absorbing_.account(step, report);
    if (report.released > 0) order_split_fans(model_, end, unordered_);  // a block reads contiguous ones
    return report;
}

/// One point is asked for its frame up to five times in a step.
std::span<const Rotation> ExplicitScheme::find_frames(const State& begin) {
    if (!model_.large_rotation) return {};
    reserve_capacity(model_.fan_points.size(), frames_);
    frames_.assign(begin.points.size(), {});
    const std::ptrdiff_t n = std::ssize(begin.split_fans), block = 8 * split_fans_in_a_block;
    for_blocks((n + block - 1) / block, [&](std::ptrdiff_t b) {
        for (std::ptrdiff_t rank = b * block; rank < std::min(n, (b + 1) * block); ++rank) {
            Rotation* frame = frames_.data() + begin.first_point[rank];
            for (const FanPoint& point : model_.points(model_.fans[begin.split_fans[rank]])) {
                if (!begin.has_retired(point.point)) *frame = point_frame(model_, begin, point);
                ++frame;
            }
        }
    });
    return frames_;
}

template <class Corner>
struct ExplicitScheme::Sweep {
    const BlockFans<Corner>& block;
    const Vec2* on_corner;  // [N]
    Vec2* kept;             // [N] per corner, where those of fans that split are kept; null: all are
    const ExplicitStep& step;
    NodeMotion& nodes;
    ThreadWorkspace& work;
    StepReport& report;
};

/// The motion of fans, a few at a time: the forces on them, a closer look where it is needed, and the others move.
template <class Corner>
void ExplicitScheme::move_fans(const Sweep<Corner>& sweep) {
    using Fan = typename BlockFans<Corner>::BlockFan;
    constexpr std::size_t fan_batch = 64;
    std::array<Vec2, fan_batch> force;  // [N] on the fans
    std::array<std::uint8_t, fan_batch> needs_decision;
    std::array<Fan, fan_batch> free;
    const BlockFans<Corner>& block = sweep.block;
    const Corner* corner = block.corners.data();
    for (std::size_t first = 0; first < block.fans.size(); first += fan_batch) {
        const auto fans = std::span(block.fans).subspan(first, std::min(fan_batch, block.fans.size() - first));
        const Corner* of_fan = corner;
        std::uint8_t any_closer = 0;
        for (std::size_t i = 0; i < fans.size(); ++i) {
            const Index f = fans[i].fan;
            needs_decision[i] =
                fan_is_candidate_[f] | splits_[f] | (sweep.step.begin.split_rank[f] >= 0) | !fans[i].is_free;
            any_closer |= needs_decision[i];
            if constexpr (std::is_same_v<Corner, Index>)  // the forces on all corners may be more than the cache holds
                for (Index k = 0; k < 2 * block.group; ++k)
                    __builtin_prefetch(&sweep.on_corner[corner[block.look_ahead - block.group + k]]);
            Pair sum{};
            for (const Corner* end = corner + block.n_places(fans[i]); corner < end; corner += block.group)
                sum = sum + load(sweep.on_corner[corner[0]]) + load(sweep.on_corner[corner[1]]) +
                      load(sweep.on_corner[corner[2]]) + load(sweep.on_corner[corner[3]]);
            store(sum, force[i]);
        }
        if (!any_closer) {
            sweep.nodes.move_freely(fans, force.data());
            continue;
        }
        std::size_t n_free = 0;
        const auto move_free = [&] {
            sweep.nodes.move_freely(std::span<const Fan>(free.data(), n_free), force.data());
            n_free = 0;
        };
        for (std::size_t i = 0; i < fans.size(); of_fan += block.n_places(fans[i]), ++i) {
            if (i + prefetch_distance < fans.size() && fan_is_candidate_[fans[i + prefetch_distance].fan]) {
                const InscribedCircle* circle = block.circles.data() + (of_fan - block.corners.data());
                __builtin_prefetch(circle + block.look_ahead);
                __builtin_prefetch(circle + block.look_ahead + 4);  // the next cache line
            }
            if (!fans[i].is_free) move_free();
            if (!needs_decision[i] || decide_and_move(sweep, fans[i], of_fan, force[i]))
                free[n_free] = fans[i], force[n_free++] = force[i];
        }
        move_free();
    }
}

/// Decides how a fan moves, and moves it. True: it is left to the caller, since it moves as one and nothing but `force`
/// [N] acts on it. False: it has been moved here, or is moved later since it splits or contacts couple it.
template <class Corner>
bool ExplicitScheme::decide_and_move(const Sweep<Corner>& sweep, const typename BlockFans<Corner>::BlockFan& fan,
                                     const Corner* corner, const Vec2& force) {
    const auto& [block, on_corner, kept, step, nodes, work, report] = sweep;
    const State& begin = step.begin;
    const Index f = fan.fan;
    if (splits_[f]) return false;
    const auto keep = [&, corner = corner, kept = kept, on_corner = on_corner] {
        for (Index k = 0; kept && k < fan.n_corners; ++k) kept[corner[k]] = on_corner[corner[k]];
    };
    if (const Index rank = begin.split_rank[f]; rank >= 0) {
        keep();
        if (fans_are_independent()) solver_.advance(rank, step, work.split, report);
        return false;
    }
    const InscribedCircle* circles = block.circles.data() + (corner - block.corners.data());
    const auto is_held = [&, &step = step, &work = work, &report = report](const auto& force_on, const Vec2& total) {
        return !fan_is_candidate_[f] ||
               is_bonded(f, {circles, static_cast<std::size_t>(fan.n_corners)}, force_on, total, step, work, report);
    };
    const auto force_on = [&, on_corner = on_corner](Index k) -> const Vec2& { return on_corner[corner[k]]; };
    if (fan.is_free) {
        if (is_held(force_on, force)) return true;
        keep();
        return false;
    }
    const auto corners = model_.corners(model_.fans[f]);
    const auto dashpots = absorbing_.of_fan(f);
    if (!dashpots.empty()) {  // they are forces at the mean velocity that the fan has as one
        const Vec2 after = velocity_as_one(f, force, Vec2::Zero(), step), mean = 0.5 * (begin.velocity[f] + after);
        const auto resisted = [&](Index k) -> Vec2 { return force_on(k) + dashpot_force(corners[k], dashpots, mean); };
        if (!is_held(resisted, force + absorbing_.force_on_fan(f, mean))) return false;
    } else if (!is_held(force_on, force)) {
        return false;
    }
    move_bonded(f, force, Vec2::Zero(), step, nodes, report);
    return false;
}

/// Forces of the triangles of a block and loads on their corners, and the motion of the fans inside.
StepReport ExplicitScheme::sweep_blocks(const ExplicitStep& step) {
    return sum_over_blocks(blocks_.size(), 1, partial_, [&](std::size_t b, std::size_t, StepReport& report) {
        const MeshBlock& block = blocks_[b];
        ThreadWorkspace& work = workspaces_[omp_get_thread_num()];
        const bool is_viscous = !no_viscous_stress_.empty();
        ViscousStep viscous = viscous_step(step);
        elastic_energy_[b] =
            forces_.evaluate(block.first, block.last, step.begin.displacement, step.begin.node_of_corner,
                             work.force.data(), fan_is_candidate_, is_viscous ? &viscous : nullptr);
        if (is_viscous) account_viscosity(viscous, report);
        if (thermal_) elastic_energy_[b] += add_thermal_forces(block, step, work.force.data(), report);
        Vec2* kept = &corner_force_[model_.mesh.corners_per_triangle() * block.first];
        for (const MeshBlock::Corner c : block.kept) kept[c] = work.force[c];
        for (Index i = block.first_load; i < block.last_load; ++i) {
            const CornerLoad& load = model_.corner_loads[i];
            Vec2& force = corner_force_[load.corner];
            store(knap::load(force) + amplitude_[load.history] * force_inlined(model_, load, step.begin), force);
        }
        NodeMotion nodes(step);
        move_fans<MeshBlock::Corner>({.block = block.inner,
                                      .on_corner = work.force.data(),
                                      .kept = kept,
                                      .step = step,
                                      .nodes = nodes,
                                      .work = work,
                                      .report = report});
        nodes.add_to(report);
    });
}

/// NodeMotion takes half of f . u_n+1 off the strain energy, of which only f . Delta belongs there; with large
/// rotations it counts the work as a defect of U.
void ExplicitScheme::account_viscosity(const ViscousStep& viscous, StepReport& report) const {
    report.bulk_viscosity_work += viscous.work;
    report.strain += 0.5 * viscous.unmoved;
    if (model_.large_rotation) report.rotation_work -= viscous.work;
}

/// With the stress sigma_n, the strain e_n and the strains before and after the step, the energy of the leapfrog is
///
///     E = 1/2 v' M v + 1/2 int sigma_n : (eps_n+1 - e_n+1),     W_th = -1/2 int sigma_n : (e_n+1 - e_n-1)
///
/// with large rotations 1/2 v' M v + U_n - 1/2 f_n . (u_n+1 - u_n) - 1/2 int S_n : (e_n+1 - e_n), and the trapezoid of
/// the rotation work has the term 1/2 int (S_n-1 + S_n) : (e_n - e_n-1). Returns what the strains add to U_n [J].
double ExplicitScheme::add_thermal_forces(const MeshBlock& block, const ExplicitStep& step, Vec2* force,
                                          StepReport& report) {
    const State& begin = step.begin;
    const auto &now = begin.temperature, &after = step.end.temperature,
               &before = begin.last_step == 0 ? now : begin.temperature_before;
    double of_end = thermal_->evaluate(block.first, block.last, begin.displacement, begin.node_of_corner, now->strain,
                                       after->strain, force, fan_is_candidate_);
    const auto product = [&](const SharedTemperatures& other) {
        return thermal_->product(block.first, block.last, begin.displacement, begin.node_of_corner, now->strain,
                                 other->strain);
    };
    if (!no_viscous_stress_.empty()) of_end = product(after);  // the forces have a viscous part, which is no sigma_n
    if (before != after) report.thermal_work -= 0.5 * (of_end - product(before));
    if (!model_.large_rotation) {
        report.strain -= 0.5 * of_end;
        return 0;
    }
    if (now != after) report.strain -= 0.5 * (of_end - product(now));
    if (before != now) report.rotation_work += 0.5 * (product(now) - product(before));
    return thermal_->energy(block.first, block.last, begin.displacement, begin.node_of_corner, now->strain);
}

/// A fan with a contact that concerns it alone is solved as a split one, in which the fan solver finds what sticks; of
/// the others the impulses of the contacts decide.
void ExplicitScheme::find_obstacle_contacts(const ExplicitStep& step) {
    obstacles_.begin(step);
    for (const ObstacleContact& contact : obstacle_step_.contacts.all())
        if (solver_.is_within_fan(contact)) splits_[contact.fan] = step.begin.split_rank[contact.fan] < 0;
    contacts_->begin_obstacles(step);
    for (const Index f : contacts_->fans()) fan_is_candidate_[f] = 1;
}

void ExplicitScheme::add_crack_forces(double sign) {
    for (const CornerLoad& load : crack_forces_.found())
        corner_force_[load.corner] += sign * amplitude_[load.history] * load.force;
}

/// The pressures of injected fluids, which so far are those of the last step. Only split fans answer to them, and
/// without contacts that reach beyond them each by itself.
void ExplicitScheme::settle_fluids(const ExplicitStep& step, StepReport& report) {
    const State& begin = step.begin;
    std::vector<double> pressure = crack_forces_.injected_pressures();
    std::vector<double> volume(pressure.size());
    std::vector<std::vector<Index>> fans(pressure.size());
    const auto move = [&](std::size_t fluid) {
        for_blocks(std::ssize(fans[fluid]), [&](std::ptrdiff_t i) {
            const Index f = fans[fluid][i];
            VertexSolver::Workspace& work = workspaces_[omp_get_thread_num()].split;
            solver_.solve(f, step, work);
            const auto corners = model_.corners(model_.fans[f]);
            for (std::size_t k = 0; k < corners.size(); ++k) corner_rate_[corners[k]] = work.fan.result.velocity[k];
        });
    };
    for (const std::size_t fluid : crack_forces_.injected_fluids()) {
        volume[fluid] = crack_forces_.volume(fluid, begin);
        for (const Index point : crack_forces_.reached_points(fluid)) {
            const Index f = model_.fan_of_corner[model_.fan_points[model_.fan_point_of[point]].corner()];
            if (begin.split_rank[f] >= 0) fans[fluid].push_back(f);
        }
        std::ranges::sort(fans[fluid]);
        fans[fluid].erase(std::ranges::unique(fans[fluid]).begin(), fans[fluid].end());
        move(fluid);
    }
    const FluidStep fluids{.balance =
                               [&](std::size_t fluid) {
                                   const double rate = crack_forces_.volume_rate(
                                       fluid, begin, [&](Index corner) -> const Vec2& { return corner_rate_[corner]; });
                                   return crack_forces_.balance(fluid, volume[fluid] + step.drift_time * rate,
                                                                begin.time + step.drift_time);
                               },
                           .compliance =
                               [&](std::size_t fluid) {
                                   return crack_forces_.storage(fluid) + step.drift_time * step.kick_time *
                                                                             step.mobility *
                                                                             crack_forces_.mobility(fluid, begin);
                               },
                           .solve_with =
                               [&](std::size_t fluid, double p) {
                                   add_crack_forces(-1);
                                   pressure[fluid] = p;
                                   crack_forces_.find_there(begin, begin.time, &pressure);
                                   add_crack_forces(1);
                                   move(fluid);
                                   return true;
                               }};
    if (const auto unsettled = unsettled_fluid(crack_forces_, fluids))
        report.reject(Rejection::not_converged, crack_forces_.place(*unsettled, begin));
    step.end.fluid_pressure = std::move(pressure);
}

/// The motion of the fans across borders of blocks, and of those with loads, prescribed motion and obstacles.
StepReport ExplicitScheme::sweep_bordering(const ExplicitStep& step) {
    return sum_over_blocks(blocks_.size(), 1, partial_, [&](std::size_t b, std::size_t, StepReport& report) {
        NodeMotion nodes(step);
        move_fans<Index>({.block = blocks_[b].bordering,
                          .on_corner = corner_force_.data(),
                          .kept = nullptr,
                          .step = step,
                          .nodes = nodes,
                          .work = workspaces_[omp_get_thread_num()],
                          .report = report});
        nodes.add_to(report);
    });
}

/// Tests a candidate of the stress criterion, by the last proof, the inscribed circles and then by BondCheck. `force`
/// [N]: on the whole fan.
template <class Force>
bool ExplicitScheme::is_bonded(Index f, std::span<const InscribedCircle> circles, const Force& force_on,
                               const Vec2& force, const ExplicitStep& step, ThreadWorkspace& work, StepReport& report) {
    fan_is_candidate_[f] = 0;
    if (contacts_ && contacts_->touches(f)) return false;  // their impulses decide
    ++report.bond_checks;
    if (incubation_.concerns(f)) {
        work.find_required(model_, f, step.begin, mass_, force_on, force);
        const double U = work.bond_check.utilisation(f, step.begin, work.required, 1);
        const bool held = incubation_.is_held(f, U, step.begin.time, step.end.incubation[f]);
        splits_[f] = !held;
        return held;
    }
    if (bond_proofs_.hold(f, force_on)) return true;
    if (within_inscribed_circles(circles.data(), static_cast<Index>(circles.size()), force_on, force)) return true;
    const bool bonded = work.is_bonded(model_, f, step.begin, mass_, force_on, force);
    if (bonded) bond_proofs_.keep(f, force_on, work.bond_check.margin(f, step.begin, 1));
    splits_[f] = !bonded;
    return bonded;
}

/// [m/s] v+ of a bonded fan.
Vec2 ExplicitScheme::velocity_as_one(Index f, const Vec2& force, const Vec2& contact, const ExplicitStep& step) const {
    const double mass = model_.fans[f].mass;
    Vec2 velocity = step.damped(f) + step.mobility * step.kick_time / mass * force;
    if (!contact.isZero(0)) velocity += step.mobility / mass * contact;
    if (const PrescribedMotion* motion = drive_of(f)) {
        const Vec2 given = step.prescribed_velocity(model_, *motion, step.begin.displacement[f]);
        for (int k = 0; k < 2; ++k)
            if (motion->component[k]) velocity[k] = given[k];
    }
    if (absorbing_.of_fan(f).empty()) return velocity;
    return absorbing_.end_velocity(f, step, step.kick_time * force + contact, velocity);
}

/// Moves the node of a bonded fan under a force [N] and the impulse [N s] of contacts.
void ExplicitScheme::move_bonded(Index f, const Vec2& force, const Vec2& contact, const ExplicitStep& step,
                                 NodeMotion& nodes, StepReport& report) const {
    const double mass = model_.fans[f].mass;
    const Vec2 velocity = velocity_as_one(f, force, contact, step);
    nodes.move(f, f, mass, force, velocity);
    if (const PrescribedMotion* motion = drive_of(f)) {
        const Index number = model_.prescribed_of_corner[model_.corners(model_.fans[f])[0]];
        const Vec2 before = step.begin.velocity[f], mean = 0.5 * (before + velocity);
        const Vec2 impulse = step.impulse(mass, before, velocity) -
                             step.kick_time * (force + absorbing_.force_on_fan(f, mean)) - contact;
        for (int k = 0; k < 2; ++k)
            if (motion->component[k]) step.drive(number, k, impulse[k], mean[k], report);
    }
}

void ExplicitScheme::release(const ExplicitStep& step, StepReport& report) {
    const std::uint8_t *first = splits_.data(), *last = first + splits_.size();
    while (const void* found = first < last ? std::memchr(first, 1, last - first) : nullptr) {
        const Index f = static_cast<Index>(static_cast<const std::uint8_t*>(found) - splits_.data());
        first = splits_.data() + f + 1;
        splits_[f] = 0;
        step.end.displacement[f] = step.begin.displacement[f];
        split(model_, f, step.end);
        if (model_.may_become_finer() && model_.too_coarse[f])
            report.reject(Rejection::too_coarse, model_.mesh.corner(model_.corners(model_.fans[f])[0]));
        ++report.released;
        if (!incubation_.concerns(f)) continue;
        Incubation& memory = step.end.incubation[f];
        memory.factor = std::max(1.0, memory.utilisation);
        report.largest_strength_factor = std::max(report.largest_strength_factor, memory.factor);
    }
}

/// The motion of the bonded fans with contacts that stay bonded.
void ExplicitScheme::advance_bonded_contacts(const ExplicitStep& step, StepReport& report) {
    NodeMotion nodes(step);
    for (const Index f : contacts_->fans()) {
        if (step.end.split_rank[f] >= 0) continue;
        const auto corners = model_.corners(model_.fans[f]);
        Vec2 force = Vec2::Zero(), impulse = Vec2::Zero();
        for (const Index c : corners) force += corner_force_[c], impulse += corner_impulse_[c];
        move_bonded(f, force, impulse, step, nodes, report);
    }
    nodes.add_to(report);
}

/// The split fans that no sweep has moved: those that split in this step, and all if contacts couple fans.
StepReport ExplicitScheme::advance_remaining_split_fans(const ExplicitStep& step) {
    const std::size_t done = fans_are_independent() ? step.begin.split_fans.size() : 0;
    const auto advance = [&](std::size_t first, std::size_t last, StepReport& report) {
        for (auto rank = static_cast<Index>(done + first); rank < static_cast<Index>(done + last); ++rank)
            solver_.advance(rank, step, workspaces_[omp_get_thread_num()].split, report,
                            contacts_ ? contacts_->motion_of(rank, step) : nullptr);
    };
    return sum_over_blocks(step.end.split_fans.size() - done, split_fans_in_a_block, partial_, advance);
}

/// Works of the loads, and their part in the energies that the report has of all forces; by the threads that moved
/// these corners, since a load on a long boundary has many.
StepReport ExplicitScheme::account_loads(const ExplicitStep& step) {
    StepReport of_cracks;
    account_loads(crack_forces_.found(), step, of_cracks);
    if (model_.corner_loads.empty()) return of_cracks;
    return of_cracks +=
           sum_over_blocks(blocks_.size(), 1, partial_, [&](std::size_t b, std::size_t, StepReport& report) {
               const Index first = blocks_[b].first_load, last = blocks_[b].last_load;
               account_loads(std::span(model_.corner_loads).subspan(first, last - first), step, report);
           });
}

/// Adds to a report without works of loads; the sums stay in registers.
void ExplicitScheme::account_loads(std::span<const CornerLoad> loads, const ExplicitStep& step,
                                   StepReport& report) const {
    const State &begin = step.begin, &end = step.end;
    const double half_drift = 0.5 * step.drift_time, half_last = 0.5 * begin.last_step, change = step.change_time();
    double external = 0, excavation = 0, strain = 0, rotation = 0, step_change = 0;
    for (const CornerLoad& load : loads) {
        const Pair force = amplitude_[load.history] * force_inlined(model_, load, begin);
        const Index from = begin.node_of_corner[load.corner], to = end.node_of_corner[load.corner];
        const Pair before = knap::load(begin.velocity[from]), after = knap::load(end.velocity[to]);
        (load.is_release ? excavation : external) += step.kick_time * dot(force, 0.5 * (before + after));
        if (model_.large_rotation) strain += half_drift * dot(force, after), rotation -= half_last * dot(force, before);
        else strain += 0.5 * dot(force, knap::load(end.displacement[to]));
        if (change != 0) step_change += change * dot(force, after - before);
    }
    report.external_work += external, report.excavation_work += excavation;
    report.strain += strain, report.rotation_work += rotation, report.step_change_work += step_change;
}

/// U_n and the terms of the step before complete the energies of NodeMotion. The first step has none before.
void ExplicitScheme::account_rotation(const ExplicitStep& step, StepReport& report) const {
    const double energy = std::accumulate(elastic_energy_.begin(), elastic_energy_.end(), 0.0);
    step.end.elastic_energy = energy;
    step.end.elastic_work = -2 * report.strain;  // f_n . Delta_n+1/2
    report.strain += energy;
    report.rotation_work += energy - step.begin.elastic_energy + 0.5 * step.begin.elastic_work;
    if (step.begin.last_step == 0) report.rotation_work = 0;
}

}  // namespace knap
