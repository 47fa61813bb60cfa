#include "stepper/explicit/vertex_contacts.hpp"

#include "base/parallel.hpp"
#include "base/union_find.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/contact/retirement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knap {
namespace {

constexpr double deep = 1e-3;                // [-] of the edge: a deeper penetration is reduced by a rebound
constexpr double merged = 1e-12;             // [-] of the speeds: nearer kinks of the friction are one
constexpr double absurd = 1e3;               // [-] of the speeds of a cluster: no impulse of a contact causes it
constexpr double max_injected = 1e-3;        // [-] of energy and losses of a cluster, by its residual
constexpr double agreed = 1e-12;             // [-] of the speeds, between contacts and fans
constexpr double position_rounding = 1e-15;  // [-] of the positions
constexpr int max_contact_rounds = 100;      // of contacts and fans
constexpr int patience = 4;                  // rounds without half the residual: a wedge has no solution

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
    return slot_of_fan_[fan] = slot;
}

void VertexContacts::add_terms(Index contact) {
    const FaceContact& c = contacts_.all()[contact];
    const Vec2 n = c.normal, t = turned_left(n), turn = c.gap / c.length * n;
    const auto add = [&](Index corner, const Vec2& along_N, const Vec2& along_T) {
        if (model_.ground_at(corner) != nullptr) return;
        const Index slot = slot_of(model_.fan_of_corner[corner]);
        std::vector<Index>& corners = touched_[slot].corners;
        const Index place = place_among(corners, corner);
        if (place == std::ssize(corners)) corners.push_back(corner);
        terms_.push_back({contact, slot, place, along_N, along_T});
    };
    for (const Index corner : c.vertex) add(corner, 0.5 * n, 0.5 * t);
    add(c.edge[0], -(1 - c.share) * n, -(1 - c.share) * t - turn);
    add(c.edge[1], -c.share * n, -c.share * t + turn);
    first_term_.push_back(terms_.size());
}

void VertexContacts::begin(const ExplicitStep& step, StepReport& report) {
    slot_of_fan_.resize(model_.fans.size(), -1);
    for (const Index f : fans_) {
        slot_of_fan_[f] = -1;
        for (const Index corner : model_.corners(model_.fans[f])) corner_impulse_[corner].setZero();
    }
    fans_.clear(), terms_.clear(), first_term_.assign(1, 0);
    contacts_.find(step.begin, step.drift_time);
    if (const auto& refusal = contacts_.refusal()) {
        if (refusal->reason == ContactRefusal::Reason::speed)
            report.reject(Rejection::contact_speed, refusal->place, refusal->value);
        else report.add_depth(refusal->value, refusal->place);
    }
    const auto n = static_cast<Index>(contacts_.all().size());
    impulse_.resize(n), before_.resize(n), residual_.assign(n, 0);
    // a force lasts; a start in equilibrium has forces
    const double scale = step.kick_time / (step.begin.last_step > 0 ? step.begin.last_step : 1);
    for (Index i = 0; i < n; ++i) {
        add_terms(i);
        impulse_[i] = scale * Vec2(contacts_.all()[i].contact, contacts_.all()[i].tangential);
        before_[i] = rate(i, step.begin);
        report.add_approach(contacts_.all()[i].gap, step.drift_time, before_[i].x(), place_of(i, step.begin));
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
    n_clusters_ = 0;
    std::vector<Index>& cluster_of = cluster_of_slot_;  // of the representatives
    cluster_of.assign(fans_.size(), -1);
    const auto cluster = [&](Index slot) {
        Index& found = cluster_of[joined.find(slot)];
        if (found >= 0) return found;
        if (clusters_.size() == n_clusters_) clusters_.emplace_back();
        Cluster& added = clusters_[n_clusters_];
        added.contacts.clear(), added.slots.clear();
        added.is_aside = false, added.residual = 0;
        return found = static_cast<Index>(n_clusters_++);
    };
    for (std::size_t i = 0; i < n; ++i)
        clusters_[cluster(terms_of(i)[0].slot)].contacts.push_back(static_cast<Index>(i));
    for (std::size_t s = 0; s < fans_.size(); ++s) clusters_[cluster(s)].slots.push_back(s);
}

/// The parts of a fan move as rigid bodies: corners that points hold together which have not moved. Soft: a fan on a
/// support, or with prescribed corners that may split, or one whose parts cannot stay as they are.
void VertexContacts::find_parts(TouchedFan& touched, const ExplicitStep& step, ThreadWorkspace& work) const {
    const State& begin = step.begin;
    const Fan& fan = model_.fans[touched.fan];
    const auto corners = model_.corners(fan);
    const Index rank = begin.split_rank[touched.fan];
    std::vector<Index>& part = touched.part;
    part.assign(corners.size(), 0);
    touched.is_soft = solver_.has_outer_forces(touched.fan);
    if (rank < 0) return;
    std::iota(part.begin(), part.end(), 0);
    for (Index j = 0; j < fan.n_points; ++j) {
        const FanPoint& point = model_.points(fan)[j];
        if (point.on_support()) {
            touched.is_soft = true;
            continue;
        }
        const Index before = begin.node_of_corner[point.before], after = begin.node_of_corner[point.after];
        const bool together =
            begin.displacement[before] == begin.displacement[after] && begin.velocity[before] == begin.velocity[after];
        const bool held = unbreakable(model_, point) || begin.points[begin.first_point[rank] + j].cohesion > 0;
        if (held && together)
            std::ranges::replace(part, part[place_among(corners, point.after)],
                                 part[place_among(corners, point.before)]);
    }
    const auto is_prescribed = [&](Index corner) { return model_.motion_of(corner) != nullptr; };
    touched.is_soft = touched.is_soft || std::ranges::any_of(touched.corners, is_prescribed) ||
                      !may_be_stationary(model_, rank, step, work.split.stationary);
}

void VertexContacts::soften(TouchedFan& touched, const State& begin, std::vector<std::uint8_t>& splits) const {
    touched.is_soft = true;
    splits[touched.fan] = begin.split_rank[touched.fan] < 0;
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

/// The motion of a fan under the present impulses.
void VertexContacts::solve_fan(TouchedFan& touched, const ExplicitStep& step, VertexSolver::Workspace& work) const {
    const auto corners = model_.corners(model_.fans[touched.fan]);
    touched.known.solution = solver_.solve(touched.fan, step, work);
    std::swap(work.fan, touched.known.fan);
    touched.velocity.clear();
    for (const Index corner : touched.corners)
        touched.velocity.push_back(touched.known.fan.result.velocity[place_among(corners, corner)]);
}

/// One body for each part that contacts touch.
void VertexContacts::add_parts(TouchedFan& touched, const ExplicitStep& step, ContactProblem& problem) const {
    const Fan& fan = model_.fans[touched.fan];
    const State& begin = step.begin;
    const auto corners = model_.corners(fan);
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
        if (const PrescribedMotion* motion = model_.motion_of(corner)) {  // of the whole fan, which is bonded
            const Vec2 given =
                step.prescribed_velocity(model_, *motion, begin.displacement[begin.node_of_corner[corner]]);
            for (int k = 0; k < 2; ++k)
                if (motion->component[k]) free[k] = given[k], mobility[k] = 0;
        }
        touched.body.push_back(problem.add_body(free, mobility));
    }
}

/// The problem of a cluster, with the impulses found last as its start.
void VertexContacts::assemble(const Cluster& cluster, const ExplicitStep& step, bool stuck_stays,
                              ThreadWorkspace& work) {
    ContactProblem& problem = work.contacts;
    problem.clear();
    for (const Index s : cluster.slots) {
        TouchedFan& touched = touched_[s];
        touched.body.clear();
        if (!touched.is_soft) {
            add_parts(touched, step, problem);
            continue;
        }
        const auto corners = model_.corners(model_.fans[touched.fan]);
        for (const Index corner : touched.corners) {  // without the contacts
            FanBody& body = touched.known.fan.problem.bodies[place_among(corners, corner)];
            body.free_velocity -= body.inverse_mass.cwiseProduct(corner_impulse_[corner]);
        }
        const Index first = problem.add_fan(touched.known.fan, static_cast<Index>(corners.size()), stuck_stays);
        for (const Index corner : touched.corners) touched.body.push_back(first + place_among(corners, corner));
    }
    for (const Index i : cluster.contacts) {
        problem.add_contact(impulse_[i]);
        for (const Term& term : terms_of(i))
            problem.add_term(touched_[term.slot].body[term.place], term.along_N, term.along_T);
    }
    problem.assemble();
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

/// [m/s] (V_N, V_T) of a contact under the present impulses.
Vec2 VertexContacts::rate(Index contact) const {
    Vec2 V = Vec2::Zero();
    for (const Term& term : terms_of(contact)) V += term.rate(touched_[term.slot].velocity[term.place]);
    return V;
}

void VertexContacts::solve_cluster(Cluster& cluster, const ExplicitStep& step, std::vector<std::uint8_t>& splits,
                                   ThreadWorkspace& work, StepReport& report) {
    ContactProblem& problem = work.contacts;
    bool has_soft = false;
    for (const Index s : cluster.slots) {
        touched_[s].is_aside = cluster.is_aside;
        find_parts(touched_[s], step, work);
        if (touched_[s].is_soft) soften(touched_[s], step.begin, splits), has_soft = true;
    }
    spread(cluster);
    for (const Index s : cluster.slots)
        if (touched_[s].is_soft) solve_fan(touched_[s], step, work.split);
    assemble(cluster, step, true, work);
    double speed = 0, error = 0;
    for (std::size_t k = 0; k < cluster.contacts.size(); ++k) {
        const FaceContact& c = contacts_.all()[cluster.contacts[k]];
        speed = std::max({speed, before_[cluster.contacts[k]].norm(), problem.contact(k).free.norm()});
        error = std::max(
            error, position_rounding * (place_of_corner(c.edge[0], step.begin).norm() + c.length) / step.drift_time);
    }
    double residual = 0, least = infinity;
    bool more_soft = false;
    for (int round = 0, last_progress = 0; round < max_contact_rounds; ++round) {
        if (round > 0) assemble(cluster, step, more_soft, work);
        for (std::size_t k = 0; k < cluster.contacts.size(); ++k) {
            const FaceContact& c = contacts_.all()[cluster.contacts[k]];
            const ContactLaw law = law_between_faces(model_, c);
            problem.contact(k).law = contact_law(c.gap, before_[cluster.contacts[k]], law.friction, law.restitution,
                                                 step.drift_time, deep * c.length, merged * speed + error);
        }
        residual = problem.solve(speed, error);
        for (std::size_t k = 0; k < cluster.contacts.size(); ++k)
            impulse_[cluster.contacts[k]] = problem.contact(k).impulse;
        spread(cluster);
        more_soft = false;
        for (const Index s : cluster.slots) {
            TouchedFan& touched = touched_[s];
            if (!touched.is_soft && (splits[touched.fan] || !keeps_its_parts(touched, step, work, report)))
                soften(touched, step.begin, splits), has_soft = more_soft = true;
            if (touched.is_soft) {
                solve_fan(touched, step, work.split);
            } else {
                touched.velocity.clear();
                for (const Index body : touched.body) touched.velocity.push_back(problem.velocity(body));
            }
        }
        work.rate.clear();
        for (const Index i : cluster.contacts) work.rate.push_back(rate(i));
        if (!has_soft) break;
        residual = problem.residual(work.rate);
        if (residual < 0.5 * least) least = residual, last_progress = round;
        if (residual <= agreed * speed + error || round - last_progress > patience) break;
    }
    for (const Index i : cluster.contacts) residual_[i] = residual + error;
    cluster.residual = speed > 0 ? std::max(0.0, residual - error) / speed : 0;
    double before = 0, after = 0, energy = 0, lost = 0, injected = 0;
    for (const Index s : cluster.slots)
        for (std::size_t c = 0; c < touched_[s].corners.size(); ++c) {
            const Index corner = touched_[s].corners[c];
            const double speed_before = step.begin.velocity[step.begin.node_of_corner[corner]].norm(),
                         mass = model_.corner_mass[corner];
            energy += 0.5 * mass * speed_before * speed_before;
            before = std::max({before, speed_before, step.kick_time / mass * step.corner_force[corner].norm()});
            after = std::max(after, touched_[s].velocity[c].norm());
        }
    for (std::size_t k = 0; k < cluster.contacts.size(); ++k) {
        const Vec2 P = impulse_[cluster.contacts[k]], mean = 0.5 * (before_[cluster.contacts[k]] + work.rate[k]);
        injected += positive_work(P, mean), lost += positive_work(-P, mean);
    }
    // a residual changes no momentum and no energy, but the sign of single works: a gate judges their sum
    if (!(after <= absurd * before) || injected > max_injected * (energy + lost) + error * problem.largest_impulse())
        report.reject(Rejection::contact_residual, place_of(cluster.contacts.front(), step.begin), cluster.residual);
}

double VertexContacts::solve(const ExplicitStep& step, bool aside, std::vector<std::uint8_t>& splits,
                             std::vector<ThreadWorkspace>& workspaces, StepReport& report) {
    last_impulse_ = impulse_;
    report += sum_over_blocks(n_clusters_, 1, partial_, [&](std::size_t k, std::size_t, StepReport& own) {
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

VertexSolver::Known* VertexContacts::motion_of(Index rank, const ExplicitStep& step) {
    const Index fan = step.end.split_fans[rank];
    if (!touches(fan) || !step.end.incubation.empty()) return nullptr;
    TouchedFan& touched = touched_[slot_of_fan_[fan]];
    return touched.is_soft && !touched.is_aside ? &touched.known : nullptr;
}

Vec2 VertexContacts::place_of_corner(Index corner, const State& state) const {
    if (const GroundVertex* ground = model_.ground_at(corner)) return ground->place;
    return model_.mesh.corner(corner) + state.displacement_of(corner);
}

Vec2 VertexContacts::place_of(Index contact, const State& state) const {
    return place_of_corner(contacts_.all()[contact].vertex[1], state);
}

void VertexContacts::finish(const ExplicitStep& step, StepReport& report) {
    const auto contacts = contacts_.all();
    step.end.face_contacts.clear();
    const double lasting = step.drift_time / step.kick_time;  // the first step kicks for half its size
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
        report.add_depth((c.depth - step.drift_time * after.x()) / c.length,
                         place_of(static_cast<Index>(i), step.begin));
        step.end.face_contacts.push_back({c.vertex[1], c.edge[0], c.vertex[0], lasting * P.x(), lasting * P.y()});
    }
    for (const Cluster& cluster : clusters())
        report.add_contact_residual(cluster.residual, place_of(cluster.contacts.front(), step.begin));
    report.face_contacts = static_cast<std::int64_t>(contacts.size());
    retire_points(model_, step.begin.retired, step.end);
}

}  // namespace knap
