#include "stepper/rigid/rigid_scheme.hpp"

#include "base/parallel.hpp"
#include "stepper/common/contact_search.hpp"
#include "stepper/common/surface_energy.hpp"
#include "stepper/contact/retirement.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double slow_for = 0.2;  // [s] until a piece falls asleep
// [s] A piece that is slow for longer has no larger acceleration than sleep/creeps_for, by default a thousandth of g.
// Where contacts bear it from rest up to that, and take more than the energy of its island, it creeps: sweeps leave
// 4 mm/s in a heap of a thousand pieces.
constexpr double creeps_for = 2;
constexpr int max_searches = 3;           // of contacts in a step
constexpr std::size_t few_pieces = 1000;  // one thread is as fast as two
constexpr double largest_turn = 0.7;      // [rad] of a piece in a step: 40 degrees
// [-] What contacts bear does not move from rest by more than so much of their errors, within these parts of what
// loads alone would do in the step. Sweeps leave 13 times the error of a rate in a heap of a hundred pieces.
constexpr double error_of_sweeps = 100, exact_rest = 1e-6, largest_rest = 1e-2;

/// Whether a slow piece sets out: its speed v grows along its way d. From rest a constant acceleration has d = v t/2,
/// and a growing one less, down to v t/4 here; what vibrates in its place has less, and what is braked more than v t.
/// What goes on has v t: where no loss brakes it, it goes on for ever.
bool sets_out(const RigidPiece& piece, double radius, double time, double sleep, bool is_braked) {
    const Vec3 size(1, 1, radius), v = size.cwiseProduct(piece.rates()),
                                   d = size.cwiseProduct(piece.place() - piece.slow_at);
    const double uniform = v.squaredNorm() * (time - piece.slow_since), most = is_braked ? 0.99 : 1.01;
    return v.norm() > stands_below * sleep && d.dot(v) > 0.25 * uniform && d.dot(v) < most * uniform;
}

}  // namespace

RigidScheme::RigidScheme(const Model& model, const SchemeOptions& options)
    : model_(model),
      options_(options),
      contacts_(model, options.rigid),
      obstacles_(model),
      amplitude_(model.histories.size()) {}

bool RigidScheme::may_begin(const State& start) const {
    State state = start;
    const FrozenPieces frozen = freeze(model_, state);
    const auto is_loaded = [](const FrozenBody::Piece& piece) { return piece.held && piece.weakest < infinity; };
    return frozen.all_vibration() <= relative_tolerance * frozen.kinetic &&
           std::ranges::none_of(frozen.body->pieces, is_loaded);
}

/// Loads of the pieces, which turn with them.
void RigidScheme::renew(const State& begin) {
    if (known_ == begin.frozen) return;
    known_ = begin.frozen;
    loads_.clear();
    for (const CornerLoad& load : model_.corner_loads) {
        const Index piece = known_->piece_of_triangle[model_.mesh.triangle_of(load.corner)];
        auto found = std::ranges::find_if(
            loads_, [&](const PieceLoad& at) { return at.piece == piece && at.history == load.history; });
        if (found == loads_.end()) found = loads_.insert(found, {piece, load.history, Vec2::Zero(), 0, 0});
        const Index node = begin.node_of_corner[load.corner];
        // all corners of a fan that split since had its one node
        const Vec2& arm = known_->arm[node < std::ssize(known_->arm) ? node : model_.fan_of_corner[load.corner]];
        found->force += load.force, found->cross += cross(arm, load.force), found->dot += arm.dot(load.force);
    }
    contacts_.renew(begin);
}

StepReport RigidScheme::step(const State& begin, double h, State& end) {
    StepReport report = try_step(begin, h, {});
    if (mark_struck(deformable_)) {
        report.rejection = Rejection::none;
        report.reject(Rejection::blow, blow_.place, blow_.value);
    }
    return report.rejection == Rejection::none ? end_step(report, end) : report;
}

StepReport RigidScheme::try_step(const State& begin, double h, std::span<const std::uint8_t> deformable) {
    StepReport report;
    if (!begin.frozen) {
        start_ = begin;
        FrozenPieces frozen = freeze(model_, start_);
        start_.frozen = frozen.body, start_.rigid_pieces = std::move(frozen.pieces);
        start_.motion = Motion::rigid;
        start_.viscous_stress.clear(), start_.free_pieces.clear();
        std::ranges::fill(start_.reaction, Vec2(Vec2::Zero()));
        for (std::size_t node = 0; node < start_.velocity.size(); ++node) {
            const RigidPiece& piece = start_.rigid_pieces[frozen.body->piece_of_node[node]];
            start_.velocity[node] = piece.velocity + piece.spin * turned_left(frozen.body->arm[node]);
        }
        for (std::size_t p = 0; p < frozen.vibration.size(); ++p)
            if (const double value =
                    unrest(frozen.body->pieces[p], start_.rigid_pieces[p], frozen.vibration[p], options_.rigid);
                value > 1)
                report.reject(Rejection::blow, start_.rigid_pieces[p].centre, value);
        report.vibration_booked = -frozen.all_vibration();
        account_freeze(begin, *frozen.body, frozen.strain, report);
    }
    trial_.emplace(
        RigidStep{.begin = begin.frozen ? begin : start_, .drift_time = h, .kick_time = 0.5 * (begin.last_step + h)});
    deformable_.assign(deformable.begin(), deformable.end());
    deformable_.resize(trial_->begin.rigid_pieces.size(), 0);
    find_contacts(report);
    return report;
}

bool RigidScheme::mark_struck(std::vector<std::uint8_t>& marked) {
    blow_ = {}, blows_.assign(trial_->begin.rigid_pieces.size(), 0);
    marked.resize(blows_.size(), 0);
    if (stays_) return false;
    blow_ = contacts_.hardest_blow(*trial_, bodies_, blows_);
    bool any = false;
    for (std::size_t p = 0; p < blows_.size(); ++p)
        if (blows_[p] > 1 && !marked[p]) marked[p] = 1, any = true;
    return any;
}

/// The strain energy of the leapfrog, U_n - 1/2 f_n . (u_n+1 - u_n), becomes U; and works of cohesion, which end in the
/// middle of the step, get what is left until its end.
void RigidScheme::account_freeze(const State& begin, const FrozenBody& body, double strain, StepReport& report) const {
    if (begin.last_step == 0) return;
    report.step_change_work = strain - (begin.elastic_energy - 0.5 * begin.elastic_work);
    if (body.recoverable == 0) return;
    State middle = begin;
    for (std::size_t node = 0; node < middle.displacement.size(); ++node)
        middle.displacement[node] -= 0.5 * begin.last_step * begin.velocity[node];
    report.cohesive_work = body.recoverable - surface_energy(model_, middle).recoverable;
    report.step_change_work += report.cohesive_work;
}

StepReport RigidScheme::thaw(const State& begin, double h, State& end) {
    trial_.emplace(
        RigidStep{.begin = begin, .drift_time = h, .kick_time = 0.5 * (begin.last_step + h), .closing = true});
    deformable_.assign(begin.rigid_pieces.size(), 0);
    StepReport report;
    find_contacts(report);
    report.rejection = Rejection::none;
    report = end_step(report, end);
    report.thaws = std::ranges::count(begin.frozen->pieces, false, &FrozenBody::Piece::held);
    end.frozen = nullptr, end.rigid_pieces.clear();
    end.motion = Motion::thawed;
    return report;
}

/// v+ without contacts, and the masses.
void RigidScheme::find_free_motion(const RigidStep& step) {
    const State& begin = step.begin;
    const FrozenBody& body = *begin.frozen;
    const std::size_t n_pieces = body.pieces.size(), n = n_pieces + model_.obstacles.size();
    const bool brakes = options_.damping_of == DampingOf::motion;
    for (std::size_t i = 0; i < amplitude_.size(); ++i)
        amplitude_[i] = model_.histories[i].over_kick(begin.time, begin.last_step, step.drift_time);
    load_.assign(n_pieces, Vec3::Zero());
    for (const PieceLoad& load : loads_) {
        const Rotation turn = Rotation::by(begin.rigid_pieces[load.piece].angle);
        load_[load.piece] += amplitude_[load.history] *
                             Vec3(load.force.x(), load.force.y(), turn.cosine * load.cross - turn.sine * load.dot);
    }
    bodies_.assign(n, {});
    for (std::size_t p = 0; p < n_pieces; ++p) {
        const RigidPiece& piece = begin.rigid_pieces[p];
        MovingBody& at = bodies_[p];
        at.centre = piece.centre;
        if (body.pieces[p].held) continue;
        at.deformable = deformable_[p];
        at.asleep = piece.state == PieceState::asleep && !at.deformable;
        at.kick = 0.5 * piece.last_step + (at.deformable ? 1 : 0.5) * step.drift_time;
        at.before = piece.rates();
        const double damping = brakes ? 0.5 * at.kick * options_.damping : 0;
        const double mass = (1 + damping) * body.pieces[p].mass;
        at.inverse_mass = {1 / mass, 1 / mass, 1 / ((1 + damping) * body.pieces[p].inertia)};
        at.acceleration = at.inverse_mass.cwiseProduct(load_[p]), at.kicked = at.kick * at.acceleration;
        at.free = (1 - damping) / (1 + damping) * at.before + at.kicked;
    }
    obstacles_.begin_explicit(begin, step.kick_time, step.drift_time,
                              brakes ? 0.5 * step.kick_time * options_.damping : 0);
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
        MovingBody& at = bodies_[n_pieces + o];
        at.is_piece = false;
        at.centre = begin.obstacles[o].pose.position;
        at.before = begin.obstacles[o].velocity;
        at.free = obstacles_.rate()[o];
        at.inverse_mass = obstacles_.inverse_mass(static_cast<Index>(o));
    }
}

/// Keeps what the velocities of the pieces gain in the step: by loads alone, or at its `end` with the contacts found.
void RigidScheme::add_rates(Vec3 MovingBody::*end) {
    std::vector<Vec3>& rates = added_.emplace_back();
    for (std::size_t p = 0; p < trial_->begin.rigid_pieces.size(); ++p) {
        const MovingBody& at = bodies_[p];
        rates.push_back((at.deformable ? at.free : at.*end) - at.before);
    }
}

/// What contacts hand on may bring others together, which are found with these velocities.
void RigidScheme::find_contacts(StepReport& report) {
    const RigidStep& step = *trial_;
    const OneThread alone(step.begin.rigid_pieces.size() < few_pieces);
    renew(step.begin);
    LargestMotion motion;
    added_.clear();
    for (int search = 1;; ++search) {
        find_free_motion(step);
        stays_ = lies_still(step);
        if (stays_) return;
        if (search == 1) add_rates(&MovingBody::free);
        contacts_.find(step, obstacles_, added_, bodies_);
        motion = contacts_.solve(step, bodies_, report);
        if (report.rejection != Rejection::none || motion.value > 1 || step.closing || search == max_searches ||
            !contacts_.misses(step, bodies_))
            break;
        add_rates(&MovingBody::end);
    }
    for (const MovingBody& body : bodies_)
        if (body.kick > 0) motion.at_least({step.drift_time * std::abs(body.end.z()) / largest_turn, body.centre});
    report.contact_motion = motion.value;
    if (motion.value > 1) report.reject(Rejection::contact_speed, motion.place, largest_rigid_motion * motion.value);
}

StepReport RigidScheme::end_step(StepReport report, State& end) {
    const RigidStep& step = *trial_;
    if (stays_) return stay(step, report, end);
    contacts_.project(step, bodies_);
    const bool moves_alone = std::ranges::any_of(deformable_, [](auto piece) { return piece != 0; });
    if (moves_alone || end.frozen != step.begin.frozen || end.displacement.size() != step.begin.displacement.size())
        end = step.begin;
    else end.points = step.begin.points, end.retired = step.begin.retired;  // islands of a rejected step changed them
    move_pieces(step, end, report);
    if (!moves_alone) retire(step.begin.retired, end);
    return report;
}

void RigidScheme::retire(const std::vector<Retirement>& before, State& end) const {
    if (!contacts_.has_points()) return;
    retire_points(model_, before, end);
    contacts_.release_retired(end);
}

/// Everything is asleep, and no load changes.
bool RigidScheme::lies_still(const RigidStep& step) {
    const double before = step.begin.time - step.begin.last_step;
    for (const TimeFunction& history : model_.histories)
        if (history(step.begin.time) != history(before)) {
            for (MovingBody& body : bodies_) body.asleep = false;
            return false;
        }
    return std::ranges::all_of(bodies_, [](const MovingBody& body) {
        return body.asleep || (!body.moves() && body.before.isZero(0) && body.free.isZero(0));
    });
}

StepReport RigidScheme::stay(const RigidStep& step, StepReport report, State& end) {
    const FrozenBody& body = *step.begin.frozen;
    end = step.begin;
    of_obstacles_.assign(model_.obstacles.size(), Vec3::Zero());
    obstacles_.finish(step.begin, of_obstacles_, end, report);
    for (std::size_t o = 0; o < end.obstacles.size(); ++o) end.obstacles[o].reaction = step.begin.obstacles[o].reaction;
    for (RigidPiece& piece : end.rigid_pieces) piece.last_step = step.drift_time;
    account_energies(body, report);
    return report;
}

/// Of what does not change while the pieces are rigid.
void RigidScheme::account_energies(const FrozenBody& body, StepReport& report) const {
    for (std::size_t p = 0; p < body.pieces.size(); ++p)
        if (!deformable_[p]) report.strain += body.pieces[p].strain;
    report.dissipated = body.dissipated, report.recoverable = body.recoverable;
    report.interface_elastic = body.interface_elastic;
}

void RigidScheme::move_pieces(const RigidStep& step, State& end, StepReport& report) {
    const State& begin = step.begin;
    const FrozenBody& body = *begin.frozen;
    const std::size_t n_pieces = body.pieces.size();
    wrench_.assign(bodies_.size(), Vec3::Zero());
    contacts_.add_wrenches(bodies_, wrench_);
    of_obstacles_.assign(wrench_.begin() + static_cast<std::ptrdiff_t>(n_pieces), wrench_.end());
    end.time = begin.time, end.last_step = begin.last_step;
    obstacles_.finish(begin, of_obstacles_, end, report);
    for (std::size_t o = 0; o < model_.obstacles.size(); ++o) {
        MovingBody& at = bodies_[n_pieces + o];
        for (int k = 0; k < 3; ++k)
            if (model_.obstacles[o].is_free(k)) at.end[k] = end.obstacles[o].velocity[k];
        if (at.moves()) move(model_.obstacles[o], at.strike + at.shift, end.obstacles[o]);
    }
    contacts_.finish(step, bodies_, end, report);
    end.rigid_pieces = begin.rigid_pieces;
    for (std::size_t p = 0; p < n_pieces; ++p) {
        RigidPiece& piece = end.rigid_pieces[p];
        const MovingBody& at = bodies_[p];
        piece.last_step = step.drift_time;
        if (body.pieces[p].held) continue;
        if (at.deformable) {
            piece.state = PieceState::deformable;
            continue;
        }
        if (at.asleep) {
            piece.state = PieceState::asleep;
            continue;
        }
        if (piece.state == PieceState::asleep) piece.state = PieceState::rigid, piece.begin_slow(begin.time);
        const Vec3 moved = step.drift_time * at.end + at.strike + at.shift, mean = 0.5 * (at.before + at.end);
        piece.centre += moved.head<2>(), piece.angle += moved.z();
        piece.velocity = at.end.head<2>(), piece.spin = at.end.z();
        const double mass = body.pieces[p].mass, inertia = body.pieces[p].inertia;
        report.kinetic += 0.5 * (mass * piece.velocity.squaredNorm() + inertia * piece.spin * piece.spin);
        const double damping = options_.damping_of == DampingOf::motion ? 0.5 * at.kick * options_.damping : 0;
        report.external_work += at.kick * load_[p].dot(mean);
        report.kick_energy += 0.5 * at.kick * at.kick * load_[p].cwiseAbs2().dot(Vec3(1 / mass, 1 / mass, 1 / inertia));
        if (at.struck_at > 0) report.external_work += at.works_at / at.struck_at * load_[p].dot(at.strike);
        report.impact_work += at.couple * mean.z();
        report.rigid_injection += std::max(0.0, at.couple * mean.z());
        report.damping_work -= 2 * damping * (mass * mean.head<2>().squaredNorm() + inertia * mean.z() * mean.z());
        report.projection_work -= load_[p].dot(at.shift);
        const double speed = largest_speed(at.end, body.pieces[p].radius);
        report.largest_speed = std::max(report.largest_speed, speed);
        if (speed >= options_.rigid.sleep) piece.begin_slow(begin.time + step.drift_time);
    }
    if (options_.rigid.sleep > 0 && !step.closing) fall_asleep(step, end, report);
    account_energies(body, report);
    place_nodes(model_, end);
    end.motion = Motion::rigid;
}

/// The bodies of the last trial, without their motion.
std::vector<MovingBody> RigidScheme::at_rest() const {
    std::vector<MovingBody> bodies = bodies_;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        MovingBody& at = bodies[b];
        if (!at.moves()) continue;
        at.free = b < load_.size() ? Vec3(at.kick * at.inverse_mass.cwiseProduct(load_[b])) : Vec3(at.free - at.before);
        at.before.setZero(), at.gained.setZero();
    }
    return bodies;
}

/// Pieces that press on each other, and of which one presses on what stands still, if contacts would bear their loads
/// at rest: at a turning point, or on a corner, speeds are small for long.
void RigidScheme::fall_asleep(const RigidStep& step, State& end, StepReport& report) {
    const FrozenBody& body = *step.begin.frozen;
    const std::size_t n_pieces = body.pieces.size();
    const auto stands_still = [&](Index b) { return b < 0 || (!bodies_[b].moves() && bodies_[b].before.isZero(0)); };
    const double time = end.time + step.drift_time;
    std::vector<double> loss(bodies_.size(), 0);  // [J] in the step
    contacts_.for_pressed([&](Index b, Index, double lost) { loss[b] += lost; });
    const auto energy_of = [&](std::size_t p) {
        const RigidPiece& piece = end.rigid_pieces[p];
        return 0.5 *
               (body.pieces[p].mass * piece.velocity.squaredNorm() + body.pieces[p].inertia * piece.spin * piece.spin);
    };
    const auto is_slow_for = [&](double least, std::size_t p) {
        return !bodies_[p].deformable && time - end.rigid_pieces[p].slow_since >= least;
    };
    bool any = false;
    for (std::size_t p = 0; p < n_pieces; ++p)
        any = any || (!body.pieces[p].held && !bodies_[p].asleep && is_slow_for(slow_for, p));
    if (!any) return;
    pressed_.start(bodies_.size());
    std::vector<std::uint8_t> held(bodies_.size(), 0), moves(bodies_.size(), 0);
    contacts_.for_pressed([&](Index a, Index b, double) {
        if (stands_still(a)) return;
        if (!stands_still(b)) pressed_.join(a, b);
    });
    std::vector<double> energy_of_island(bodies_.size(), 0), loss_of_island(bodies_.size(), 0);  // [J]
    for (std::size_t p = 0; p < n_pieces; ++p) {
        const Index island = pressed_.find(static_cast<Index>(p));
        energy_of_island[island] += energy_of(p), loss_of_island[island] += loss[p];
    }
    const double steps = slow_for / step.kick_time;
    const auto creeps = [&](std::size_t p) {
        const Index island = pressed_.find(static_cast<Index>(p));
        return is_slow_for(creeps_for, p) && steps * loss_of_island[island] > energy_of_island[island];
    };
    const auto is_slow = [&](std::size_t p) {
        const RigidPiece& piece = end.rigid_pieces[p];
        const bool is_braked = steps * loss[p] > energy_of(p);
        return is_slow_for(slow_for, p) &&
               (creeps(p) || !sets_out(piece, body.pieces[p].radius, time, options_.rigid.sleep, is_braked));
    };
    contacts_.for_pressed([&](Index a, Index b, double) {
        if (!stands_still(a) && stands_still(b)) held[pressed_.find(a)] = 1;
    });
    for (std::size_t b = 0; b < bodies_.size(); ++b)
        if (!stands_still(static_cast<Index>(b)) && (b >= n_pieces || !is_slow(b)))
            moves[pressed_.find(static_cast<Index>(b))] = 1;
    const auto may_sleep = [&](std::size_t p) {
        const Index island = pressed_.find(static_cast<Index>(p));
        return !body.pieces[p].held && !bodies_[p].asleep && held[island] && !moves[island];
    };
    std::vector<std::uint8_t> rests(bodies_.size(), 0);
    for (std::size_t p = 0; p < n_pieces; ++p) rests[p] = may_sleep(p);
    if (std::ranges::none_of(rests, [](auto at) { return at != 0; })) return;
    std::vector<MovingBody> resting = at_rest();
    bool any_creeps = false;
    for (std::size_t p = 0; p < n_pieces; ++p) any_creeps = any_creeps || (rests[p] && creeps(p));
    const double error = contacts_.move_from_rest(step, rests, any_creeps ? exact_rest : infinity, resting);
    double speed = 0;  // [m/s] of what nothing bears
    for (std::size_t p = 0; p < n_pieces; ++p)
        if (rests[p]) speed = std::max(speed, resting[p].free.head<2>().norm());
    const double allowed = any_creeps ? options_.rigid.sleep / creeps_for * step.kick_time
                                      : std::clamp(error_of_sweeps * error, exact_rest * speed, largest_rest * speed);
    for (std::size_t p = 0; p < n_pieces; ++p) {
        if (!rests[p] || Vec3(1, 1, body.pieces[p].radius).cwiseProduct(resting[p].end).norm() <= allowed) continue;
        moves[pressed_.find(static_cast<Index>(p))] = 1;
        end.rigid_pieces[p].begin_slow(time);
    }
    for (std::size_t p = 0; p < n_pieces; ++p) {
        if (!may_sleep(p)) continue;
        RigidPiece& piece = end.rigid_pieces[p];
        const double energy = energy_of(p);
        piece.velocity.setZero(), piece.spin = 0;
        piece.state = PieceState::asleep;
        report.kinetic -= energy, report.sleep_work -= energy;
    }
}

}  // namespace knap
