#include "stepper/equilibrium.hpp"

#include "base/display_unit.hpp"
#include "base/error.hpp"
#include "base/formatted.hpp"
#include "base/union_find.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "stepper/implicit/implicit_scheme.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

namespace knap {
namespace {

// Implicit steps with theta = 1, each from rest at the displacement of the previous one,
//
//     (M/h^2 + K) (u_new - u_old) = F - K u_old + reactions.
//
// A step divides the force that inertia carries, M (u_new - u_old)/h^2, by 1 + (omega h)^2; this force is the error of
// the equilibrium. A body without sufficient supports shows by a force that stays.
//
// The step size, in passages of a wave through the body, grows until it is the largest or the solver rejects it:
// a slender body on few supports needs a large one, but what moves far in a step, and a free body moves with its
// square, takes the digits that the solver needs. Nearer to equilibrium less moves, so it is tried again after some
// steps. A piece that moves as a rigid body, and in the next size would move too far for its contacts, gets another
// step of this size: on a slope that does not hold it the same force stays, and the search ends before large steps are
// tried, which slide and cost a hundred times as much.
constexpr double first_step = 1, last_step = 1e4, growth = 10;
constexpr int max_steps = 200;
constexpr double accepted_residual = 1e-9;  // where rounding prevents less
constexpr double jammed = 3;  // a large step that increases this force by more has jammed the body, with friction
constexpr double follows_body = 10, closes_gap = 0.05;  // [-] of displacements; of the half width of an obstacle
constexpr double stays = 0.95;                          // a step that leaves more of it changes nothing
constexpr double too_far = 0.05;                      // [-] of the longest edge: more than contacts may move in a step
constexpr double slides = 1 - 1 / (growth * growth);  // as `stays`, of such a piece: a spring that holds it in this way
                                                      // leaves less

/// The model at one moment for ever, without restitution, which would delay a contact by a step.
Model frozen(const Model& model, double time) {
    const auto freeze = [&](TimeFunction& history) { history = {.time = {0}, .value = {history(time)}}; };
    Model still = model;
    std::ranges::for_each(still.histories, freeze);
    for (CrackFluid& fluid : still.crack_fluids) fluid.only_time = time;
    for (StateForce& force : still.state_forces)
        force = [given = force, time](const State& state, double) { return given(state, time); };
    for (PrescribedMotion& motion : still.prescribed)
        for (int k = 0; k < 2; ++k)
            if (!motion.is_displacement[k]) motion.value[k] = 0;
    for (Obstacle& obstacle : still.obstacles) {
        for (Drive& drive : obstacle.drive) {
            freeze(drive.history);
            if (drive.kind == Drive::Kind::velocity) drive = {};  // fixed where it is
        }
        for (ObstacleForce& force : obstacle.forces) freeze(force.history);
        obstacle.for_laws([](ContactLaw& law) { law.restitution = 0; });
    }
    for (CohesiveLaw& law : still.laws) law.restitution = 0;
    for (std::vector<ContactLaw>& of_material : still.contact_of_pair)
        for (ContactLaw& law : of_material) law.restitution = 0;
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
    double force = 0;               // [N] carried by inertia, sum over all corners and free obstacles
    Index fastest = 0;              // corner
    std::optional<Index> obstacle;  // that carries more than the body
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
    double most = inertia.force;
    for (Index o = 0; o < static_cast<Index>(model.obstacles.size()); ++o) {
        double force = 0;
        for (int k = 0; k < 2; ++k)
            if (model.obstacles[o].is_free(k))
                force += model.obstacles[o].mass * std::abs(state.obstacles[o].velocity[k]) / h;
        inertia.force += force;
        if (force > most) most = force, inertia.obstacle = o;
    }
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

/// [N] All given forces on the corners of the body in this state, and those of its triangles.
std::vector<Vec2> forces_on_corners(const Model& model, const State& state) {
    std::vector<Vec2> force;
    elastic_energy(model, state, force);
    const auto add = [&](const CornerLoad& load, const Vec2& of_one) {
        force[load.corner] += model.histories[load.history](0) * of_one;
    };
    for (const CornerLoad& load : model.corner_loads) add(load, force_of(model, load, state));
    CrackForces in_cracks(model);
    for (const CornerLoad& load : in_cracks.find(state)) add(load, load.force);
    for (std::size_t rank = 0; rank < state.split_fans.size(); ++rank) {
        const auto points = model.points(model.fans[state.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const FanPoint& point = points[j];
            const Vec2& t = state.points[state.first_point[rank] + j].traction;
            const Vec2 n = point_frame(model, state, point).turned(point.normal),
                       P = point.area * (t.x() * n + t.y() * turned_left(n));
            if (point.after != rigid_support) force[point.after] += P;
            if (point.before != rigid_support) force[point.before] -= P;
        }
    }
    return force;
}

/// Why no step is solved.
const char* unsolved(Rejection rejection) {
    switch (rejection) {
        case Rejection::jammed: return "contacts are driven against each other and jam";
        case Rejection::contact_speed: return "what nothing holds moves too far before it meets something";
        default: return "contact and friction do not settle";
    }
}

/// How a piece that no points hold to others moved in a step: as a rigid body, or it changed its shape.
struct Motion {
    bool turns = false, bends = false;
    double largest = 0;  // [m]
};

Motion motion_of(const Model& model, const State& before, const State& after, Index of_corner) {
    const Mesh& mesh = model.mesh;
    UnionFind pieces(mesh.n_triangles());
    std::vector<Index> first_at(after.displacement.size(), -1);
    for (Index c = 0; c < mesh.n_corners(); ++c) {
        Index& first = first_at[after.node_of_corner[c]];
        if (first < 0) first = mesh.triangle_of(c);
        pieces.join(first, mesh.triangle_of(c));
    }
    const Index piece = pieces.find(mesh.triangle_of(of_corner));
    const auto sum = [&](auto zero, const auto& of) {
        for (Index c = 0; c < mesh.n_corners(); ++c)
            if (pieces.find(mesh.triangle_of(c)) == piece) zero += model.corner_mass[c] * of(c);
        return zero;
    };
    const auto move = [&](Index c) -> Vec2 { return after.displacement_of(c) - before.displacement_of(c); };
    const double mass = sum(0., [](Index) { return 1.; });
    const Vec2 centre = sum(Vec2(0, 0), [&](Index c) -> Vec2 { return mesh.corner(c); }) / mass,
               mean = sum(Vec2(0, 0), move) / mass;
    const auto arm = [&](Index c) -> Vec2 { return mesh.corner(c) - centre; };
    const double turn = sum(0., [&](Index c) { return cross(arm(c), move(c)); }) /
                        sum(0., [&](Index c) { return arm(c).squaredNorm(); });
    const double whole = sum(0., [&](Index c) { return move(c).squaredNorm(); }),
                 turned = sum(0., [&](Index c) { return turn * turn * arm(c).squaredNorm(); }),
                 bent = sum(0., [&](Index c) { return (move(c) - mean - turn * turned_left(arm(c))).squaredNorm(); });
    return {.turns = turned > 1e-2 * whole, .bends = bent > 1e-2 * whole, .largest = move(of_corner).norm()};
}

/// What may happen to interfaces on the way.
enum class Interfaces {
    intact,     // nothing loses cohesion, or the search ends
    glued,      // what has cohesion holds, however strong the forces
    softening,  // cohesion falls where the forces exceed it, as long as the body is stable
    breaking    // also where it is not
};

/// The model without large rotations, in whose place forces on its corners correct those of small ones.
struct Still {
    Still(const Model& turned, MassMatrix mass, Interfaces interfaces)
        : model(with_small_rotations(turned)),
          scheme(model, {.bulk = BulkScheme::implicit_theta,
                         .cohesion = interfaces >= Interfaces::softening ? CohesionScheme::implicit_beta
                                                                         : CohesionScheme::explicit_beta,
                         .theta = 1,
                         .mass = mass,
                         .respect_assumption_1 = interfaces == Interfaces::softening}) {
        scheme.leave_free_motions();
        for (CohesiveLaw& law : model.laws)
            if (interfaces == Interfaces::glued && law.sigma_c > 0) law.sigma_c = infinity;
        if (interfaces == Interfaces::glued) model.laws_follow_temperature = false;
        if (!turned.large_rotation) return;
        model.histories.push_back({.time = {0}, .value = {1}});
        for (CornerLoad& load : model.corner_loads) load.state_force = -1;
        for (Index c = 0; c < model.mesh.n_corners(); ++c)
            model.corner_loads.push_back(
                {.corner = c, .history = static_cast<Index>(model.histories.size()) - 1, .force = Vec2::Zero()});
    }
    Still(const Still&) = delete;  // the scheme refers to the model

    static Model with_small_rotations(Model model) {
        model.large_rotation = false;
        return model;
    }

    Model model;
    ImplicitScheme scheme;
};

class EquilibriumSearch {
public:
    EquilibriumSearch(const Model& model, MassMatrix mass, double time, const TellSearch& tell)
        : mass_(mass), time_(time), tell_(tell), turned_(frozen(model, time)) {}

    State find(const State& start) {
        State now = start;
        stop(now);
        fit_laws(turned_, now);
        const State unloaded = now;
        if (settle(Interfaces::intact, now)) return check_obstacles(start, now), now;
        // On the way to the equilibrium forces are other than in it: first the forces of what holds altogether, then
        // the damage that they do.
        now = unloaded;
        settle(Interfaces::glued, now);
        settle(Interfaces::softening, now);
        check_obstacles(start, now);
        return now;
    }

private:
    [[noreturn]] void no_equilibrium(const std::string& reason, const Vec2& where) const {
        throw SimulationError(formatted("no equilibrium under the loads at t = %s: %s, at ",
                                        readable(time_, "s", 6).c_str(), reason.c_str()) +
                              place_text(where));
    }

    Vec2 place_of_largest_displacement(const State& state) const {
        Index farthest = 0;
        for (Index c = 0; c < turned_.mesh.n_corners(); ++c)
            if (state.displacement_of(c).norm() > state.displacement_of(farthest).norm()) farthest = c;
        return turned_.mesh.corner(farthest);
    }

    void check_obstacles(const State& start, const State& now) const;
    std::string unheld(const State& before, const State& state, double acceleration, Index fastest) const;
    std::string overloaded(const State& now, double h) const;
    double correct(const State& now);
    bool settle(Interfaces interfaces, State& now);
    bool find_still(Interfaces interfaces, State& now);

    MassMatrix mass_;
    double time_;
    const TellSearch& tell_;
    int n_steps_ = 0;
    Model turned_;
    std::unique_ptr<Still> still_;
};

/// From `now` on. False: an interface that was to stay intact loses cohesion.
bool EquilibriumSearch::settle(Interfaces interfaces, State& now) {
    auto still = std::make_unique<Still>(turned_, mass_, interfaces);
    if (still_ && interfaces == Interfaces::softening) still->model.corner_loads = still_->model.corner_loads;
    still_ = std::move(still);
    if (!find_still(interfaces, now)) return false;
    if (!turned_.large_rotation) return true;
    // Large rotations: forces of small ones + (forces of large ones - forces of small ones) = 0, with the bracket
    // of the last round. A round leaves the part of the error by which turning changes the stiffness.
    double last = infinity;
    for (int round = 0;; ++round) {
        const double change = correct(now);
        if (change <= relative_tolerance || (change <= accepted_residual && change > 0.5 * last)) return true;
        if (round == max_iterations || !(change <= 2 * last))
            no_equilibrium("the body turns or strains too far", place_of_largest_displacement(now));
        last = change;
        if (!find_still(interfaces, now)) return false;
    }
}

/// Renews the forces by which turning differs; returns their change, over the loads.
double EquilibriumSearch::correct(const State& now) {
    const auto n = static_cast<std::size_t>(turned_.mesh.n_corners());
    const std::span<CornerLoad> corrections = std::span(still_->model.corner_loads).last(n);
    const std::vector<Vec2> small = forces_on_corners(still_->model, now), large = forces_on_corners(turned_, now);
    double change = 0;
    for (std::size_t c = 0; c < n; ++c) {
        const Vec2 lacks = large[c] - small[c];  // `small` has the last correction
        change += lacks.norm();
        corrections[c].force += lacks;
    }
    const double load = load_of(still_->model, now);
    return load > 0 ? change / load : 0;
}

/// A free obstacle that found its rest elsewhere was not held where it started. It may follow the body, and close gaps.
void EquilibriumSearch::check_obstacles(const State& start, const State& now) const {
    double of_body = 0;
    for (Index c = 0; c < turned_.mesh.n_corners(); ++c)
        of_body = std::max(of_body, (now.displacement_of(c) - start.displacement_of(c)).norm());
    for (std::size_t o = 0; o < now.obstacles.size(); ++o) {
        const Obstacle& obstacle = turned_.obstacles[o];
        if (!obstacle.is_free() || !obstacle.outline.is_bounded()) continue;
        const Vec3 way = now.obstacles[o].moved - start.obstacles[o].moved;
        const double width = obstacle.outline.half_width(), moved = way.head<2>().norm() + width * std::abs(way.z());
        if (moved > follows_body * of_body + closes_gap * width)
            no_equilibrium(formatted("nothing holds the free obstacle `%s` where it starts, it comes to rest %s away",
                                     obstacle.name.c_str(), readable(moved, "m").c_str()),
                           start.obstacles[o].pose.position);
    }
}

/// Why a body moves away, from its last step.
std::string EquilibriumSearch::unheld(const State& before, const State& state, double acceleration,
                                      Index fastest) const {
    const Motion motion = motion_of(turned_, before, state, fastest);
    if (motion.bends)
        return formatted(
            "the body bends too far for steps that are solved: %s in the last one; let the loads grow with a ramp from "
            "start = \"rest\"",
            readable(motion.largest, "m").c_str());
    const bool meets = std::ranges::any_of(state.face_contacts, [](const auto& at) { return at.contact > 0; }) ||
                       std::ranges::any_of(state.points, [](const auto& at) { return at.traction.x() > 0; }) ||
                       std::ranges::any_of(state.obstacles, [](const auto& at) { return !at.reaction.isZero(0); });
    // a support that the loads tilt by a millionth lets a block slide that nothing but its weight holds
    const bool slides =
        std::ranges::any_of(state.face_contacts, [](const auto& at) { return at.contact > 0 && at.tangential == 0; }) ||
        std::ranges::any_of(turned_.obstacles, [](const Obstacle& obstacle) {
            return obstacle.any_law([](const ContactLaw& law) { return law.friction == 0; });
        });
    return formatted("%s the body, it would move away with %.3g m/s2%s%s",
                     meets ? "contact and friction do not hold" : "nothing holds", acceleration,
                     !meets         ? ""
                     : motion.turns ? " and turn"
                                    : " without turning",
                     meets && slides
                         ? "; contacts without friction slide on the least slope, also on that of an elastic "
                           "deformation: give them a small friction"
                         : "");
}

/// What breaks loose in a step of h from `now` [s], however it softens there.
std::string EquilibriumSearch::overloaded(const State& now, double h) const {
    Still breaking(turned_, mass_, Interfaces::breaking);
    breaking.model.corner_loads = still_->model.corner_loads;
    State next;
    next.temperature = now.temperature;
    const bool taken = breaking.scheme.step(now, h, next).rejection == Rejection::none;
    const Index c = taken ? inertia_of(breaking.model, next, h).fastest : 0;
    const double acceleration = taken ? next.velocity[next.node_of_corner[c]].norm() / h : 0;
    return "the preload is more than the interfaces hold" +
           (acceleration > 0 ? formatted(", what breaks loose would move away with %.3g m/s2", acceleration) : "");
}

/// With small rotations, from `now` on.
bool EquilibriumSearch::find_still(Interfaces interfaces, State& now) {
    const Model& model = still_->model;
    const double passage = passage_time(model), farthest = too_far * largest_edge(model.mesh);
    State next;
    // what is in equilibrium but for its damage needs the largest step, whose solution depends on no way
    double h = (interfaces == Interfaces::softening ? last_step : first_step) * passage;
    double part = 1;                        // of the loads, carried by inertia
    int patience = 2, wait = 0;             // steps without growth after a rejection
    bool once_more = false, again = false;  // again: a step of the same size tells whether a piece goes on moving
    for (int step = 0; part > relative_tolerance; ++step) {
        if (tell_) tell_(++n_steps_, part);
        next.temperature = now.temperature;
        const StepReport report = still_->scheme.step(now, h, next);
        const bool rejected = report.rejection != Rejection::none, smallest = h < 2 * first_step * passage;
        const Inertia inertia = rejected ? Inertia{} : inertia_of(model, next, h);
        const double load = rejected ? 0 : load_of(model, next), after = load > 0 ? inertia.force / load : 0;
        if (report.rejection == Rejection::assumption_1) no_equilibrium(overloaded(now, h), report.where);
        if (rejected || (after > jammed * part && !smallest)) {
            if ((rejected && smallest && once_more) || step == max_steps)
                no_equilibrium(unsolved(report.rejection), report.where);
            // no size was solved: which ones are depends on where friction cycles, so others are tried from above
            if (rejected && smallest) once_more = true, h = last_step * passage;
            else h /= once_more ? std::sqrt(growth) : growth;
            wait = patience *= 2, again = false;
            continue;
        }
        if (report.softened > 0 && interfaces == Interfaces::intact) return false;
        const double leaves = after / part;
        const bool stalled = leaves > stays;
        part = after;
        std::swap(now, next);
        const ObstacleState* const obstacle = inertia.obstacle ? &now.obstacles[*inertia.obstacle] : nullptr;
        const double acceleration =
            (obstacle ? Vec2(obstacle->velocity.head<2>()) : now.velocity[now.node_of_corner[inertia.fastest]]).norm() /
            h;
        stop(now);
        if (stalled && part <= accepted_residual) break;
        const double largest = wait > 0 ? h : last_step * passage;
        const bool ends = (stalled && h >= largest) || (again && leaves > slides) || step == max_steps;
        if (ends && obstacle)
            no_equilibrium(formatted("nothing holds the free obstacle `%s`, it would move away with %.3g m/s2",
                                     model.obstacles[*inertia.obstacle].name.c_str(), acceleration),
                           model.obstacles[*inertia.obstacle].start.position);
        if (ends)
            no_equilibrium(interfaces == Interfaces::softening ? overloaded(now, h)
                                                               : unheld(next, now, acceleration, inertia.fastest),
                           model.mesh.corner(inertia.fastest));
        const Motion motion = obstacle ? Motion{.bends = true} : motion_of(model, next, now, inertia.fastest);
        again = !motion.bends && growth * growth * motion.largest > farthest && model.faces_meet();
        if (!again) h = std::min(growth * h, largest);
        wait = std::max(0, wait - 1);
    }
    return true;
}

}  // namespace

void start_in_equilibrium(const Model& model, MassMatrix mass, State& start, const TellSearch& tell) {
    State now = EquilibriumSearch(model, mass, start.time, tell).find(start);
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        now.velocity[now.node_of_corner[c]] = start.velocity[start.node_of_corner[c]];
    for (std::size_t o = 0; o < now.obstacles.size(); ++o) now.obstacles[o].velocity = start.obstacles[o].velocity;
    now.retired = start.retired;
    now.temperature = start.temperature, now.temperature_before = start.temperature_before;
    for (Incubation& memory : now.incubation) memory.time = -infinity;
    start = std::move(now);
}

}  // namespace knap
