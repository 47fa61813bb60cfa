#include "stepper/moreau_jean.hpp"

#include "base/error.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/common/law_change.hpp"
#include "stepper/explicit/explicit_scheme.hpp"
#include "stepper/implicit/implicit_scheme.hpp"
#include "stepper/step_control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace knap {
namespace {

/// The implicit scheme and its equilibrium are linear in the displacement.
void need_small_rotations(const Model& model) {
    if (model.large_rotation) throw UserError("large-rotation", "large rotations need the explicit bulk from rest");
}

std::unique_ptr<StepScheme> make_scheme(const Model& model, const SchemeOptions& options) {
    if (options.bulk == BulkScheme::explicit_lumped) return std::make_unique<ExplicitScheme>(model, options);
    need_small_rotations(model);
    return std::make_unique<ImplicitScheme>(model, options);
}

// Start in equilibrium: implicit steps with theta = 1, each from rest at the displacement of the previous one,
//
//     (M/h^2 + K) (u_new - u_old) = F - K u_old + reactions.
//
// A step divides the force that inertia carries, M (u_new - u_old)/h^2, by 1 + (omega h)^2; this force is the error of
// the equilibrium. A body without sufficient supports shows by a force that stays.
//
// The step size, in passages of a wave through the body, grows until it is the largest or the solver rejects it:
// a slender body on few supports needs a large one, but what moves far in a step, and a free body moves with its
// square, takes the digits that the solver needs. Nearer to equilibrium less moves, so it is tried again after some
// steps.
constexpr double first_step = 1, last_step = 1e4, growth = 10;
constexpr int max_steps = 200;
constexpr double in_equilibrium = 1e-12;  // force carried by inertia, over the loads
constexpr double good_enough = 1e-9;      // where rounding prevents less
constexpr double jammed = 3;    // a large step that increases this force by more has jammed the body, with friction
constexpr double stays = 0.95;  // a step that leaves more of it changes nothing

/// The model at one moment for ever, without restitution, which would delay a contact by a step.
Model frozen(const Model& model, double time) {
    const auto freeze = [&](TimeFunction& history) { history = {.time = {0}, .value = {history(time)}}; };
    Model still = model;
    std::ranges::for_each(still.histories, freeze);
    for (PrescribedMotion& motion : still.prescribed)
        for (int k = 0; k < 2; ++k)
            if (!motion.is_displacement[k]) motion.value[k] = 0;
    for (Obstacle& obstacle : still.obstacles) {
        for (Drive& drive : obstacle.drive) {
            freeze(drive.history);
            if (drive.kind == Drive::Kind::velocity) drive = {};  // fixed where it is
        }
        for (ObstacleForce& force : obstacle.forces) freeze(force.history);
        obstacle.contact.restitution = 0;
    }
    for (CohesiveLaw& law : still.laws) law.restitution = 0;
    return still;
}

/// [s] Passage of a dilatational wave across the body.
double passage_time(const Model& model) {
    double speed = 0;
    for (const Elastic& material : model.materials) speed = std::max(speed, material.dilatational_speed(model.plane));
    return speed > 0 ? bounding_box(model.mesh.vertices).extent().norm() / speed : 1;
}

void stop(State& state) {
    std::ranges::fill(state.velocity, Vec2::Zero());
    for (ObstacleState& obstacle : state.obstacles) obstacle.velocity.setZero();
    state.rate.clear();
}

struct Inertia {
    double force = 0;   // [N] carried by inertia, sum over all corners
    Index fastest = 0;  // corner
};

Inertia inertia_of(const Model& model, const State& state, double h) {
    Inertia inertia;
    double largest = -1;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Index motion = model.prescribed_of_corner[c];
        Vec2 velocity = state.velocity[state.node_of_corner[c]];
        for (int k = 0; k < 2; ++k)
            if (motion >= 0 && model.prescribed[motion].component[k]) velocity[k] = 0;
        inertia.force += model.corner_mass[c] * velocity.norm() / h;
        if (velocity.norm() > largest) largest = velocity.norm(), inertia.fastest = c;
    }
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        for (int k = 0; k < 2; ++k)
            if (model.obstacles[o].is_free(k))
                inertia.force += model.obstacles[o].mass * std::abs(state.obstacles[o].velocity[k]) / h;
    return inertia;
}

/// [N] Sum of the magnitudes of all loads and reactions.
double load_of(const Model& model, const State& state) {
    double load = 0;
    for (const CornerLoad& at : model.corner_loads) load += std::abs(model.histories[at.history](0)) * at.force.norm();
    CrackForces in_cracks(model);
    for (const CornerLoad& at : in_cracks.find(state))
        load += std::abs(model.histories[at.history](0)) * at.force.norm();
    for (const Vec2& reaction : state.reaction) load += reaction.norm();
    if (state.temperature) {
        std::vector<Vec2> force(model.mesh.n_corners(), Vec2::Zero());
        ThermalStress(model.mesh, model.materials, model.plane, model.thickness)
            .add_forces(state.temperature->strain, 1, force);
        for (const Vec2& of_corner : force) load += of_corner.norm();
    }
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        load += state.obstacles[o].reaction.head<2>().norm() + force_at(model.obstacles[o], 0).head<2>().norm();
    return load;
}

[[noreturn]] void fail(const char* format, auto... values) {
    char text[400];
    std::snprintf(text, sizeof text, format, values...);
    throw SimulationError(text);
}

}  // namespace

MoreauJean::MoreauJean(const Model& model, const SchemeOptions& options)
    : model_(model), options_(options), scheme_(make_scheme(model, options)) {
    if (model.heat) heat_.emplace(model, options.bulk == BulkScheme::implicit_theta);
}

StepReport MoreauJean::step(const State& begin, double h, State& end) {
    if (heat_) end.temperature = heat_->after(begin, h);
    StepReport report = scheme_->step(begin, h, end);
    if (heat_) end.temperature_before = begin.temperature;
    if (model_.laws_follow_temperature) account_law_change(model_, begin, report);
    if (report.rejection != Rejection::none) return report;
    end.time = begin.time + h;
    end.last_step = h;
    end.n_steps = begin.n_steps + 1;
    if (std::isfinite(report.kinetic + report.strain)) return report;
    const Vec2 where = place_of_largest_speed(model_, end);
    fail(
        "the motion is no longer finite at t = %.9g s (step %lld) at (x, y) = (%.6g, %.6g) m: the step is probably too "
        "large, or a load or velocity absurd; try a smaller time.step, and look at the units of the loads",
        end.time, static_cast<long long>(end.n_steps), where.x(), where.y());
}

void MoreauJean::start_in_equilibrium(State& start) const {
    const auto no_equilibrium = [&](const char* reason, const Vec2& where) {
        fail("no equilibrium under the loads at t = %.6g s: %s, at (%.6g, %.6g) m", start.time, reason, where.x(),
             where.y());
    };
    need_small_rotations(model_);
    const Model still = frozen(model_, start.time);
    // nothing may soften, so Assumption 1 does not matter
    ImplicitScheme scheme(
        still, {.bulk = BulkScheme::implicit_theta, .theta = 1, .mass = options_.mass, .respect_assumption_1 = false});
    const double passage = passage_time(still);
    State now = start, next;
    stop(now);
    fit_laws(still, now);
    double h = first_step * passage, part = 1;  // of the loads, carried by inertia
    int patience = 2, wait = 0;                 // steps without growth after a rejection
    for (int step = 0; part > in_equilibrium; ++step) {
        next.temperature = now.temperature;
        const StepReport report = scheme.step(now, h, next);
        const bool rejected = report.rejection != Rejection::none, smallest = h < 2 * first_step * passage;
        const Inertia inertia = rejected ? Inertia{} : inertia_of(still, next, h);
        const double load = rejected ? 0 : load_of(still, next), after = load > 0 ? inertia.force / load : 0;
        if (rejected || (after > jammed * part && !smallest)) {
            if ((rejected && smallest) || step == max_steps)
                no_equilibrium("contact and friction do not settle", report.where);
            h /= growth;
            wait = patience *= 2;
            continue;
        }
        if (report.softened > 0)
            no_equilibrium("the preload is more than the interfaces hold", place_of_damage(still, now, next));
        const bool stalled = after > stays * part;
        part = after;
        std::swap(now, next);
        stop(now);
        if (stalled && part <= good_enough) break;
        const double largest = wait > 0 ? h : last_step * passage;
        if ((stalled && h >= largest) || step == max_steps)
            no_equilibrium("nothing holds the body, it would move away", still.mesh.corner(inertia.fastest));
        h = std::min(growth * h, largest);
        wait = std::max(0, wait - 1);
    }
    for (Index c = 0; c < model_.mesh.n_corners(); ++c)
        now.velocity[now.node_of_corner[c]] = start.velocity[start.node_of_corner[c]];
    for (std::size_t o = 0; o < now.obstacles.size(); ++o) now.obstacles[o].velocity = start.obstacles[o].velocity;
    now.temperature = start.temperature, now.temperature_before = start.temperature_before;
    for (Incubation& memory : now.incubation) memory.time = -std::numeric_limits<double>::infinity();
    start = std::move(now);
}

}  // namespace knap
