#include "stepper/adapt/excavation.hpp"

#include "element/bulk_viscosity.hpp"
#include "element/shape_functions.hpp"
#include "model/successor.hpp"
#include "stepper/common/crack_forces.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/contact/face_contacts.hpp"
#include "stepper/explicit/explicit_step.hpp"
#include "stepper/explicit/free_pieces.hpp"
#include "stepper/implicit/carried_motion.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

double smaller(double a, double b) { return a * b > 0 ? std::copysign(std::min(std::abs(a), std::abs(b)), a) : 0; }

/// Calls visit(contact, corner, force) for the corners on which the contacts between free faces acted [N] in a step, as
/// in contact/face_contacts.hpp.
void visit_contact_forces(const Model& model, const State& begin, const State& end, const auto& visit) {
    for (const FaceContactState& contact : end.face_contacts) {
        const GroundVertex* ground = model.ground_at(contact.edge);
        const Index a = contact.edge, b = ground ? model.mesh.n_corners() + ground->next : next_in_triangle(a);
        const Vec2 x = place_of(model, begin, contact.vertex);
        const PlacedEdge edge = placed_edge(place_of(model, begin, a), place_of(model, begin, b));
        const FaceContact at{.vertex = {contact.entering, contact.vertex},
                             .edge = {a, b},
                             .normal = edge.outward,
                             .length = edge.length,
                             .share = edge.share(x),
                             .gap = edge.gap(x)};
        const Vec2 force = Vec2(contact.contact, contact.tangential) / end.last_step;
        at.visit_terms([&](const CornerTerm& term) { visit(contact, term.body, term.wrench(force)); });
    }
}

class ReleasedForces {
public:
    ReleasedForces(const Model& model, const State& begin, const State& end, const SchemeOptions& scheme,
                   std::span<const std::uint8_t> vanishes, std::span<const Vec2> contacts)
        : model_(model),
          begin_(begin),
          end_(end),
          vanishes_(vanishes),
          released_(model.mesh.n_corners(), Vec2::Zero()) {
        if (end.has_end_velocities()) find_impulses_of_theta_scheme(scheme);
        else find_forces_of_leapfrog(scheme);
        for (std::size_t c = 0; c < contacts.size(); ++c) released_[c] = contacts[c];
    }

    std::vector<CornerLoad> loads() {
        for (Index f = 0; f < static_cast<Index>(model_.fans.size()); ++f) cut(f);
        std::vector<CornerLoad> loads;
        for (Index c = 0; c < model_.mesh.n_corners(); ++c)
            if (!released_[c].isZero(0)) loads.push_back({.corner = c, .history = -1, .force = released_[c]});
        return loads;
    }

private:
    /// F - K u - m a
    void find_forces_of_leapfrog(const SchemeOptions& scheme) {
        const double kick_time = 0.5 * (begin_.last_step + end_.last_step), damping = 0.5 * kick_time * scheme.damping;
        const std::vector<Dashpot> dashpots = dashpots_on(model_, scheme.absorbing);
        FreePieces pieces(model_, scheme, dashpots);
        std::vector<PieceMotion> moments;
        const Vec2* carried = pieces.carried(begin_, damping, moments);
        elastic_energy(model_, begin_, exerted_);
        CrackForces fluids(model_);
        const auto add = [&](std::span<const CornerLoad> loads) {
            for (const CornerLoad& load : loads)
                exerted_[load.corner] +=
                    model_.histories[load.history].over_kick(begin_.time, begin_.last_step, end_.last_step) *
                    knap::force_of(model_, load, begin_);
        };
        add(model_.corner_loads), add(fluids.find(begin_)), add_contacts();
        if (!end_.viscous_stress.empty()) add_viscosity();
        for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
            const Vec2 before = begin_.velocity[begin_.node_of_corner[c]],
                       after = end_.velocity[end_.node_of_corner[c]];
            const double mass = model_.corner_mass[c] / kick_time;
            exerted_[c] -= damped_impulse(mass, before, after, damping);
            if (carried != nullptr) exerted_[c] += mass * (1 + damping) * carried[begin_.node_of_corner[c]];
        }
    }

    /// -r(w)/(theta h), with r of implicit_bulk.hpp.
    void find_impulses_of_theta_scheme(const SchemeOptions& scheme) {
        StepContext step{{.h = end_.last_step, .theta = scheme.theta}, &begin_, end_.temperature};
        ImplicitBulk bulk(model_, scheme.mass, scheme.damping, scheme.absorbing);
        bulk.begin_step(step);
        std::vector<std::uint8_t> split;
        for (const Index rank : end_.split_rank) split.push_back(rank >= 0);
        CornerPartition nodes;
        partition_corners(model_, split, nodes);
        std::vector<Vec2> of_corner, of_node;
        for (const Index node : end_.node_of_corner) of_corner.push_back(end_.rate[node]);
        if (bulk.frames()) bulk.linearise(of_corner);
        bulk.set_nodes(nodes, of_corner, of_node);
        CarriedMotion carried(model_, scheme, bulk);
        carried.begin(step);
        while (carried.has_pieces() && !carried.agrees(of_corner)) {
        }  // a projection: at the second time
        bulk.impulse(of_node, exerted_);
        for (Vec2& force : exerted_) force /= -step.kick();
        add_contacts();
    }

    void add_contacts() {
        visit_contact_forces(model_, begin_, end_, [&](const FaceContactState&, Index corner, const Vec2& force) {
            if (model_.ground_at(corner) == nullptr) exerted_[corner] += force;
        });
    }

    /// -V (s cof F + F q) grad l_k at the three corners of every triangle, s and q the viscous stresses at the start of
    /// the trial step.
    void add_viscosity() {
        for (Index t = 0; t < model_.mesh.n_triangles(); ++t) {
            const double* stress = &end_.viscous_stress[viscous_components * t];
            const std::array<Vec2, 3> gradient = shape_gradients(model_.mesh, t);
            Eigen::Matrix2d F = Eigen::Matrix2d::Identity(), cofactor, q;
            if (model_.large_rotation)
                for (Index k = 0; k < 3; ++k) F += begin_.displacement_of(3 * t + k) * gradient[k].transpose();
            cofactor << F(1, 1), -F(1, 0), -F(0, 1), F(0, 0);
            q << stress[1], stress[2], stress[2], -stress[1];
            const Eigen::Matrix2d P = stress[0] * cofactor + F * q;
            const double volume = model_.mesh.area(t) * model_.thickness;
            for (Index k = 0; k < 3; ++k) exerted_[3 * t + k] -= volume * P * gradient[k];
        }
    }

    bool vanishes(Index corner) const { return vanishes_[model_.mesh.triangle_of(corner)]; }
    /// Between a corner that stays and one that vanishes.
    bool is_cut(const FanPoint& point) const {
        return !point.on_support() && vanishes(point.before) != vanishes(point.after);
    }

    /// [N] On the corner of a cut point that stays.
    Vec2 force_of(const FanPoint& point, const Vec2& traction) const {
        const Vec2 n = point_frame(model_, begin_, point).turned(point.normal);
        const Vec2 on_after = point.area * (traction.x() * n + traction.y() * turned_left(n));
        return vanishes(point.after) ? Vec2(-on_after) : on_after;
    }
    /// [N] Likewise, of the mean stress.
    Vec2 stress_force(const FanPoint& point) const { return force_of(point, traction(model_, begin_, point.point)); }
    /// [Pa] Of a point of a fan that is split at the end of the trial step.
    Vec2 lasting_traction(Index fan, Index point) const {
        const Vec2 now = traction(model_, end_, point);
        if (begin_.split_rank[fan] < 0) return now;
        const Vec2 before = traction(model_, begin_, point);
        return {smaller(now.x(), before.x()), smaller(now.y(), before.y())};
    }

    void add(const FanPoint& point, const Vec2& force) {
        released_[vanishes(point.after) ? point.before : point.after] += force;
    }

    void cut(Index f) {
        const Fan& fan = model_.fans[f];
        const auto points = model_.points(fan);
        if (std::ranges::none_of(points, [&](const FanPoint& point) { return is_cut(point); })) return;
        if (end_.split_rank[f] >= 0) {
            for (const FanPoint& point : points)
                if (is_cut(point)) add(point, force_of(point, lasting_traction(f, point.point)));
            return;
        }
        // runs of corners that vanish; a closed fan is read from a cut point, so that no run goes over its end
        const auto corners = model_.corners(fan);
        Index first = 0;
        while (fan.closed && !is_cut(points[first])) ++first;
        for (Index i = 0; i < fan.n_corners;) {
            Index last = i;  // behind the run
            while (last < fan.n_corners && vanishes(at(corners, first + last)) == vanishes(at(corners, first + i)))
                ++last;
            if (vanishes(at(corners, first + i))) cut_run(fan, first + i, last - i);
            i = last;
        }
    }

    static Index at(std::span<const Index> corners, Index i) { return corners[i % corners.size()]; }

    /// `n` corners from place `first` of a bonded fan, modulo its size. Point i lies before corner i of a closed fan,
    /// before corner i + 1 of an open one.
    void cut_run(const Fan& fan, Index first, Index n) {
        const auto corners = model_.corners(fan);
        const auto points = model_.points(fan);
        Vec2 missing = Vec2::Zero();
        for (Index i = first; i < first + n; ++i) missing += exerted_[at(corners, i)];
        std::array<const FanPoint*, 2> ends{};
        int n_ends = 0;
        double area = 0;
        for (const Index corner : {first, first + n}) {
            const Index j = fan.closed ? corner % fan.n_points : corner - 1;
            if (j < 0 || j >= fan.n_points || !is_cut(points[j])) continue;
            ends[n_ends++] = &points[j];
            area += points[j].area;
            missing -= stress_force(points[j]);
        }
        const PrescribedMotion* motion = model_.motion_of(corners[0]);
        for (int e = 0; e < n_ends; ++e) {
            Vec2 force = stress_force(*ends[e]) + ends[e]->area / area * missing;
            for (int k = 0; k < 2 && motion; ++k)
                if (motion->component[k]) force[k] = 0;
            add(*ends[e], force);
        }
    }

    const Model& model_;
    const State &begin_, &end_;
    std::span<const std::uint8_t> vanishes_;
    std::vector<Vec2> exerted_;   // [N] per corner, on its neighbours: what is left of its loads and stresses
    std::vector<Vec2> released_;  // [N] R per corner
};

/// A thermal strain would move what is gone.
SharedTemperatures without_strain_of_vanished(const Model& model, Temperatures temperatures) {
    const std::size_t n = temperatures.strain.size() / model.mesh.n_triangles();
    for (std::size_t i = 0; i < temperatures.strain.size(); ++i)
        if (model.has_vanished(static_cast<Index>(i / n))) temperatures.strain[i] = 0;
    return std::make_shared<Temperatures>(std::move(temperatures));
}

/// [J] Of the bodies: 1/2 v' M v.
double kinetic_energy_of(const Model& model, const State& state, MassMatrix mass) {
    std::vector<Vec2> velocity, momentum;
    for (const Index node : state.node_of_corner) velocity.push_back(state.velocity[node]);
    ImplicitBulk(model, mass).momentum(velocity, momentum);
    double energy = 0;
    for (std::size_t c = 0; c < velocity.size(); ++c) energy += 0.5 * velocity[c].dot(momentum[c]);
    return energy;
}

/// Adds the surface of the points of split fans that the successor has no more.
void add_lost_surface(const Model& model, const State& state, const Model& rest, ExcavationEnergies& energies) {
    StepReport lost;
    for (std::size_t s = 0; s < state.split_fans.size(); ++s) {
        const auto points = model.points(model.fans[state.split_fans[s]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            if (rest.fan_point_of[points[j].point] >= 0 || unbreakable(model, points[j])) continue;
            const CohesiveLaw& law = law_of(model, state, points[j]);
            const PointState& known = state.points[state.first_point[s] + j];
            const double beta = known.cohesion;
            const Rotation frame = point_frame(model, state, points[j]);
            const Vec2 u = cohesive_opening(model, state, points[j], frame, beta);
            const auto rate = [&](Index corner) -> Vec2 {
                return corner == rigid_support ? Vec2::Zero() : state.velocity[state.node_of_corner[corner]];
            };
            const Vec2 n = frame.turned(points[j].normal), half = (state.has_end_velocities() ? 0 : 0.5) *
                                                                  state.last_step *
                                                                  (rate(points[j].after) - rate(points[j].before));
            const Vec2 middle = u - Vec2(n.dot(half), turned_left(n).dot(half));
            account_cohesion(points[j], law,
                             {.area = points[j].area * state.strength_factor(state.split_fans[s]),
                              .before = beta,
                              .after = beta,
                              .opening = law.equivalent_opening(u.x(), u.y()),
                              .at_works = law.equivalent_opening(middle.x(), middle.y()),
                              .kappa = law.ramp(beta, known.largest_opening)},
                             lost);
        }
    }
    energies.dissipated = lost.dissipated, energies.recoverable = lost.recoverable;
    energies.interface_elastic = lost.interface_elastic;
}

}  // namespace

std::vector<CornerLoad> released_forces(const Model& model, const State& begin, const State& end,
                                        const SchemeOptions& scheme, std::span<const std::uint8_t> vanishes,
                                        std::span<const Vec2> contacts) {
    return ReleasedForces(model, begin, end, scheme, vanishes, contacts).loads();
}

std::vector<CornerLoad> released_pressures(const Model& model, const State& state, const Model& rest_model,
                                           const State& rest) {
    if (model.crack_fluids.empty()) return {};
    std::vector<Vec2> lost(model.mesh.n_corners(), Vec2::Zero());
    const auto add = [&](const Model& of, const State& in, double sign) {
        CrackForces fluids(of);
        for (const CornerLoad& load : fluids.find(in))
            lost[load.corner] += sign * of.histories[load.history](in.time) * load.force;
    };
    add(model, state, 1), add(rest_model, rest, -1);
    std::vector<CornerLoad> loads;
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        if (!lost[c].isZero(0) && !rest_model.has_vanished(model.mesh.triangle_of(c)))
            loads.push_back({.corner = c, .history = -1, .force = lost[c]});
    return loads;
}

std::vector<Vec2> lasting_contacts(const Model& model, MoreauJean& stepper, const State& begin, const State& trial,
                                   double h, std::span<const std::uint8_t> vanishes) {
    constexpr int n_steps = 64;  // more than contacts need that chatter
    const auto is_lost = [&](Index corner) {
        return corner < model.mesh.n_corners() && vanishes[model.mesh.triangle_of(corner)] != 0;
    };
    const auto is_cut = [&](const FaceContactState& c) { return is_lost(c.vertex) != is_lost(c.edge); };
    if (std::ranges::none_of(begin.face_contacts, is_cut) && std::ranges::none_of(trial.face_contacts, is_cut))
        return {};
    std::array<std::vector<Vec2>, 2> mean;  // [N] of the first and the second half
    for (std::vector<Vec2>& half : mean) half.assign(model.mesh.n_corners(), Vec2::Zero());
    State now = begin, next = trial;
    for (int i = 0; i < n_steps; ++i) {
        if (i > 0 && stepper.step(now, h, next).rejection != Rejection::none) break;
        visit_contact_forces(model, now, next, [&](const FaceContactState& contact, Index corner, const Vec2& force) {
            if (is_cut(contact) && model.ground_at(corner) == nullptr && !is_lost(corner))
                mean[2 * i / n_steps][corner] += 2. / n_steps * force;
        });
        std::swap(now, next);
    }
    for (std::size_t c = 0; c < mean[0].size(); ++c)
        for (int k = 0; k < 2; ++k) mean[0][c][k] = smaller(mean[0][c][k], mean[1][c][k]);
    return std::move(mean[0]);
}

Excavated excavate(const Model& model, const State& state, std::span<const Index> triangles, MassMatrix mass) {
    Excavated rest{.model = without(model, triangles)};
    rest.state = carried_over(model, state, rest.model);
    for (SharedTemperatures* temperature : {&rest.state.temperature, &rest.state.temperature_before})
        if (*temperature) *temperature = without_strain_of_vanished(rest.model, **temperature);
    if (state.temperature == state.temperature_before) rest.state.temperature_before = rest.state.temperature;
    add_lost_surface(model, state, rest.model, rest.energies);
    if (state.has_end_velocities()) {
        std::vector<Vec2> force;
        rest.energies.strain = elastic_energy(rest.model, rest.state, force);
        rest.energies.kinetic = kinetic_energy_of(rest.model, rest.state, mass);
    } else {
        const LeapfrogEnergies energies = leapfrog_energies(rest.model, rest.state);
        rest.state.elastic_energy = energies.elastic, rest.state.elastic_work = energies.work;
        rest.energies.kinetic = energies.kinetic, rest.energies.strain = energies.strain;
    }
    for (std::size_t o = 0; o < model.obstacles.size(); ++o)
        rest.energies.kinetic += kinetic_energy(model.obstacles[o], state.obstacles[o].velocity);
    return rest;
}

void release(std::span<const CornerLoad> forces, double time, double ramp, Model& model) {
    const auto history = static_cast<Index>(model.histories.size());
    model.histories.push_back({.time = {time, time + ramp}, .value = {1, 0}});
    for (const CornerLoad& at : forces)
        model.corner_loads.push_back({.corner = at.corner, .history = history, .force = at.force, .is_release = true});
    std::ranges::stable_sort(model.corner_loads, {}, &CornerLoad::corner);
}

}  // namespace knap
