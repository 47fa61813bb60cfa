#include "stepper/rigid/rigid_contacts.hpp"

#include "base/parallel.hpp"
#include "stepper/common/contact_search.hpp"
#include "stepper/common/point_work.hpp"
#include "stepper/rigid/freeze.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace knap {
namespace {

constexpr int more_rounds = 10, sweeps_of_round = 40;  // of clusters whose works are positive beyond the next two
constexpr int sweeps_of_heap = 2400;                   // of a round where it is asked whether contacts bear the loads
constexpr double allowed_injection = 2e-4;             // [-] of the losses
constexpr double at_rest = 1e-8;                       // [-] of the impulses times the speeds
constexpr double lasting_load = 0.5;   // [-] of sigma_c, over an edge, that a piece bears without a blow
constexpr double deepens = 1e-4;       // [-] of an edge: by less an overlap does not grow
constexpr double allowed_bend = 0.01;  // [-] of an edge: how far a corner that turns leaves its straight way in a step

}  // namespace

void RigidContacts::renew(const State& begin) {
    n_pieces_ = static_cast<Index>(begin.rigid_pieces.size());
    faces_.set_pieces(begin.frozen);
    obstacle_contacts_.set_pieces(begin.frozen);
    weakest_ = infinity;
    for (const FrozenBody::Piece& piece : begin.frozen->pieces) weakest_ = std::min(weakest_, piece.weakest);
    points_.clear();
    for (const Index f : begin.split_fans) {
        const auto points = model_.points(model_.fans[f]);
        const Index first = begin.first_point[begin.split_rank[f]];
        for (std::size_t j = 0; j < points.size(); ++j) {
            const FanPoint& point = points[j];
            if (begin.has_retired(point.point) || unbreakable(model_, point)) continue;
            if (begin.points[first + static_cast<Index>(j)].cohesion > 0) continue;
            const auto piece = [&](Index corner) {
                return corner == rigid_support ? -1 : begin.frozen->piece_of_triangle[model_.mesh.triangle_of(corner)];
            };
            if (piece(point.before) != piece(point.after)) points_.push_back({f, static_cast<Index>(j)});
        }
    }
}

/// When all its terms are there.
void RigidContacts::add_row(Row& row, const std::vector<MovingBody>& bodies) {
    row.before = rate(row, bodies, &MovingBody::before);
    row.lasting = row.impulse;
    row.apart = row.source == Source::face && row.gap < 0 ? -faces_.all()[row.number].depth : row.gap;
    rows_.push_back(row);
}

ContactLaw RigidContacts::law_for(ContactLaw law, bool breaks) const {
    if (!law.gives_restitution) law.restitution = options_.restitution;
    if (breaks && law.rebound == ContactLaw::Rebound::of_faces) law.restitution = 0;
    return law;
}

bool RigidContacts::can_break(Index body) const {
    return body < n_pieces_ && knap::can_break(begin_->frozen->pieces[body], options_);
}

void RigidContacts::add_faces(const RigidStep& step, AddedRates added, const std::vector<MovingBody>& bodies) {
    row_of_face_.clear();
    if (!meets_faces()) return;
    faces_.find_of_pieces(step.begin, step.drift_time, added);
    const double scale = step.kick_time / (step.begin.last_step > 0 ? step.begin.last_step : 1);  // else a force
    row_of_face_.assign(faces_.all().size(), -1);
    for (Index i = 0; i < static_cast<Index>(faces_.all().size()); ++i) {
        const FaceContact& c = faces_.all()[i];
        Row row{row_of(model_, step.begin, c, scale), Source::face, i};
        bool breaks = false, on_ground = false;
        c.visit_terms([&](const CornerTerm& term) {
            if (model_.ground_at(term.body) != nullptr) {
                on_ground = true;
                return;
            }
            const Index piece = piece_of(term.body);
            const Vec2 arm = place_of(term.body) - bodies[piece].centre;
            breaks = breaks || can_break(piece);
            row.add({piece, wrench_of(term.along_N, arm), wrench_of(term.along_T, arm)});
        });
        if (row.n_terms == 1 && !on_ground) continue;  // of one piece with itself
        row.law = law_for(row.law, breaks);
        row_of_face_[i] = static_cast<Index>(rows_.size());
        add_row(row, bodies);
    }
}

void RigidContacts::add_obstacles(const RigidStep& step, const std::vector<MovingBody>& bodies) {
    const State& begin = step.begin;
    const std::size_t first = rows_.size();
    const double scale = begin.last_step > 0 ? step.kick_time / begin.last_step : 0;
    ImpulsesBefore before(begin, by_corner_);
    for (Index i = 0; i < static_cast<Index>(obstacle_contacts_.all().size()); ++i) {
        const ObstacleContact& c = obstacle_contacts_.all()[i];
        const Index piece = piece_of(c.corner);
        const Vec2 x = c.of_body([&](Index corner) { return place_of(corner); });
        Row row{{.gap = c.gap,
                 .length = begin.frozen->pieces[piece].edge(),
                 .rounding = position_rounding * (x.norm() + c.arm.norm()),
                 .law = law_for(obstacle_contacts_.law_of(c, begin), can_break(piece)),
                 .place = x,
                 .impulse = scale * before.next(c)},
                Source::obstacle,
                i};
        row.add(term_on(piece, c.normal, x - bodies[piece].centre));
        row.add(term_on(body_of_obstacle(c.obstacle), -c.normal, c.arm));
        add_row(row, bodies);
    }
    keep_hull(first);
}

/// Of the contacts of a piece with one plane of an obstacle only the ends of the lower hull of the points (place along
/// the plane, gap) concern a rigid piece: rates are linear along the plane, so the others follow.
void RigidContacts::keep_hull(std::size_t first) {
    const auto along = [&](std::size_t r) {
        return turned_left(rows_[r].terms[0].along_N.head<2>()).dot(rows_[r].place);
    };
    std::vector<std::uint8_t> seen(rows_.size() - first, 0), kept(rows_.size() - first, 0);
    const auto bodies_of = [&](std::size_t r) { return std::pair(rows_[r].terms[0].body, rows_[r].terms[1].body); };
    by_bodies_.resize(rows_.size() - first);
    std::iota(by_bodies_.begin(), by_bodies_.end(), first);
    std::ranges::stable_sort(by_bodies_, {}, bodies_of);
    for (std::size_t i = 0; i < by_bodies_.size(); ++i) {
        const std::size_t r = by_bodies_[i];
        if (seen[r - first]) continue;
        hull_.clear();
        for (std::size_t j = i; j < by_bodies_.size() && bodies_of(by_bodies_[j]) == bodies_of(r); ++j) {
            const std::size_t k = by_bodies_[j];
            if (rows_[k].terms[0].along_N.head<2>().dot(rows_[r].terms[0].along_N.head<2>()) >= 1 - relative_tolerance)
                hull_.push_back(k), seen[k - first] = 1;
        }
        std::ranges::stable_sort(hull_, {}, along);
        std::size_t n = 0;  // Andrew's monotone chain
        const auto turns_left = [&](std::size_t a, std::size_t b, std::size_t c) {
            return (along(b) - along(a)) * (rows_[c].gap - rows_[a].gap) -
                       (along(c) - along(a)) * (rows_[b].gap - rows_[a].gap) >
                   0;
        };
        for (std::size_t m = 0; m < hull_.size(); ++m) {
            const std::size_t k = hull_[m];
            if (n > 0 && along(hull_[n - 1]) == along(k)) {  // corners at one place
                if (rows_[k].gap >= rows_[hull_[n - 1]].gap) continue;
                --n;
            }
            while (n > 1 && !turns_left(hull_[n - 2], hull_[n - 1], k)) --n;
            hull_[n++] = k;
        }
        for (std::size_t m = 0; m < n; ++m) kept[hull_[m] - first] = 1;
    }
    std::size_t n = first;
    for (std::size_t r = first; r < rows_.size(); ++r)
        if (kept[r - first]) rows_[n++] = rows_[r];
    rows_.resize(n);
}

/// Of two obstacles: with the geometric means of what each has against the body.
void RigidContacts::add_pairs(const RigidStep& step, const std::vector<MovingBody>& bodies) {
    for (Index i = 0; i < static_cast<Index>(pairs_.all().size()); ++i) {
        Row row{row_of(model_, step.begin, pairs_.all()[i]), Source::pair, i};
        visit_terms(pairs_.all()[i], [&](ClusterTerm term) {
            term.body = body_of_obstacle(term.body);
            row.add(term);
        });
        add_row(row, bodies);
    }
}

void RigidContacts::add_points(const RigidStep& step, const std::vector<MovingBody>& bodies) {
    const State& begin = step.begin;
    std::erase_if(points_, [&](const Point& at) {
        return begin.has_retired(model_.points(model_.fans[at.fan])[at.place].point);
    });
    for (Index i = 0; i < static_cast<Index>(points_.size()); ++i) {
        const FanPoint& point = model_.points(model_.fans[points_[i].fan])[points_[i].place];
        const CohesiveLaw& law = law_of(model_, begin, point);
        const Rotation frame = point_frame(model_, begin, point);
        const Vec2 n = frame.turned(point.normal);
        const PointState& state = begin.points[begin.first_point[begin.split_rank[points_[i].fan]] + points_[i].place];
        const double gap = begin.opening_of(point, frame).x();
        Row row{{.gap = std::abs(gap) <= touching_gap(model_, begin, point) ? 0 : gap,
                 .length = 2 * point.area / model_.thickness,
                 .place = place_of(point.corner()),
                 .impulse = step.kick_time * point.area * state.traction},
                Source::point,
                i};
        row.rounding = position_rounding * (row.place.norm() + row.length);
        // the same point for both sides, so that the impulse has no moment
        if (!point.on_support()) row.place = 0.5 * (place_of(point.before) + place_of(point.after));
        bool breaks = false;
        const auto add = [&](Index corner, double sign) {
            if (corner == rigid_support) return;
            const Index piece = piece_of(corner);
            breaks = breaks || can_break(piece);
            row.add(term_on(piece, sign * n, row.place - bodies[piece].centre));
        };
        add(point.after, 1), add(point.before, -1);
        row.law = law_for(
            {.friction = law.friction_after(state.slid), .restitution = law.restitution, .gives_restitution = true},
            breaks);
        add_row(row, bodies);
    }
}

/// What is hit faster than the speed of sleep wakes, and so does what an awake body that bore it leaves; what an awake
/// body begins to touch and a driven obstacle touches, however slowly they move; and what lies on these.
void RigidContacts::wake(std::vector<MovingBody>& bodies) const {
    if (std::ranges::none_of(bodies, &MovingBody::asleep)) return;
    std::vector<std::uint8_t> woken(bodies.size(), 0);
    const auto for_asleep = [&](const Row& row, const auto& visit) {
        for (int k = 0; k < row.n_terms; ++k)
            if (bodies[row.terms[k].body].asleep) visit(row.terms[k].body);
    };
    for (const Row& row : rows_) {
        bool has_awake = false, is_driven = false;
        for (int k = 0; k < row.n_terms; ++k) {
            const MovingBody& body = bodies[row.terms[k].body];
            has_awake = has_awake || (!body.asleep && (body.moves() || !body.before.isZero(0)));
            is_driven =
                is_driven || (!body.is_piece && !body.moves() && !(body.before.isZero(0) && body.free.isZero(0)));
        }
        const double approach = -row.before.x();
        const bool touches = row.lasting.x() > 0 || row.gap <= begin_->last_step * approach,
                   is_new = touches && row.lasting.x() == 0 && approach > stands_below * options_.sleep;
        if ((has_awake &&
             (approach > options_.sleep || is_new || (row.lasting.x() > 0 && -approach > options_.sleep))) ||
            (is_driven && touches))
            for_asleep(row, [&](Index body) { woken[body] = 1; });
    }
    for (const Row& row : rows_) {
        bool meets_woken = false;
        for (int k = 0; k < row.n_terms; ++k) meets_woken = meets_woken || woken[row.terms[k].body] == 1;
        if (meets_woken && row.lasting.x() > 0)
            for_asleep(row, [&](Index body) { woken[body] = std::max<std::uint8_t>(woken[body], 2); });
    }
    for (std::size_t b = 0; b < bodies.size(); ++b)
        if (woken[b]) bodies[b].asleep = false;
}

void RigidContacts::find(const RigidStep& step, const ObstacleMotion& obstacles, AddedRates added,
                         std::vector<MovingBody>& bodies) {
    begin_ = &step.begin;
    rows_.clear();
    add_faces(step, added, bodies);
    obstacle_contacts_.find(step.begin, step.drift_time, obstacles.rate(), {}, added);
    pairs_.find(step.begin, step.drift_time, obstacles.rate());
    add_obstacles(step, bodies);
    add_pairs(step, bodies);
    add_points(step, bodies);
    wake(bodies);
    for (MovingBody& body : bodies)
        if (body.asleep) body.free.setZero(), body.inverse_mass.setZero(), body.acceleration.setZero();
    for (Row& row : rows_) {
        if (step.closing && row.lasting.isZero(0)) row.n_terms = 0;  // a blow, which the deformable body takes
        complete(row, bodies);
    }
    find_strikes(step, rows_, bodies);
    find_clusters(bodies);
}

/// Contacts that share a body which moves.
void RigidContacts::find_clusters(const std::vector<MovingBody>& bodies) {
    lists_.find(static_cast<Index>(rows_.size()), {static_cast<Index>(bodies.size()), 0},
                [&](Index r, const auto& visit) {
                    for (int k = 0; k < rows_[r].n_terms; ++k)
                        if (const Index body = rows_[r].terms[k].body; bodies[body].moves()) visit(0, body);
                });
    clusters_.assign(lists_.size(), {});
    for (std::size_t r = 0; r < rows_.size(); ++r) rows_[r].cluster = lists_.of_row(static_cast<Index>(r));
}

void RigidContacts::solve(std::size_t number, const RigidStep& step, const std::vector<MovingBody>& bodies,
                          Workspace& work, double goal) {
    Cluster& cluster = clusters_[number];
    const std::span<const Index> rows = lists_.rows(number);
    ContactCluster& problem = work.cluster;
    problem.contacts.clear(), problem.couplings.clear(), problem.bodies.clear(), problem.terms.clear();
    work.body.resize(bodies.size());
    for (const Index b : lists_.members(0, number)) {
        work.body[b] = static_cast<Index>(problem.bodies.size());
        problem.bodies.push_back({bodies[b].inverse_mass});
    }
    double error = cluster.speed = 0;
    for (const Index r : rows) {
        const Row& row = rows_[r];
        cluster.speed = std::max({cluster.speed, row.before.norm(), row.free.norm()});
        error = std::max(error, row.rounding / step.drift_time);
    }
    const double tolerance = cluster.tolerance = relative_tolerance * cluster.speed + error;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        Row& row = rows_[rows[i]];
        const auto contact = static_cast<Index>(i);
        problem.contacts.push_back({.free = row.free, .impulse = row.impulse});
        for (int k = 0; k < row.n_terms; ++k) {
            ClusterTerm term = row.terms[k];
            if (!bodies[term.body].moves()) continue;
            if (row.own_N <= relative_tolerance * (row.own_N + row.own_T)) term.along_N.setZero();
            if (row.own_T <= relative_tolerance * (row.own_N + row.own_T)) term.along_T.setZero();
            problem.add_term(contact, {work.body[term.body], term.along_N, term.along_T});
        }
        problem.couple(contact, contact, Eigen::Matrix2d::Zero());
        InterfaceLaw& law = problem.contacts.back().law;
        law = row.is_struck ? law_of_strike(row, step, bodies, tolerance)
                            : contact_law(row.gap, row.before, row.law.friction, row.law.restitution, step.drift_time,
                                          infinity, tolerance, row.law.tangential);
    }
    cluster.residual = problem.solve(cluster.speed, error, ClusterEffort::sweeps);
    const auto injects = [&] {
        double positive = 0, losses = 0, scale = 0;  // [J]
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const ClusterContact& c = problem.contacts[i];
            const Row& row = rows_[rows[i]];
            const Vec2 mean = 0.5 * (c.velocity + row.before) + rate(row, bodies, &MovingBody::gained);
            const double now = positive_work(c.impulse, mean);
            positive += now, losses += now - c.impulse.dot(mean), scale += c.impulse.x() * cluster.speed;
        }
        return positive > allowed_injection * losses + at_rest * scale;
    };
    for (int k = 0; k < more_rounds && injects(); ++k)
        cluster.residual = problem.sweep_bodies(cluster.speed, sweeps_of_round);
    for (int k = 0; k < more_rounds && cluster.residual > goal * cluster.speed; ++k)
        cluster.residual = problem.sweep_bodies(cluster.speed, sweeps_of_heap);
    for (std::size_t i = 0; i < rows.size(); ++i) rows_[rows[i]].impulse = problem.contacts[i].impulse;
}

LargestMotion RigidContacts::solve(const RigidStep& step, std::vector<MovingBody>& bodies, StepReport& report) {
    LargestMotion fastest;
    for (const LargestMotion& passing : {faces_.passing(), obstacle_contacts_.passing()})
        fastest.at_least({passing.value / most_passed, passing.place});
    for (const Row& row : rows_) {
        const Sides sides = sides_of(row, bodies);
        if (!(row.own_N > 0) || row.gap + step.drift_time * row.before.x() >= 0 || sides == Sides::deformable) continue;
        const double allowed = sides == Sides::rigid ? largest_rigid_motion : largest_motion;
        const bool of_faces = row.source == Source::face || row.source == Source::point;
        const double speed = of_faces ? row.before.norm() : -row.before.x();
        fastest.at_least({step.drift_time * speed / (allowed * row.length), row.place});
    }
    if (const auto& refusal = faces_.refusal();
        refusal && refusal->reason == ContactRefusal::Reason::speed && meets_faces())
        report.reject(Rejection::contact_speed, refusal->place, refusal->value);
    const bool is_too_fast = report.rejection != Rejection::none || fastest.value > 1;
    if (is_too_fast && !step.closing && weakest_ == infinity) return fastest;  // else it may be a blow, too
    if (work_.size() < clusters_.size()) work_.resize(clusters_.size());
    for_blocks(std::ssize(clusters_), [&](std::ptrdiff_t k) { solve(k, step, bodies, work_[k]); });
    for (MovingBody& body : bodies) body.end = body.free;
    for (const Row& row : rows_) push_bodies(row, bodies);
    for (MovingBody& body : bodies)
        if (body.struck_at > 0) body.strike = body.struck_at * (body.flight - body.end);
    for (Row& row : rows_) {
        row.after = rate(row, bodies, &MovingBody::end);
        const double slip = row.source == Source::point ? step.drift_time * row.after.norm() : 0,
                     depth = row.gap > 0 ? depth_at_end(row, step, bodies) : 0;
        if (row.own_N > 0 && sides_of(row, bodies) != Sides::deformable)
            fastest.at_least({std::max(slip, depth) / (largest_motion * row.length), row.place});
        for (int k = 0; k < row.n_terms; ++k) {
            const MovingBody& body = bodies[row.terms[k].body];
            const double turn = step.drift_time * body.end.z();
            const double bend = 0.5 * turn * turn * (row.place - body.centre).norm() / row.length;
            if (!body.deformable) fastest.at_least({std::sqrt(bend / allowed_bend), row.place});
        }
    }
    return fastest;
}

template <class Change, class Take>
void RigidContacts::solve_anew(std::size_t cluster, const RigidStep& step, const std::vector<MovingBody>& bodies,
                               double goal, const Change& change, const Take& take) {
    const std::span<const Index> rows = lists_.rows(cluster);
    const Cluster before = clusters_[cluster];
    std::vector<Row> kept;
    for (const Index r : rows) {
        kept.push_back(rows_[r]), change(rows_[r]);
        rows_[r].law.restitution = rows_[r].law.tangential = 0, rows_[r].is_struck = false;
    }
    solve(cluster, step, bodies, work_[0], goal);
    for (const Index r : rows) take(r, rows_[r]);
    for (std::size_t i = 0; i < rows.size(); ++i) rows_[rows[i]] = kept[i];
    clusters_[cluster] = before;
}

double RigidContacts::move_from_rest(const RigidStep& step, const std::vector<std::uint8_t>& marked, double goal,
                                     std::vector<MovingBody>& bodies) {
    double error = 0;
    for (std::size_t k = 0; k < clusters_.size(); ++k) {
        const auto members = lists_.members(0, k);
        if (std::ranges::none_of(members, [&](Index body) { return marked[body] != 0; })) continue;
        for (const Index b : members) bodies[b].end = bodies[b].free;
        solve_anew(
            k, step, bodies, goal,
            [&](Row& row) {
                row.before = rate(row, bodies, &MovingBody::before), row.free = rate(row, bodies, &MovingBody::free);
                if (row.lasting.x() > 0) row.gap = std::min(row.gap, 0.0);
            },
            [&](Index, const Row& row) {
                error = std::max(error, clusters_[k].residual);
                push_bodies(row, bodies);
            });
    }
    return error;
}

RigidContacts::Blow RigidContacts::hardest_blow(const RigidStep& step, const std::vector<MovingBody>& bodies,
                                                std::vector<double>& of_piece) {
    Blow hardest;
    of_piece.assign(n_pieces_, 0);
    std::vector<std::optional<double>> of_motion(rows_.size());  // [N s] once it was asked
    const auto impulse_of_motion = [&](std::size_t r) {
        if (!of_motion[r])
            solve_anew(
                rows_[r].cluster, step, bodies, infinity,
                [&](Row& row) {
                    if (row.impulse.x() > 0) row.gap = std::min(row.gap, 0.0);
                    row.impulse.setZero(), row.free = row.before;
                    for (int k = 0; k < row.n_terms; ++k)  // what drives an obstacle is no load
                        if (const MovingBody& body = bodies[row.terms[k].body]; !body.moves())
                            row.free += row.terms[k].rate(body.free - body.before);
                },
                [&](Index i, const Row& row) { of_motion[i] = row.impulse.x(); });
        return *of_motion[r];
    };
    for (std::size_t r = 0; r < rows_.size(); ++r) {
        const Row& row = rows_[r];
        if (!(row.impulse.x() > 0) || !(row.own_N > 0)) continue;
        // what is handed on to a piece that steps by itself, at another time and by other forces than in this step
        const double least_mixed = sides_of(row, bodies) == Sides::mixed ? options_.thaw * weakest_ : infinity;
        double least = least_mixed;
        const auto may_break = [&](Index body) { return can_break(body) && !bodies[body].asleep; };
        for (int k = 0; k < row.n_terms; ++k)
            if (const Index body = row.terms[k].body; may_break(body))
                least = std::min(least, least_blow(begin_->frozen->pieces[body], options_));
        if (least == infinity) continue;
        const Vec2 sudden = row.impulse - row.lasting;
        const bool is_sudden = sudden.x() > 0;
        // friction stops a part of the approach, too, so W_NN p alone may be less
        const double approach = is_sudden ? std::max(0.0, -row.before.x()) : 0;
        // the impulse of the rebound comes after that which stopped the approach, and loads no more than this
        const double rebound = row.law.rebounds() && approach > 0 ? std::max(0.0, row.after.x()) / approach : 0;
        const double slope = is_sudden ? std::min(std::abs(sudden.y()) / sudden.x(), row.law.friction) : 0;
        double handed = is_sudden ? sudden.x() * row.own_N / (1 + rebound) : 0;
        // loads, which contacts may share anew, are no blow
        if (std::hypot(1, slope) * handed > least) handed = std::min(handed, impulse_of_motion(r) * row.own_N);
        const double blow = std::hypot(1, slope) * std::max(approach, handed + std::max(0.0, -row.after.x()));
        const double load =
            std::min(row.impulse.x(), row.lasting.x()) / (step.kick_time * row.length * model_.thickness);
        double of_row = blow / least_mixed;
        for (int k = 0; k < row.n_terms; ++k) {
            if (!may_break(row.terms[k].body)) continue;
            const FrozenBody::Piece& piece = begin_->frozen->pieces[row.terms[k].body];
            const double value = std::max(blow / least_blow(piece, options_), load / (lasting_load * piece.strength));
            if (value > hardest.value) hardest = {value, row.place};
            of_row = std::max(of_row, value);
        }
        for (int k = 0; k < row.n_terms; ++k)
            if (const Index body = row.terms[k].body; body < n_pieces_ && !begin_->frozen->pieces[body].held)
                of_piece[body] = std::max(of_piece[body], of_row);
    }
    return hardest;
}

void RigidContacts::add_wrenches(const std::vector<MovingBody>& bodies, std::vector<Vec3>& wrench) const {
    for (const Row& row : rows_) {
        if (sides_of(row, bodies) == Sides::deformable) continue;
        for (int k = 0; k < row.n_terms; ++k) wrench[row.terms[k].body] += row.terms[k].wrench(row.impulse);
    }
}

void RigidContacts::finish(const RigidStep& step, const std::vector<MovingBody>& bodies, State& end,
                           StepReport& report) const {
    // impulses are kept as forces times the step; before a step of the deformable body as forces
    const double lasting = (step.closing ? 1 : step.drift_time) / step.kick_time;
    // a piece alone keeps what it knows of its own faces, unless they meet in an island
    if (meets_faces() || std::ranges::any_of(bodies, &MovingBody::deformable)) end.face_contacts.clear();
    end.obstacle_contacts.clear(), end.impacts.clear();
    for (const Row& row : rows_) {
        const Sides sides = sides_of(row, bodies);
        if (sides == Sides::deformable) continue;
        const Vec2 after = rate(row, bodies, &MovingBody::end), gained = rate(row, bodies, &MovingBody::gained),
                   mean = 0.5 * (row.before + after) + gained, P = row.impulse;
        const double residual = 1e-14 * (row.before.norm() + row.free.norm() + after.norm()) +
                                (after - row.after).norm() + (row.is_struck ? 0 : gained.norm());
        const double error = row.cluster >= 0 ? clusters_[row.cluster].residual : 0,
                     merged = row.cluster >= 0 ? clusters_[row.cluster].tolerance : row.rounding / step.drift_time;
        const auto by_impulse = [&](int k, double own) { return own > 0 ? error / own * std::abs(mean[k]) : 0; };
        if (sides == Sides::mixed) {  // the work on the deformable side is that of its own steps
            for (int k = 0; k < row.n_terms; ++k)
                if (const MovingBody& body = bodies[row.terms[k].body]; !body.deformable)
                    report.exchange_work += row.terms[k].wrench(P).dot(0.5 * (body.before + body.end) + body.gained);
        } else {
            account_contact({.contact = P.x(),
                             .friction = P.y(),
                             .rate_N = mean.x(),
                             .rate_T = mean.y(),
                             .rate_error = residual + error + merged,
                             .opening = 0,
                             .work_error = by_impulse(0, row.own_N) + by_impulse(1, row.own_T)},
                            report);
            report.rigid_injection += std::max(0.0, positive_work(P, mean) - merged * P.norm());
        }
        const double depth = depth_at_end(row, step, bodies);
        const bool gave_way = row.law.rebound == ContactLaw::Rebound::of_bodies && depth <= -row.gap;
        if (!gave_way) report.add_depth(depth / row.length, row.place);  // else no penetration (explicit/rebounds.hpp)
        switch (row.source) {
            case Source::obstacle: {
                const ObstacleContact& c = obstacle_contacts_.all()[row.number];
                if (!P.isZero(0))
                    end.obstacle_contacts.push_back(
                        {c.corner, c.second_corner, c.obstacle, lasting * P.x(), lasting * P.y()});
                break;
            }
            case Source::point: {
                const Point& at = points_[row.number];
                PointState& state = end.points[end.first_point[end.split_rank[at.fan]] + at.place];
                state.traction = P / (step.kick_time * model_.points(model_.fans[at.fan])[at.place].area);
                break;
            }
            case Source::face:
            case Source::pair: break;
        }
    }
    for (std::size_t i = 0; i < row_of_face_.size(); ++i) {
        const FaceContact& c = faces_.all()[i];
        if (is_deformable(c, bodies)) continue;
        const Vec2 P = row_of_face_[i] < 0 ? Vec2(Vec2::Zero()) : Vec2(lasting * rows_[row_of_face_[i]].impulse);
        end.face_contacts.push_back({c.vertex[1], c.edge[0], c.vertex[0], P.x(), P.y()});
    }
    report.face_contacts = static_cast<std::int64_t>(row_of_face_.size());
}

// ---- contacts between pieces that step by themselves (stepper/islands) and others

void RigidContacts::impulses_on_deformable(const std::vector<MovingBody>& bodies,
                                           std::vector<CornerImpulse>& impulses) const {
    impulses.clear();
    const auto add = [&](Index corner, const Vec2& impulse) {
        if (corner == rigid_support || model_.ground_at(corner) != nullptr) return;
        const Index piece = piece_of(corner);
        if (bodies[piece].deformable) impulses.push_back({piece, corner, impulse});
    };
    for (const Row& row : rows_) {
        if (row.impulse.isZero(0) || sides_of(row, bodies) != Sides::mixed) continue;
        if (row.source == Source::face) {
            faces_.all()[row.number].visit_terms(
                [&](const CornerTerm& term) { add(term.body, term.wrench(row.impulse)); });
        } else {
            const FanPoint& point = model_.points(model_.fans[points_[row.number].fan])[points_[row.number].place];
            for (int k = 0; k < row.n_terms; ++k) {
                const Vec3 P = row.terms[k].wrench(row.impulse);
                for (const Index corner : {point.before, point.after})
                    if (corner != rigid_support && piece_of(corner) == row.terms[k].body) add(corner, P.head<2>());
            }
        }
    }
}

bool RigidContacts::is_deformable(const FaceContact& c, const std::vector<MovingBody>& bodies) const {
    return std::ranges::all_of(std::array{c.vertex[1], c.edge[0]}, [&](Index corner) {
        return model_.ground_at(corner) == nullptr && bodies[piece_of(corner)].deformable;
    });
}

void RigidContacts::release_retired(State& end) const {
    for (const Point& at : points_)
        if (end.has_retired(model_.points(model_.fans[at.fan])[at.place].point))
            end.points[end.first_point[end.split_rank[at.fan]] + at.place].traction.setZero();
}

bool RigidContacts::mark_rigid_sides(const Row& row, const std::vector<MovingBody>& bodies,
                                     std::vector<std::uint8_t>& marked) const {
    bool any = false;
    for (int k = 0; k < row.n_terms; ++k)
        if (const Index body = row.terms[k].body; body < n_pieces_ && !bodies[body].deformable)
            marked[body] = 1, any = true;
    return any;
}

bool RigidContacts::mark_touching(const std::vector<MovingBody>& bodies, std::vector<std::uint8_t>& marked) const {
    bool any = false;
    for (const Row& row : rows_)
        if (sides_of(row, bodies) == Sides::mixed) any = mark_rigid_sides(row, bodies, marked) || any;
    return any;
}

bool RigidContacts::mark_overlapping(const State& end, double allowed, const std::vector<MovingBody>& bodies,
                                     std::vector<std::uint8_t>& marked) const {
    bool any = false;
    for (const Row& row : rows_) {
        if (row.source != Source::face || sides_of(row, bodies) != Sides::mixed) continue;
        const FaceContact& c = faces_.all()[row.number];
        const double gap = c.normal.dot(c.jump([&](Index corner) { return knap::place_of(model_, end, corner); }));
        if (gap < -allowed * row.length && gap < row.gap - deepens * row.length)
            any = mark_rigid_sides(row, bodies, marked) || any;
    }
    return any;
}

}  // namespace knap
