#include "stepper/explicit/vertex_contacts.hpp"

#include "base/parallel.hpp"
#include "base/union_find.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/contact/retirement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace knap {
namespace {

constexpr double deep = 1e-3;                       // [-] of the edge: a deeper penetration is reduced by a rebound
constexpr double merged = 1e-12;                    // [-] of the speeds: nearer kinks of the friction are one
constexpr double difference = 1e-6;                 // [-] of the momenta, for the slope of a soft fan
constexpr double held = 1e-6;                       // [-] of the mobility of a free corner: a smaller one is zero
constexpr double absurd = 1e3;                      // [-] of the speeds of a cluster: no impulse of a contact causes it
constexpr double max_injected = 1e-3;               // [-] of energy and losses of a cluster, by its residual
constexpr double agreed = 1e-12;                    // [-] of the speeds, between contacts and fans
constexpr double rounding = 1e-15;                  // [-] of the positions
constexpr int newton_rounds = 8, max_rounds = 300;  // of contacts and fans
constexpr int patience = 20;                        // rounds without half the residual: a wedge has no solution

/// [J] Of the impulse P at a mean rate, both (N, T): what the residual of the laws injects.
double positive_work(const Vec2& P, const Vec2& mean) {
    return std::max(0.0, P.x() * mean.x()) + std::max(0.0, P.y() * mean.y());
}

}  // namespace

Index VertexContacts::slot_of(Index fan) {
    if (slot_of_fan_[fan] >= 0) return slot_of_fan_[fan];
    const auto slot = static_cast<Index>(fans_.size());
    fans_.push_back(fan);
    if (touched_.size() < fans_.size()) touched_.emplace_back();
    touched_[slot].fan = fan;
    touched_[slot].is_soft = false;
    touched_[slot].corners.clear();
    touched_[slot].terms.clear();
    return slot_of_fan_[fan] = slot;
}

void VertexContacts::add_terms(Index contact) {
    const FaceContact& c = contacts_.all()[contact];
    const Vec2 n = c.normal, t = turned_left(n), turn = c.gap / c.length * n;
    const auto add = [&](Index corner, const Vec2& along_N, const Vec2& along_T) {
        const Index slot = slot_of(model_.fan_of_corner[corner]);
        std::vector<Index>& corners = touched_[slot].corners;
        const auto place = static_cast<Index>(std::ranges::find(corners, corner) - corners.begin());
        if (place == std::ssize(corners)) corners.push_back(corner);
        touched_[slot].terms.push_back(static_cast<Index>(terms_.size()));
        terms_.push_back({contact, slot, place, along_N, along_T});
    };
    for (const Index corner : c.vertex) add(corner, 0.5 * n, 0.5 * t);
    add(c.edge[0], -(1 - c.share) * n, -(1 - c.share) * t - turn);
    add(c.edge[1], -c.share * n, -c.share * t + turn);
}

void VertexContacts::begin(const ExplicitStep& step, StepReport& report) {
    slot_of_fan_.resize(model_.fans.size(), -1);
    for (const Index f : fans_) {
        slot_of_fan_[f] = -1;
        for (const Index corner : model_.corners(model_.fans[f])) corner_impulse_[corner].setZero();
    }
    fans_.clear(), terms_.clear();
    contacts_.find(step.begin, step.drift_time);
    if (const auto& refusal = contacts_.refusal()) {
        if (refusal->reason == ContactRefusal::Reason::speed) report.reject(Rejection::contact_speed, refusal->place);
        else report.contact_depth = std::max(report.contact_depth, refusal->value);
    }
    const auto n = static_cast<Index>(contacts_.all().size());
    impulse_.resize(n), before_.resize(n), residual_.assign(n, 0);
    // a lasting force has the impulse of its step
    const double scale = step.begin.last_step > 0 ? step.kick_time / step.begin.last_step : 1;
    for (Index i = 0; i < n; ++i) {
        add_terms(i);
        impulse_[i] = scale * Vec2(contacts_.all()[i].contact, contacts_.all()[i].tangential);
        before_[i] = rate(i, step.begin);
    }
    find_clusters();
}

/// [m/s] (V_N, V_T) of a contact.
Vec2 VertexContacts::rate(Index contact, const State& state) const {
    Vec2 V = Vec2::Zero();
    for (const Term& term : terms_of(contact))
        V += term.rate(state.velocity[state.node_of_corner[touched_[term.slot].corners[term.place]]]);
    return V;
}

/// Contacts that share a fan, in the order of their first contact; the contacts of a cluster in their order.
void VertexContacts::find_clusters() {
    const std::size_t n = contacts_.all().size();
    UnionFind joined(fans_.size());
    for (std::size_t i = 0; i < n; ++i)
        for (const Term& term : terms_of(i)) joined.join(terms_of(i)[0].slot, term.slot);
    clusters_.clear();
    std::vector<Index>& cluster_of = cluster_of_slot_;  // of the representatives
    cluster_of.assign(fans_.size(), -1);
    const auto cluster = [&](Index slot) {
        Index& found = cluster_of[joined.find(slot)];
        if (found < 0) found = static_cast<Index>(clusters_.size()), clusters_.emplace_back();
        return found;
    };
    place_in_cluster_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        std::vector<Index>& contacts = clusters_[cluster(terms_of(i)[0].slot)].contacts;
        place_in_cluster_[i] = static_cast<Index>(contacts.size());
        contacts.push_back(static_cast<Index>(i));
    }
    for (std::size_t s = 0; s < fans_.size(); ++s) clusters_[cluster(s)].slots.push_back(s);
}

ContactLaw VertexContacts::law_between(const FaceContact& contact) const {
    const auto material = [&](Index corner) { return model_.mesh.region[model_.mesh.triangle_of(corner)]; };
    return model_.contact_of_pair[material(contact.vertex[1])][material(contact.edge[0])];
}

/// The parts of a fan move as rigid bodies: corners that points hold together which have not moved.
void VertexContacts::respond_as_parts(TouchedFan& touched, const ExplicitStep& step) const {
    const Fan& fan = model_.fans[touched.fan];
    const State& begin = step.begin;
    const auto corners = model_.corners(fan);
    const Index rank = begin.split_rank[touched.fan];
    std::vector<Index>& part = touched.part;
    part.assign(corners.size(), 0);
    if (rank >= 0) {
        std::iota(part.begin(), part.end(), 0);
        const auto place = [&](Index corner) { return std::ranges::find(corners, corner) - corners.begin(); };
        for (Index j = 0; j < fan.n_points; ++j) {
            const FanPoint& point = model_.points(fan)[j];
            if (point.on_support()) {
                touched.is_soft = true;
                continue;
            }
            const Index before = begin.node_of_corner[point.before], after = begin.node_of_corner[point.after];
            const bool together = begin.displacement[before] == begin.displacement[after] &&
                                  begin.velocity[before] == begin.velocity[after];
            const bool held = unbreakable(model_, point) || begin.points[begin.first_point[rank] + j].cohesion > 0;
            if (held && together) std::ranges::replace(part, part[place(point.after)], part[place(point.before)]);
        }
    }
    const auto n = static_cast<Eigen::Index>(touched.corners.size());
    touched.free.assign(n, Vec2::Zero());
    touched.R.setZero(2 * n, 2 * n);
    for (Eigen::Index c = 0; c < n; ++c) {
        const Index own = part[std::ranges::find(corners, touched.corners[c]) - corners.begin()];
        double mass = 0;
        Vec2 momentum = Vec2::Zero();
        for (Index i = 0; i < fan.n_corners; ++i) {
            if (part[i] != own) continue;
            const double m = step.mass[fan.first_corner + i];
            mass += m;
            momentum += step.decay * m * begin.velocity[begin.node_of_corner[corners[i]]] +
                        step.mobility * step.kick_time * step.corner_force[corners[i]];
        }
        touched.free[c] = momentum / mass;
        Vec2 mobility = Vec2::Constant(step.mobility / mass);
        if (const PrescribedMotion* motion = model_.motion_of(touched.corners[c])) {
            const Index node = begin.node_of_corner[touched.corners[c]];
            const Vec2 given = step.prescribed_velocity(model_, *motion, begin.displacement[node]);
            for (int k = 0; k < 2; ++k)
                if (motion->component[k]) touched.free[c][k] = given[k], mobility[k] = 0;
            touched.is_soft = touched.is_soft || rank >= 0;
        }
        for (Eigen::Index d = 0; d < n; ++d)
            if (part[std::ranges::find(corners, touched.corners[d]) - corners.begin()] == own)
                touched.R.block<2, 2>(2 * c, 2 * d) = mobility.asDiagonal();
    }
}

/// Whether the impulses on its corners leave the parts of a fan as they are.
bool VertexContacts::keeps_its_parts(const TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work,
                                     StepReport& report) const {
    const Fan& fan = model_.fans[touched.fan];
    const auto corners = model_.corners(fan);
    if (const Index rank = step.begin.split_rank[touched.fan]; rank >= 0)
        return is_stationary(model_, rank, step, work.split.stationary);
    const auto force_on = [&](Index i) -> Vec2 {
        return step.corner_force[corners[i]] + corner_impulse_[corners[i]] / step.kick_time;
    };
    Vec2 force = Vec2::Zero();
    for (Index i = 0; i < fan.n_corners; ++i) force += force_on(i);
    ++report.bond_checks;
    return work.is_bonded(model_, touched.fan, step.begin, step.mass, force_on, force);
}

/// [1/kg] R by differences; `respond` finds the velocities of the touched corners. Unsymmetric where points of the fan
/// slide: with its symmetric part Newton's method takes three times as many rounds.
template <class Respond>
void VertexContacts::find_slope(TouchedFan& touched, ThreadWorkspace& work, const Respond& respond) {
    const auto n = static_cast<Eigen::Index>(touched.corners.size());
    double speed = 0;
    for (const FanBody& body : work.split.problem.bodies)
        speed = std::max({speed, body.free_velocity.norm(), body.velocity.norm(), body.end_velocity.norm()});
    if (speed == 0) speed = 1;
    for (Eigen::Index c = 0; c < n; ++c) {
        const Index corner = touched.corners[c];
        const double impulse = difference * speed * model_.corner_mass[corner];
        for (int k = 0; k < 2; ++k) {
            const Vec2 kept = corner_impulse_[corner];
            corner_impulse_[corner][k] += impulse;
            respond(work.velocity);
            corner_impulse_[corner] = kept;
            for (Eigen::Index d = 0; d < n; ++d)
                touched.R.block<2, 1>(2 * d, 2 * c + k) = (work.velocity[d] - touched.velocity[d]) / impulse;
        }
    }
    // a corner that an obstacle holds does not move: what is left is the rounding of the differences
    for (Eigen::Index c = 0; c < n; ++c)
        for (int k = 0; k < 2; ++k) {
            const Eigen::Index row = 2 * c + k;
            if (touched.R(row, row) > held / model_.corner_mass[touched.corners[c]]) continue;
            touched.R.row(row).setZero(), touched.R.col(row).setZero();
        }
}

/// End velocities of the touched corners from the interface laws of the fan; with their slope by differences.
void VertexContacts::respond_softly(TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work, Slope slope) {
    const Fan& fan = model_.fans[touched.fan];
    const auto corners = model_.corners(fan);
    const auto n = static_cast<Eigen::Index>(touched.corners.size());
    const auto respond = [&](std::vector<Vec2>& velocity) {
        solver_.solve(touched.fan, step, work.split);
        velocity.resize(n);
        for (Eigen::Index c = 0; c < n; ++c)
            velocity[c] = work.split.problem.bodies[std::ranges::find(corners, touched.corners[c]) - corners.begin()]
                              .end_velocity;
    };
    respond(touched.velocity);
    if (slope == Slope::none) return;
    touched.R.setZero(2 * n, 2 * n);
    if (slope == Slope::largest) {
        for (Eigen::Index c = 0; c < n; ++c)
            touched.R.block<2, 2>(2 * c, 2 * c)
                .diagonal()
                .setConstant(step.mobility / model_.corner_mass[touched.corners[c]]);
    } else {
        find_slope(touched, work, respond);
    }
    for (Eigen::Index c = 0; c < n; ++c) {
        touched.free[c] = touched.velocity[c];
        for (Eigen::Index d = 0; d < n; ++d)
            touched.free[c] -= touched.R.block<2, 2>(2 * c, 2 * d) * corner_impulse_[touched.corners[d]];
    }
}

/// Spreads the impulses of a cluster over the corners.
void VertexContacts::spread(const Cluster& cluster) {
    for (const Index s : cluster.slots)
        for (const Index corner : touched_[s].corners) corner_impulse_[corner].setZero();
    for (const Index i : cluster.contacts)
        for (const Term& term : terms_of(i))
            corner_impulse_[touched_[term.slot].corners[term.place]] +=
                impulse_[i].x() * term.along_N + impulse_[i].y() * term.along_T;
}

/// W = sum over the fans of along' R along, and V_free likewise.
void VertexContacts::assemble(const Cluster& cluster, ContactCluster& problem) const {
    for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
        ClusterContact& c = problem.contacts[i];
        c.free.setZero();
        c.impulse = impulse_[cluster.contacts[i]];
        c.first_coupling = c.last_coupling = 0;
    }
    problem.couplings.clear();
    for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
        for (const Term& term : terms_of(cluster.contacts[i])) {
            const TouchedFan& touched = touched_[term.slot];
            problem.contacts[i].free += term.rate(touched.free[term.place]);
            for (const Index k : touched.terms) {
                const Term& other = terms_[k];
                const Eigen::Matrix2d R = touched.R.block<2, 2>(2 * other.place, 2 * term.place);
                Eigen::Matrix2d along, of_other;
                along << term.along_N, term.along_T;
                of_other << other.along_N, other.along_T;
                problem.couple(static_cast<Index>(i), place_in_cluster_[other.contact],
                               of_other.transpose() * R * along);
            }
        }
    }
}

/// A vertex that moves as one with the end of the edge that it touches is no contact, nor are two that are held.
void VertexContacts::drop_immobile(const Cluster& cluster, ContactCluster& problem) const {
    for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
        double own = 0, of_free_corners = 0;
        for (Index k = problem.contacts[i].first_coupling; k < problem.contacts[i].last_coupling; ++k)
            if (problem.couplings[k].on == static_cast<Index>(i)) own = problem.couplings[k].W.trace();
        for (const Term& term : terms_of(cluster.contacts[i]))
            of_free_corners =
                std::max(of_free_corners,
                         term.along_N.squaredNorm() / model_.corner_mass[touched_[term.slot].corners[term.place]]);
        if (own <= held * of_free_corners) problem.contacts[i].law.contact.may_touch = false;
    }
}

void VertexContacts::solve_cluster(const Cluster& cluster, const ExplicitStep& step, std::vector<std::uint8_t>& splits,
                                   ThreadWorkspace& work, StepReport& report) {
    ContactCluster& problem = work.cluster;
    spread(cluster);
    for (const Index s : cluster.slots) {
        TouchedFan& touched = touched_[s];
        respond_as_parts(touched, step);
        if (touched.is_soft || solver_.has_outer_forces(touched.fan)) {
            touched.is_soft = true;
            splits[touched.fan] = step.begin.split_rank[touched.fan] < 0;
            respond_softly(touched, step, work, Slope::of_differences);
        }
    }
    problem.contacts.resize(cluster.contacts.size());
    assemble(cluster, problem);
    double speed = 0, error = 0;
    for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
        const FaceContact& c = contacts_.all()[cluster.contacts[i]];
        speed = std::max({speed, before_[cluster.contacts[i]].norm(), problem.contacts[i].free.norm()});
        const Vec2 place = model_.mesh.corner(c.edge[0]) + step.begin.displacement_of(c.edge[0]);
        error = std::max(error, rounding * (place.norm() + c.length) / step.drift_time);
    }
    for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
        const FaceContact& c = contacts_.all()[cluster.contacts[i]];
        const ContactLaw law = law_between(c);
        problem.contacts[i].law = contact_law(c.gap, before_[cluster.contacts[i]], law.friction, law.restitution,
                                              step.drift_time, deep * c.length, merged * speed + error);
    }
    drop_immobile(cluster, problem);
    double residual = 0, least = std::numeric_limits<double>::infinity();
    for (int round = 0, last_progress = 0; round < max_rounds; ++round) {
        residual = problem.solve(speed, error);
        for (std::size_t i = 0; i < cluster.contacts.size(); ++i)
            impulse_[cluster.contacts[i]] = problem.contacts[i].impulse;
        spread(cluster);
        bool has_soft = false;
        for (const Index s : cluster.slots) {
            TouchedFan& touched = touched_[s];
            if (!touched.is_soft && (splits[touched.fan] || !keeps_its_parts(touched, step, work, report))) {
                touched.is_soft = true;
                splits[touched.fan] = step.begin.split_rank[touched.fan] < 0;
            }
            if (touched.is_soft) respond_softly(touched, step, work, Slope::none);
            has_soft = has_soft || touched.is_soft;
        }
        if (!has_soft) break;
        // the rates that contacts really have
        for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
            Vec2& V = problem.contacts[i].velocity;
            V.setZero();
            for (const Term& term : terms_of(cluster.contacts[i]))
                V += term.rate(velocity_of(touched_[term.slot], term.place));
        }
        residual = problem.residual();
        if (residual < 0.5 * least) least = residual, last_progress = round;
        if (residual <= agreed * speed + error || round - last_progress > patience) break;
        const Slope slope = round < newton_rounds ? Slope::of_differences : Slope::largest;
        for (const Index s : cluster.slots)
            if (touched_[s].is_soft) respond_softly(touched_[s], step, work, slope);
        assemble(cluster, problem);
        drop_immobile(cluster, problem);
    }
    for (const Index i : cluster.contacts) residual_[i] = residual + error;
    if (speed > 0) report.contact_residual = std::max(report.contact_residual, std::max(0.0, residual - error) / speed);
    double before = 0, after = 0, energy = 0, lost = 0, injected = 0;
    for (const Index s : cluster.slots)
        for (std::size_t c = 0; c < touched_[s].corners.size(); ++c) {
            const Index corner = touched_[s].corners[c];
            const double speed_before = step.begin.velocity[step.begin.node_of_corner[corner]].norm(),
                         mass = model_.corner_mass[corner];
            energy += 0.5 * mass * speed_before * speed_before;
            before = std::max({before, speed_before, step.kick_time / mass * step.corner_force[corner].norm()});
            after = std::max(after, velocity_of(touched_[s], static_cast<Index>(c)).norm());
        }
    for (std::size_t i = 0; i < cluster.contacts.size(); ++i) {
        const Vec2 &P = problem.contacts[i].impulse,
                   mean = 0.5 * (before_[cluster.contacts[i]] + problem.contacts[i].velocity);
        injected += positive_work(P, mean), lost += positive_work(-P, mean);
    }
    // a residual changes no momentum and no energy, but the sign of single works: a gate judges their sum
    if (!(after <= absurd * before) || injected > max_injected * (energy + lost) + error * problem.largest_impulse()) {
        report.reject(Rejection::not_converged, place_of(cluster.contacts.front(), step.begin));
    }
}

/// [m/s] Of a touched corner under the present impulses.
Vec2 VertexContacts::velocity_of(const TouchedFan& touched, Index place) const {
    if (touched.is_soft) return touched.velocity[place];
    Vec2 v = touched.free[place];
    for (std::size_t d = 0; d < touched.corners.size(); ++d)
        v += touched.R.block<2, 2>(2 * place, 2 * static_cast<Eigen::Index>(d)) * corner_impulse_[touched.corners[d]];
    return v;
}

double VertexContacts::solve(const ExplicitStep& step, bool aside, std::vector<std::uint8_t>& splits,
                             std::vector<ThreadWorkspace>& workspaces, StepReport& report) {
    last_impulse_ = impulse_;
    report += sum_over_blocks(clusters_.size(), 1, partial_, [&](std::size_t k, std::size_t, StepReport& own) {
        if (clusters_[k].is_aside == aside)
            solve_cluster(clusters_[k], step, splits, workspaces[omp_get_thread_num()], own);
    });
    double largest = 0, change = 0;
    for (std::size_t i = 0; i < impulse_.size(); ++i) {
        largest = std::max(largest, impulse_[i].norm());
        change = std::max(change, (impulse_[i] - last_impulse_[i]).norm());
    }
    return largest > 0 ? change / largest : 0;
}

Vec2 VertexContacts::place_of(Index contact, const State& state) const {
    const Index corner = contacts_.all()[contact].vertex[1];
    return model_.mesh.corner(corner) + state.displacement_of(corner);
}

void VertexContacts::finish(const ExplicitStep& step, StepReport& report) {
    const auto contacts = contacts_.all();
    step.end.face_contacts.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const FaceContact& c = contacts[i];
        const Vec2 after = rate(i, step.end), mean = 0.5 * (before_[i] + after), P = impulse_[i];
        account_contact({.contact = P.x(),
                         .friction = P.y(),
                         .rate_N = mean.x(),
                         .rate_T = mean.y(),
                         .rate_error = residual_[i] + 1e-14 * (before_[i].norm() + after.norm()),
                         .opening = 0},  // contact_depth has it
                        report);
        report.contact_injection += positive_work(P, mean);
        report.contact_depth = std::max(report.contact_depth, -(c.gap + step.drift_time * after.x()) / c.length);
        step.end.face_contacts.push_back({c.vertex[1], c.edge[0], P.x(), P.y()});
    }
    report.face_contacts = static_cast<std::int64_t>(contacts.size());
    step.end.retired = step.begin.retired;  // for good; `end` may be an older state
    retire_points(model_, step.end);
}

}  // namespace knap
