#include "stepper/static_preload.hpp"

#include "base/error.hpp"
#include "stepper/implicit/implicit_scheme.hpp"
#include "stepper/step_control.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace knap {
namespace {

// The step in passages of a wave through the body. It grows, since a slender body that is held needs a large one, until
// it is the largest or the solver refuses: what moves far in a step, and a body that is not held moves by the square of
// it, takes the digits that the solver needs. Nearer to equilibrium less moves, so it is tried again after some steps.
constexpr double first_step = 1, last_step = 1e4, growth = 10;
constexpr int max_steps = 200;
constexpr double in_equilibrium = 1e-12;  // what inertia carries, over the loads
constexpr double good_enough = 1e-9;      // where rounding lets it come no nearer
constexpr double astray = 3;     // a large step that leaves so much more of it jammed on the way, with friction
constexpr double stands = 0.95;  // a step that leaves more than that of it changes nothing

/// The model at one moment for ever, without impacts.
Model frozen(const Model& model, double time) {
    Model still = model;
    for (TimeFunction& history : still.histories) history = {.time = {0}, .value = {history(time)}};
    for (PrescribedMotion& motion : still.prescribed)
        for (int k = 0; k < 2; ++k)
            if (!motion.is_displacement[k]) motion.value[k] = 0;
    for (Obstacle& obstacle : still.obstacles) {
        for (Drive& drive : obstacle.drive) {
            drive.history = {.time = {0}, .value = {drive.history(time)}};
            if (drive.kind == Drive::Kind::velocity) drive = {};  // held where it is
        }
        for (ObstacleForce& force : obstacle.forces) force.history = {.time = {0}, .value = {force.history(time)}};
        obstacle.contact.restitution = 0;
    }
    for (CohesiveLaw& law : still.laws) law.restitution = 0;  // an impact with restitution waits a step at the wall
    return still;
}

/// [s] that a dilatational wave needs across the body.
double passage_time(const Model& model) {
    Vec2 low = model.mesh.vertices.front(), high = low;
    for (const Vec2& x : model.mesh.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
    double speed = 0;
    for (const Elastic& material : model.materials) speed = std::max(speed, material.dilatational_speed(model.plane));
    return speed > 0 ? (high - low).norm() / speed : 1;
}

struct Inertia {
    double carried = 0;  // [N] sum over all corners
    Index most = 0;      // the corner that carries most for its mass
};

Inertia inertia_of(const Model& model, const State& state, double h) {
    Inertia inertia;
    double fastest = -1;
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const Index which = model.prescribed_of_corner[c];
        Vec2 velocity = state.velocity[state.node_of_corner[c]];
        for (int k = 0; k < 2; ++k)
            if (which >= 0 && model.prescribed[which].component[k]) velocity[k] = 0;
        inertia.carried += model.corner_mass[c] * velocity.norm() / h;
        if (velocity.norm() > fastest) fastest = velocity.norm(), inertia.most = c;
    }
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        for (int k = 0; k < 2; ++k)
            if (model.obstacles[o].is_free(k))
                inertia.carried += model.obstacles[o].mass * std::abs(state.obstacles[o].velocity[k]) / h;
    return inertia;
}

/// [N] loads and reactions together.
double load_of(const Model& model, const State& state) {
    double load = 0;
    for (const CornerLoad& at : model.corner_loads) load += std::abs(model.histories[at.history](0)) * at.force.norm();
    for (const Vec2& reaction : state.reaction) load += reaction.norm();
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        load += state.obstacles[o].reaction.head<2>().norm() + force_at(model.obstacles[o], 0).head<2>().norm();
    return load;
}

[[noreturn]] void fail(const State& start, const char* what, const Vec2& where) {
    char text[400];
    std::snprintf(text, sizeof text, "no equilibrium under the loads at t = %.6g s: %s, at (%.6g, %.6g) m", start.time,
                  what, where.x(), where.y());
    throw SimulationError(text);
}

}  // namespace

void load_statically(const Model& model, const SchemeOptions& options, State& start) {
    const Model still = frozen(model, start.time);
    // which of several solutions a softening step has is no question here: nothing may soften
    ImplicitScheme scheme(
        still, {.bulk = BulkScheme::implicit_theta, .theta = 1, .mass = options.mass, .respect_assumption_1 = false});
    const double passage = passage_time(still);
    State now = start, next;
    const auto rest = [](State& state) {
        std::fill(state.velocity.begin(), state.velocity.end(), Vec2::Zero());
        for (ObstacleState& obstacle : state.obstacles) obstacle.velocity.setZero();
        state.rate.clear();
    };
    rest(now);
    double h = first_step * passage, part = 1;  // of the loads, carried by inertia
    int patience = 2, wait = 0;                 // steps without growth after a rejection
    for (int step = 0; part > in_equilibrium; ++step) {
        const StepReport report = scheme.step(now, h, next);
        const bool rejected = report.rejection != Rejection::none, smallest = h < 2 * first_step * passage;
        if (rejected && smallest) fail(start, "contact and friction do not settle", report.where);
        const Inertia inertia = rejected ? Inertia{} : inertia_of(still, next, h);
        const double load = rejected ? 0 : load_of(still, next), before = part,
                     after = load > 0 ? inertia.carried / load : 0;
        if (rejected || (after > astray * before && !smallest)) {
            if (step == max_steps) fail(start, "contact and friction do not settle", report.where);
            h /= growth;
            wait = patience *= 2;
            continue;
        }
        if (report.softened > 0)
            fail(start, "the preload is more than the interfaces hold", place_of_damage(still, now, next));
        part = after;
        std::swap(now, next);
        rest(now);
        const bool stalled = part > stands * before;
        if (stalled && part <= good_enough) break;
        const double largest = wait > 0 ? h : last_step * passage;
        if ((stalled && h >= largest) || step == max_steps)
            fail(start, "nothing holds the body, it would move away", still.mesh.corner(inertia.most));
        h = std::min(growth * h, largest);
        wait = std::max(0, wait - 1);
    }
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        now.velocity[now.node_of_corner[c]] = start.velocity[start.node_of_corner[c]];
    for (std::size_t o = 0; o < now.obstacles.size(); ++o) now.obstacles[o].velocity = start.obstacles[o].velocity;
    start = std::move(now);
}

}  // namespace knap
