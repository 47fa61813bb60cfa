#include "stepper/explicit/vertex_contacts.hpp"

#include "base/parallel.hpp"
#include "stepper/common/contact_search.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/contact/retirement.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double max_speed_ratio = 1e3;  // [-] of the speeds of a cluster: no impulse of a contact causes it
constexpr double max_injected = 1e-3;    // [-] of energy and losses of a cluster, by its residual
constexpr int careful_round = 3;         // of clusters with obstacles
constexpr int patience = 4;              // rounds without half the residual: a wedge has no solution

/// A face of the body, which is deformable: what R_N and R_T are for it, Rebounds has.
ContactLaw of_deformable(const ContactLaw& law) {
    return {.friction = law.friction, .restitution = law.restitution_of_faces(), .changing = law.changing};
}

}  // namespace

Index VertexContacts::touched_index_of(Index fan) {
    if (touched_of_fan_[fan] >= 0) return touched_of_fan_[fan];
    const auto touched_index = static_cast<Index>(fans_.size());
    fans_.push_back(fan);
    if (touched_.size() < fans_.size()) touched_.emplace_back();
    touched_[touched_index].fan = fan;
    touched_[touched_index].solved_jointly = false;
    touched_[touched_index].corners.clear();
    return touched_of_fan_[fan] = touched_index;
}

void VertexContacts::add_term(const CornerTerm& term) {
    const Index touched_index = touched_index_of(model_.fan_of_corner[term.body]);
    std::vector<Index>& corners = touched_[touched_index].corners;
    const Index place = place_among(corners, term.body);
    if (place == std::ssize(corners)) corners.push_back(term.body);
    terms_.push_back({term, touched_index, place});
}

/// [m/s] By which the forces of the step alone would make the sides approach: of the fans as a whole, and of obstacles.
double VertexContacts::approach_by_forces(Index contact, const ExplicitStep& step) const {
    double push = 0;
    for (const Term& term : terms_of(contact)) {
        const Fan& fan = model_.fans[fans_[term.touched_index]];
        Vec2 force = Vec2::Zero();
        for (const Index c : model_.corners(fan)) force += step.corner_force[c];
        if (const PrescribedMotion* motion = model_.motion_of(model_.corners(fan)[0]))
            for (int k = 0; k < 2; ++k)
                if (motion->component[k]) force[k] = 0;
        push -= step.kick_time / fan.mass * term.along_N.dot(force);
    }
    for (const ClusterTerm& term : obstacle_terms_of(contact))
        if (is_free(term.body))
            push -= term.along_N.dot(obstacles_.motion.rate()[term.body] - step.begin.obstacles[term.body].velocity);
    return push;
}

void VertexContacts::add_row(const FaceContact& contact, const ExplicitStep& step) {
    // a force lasts; a start in equilibrium has forces
    const double scale = step.kick_time / (step.begin.last_step > 0 ? step.begin.last_step : 1);
    Row row{row_of(model_, step.begin, contact, scale), touching_part * contact.length};
    row.gives = obstacles_.rebounds.find(contact, row.law, step.begin);
    if (row.law.rebound == ContactLaw::Rebound::of_bodies) row.deep = Rebounds::depth_of_faces() * contact.length;
    row.law = of_deformable(row.law);
    contact.visit_terms([&](const CornerTerm& term) {
        if (model_.ground_at(term.body) == nullptr) add_term(term);
    });
    add_row(row, step.begin);
}

void VertexContacts::add_row(const ObstacleContact& contact, const Vec2& impulse, const ExplicitStep& step) {
    const Vec2 n = contact.normal, t = turned_left(n),
               x = step.begin.obstacles[contact.obstacle].pose.position + contact.arm;
    add_term({contact.corner, (1 - contact.share) * n, (1 - contact.share) * t});
    if (contact.is_on_edge()) add_term({contact.second_corner, contact.share * n, contact.share * t});
    obstacle_terms_.push_back(term_on(contact.obstacle, -n, contact.arm));
    Row row{{.gap = contact.gap,
             .rounding = position_rounding * (x.norm() + contact.arm.norm()),
             .law = of_deformable(obstacles_.contacts.law_of(contact, step.begin)),
             .place = x,
             .impulse = impulse}};
    row.gives = obstacles_.given_at(contact);
    add_row(row, step.begin);
    settle_law(step);
}

void VertexContacts::add_row(const ObstaclePairContact& contact, const ExplicitStep& step) {
    visit_terms(contact, [&](const ClusterTerm& term) { obstacle_terms_.push_back(term); });
    add_row({row_of(model_, step.begin, contact), touching_part * contact.size}, step.begin);
    settle_law(step);
}

/// When all its terms are added.
void VertexContacts::add_row(const Row& row, const State& begin) {
    first_term_.push_back(terms_.size());
    first_obstacle_term_.push_back(obstacle_terms_.size());
    rows_.push_back(row);
    rows_.back().before = rate(static_cast<Index>(rows_.size()) - 1, begin);
}

/// Of the last row: what comes to rest under its load does not rebound.
void VertexContacts::settle_law(const ExplicitStep& step) {
    ContactLaw& law = rows_.back().law;
    const double approach = -rows_.back().before.x(),
                 push = approach_by_forces(static_cast<Index>(rows_.size()) - 1, step);
    if (rests_under(law.restitution, approach, push)) law.restitution = 0;
    if (approach <= push) law.tangential = 0;  // no impact
}

void VertexContacts::begin_obstacles(const ExplicitStep& step) {
    for (std::size_t o = 0; o < obstacle_velocity_.size(); ++o)
        obstacle_velocity_[o] = step.begin.obstacles[o].velocity;
    const double scale = step.begin.last_step > 0 ? step.kick_time / step.begin.last_step : 0;
    ImpulsesBefore before(step.begin, by_corner_);
    for (const ObstacleContact& contact : obstacles_.contacts.all())
        if (!solver_.is_within_fan(contact)) add_row(contact, scale * before.next(contact), step);
    for (const ObstaclePairContact& contact : obstacles_.pairs.all()) add_row(contact, step);
    obstacle_velocity_ = obstacles_.motion.rate();
    find_clusters();
}

void VertexContacts::begin(const ExplicitStep& step, StepReport& report) {
    touched_of_fan_.resize(model_.fans.size(), -1);
    for (const Index f : fans_) {
        touched_of_fan_[f] = -1;
        for (const Index corner : model_.corners(model_.fans[f])) corner_impulse_[corner].setZero();
    }
    fans_.clear(), rows_.clear(), terms_.clear(), obstacle_terms_.clear();
    first_term_.assign(1, 0), first_obstacle_term_.assign(1, 0);
    obstacle_velocity_.resize(model_.obstacles.size());
    contacts_.find(step.begin, step.drift_time);
    obstacles_.rebounds.begin(step.begin);
    if (const auto& refusal = contacts_.refusal()) {
        if (refusal->reason == ContactRefusal::Reason::speed)
            report.reject(Rejection::contact_speed, refusal->place, refusal->value);
        else report.add_depth(refusal->value, refusal->place);
    }
    for (const FaceContact& contact : contacts_.all()) {
        add_row(contact, step);
        report.add_approach(contact.gap, step.drift_time, rows_.back().before.x(), rows_.back().place);
    }
}

/// [m/s] The part of a rate that is by obstacles, under the present impulses.
Vec2 VertexContacts::rate_of_obstacles(Index contact) const {
    Vec2 V = Vec2::Zero();
    for (const ClusterTerm& term : obstacle_terms_of(contact)) V += term.rate(obstacle_velocity_[term.body]);
    return V;
}

/// [m/s] (V_N, V_T) of a contact, by the velocities of the body in a state.
Vec2 VertexContacts::rate(Index contact, const State& state) const {
    Vec2 V = rate_of_obstacles(contact);
    for (const Term& term : terms_of(contact)) V += term.rate(state.velocity[state.node_of_corner[term.body]]);
    return V;
}

/// Contacts that share a fan or a free obstacle.
void VertexContacts::find_clusters() {
    lists_.find(static_cast<Index>(rows_.size()),
                {static_cast<Index>(fans_.size()), static_cast<Index>(model_.obstacles.size())},
                [&](Index contact, const auto& visit) {
                    for (const Term& term : terms_of(contact)) visit(0, term.touched_index);
                    for (const ClusterTerm& term : obstacle_terms_of(contact))
                        if (is_free(term.body)) visit(1, term.body);
                });
    clusters_.clear();
    for (std::size_t k = 0; k < lists_.size(); ++k)
        clusters_.push_back({lists_.rows(k), lists_.members(0, k), lists_.members(1, k)});
    rigid_body_.resize(model_.obstacles.size());
}

/// The problem of a cluster, with the impulses found last as its start.
void VertexContacts::assemble(const Cluster& cluster, const ExplicitStep& step, bool stuck_stays,
                              ThreadWorkspace& work) {
    ContactProblem& problem = work.contacts;
    problem.clear();
    for (const Index s : cluster.touched) {
        TouchedFan& touched = touched_[s];
        touched.body.clear();
        if (!touched.solved_jointly) {
            add_parts(model_, touched, step, problem);
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
    for (const Index o : cluster.obstacles)
        rigid_body_[o] = problem.add_rigid_body(obstacles_.motion.rate()[o], obstacles_.motion.inverse_mass(o));
    for (const Index i : cluster.contacts) {
        Vec2 given = Vec2::Zero();
        for (const ClusterTerm& term : obstacle_terms_of(i))
            if (!is_free(term.body)) given += term.rate(obstacle_velocity_[term.body]);
        problem.add_contact(rows_[i].impulse, given);
        for (const Term& term : terms_of(i))
            problem.add_term(CornerTerm{touched_[term.touched_index].body[term.place], term.along_N, term.along_T});
        for (const ClusterTerm& term : obstacle_terms_of(i))
            if (is_free(term.body)) problem.add_term(ClusterTerm{rigid_body_[term.body], term.along_N, term.along_T});
    }
    problem.assemble();
}

/// Spreads the impulses of a cluster over the corners.
void VertexContacts::spread(const Cluster& cluster) {
    for (const Index s : cluster.touched)
        for (const Index corner : touched_[s].corners) corner_impulse_[corner].setZero();
    for (const Index i : cluster.contacts)
        for (const Term& term : terms_of(i)) corner_impulse_[term.body] += term.wrench(rows_[i].impulse);
}

/// [m/s] (V_N, V_T) of a contact under the present impulses.
Vec2 VertexContacts::rate(Index contact) const {
    Vec2 V = rate_of_obstacles(contact);
    for (const Term& term : terms_of(contact)) V += term.rate(touched_[term.touched_index].velocity[term.place]);
    return V;
}

void VertexContacts::solve_cluster(Cluster& cluster, const ExplicitStep& step, std::vector<std::uint8_t>& splits,
                                   ThreadWorkspace& work, StepReport& report) {
    ContactProblem& problem = work.contacts;
    bool any_jointly = false;
    for (const Index s : cluster.touched) {
        find_parts(model_, solver_, touched_[s], step, work);
        if (touched_[s].solved_jointly) solve_jointly(touched_[s], step.begin, splits), any_jointly = true;
    }
    spread(cluster);
    for (const Index s : cluster.touched)
        if (touched_[s].solved_jointly) solve_fan(model_, solver_, touched_[s], step, work.split);
    assemble(cluster, step, true, work);
    double speed = 0, error = 0;
    for (std::size_t k = 0; k < cluster.contacts.size(); ++k) {
        speed = std::max({speed, rows_[cluster.contacts[k]].before.norm(), problem.contact(k).free.norm()});
        error = std::max(error, rows_[cluster.contacts[k]].rounding / step.drift_time);
    }
    const bool meets_obstacles =
        std::ranges::any_of(cluster.contacts, [&](Index i) { return !obstacle_terms_of(i).empty(); });
    // with obstacles the first rounds are guesses: the fans judge them, and most agree before the laws of all points do
    const auto effort_of = [&](int round) {
        if (!meets_obstacles || !any_jointly || round >= careful_round) return ClusterEffort::careful;
        return round == 0 ? ClusterEffort::active_set : ClusterEffort::proximal_points;
    };
    double residual = 0, least = infinity;
    bool more_jointly = false;
    for (int round = 0, last_progress = 0; round < max_iterations; ++round) {
        if (round > 0) assemble(cluster, step, more_jointly, work);
        for (std::size_t k = 0; k < cluster.contacts.size(); ++k) {
            const Row& row = rows_[cluster.contacts[k]];
            const double of_gap = cluster.contacts[k] < n_faces() ? error : 0;  // else ObstacleContacts clears it
            const bool rubs = row.gives.rubs && problem.may_slip(k);
            problem.contact(k).law =
                contact_law(row.gap, row.before, rubs ? row.law.friction : 0, row.law.restitution, step.drift_time,
                            row.deep, relative_tolerance * speed + of_gap, row.law.tangential, row.gives.rate);
            if (!row.gives.pushes) problem.contact(k).law.contact.may_touch = false;
        }
        residual = problem.solve(speed, error, effort_of(round));
        for (std::size_t k = 0; k < cluster.contacts.size(); ++k)
            rows_[cluster.contacts[k]].impulse = problem.contact(k).impulse;
        for (const Index o : cluster.obstacles) obstacle_velocity_[o] = problem.velocity_of_rigid_body(rigid_body_[o]);
        spread(cluster);
        more_jointly = false;
        for (const Index s : cluster.touched) {
            TouchedFan& touched = touched_[s];
            if (!touched.solved_jointly &&
                (splits[touched.fan] || !keeps_its_parts(model_, touched, step, work, report)))
                solve_jointly(touched, step.begin, splits), any_jointly = more_jointly = true;
            if (touched.solved_jointly) {
                solve_fan(model_, solver_, touched, step, work.split);
            } else {
                touched.velocity.clear();
                for (const Index body : touched.body) touched.velocity.push_back(problem.velocity(body));
            }
        }
        work.rate.clear();
        for (const Index i : cluster.contacts) work.rate.push_back(rate(i));
        if (!any_jointly) break;
        residual = problem.residual(work.rate);
        if (residual < 0.5 * least) least = residual, last_progress = round;
        if (residual <= relative_tolerance * speed + error || round - last_progress > patience) break;
    }
    cluster.error = residual + error;
    cluster.residual = speed > 0 ? std::max(0.0, residual - error) / speed : 0;
    cluster.worst = cluster.contacts[cluster.residual > relative_tolerance ? problem.worst() : 0];
    double before = 0, after = 0, energy = 0, lost = 0, injected = 0;
    for (const Index s : cluster.touched) {
        for (const Index corner : model_.corners(model_.fans[touched_[s].fan])) {  // what pushes may not touch
            const double speed_before = step.begin.velocity[step.begin.node_of_corner[corner]].norm(),
                         mass = model_.corner_mass[corner];
            energy += 0.5 * mass * speed_before * speed_before;
            before = std::max({before, speed_before, step.kick_time / mass * step.corner_force[corner].norm()});
        }
        for (const Vec2& velocity : touched_[s].velocity) after = std::max(after, velocity.norm());
    }
    for (const Index o : cluster.obstacles)
        energy += kinetic_energy(model_.obstacles[o], step.begin.obstacles[o].velocity);
    before = std::max(before, speed);  // also of what is driven, or falls on what rests
    for (std::size_t k = 0; k < cluster.contacts.size(); ++k) {
        const Row& row = rows_[cluster.contacts[k]];
        const Vec2 P = row.impulse, mean = 0.5 * (row.before + work.rate[k]);
        injected += positive_work(P, mean), lost += positive_work(-P, mean);
    }
    // a residual changes no momentum and no energy, but the sign of single works: a gate judges their sum
    if (!(after <= max_speed_ratio * before) ||
        injected > max_injected * (energy + lost) + error * problem.largest_impulse())
        report.reject(Rejection::contact_residual, rows_[cluster.worst].place,
                      cluster.residual > max_contact_residual ? cluster.residual : 0);
}

void VertexContacts::solve(const ExplicitStep& step, std::vector<std::uint8_t>& splits,
                           std::vector<ThreadWorkspace>& workspaces, StepReport& report) {
    report += sum_over_blocks(clusters_.size(), 1, partial_, [&](std::size_t k, std::size_t, StepReport& own) {
        solve_cluster(clusters_[k], step, splits, workspaces[omp_get_thread_num()], own);
    });
}

void VertexContacts::add_wrenches(std::vector<Vec3>& wrench) const {
    for (Index i = 0; i < static_cast<Index>(rows_.size()); ++i)
        for (const ClusterTerm& term : obstacle_terms_of(i)) wrench[term.body] += term.wrench(rows_[i].impulse);
}

VertexSolver::Known* VertexContacts::motion_of(Index rank, const ExplicitStep& step) {
    const Index fan = step.end.split_fans[rank];
    if (!touches(fan) || !step.end.incubation.empty()) return nullptr;
    TouchedFan& touched = touched_[touched_of_fan_[fan]];
    return touched.solved_jointly ? &touched.known : nullptr;
}

/// The rates of obstacles are those that their impulses give them, as in the state.
void VertexContacts::finish(const ExplicitStep& step, StepReport& report) {
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o)
        for (int k = 0; k < 3; ++k)
            if (model_.obstacles[o].is_free(k)) obstacle_velocity_[o][k] = step.end.obstacles[o].velocity[k];
    step.end.face_contacts.clear();
    const double lasting = step.drift_time / step.kick_time;  // the first step kicks for half its size
    step.end.obstacle_contacts.clear();
    for (Index row = n_faces(); const ObstacleContact& contact : obstacles_.contacts.all())
        if (!solver_.is_within_fan(contact)) {
            const Vec2 P = lasting * rows_[row++].impulse;
            const bool may_be_one_of_two = model_.obstacles[contact.obstacle].outline.line != nullptr;
            if (may_be_one_of_two || !P.isZero(0))
                step.end.obstacle_contacts.push_back(
                    {contact.corner, contact.second_corner, contact.obstacle, P.x(), P.y()});
        }
    for (Index i = 0; i < static_cast<Index>(rows_.size()); ++i) {
        const Row& row = rows_[i];
        const Vec2 after = rate(i, step.end), mean = 0.5 * (row.before + after), P = row.impulse;
        account_contact(
            {.contact = P.x(),
             .friction = P.y(),
             .rate_N = mean.x(),
             .rate_T = mean.y(),
             .rate_error = clusters_[lists_.of_row(i)].error + rate_rounding * (row.before.norm() + after.norm()),
             // of faces contact_depth has it
             .opening = i < n_faces() || row.gives.lies_deep ? 0 : row.gap + step.drift_time * after.x(),
             .may_flutter = row.law.changing >= 0},
            report);
        report.contact_injection += positive_work(P, mean);
        if (i >= n_faces()) continue;
        const FaceContact& c = contacts_.all()[i];
        report.add_depth((c.depth - step.drift_time * after.x()) / c.length, row.place);
        step.end.face_contacts.push_back({c.vertex[1], c.edge[0], c.vertex[0], lasting * P.x(), lasting * P.y()});
    }
    for (const Cluster& cluster : clusters_) report.add_contact_residual(cluster.residual, rows_[cluster.worst].place);
    report.face_contacts = n_faces();
    obstacles_.rebounds.finish(step.end);
    if (model_.faces_meet()) retire_points(model_, step.begin.retired, step.end);
}

}  // namespace knap
