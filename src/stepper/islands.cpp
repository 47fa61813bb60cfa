#include "stepper/islands.hpp"

#include "base/parallel.hpp"
#include "stepper/common/changing_friction.hpp"
#include "stepper/common/elastic_energy.hpp"
#include "stepper/common/mean_motions.hpp"
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/common/surface_energy.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr int max_rings = 3;
constexpr Index few_triangles = 512;      // of an island: one thread is as fast as two
constexpr double allowed_overlap = 0.01;  // [-] of an edge, of the island and the rest
constexpr double allowed_gain = 1e-5;     // [-] exchange_work over the kinetic energy

/// Adds the works and counts of another step; the energies are those of the end.
void add_works(StepReport step, StepReport& sum) {
    step.kinetic = step.strain = step.dissipated = step.recoverable = step.interface_elastic = 0;
    sum += step;
}

/// Forces of the rest, which the explicit scheme reads as loads, on all corners: cracks make corners inside the part
/// ends of free faces. Returns the place of each corner in Model::corner_loads.
std::vector<Index> add_forces_of_rest(PartOfBody& part) {
    Model& model = part.model;
    const auto history = static_cast<Index>(model.histories.size());
    model.histories.emplace_back(), model.load_names.emplace_back();
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        model.corner_loads.push_back({.corner = c, .history = history, .force = Vec2::Zero()});
    std::ranges::stable_sort(model.corner_loads, {}, &CornerLoad::corner);
    std::vector<Index> places;
    for (Index i = 0; i < std::ssize(model.corner_loads); ++i)
        if (model.corner_loads[i].history == history) places.push_back(i);
    return places;
}

}  // namespace

/// The contacts of a step in which nothing else is hit too hard.
StepReport Islands::try_step(const State& begin, double h) {
    for (;;) {
        StepReport report = rigid_.try_step(begin, h, deformable_);
        if (!rigid_.mark_struck(deformable_)) return report;
    }
}

StepReport Islands::step(const State& begin, double h, State& end) {
    deformable_.clear();
    std::size_t n_before = 0;
    for (const RigidPiece& piece : begin.rigid_pieces) {
        deformable_.push_back(piece.state == PieceState::deformable);
        n_before += deformable_.back();
    }
    for (int ring = 0;; ++ring) {
        StepReport report = try_step(begin, h);
        const auto n = static_cast<std::size_t>(std::ranges::count(deformable_, 1));
        if (n > 0 && !begin.frozen && begin.last_step > 0) {
            report.rejection = Rejection::none;
            report.reject(Rejection::blow, rigid_.blow().place, rigid_.blow().value);
        }
        if (report.rejection != Rejection::none) return report;
        report = rigid_.end_step(report, end);
        if (n == 0) return report;
        report.thaws = static_cast<std::int64_t>(n - n_before);
        advance(h, end, report);
        const bool fails = report.rejection != Rejection::none;
        if (grow(ring, end, report)) {
            explicit_.reset();  // it has seen states that do not count
            continue;
        }
        if (fails) return report;
        update_pieces(h, end, report);
        return report;
    }
}

/// Marks what must be deformable, too; false where nothing must. An island that fails may take in all pieces; one that
/// still lies deep in others after some rings takes in all that it touches.
bool Islands::grow(int ring, const State& end, const StepReport& report) {
    const RigidContacts& contacts = rigid_.contacts();
    const bool fails = report.rejection != Rejection::none, is_late = ring >= max_rings,
               gains = !is_late && report.exchange_work > allowed_gain * report.kinetic;
    if (!fails && !gains) {
        if (!contacts.mark_overlapping(end, allowed_overlap, rigid_.bodies(), deformable_)) return false;
        if (is_late) contacts.mark_touching(rigid_.bodies(), deformable_);
        return true;
    }
    if (contacts.mark_touching(rigid_.bodies(), deformable_)) return true;
    if (!fails || std::ranges::count(deformable_, 0) == 0) return false;
    std::ranges::fill(deformable_, 1);
    return true;
}

/// The deformable pieces as a body of their own.
void Islands::find_part() {
    const FrozenBody& body = *rigid_.start().frozen;
    std::vector<Index> triangles;
    for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
        if (deformable_[body.piece_of_triangle[t]]) triangles.push_back(t);
    if (explicit_ && triangles == part_.triangles) return;
    explicit_.reset();
    part_ = part_of(model_, triangles);
    load_of_corner_ = add_forces_of_rest(part_), pushed_.clear();
    explicit_ = std::make_unique<ExplicitScheme>(part_.model, options_);
    now_ = {}, next_ = {};
}

/// What overlaps after the large step before has a contact of this step: without it, the micro steps would take a deep
/// vertex for the back of a body (contact/README.md, rule 5).
void Islands::add_contacts_of_trial() {
    std::vector<FaceContactState>& contacts = start_.face_contacts;
    const auto place = [](const FaceContactState& at) { return std::pair(at.vertex, at.edge); };
    const auto known = static_cast<std::ptrdiff_t>(contacts.size());
    rigid_.contacts().for_overlapping_deformable(rigid_.bodies(), [&](Index vertex, Index edge, Index entering) {
        const FaceContactState at{part_.in_part(vertex), part_.in_part(edge), part_.in_part(entering), 0, 0};
        if (!std::ranges::binary_search(contacts.begin(), contacts.begin() + known, place(at), {}, place))
            contacts.push_back(at);
    });
    std::ranges::sort(contacts, {}, place);
}

/// Velocities of this moment: what was rigid gets the second half of its last kick.
void Islands::begin_island(StepReport& report) {
    const State& start = rigid_.start();
    const std::vector<MovingBody>& bodies = rigid_.bodies();
    rigid_.contacts().impulses_on_deformable(bodies, impulses_);
    std::vector<Vec3> wrench(start.rigid_pieces.size(), Vec3::Zero());
    forces_.clear();
    for (const auto& [piece, corner, impulse] : impulses_) {
        const Vec2 place = model_.mesh.corner(corner) + start.displacement_of(corner);
        wrench[piece] += wrench_of(impulse, place - bodies[piece].centre);
        forces_.push_back({part_.in_part(corner), impulse / bodies[piece].kick});
    }
    std::ranges::stable_sort(forces_, {}, &Force::corner);
    start_ = state_of_part(model_, start, part_);
    add_contacts_of_trial();
    std::vector<Vec3> after(start.rigid_pieces.size(), Vec3::Zero());
    for (Index p = 0; p < std::ssize(after); ++p) {
        if (!begins(p)) continue;
        const RigidPiece& piece = start.rigid_pieces[p];
        const FrozenBody::Piece& body = start.frozen->pieces[p];
        const double half = 0.5 * piece.last_step;
        const Vec3 of_loads = half * rigid_.load_on(p), of_rest = half / bodies[p].kick * wrench[p];
        after[p] =
            piece.rates() + Vec3(1 / body.mass, 1 / body.mass, 1 / body.inertia).cwiseProduct(of_loads + of_rest);
        const Vec3 mean = 0.5 * (piece.rates() + after[p]);
        report.external_work += of_loads.dot(mean), report.exchange_work += of_rest.dot(mean);
    }
    for (Index c = 0; c < part_.model.mesh.n_corners(); ++c) {
        const Index corner = part_.in_whole(c), p = start.frozen->piece_of_triangle[corner / 3];
        if (!begins(p)) continue;
        const Vec2 arm = model_.mesh.corner(corner) + start.displacement_of(corner) - bodies[p].centre;
        start_.velocity[start_.node_of_corner[c]] = after[p].head<2>() + after[p].z() * turned_left(arm);
    }
    now_ = start_;
    mean_reaction_.assign(model_.obstacles.size(), Vec3::Zero());
}

/// Sets the forces of the rest, times a factor.
void Islands::push(double factor) {
    for (const Index corner : pushed_) force_on(corner).setZero();
    pushed_.clear();
    for (const Force& at : forces_) {
        force_on(at.corner) += factor * at.value;
        if (pushed_.empty() || pushed_.back() != at.corner) pushed_.push_back(at.corner);
    }
}

/// The work of the forces of the rest in the step from now_ to next_, which is none of loads.
void Islands::account_exchange(double kick, StepReport& report) {
    double work = 0;
    for (const Index c : pushed_)
        work += 0.5 * kick *
                force_on(c).dot(now_.velocity[now_.node_of_corner[c]] + next_.velocity[next_.node_of_corner[c]]);
    report.external_work -= work, report.exchange_work += work;
}

bool Islands::begins(Index piece) const {
    return deformable_[piece] && rigid_.start().rigid_pieces[piece].state != PieceState::deformable;
}

StepReport Islands::take_micro_steps(double h) {
    const double closing = closing_part * std::min(limits_.cracking, h), span = h - closing;
    StepLimits limits = limits_;
    limits.end = start_.time + span;
    limits.largest = limits.cracking = span / std::ceil(span / limits_.cracking);
    limits.smallest = std::min(limits.smallest, limits.cracking);
    limits.rigid = {}, limits.change = {};
    StepControl control(limits);
    const OneThread alone(part_.model.mesh.n_triangles() < few_triangles);
    double struck = -infinity;  // before this step
    for (const RigidPiece& piece : rigid_.start().rigid_pieces)
        if (piece.state == PieceState::deformable) struck = std::max(struck, piece.struck);
    control.go_on_after_impact(struck);
    StepReport works;
    const auto psi = [](const StepReport& at) { return at.dissipated + at.recoverable + at.interface_elastic; };
    const double psi_at_start = psi(surface_energy(part_.model, start_));
    double psi_before = psi_at_start;
    double given = 0;  // [s] sum of the kicks
    const auto advance = [&](double drift, const StepReport& step) {
        const double kick = 0.5 * (now_.last_step + drift);
        add_works(step, works);
        // as the ledger has it after a step: works belong to the middle, and Psi of constant unloading to the end
        const double lag = works.cohesive_work - works.crossing_loss - works.viscous_dissipation -
                           works.mixed_dissipation - (psi(step) - psi_at_start) +
                           (step.interface_elastic == 0 ? 0.5 * (psi(step) - psi_before) : 0);
        works.micro_lag = std::max(works.micro_lag, lag), works.micro_lead = std::max(works.micro_lead, -lag);
        psi_before = psi(step);
        account_exchange(kick, works);
        for (std::size_t o = 0; o < mean_reaction_.size(); ++o)
            mean_reaction_[o] += kick / h * next_.obstacles[o].reaction;
        if (follows_slip(part_.model)) follow_slip(part_.model, now_, next_);
        next_.time = now_.time + drift, next_.last_step = drift, next_.n_steps = now_.n_steps + 1;
        given += kick;
        if (works.micro_steps == 0)
            works.thaw_dissipation = dissipated_since(part_.model, start_, next_, [&](Index corner) {
                return begins(rigid_.start().frozen->piece_of_triangle[part_.triangles[corner / 3]]);
            });
        std::swap(now_, next_);
        ++works.micro_steps;
    };
    push(1);
    while (!StepControl::has_reached(now_, limits.end)) {
        const double drift = control.next(now_);
        const StepReport step = explicit_->step(now_, drift, next_);
        if (const auto cut = control.judge(now_, drift, step)) {
            if (!control.is_stuck()) continue;
            works = step;
            works.reject(Rejection::not_converged, cut->place.value_or(Vec2::Zero()), cut->value);
            return works;
        }
        advance(drift, step);
    }
    // the other half of the last kick; of loads and of the rest also what the middle of this step lacks to its end
    const double kick = 0.5 * (now_.last_step + closing);
    const std::vector<TimeFunction> histories = part_.model.histories;
    for (TimeFunction& history : part_.model.histories)
        history = {.time = {now_.time}, .value = {history(now_.time) * (1 + 0.5 * closing / kick)}};
    push((h - given) / kick / part_.model.histories.back()(now_.time));
    StepReport step = explicit_->step(now_, closing, next_);
    part_.model.histories = histories;
    if (step.rejection != Rejection::none && step.rejection != Rejection::contact_residual &&
        step.rejection != Rejection::contact_speed)
        return step;
    // a shorter one would not help; contact_injection judges what single contacts gain by it
    step.contact_residual = std::min(step.contact_residual, max_contact_residual);
    push((h - given) / kick);
    advance(closing, step);
    works.rejection = Rejection::none;
    const StepReport surface = surface_energy(part_.model, now_);
    std::vector<Vec2> force;
    const double strain = elastic_energy(part_.model, now_, force);
    works.step_change_work += strain - step.strain;
    works.kinetic = step.kinetic, works.strain = strain, works.dissipated = surface.dissipated;
    works.recoverable = surface.recoverable, works.interface_elastic = surface.interface_elastic;
    return works;
}

void Islands::advance(double h, State& end, StepReport& report) {
    find_part();
    begin_island(report);
    const StepReport all = surface_energy(model_, rigid_.start()), own = surface_energy(part_.model, start_);
    report.dissipated = all.dissipated - own.dissipated, report.recoverable = all.recoverable - own.recoverable;
    report.interface_elastic = all.interface_elastic - own.interface_elastic;
    report += take_micro_steps(h);
    if (report.rejection != Rejection::none) return;
    for (std::size_t o = 0; o < mean_reaction_.size(); ++o) end.obstacles[o].reaction += mean_reaction_[o];
    write_back(part_, now_, model_, end);
    const std::vector<Retirement> marked = end.retired;  // with those of the micro steps
    rigid_.retire(marked, end);
    take_contacts(h, now_.last_step, end);
    end.free_pieces.clear(), end.viscous_stress.clear();
}

/// The contacts of the island, as forces of the closing step times h, beside those of the rest.
void Islands::take_contacts(double h, double closing, State& end) const {
    const double scale = h / closing;
    for (const FaceContactState& at : now_.face_contacts)
        end.face_contacts.push_back({part_.in_whole(at.vertex), part_.in_whole(at.edge), part_.in_whole(at.entering),
                                     scale * at.contact, scale * at.tangential});
    std::ranges::sort(end.face_contacts, {}, [](const FaceContactState& at) { return std::pair(at.vertex, at.edge); });
    for (const ObstacleContactState& at : now_.obstacle_contacts)
        end.obstacle_contacts.push_back({part_.in_whole(at.corner),
                                         at.second_corner < 0 ? -1 : part_.in_whole(at.second_corner), at.obstacle,
                                         scale * at.contact, scale * at.tangential});
    for (Impact impact : now_.impacts) {
        impact.piece = part_.triangles[impact.piece];
        if (impact.other >= 0) impact.other = part_.triangles[impact.other];
        end.impacts.push_back(impact);
    }
}

double Islands::hold(double area, Index triangle) const {
    const Elastic& material = model_.materials[model_.mesh.region[triangle]];
    return rigid_options_.hold * std::sqrt(area * material.density / material.E);
}

/// Which pieces there are now, and which of them are rigid again.
void Islands::update_pieces(double h, State& end, StepReport& report) {
    const State& start = rigid_.start();
    const FrozenBody& body = *start.frozen;
    const Model& own = part_.model;
    const double end_time = start.time + h;
    struck_.clear();
    for (const Index t : part_.triangles) {
        const Index p = body.piece_of_triangle[t];
        const bool is_hit = start.rigid_pieces[p].state != PieceState::deformable || rigid_.blows()[p] > 1;
        struck_.push_back(is_hit ? end_time : start.rigid_pieces[p].struck);
    }
    for (std::size_t rank = 0; rank < now_.split_fans.size(); ++rank) {
        const auto points = own.points(own.fans[now_.split_fans[rank]]);
        for (std::size_t j = 0; j < points.size(); ++j) {
            const double after = now_.points[now_.first_point[rank] + j].cohesion;
            if (!points[j].cracked && after < cohesion(own, start_, points[j].point))
                for (const Index corner : {points[j].before, points[j].after}) struck_[corner / 3] = end_time;
        }
    }
    const PiecesOfBody pieces = pieces_of_body(own, now_, {});
    std::vector<double> last(struck_.size(), 0);
    bool changed = false;
    for (std::size_t t = 0; t < last.size(); ++t) {
        last[pieces.first[t]] = std::max(last[pieces.first[t]], struck_[t]);
        const FrozenBody::Piece& piece = body.pieces[body.piece_of_triangle[part_.triangles[t]]];
        changed = changed || part_.triangles[pieces.first[t]] != piece.first_triangle;
    }
    for (std::size_t t = 0; t < last.size(); ++t) struck_[t] = last[pieces.first[t]];
    if (!changed) {
        const std::vector<double> vibration = find_means(end);
        for (std::size_t t = 0; t < last.size() && !changed; ++t) {
            const Index p = body.piece_of_triangle[part_.triangles[t]];
            changed = is_quiet(body.pieces[p], end.rigid_pieces[p], vibration[p], end_time);
        }
    }
    if (changed) rebuild_pieces(end_time, end, report);
}

/// Whether it may become rigid.
bool Islands::is_quiet(const FrozenBody::Piece& piece, const RigidPiece& motion, double vibration, double now) const {
    return now >= motion.struck + hold(piece.area, piece.first_triangle) &&
           unrest(piece, motion, vibration, rigid_options_) <= 1;
}

/// The rest keeps its bits.
void Islands::rebuild_pieces(double end_time, State& end, StepReport& report) const {
    const SharedFrozenBody old = end.frozen;
    const std::vector<RigidPiece> before = end.rigid_pieces;
    FrozenPieces frozen = freeze(model_, end);
    auto body = std::make_shared<FrozenBody>(*frozen.body);
    for (std::size_t q = 0; q < body->pieces.size(); ++q) {
        FrozenBody::Piece& piece = body->pieces[q];
        RigidPiece& motion = frozen.pieces[q];
        const Index p = old->piece_of_triangle[piece.first_triangle];
        if (!deformable_[p]) {
            piece = old->pieces[p], motion = before[p];
            continue;
        }
        motion.last_step = 0, motion.begin_slow(end_time);
        motion.struck = struck_[part_.triangle_of_part[piece.first_triangle]];
        const bool stays = can_break(piece, rigid_options_) && !is_quiet(piece, motion, frozen.vibration[q], end_time);
        motion.state = stays ? PieceState::deformable : PieceState::rigid;
        if (!stays) report.vibration_booked -= frozen.vibration[q], report.kinetic -= frozen.vibration[q];
    }
    for (std::size_t node = 0; node < body->arm.size(); ++node) {
        const RigidPiece& motion = frozen.pieces[body->piece_of_node[node]];
        const bool is_old = node < old->arm.size() && !deformable_[old->piece_of_node[node]];
        if (is_old) body->arm[node] = old->arm[node];
        else if (motion.state == PieceState::rigid)
            end.velocity[node] = motion.velocity + motion.spin * turned_left(body->arm[node]);
    }
    end.frozen = std::move(body), end.rigid_pieces = std::move(frozen.pieces);
}

/// The mean motions of the deformable pieces. Returns the energy [J] of what moves beside them, per piece.
std::vector<double> Islands::find_means(State& end) const {
    const FrozenBody& body = *end.frozen;
    const State& start = rigid_.start();
    std::vector<Vec2> near;
    for (const RigidPiece& piece : end.rigid_pieces) near.push_back(piece.centre);
    const MeanMotions mean = mean_motions(near, [&](const auto& visit) {
        for (Index c = 0; c < part_.model.mesh.n_corners(); ++c) {
            const Index corner = part_.in_whole(c), node = end.node_of_corner[corner];
            visit(body.piece_of_triangle[corner / 3], model_.corner_mass[corner],
                  Vec2(model_.mesh.corner(corner) + end.displacement[node]), end.velocity[node]);
        }
    });
    std::vector<double> cross_arms(near.size(), 0), dot_arms(near.size(), 0), vibration(near.size(), 0);
    for (Index c = 0; c < part_.model.mesh.n_corners(); ++c) {  // the turn since the start of the step
        const Index corner = part_.in_whole(c), p = body.piece_of_triangle[corner / 3];
        const Vec2 &X = model_.mesh.corner(corner),
                   before = X + start.displacement_of(corner) - start.rigid_pieces[p].centre,
                   after = X + end.displacement_of(corner) - mean.centre[p];
        const Vec2 rigid = mean.velocity[p] + mean.spin[p] * turned_left(after);
        vibration[p] +=
            0.5 * model_.corner_mass[corner] * (end.velocity[end.node_of_corner[corner]] - rigid).squaredNorm();
        cross_arms[p] += model_.corner_mass[corner] * cross(before, after);
        dot_arms[p] += model_.corner_mass[corner] * before.dot(after);
    }
    for (std::size_t p = 0; p < near.size(); ++p) {
        if (!deformable_[p]) continue;
        RigidPiece& piece = end.rigid_pieces[p];
        piece.centre = mean.centre[p], piece.velocity = mean.velocity[p], piece.spin = mean.spin[p];
        piece.angle += std::atan2(cross_arms[p], dot_arms[p]);
        piece.last_step = 0, piece.struck = struck_[part_.triangle_of_part[body.pieces[p].first_triangle]];
    }
    return vibration;
}

}  // namespace knap
