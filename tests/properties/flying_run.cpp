#include "properties/flying_run.hpp"
#include "model/make_model.hpp"

#include "properties/wild_body.hpp"

#include "analysis/deformation_watch.hpp"
#include "analysis/gates.hpp"
#include "base/error.hpp"
#include "stepper/step_control.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

namespace knap::tests {
namespace {

constexpr double max_overlap = 0.05;       // [-] of two triangles, beyond the reported depth
constexpr double rounding_energy = 1e-24;  // [J] of bodies at rest; E and size are of order 1
constexpr int search_every = 10;           // steps
constexpr int resume_every = 5;            // steps
constexpr double rigid_momentum = 1e-11;   // [-] of rigid pieces: over tens of steps of the deformable body

SchemeOptions options_of(const FlyingScene& scene) {
    return {.cohesion = scene.implicit_cohesion ? CohesionScheme::implicit_beta : CohesionScheme::explicit_beta,
            .damping = scene.damping,
            .rigid = scene.rigid};
}

State start_of(const Model& model, const FlyingScene& scene) {
    State state = initial_state(model);
    Random random(1, "scatter");
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        const FlyingBody& body = scene.bodies[model.mesh.region[c / 3]];
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        Vec2& v = state.velocity[state.node_of_corner[c]];
        v = body.velocity + body.spin * turned_left(model.mesh.corner(c) - body.place);
        if (model.fans[model.fan_of_corner[c]].split_at_start && !scene.law.sigma_c) v += scene.scatter * Vec2(x, y);
    }
    return state;
}

/// [-] The largest distance of the two sides of a point that has not retired, over its edge: damaged faces slide on their
/// first neighbour.
double largest_live_opening(const Model& model, const State& state) {
    double most = 0;
    for (Index p = 0; p < model.n_points(); ++p) {
        if (state.has_retired(p)) continue;
        const FanPoint& point = model.fan_points[model.fan_point_of[p]];
        const Vec2 jump = state.displacement_of(point.after) - state.displacement_of(point.before);
        most = std::max(most, jump.norm() / model.interfaces[model.interface_of(p)].length);
    }
    return most;
}

class FlyingWatch {
public:
    FlyingWatch(const Model& model, const FlyingScene& scene, const State& start, FlyingOutcome& outcome)
        : model_(model), scene_(scene), ledger_(model, start), deformation_(model), outcome_(outcome) {
        for (const double m : model.corner_mass) mass_ += m;
        for (const Interface& one : model.interfaces) longest_ = std::max(longest_, one.length);
    }

    void step(const State& begin, const State& end, const StepReport& report) {
        ledger_.add(end, report);
        deformation_.look_at(end);
        ++outcome_.n_steps;
        outcome_.n_contacts += static_cast<long>(report.face_contacts);
        outcome_.depth = std::max(outcome_.depth, report.contact_depth);
        outcome_.residual = std::max(outcome_.residual, report.contact_residual);
        outcome_.energy_error = ledger_.largest_residual() / std::max(ledger_.largest_energy(), rounding_energy);
        if (!std::isfinite(report.kinetic + report.strain + report.impact_work + report.friction_work))
            fail("not a finite number", 1, 0);
        at_most("energy residual over the largest energy", outcome_.energy_error, 1e-10);
        at_most("growth of the cohesion", report.largest_beta_growth, 0);
        at_most("change of area", deformation_.area_change().value, 0.9);
        if (scene_.rigid_step > 0) keeps_rigid_momentum(begin, end, report);
        else keeps_momentum(begin, end, report);
        // what the program refuses by a gate
        if (report.residual > max_residual) outcome_.refusal = "gate interface_residual";
        if (deformation_.strain().value > max_strain) outcome_.refusal = "a strain far from small";
        if (scene_.rigid_step > 0 || outcome_.n_steps % search_every == 0) search(end);
        if (report.contact_depth > max_overlap && report.contact_depth > deepest_)
            at_most("depth of a contact where hardly anything overlaps", deepest_ = report.contact_depth,
                    2 * max_overlap + 4 * largest_overlap(model_, end).of_shortest);
    }

    void end(const State& state) {
        search(state);
        const EnergyRow& row = ledger_.row();
        const double lost = -row.impact_work - row.friction_work,
                     scale = std::max(lost, 1e-3 * ledger_.largest_energy());
        outcome_.injected = ledger_.worst().contact_injection / std::max(scale, 1e-300);
        at_most("positive works of contacts", outcome_.injected, 1e-6);
        // impacts without loss
        if (scene_.rigid_step == 0 && scene_.unbreakable() && scene_.contact.friction == 0 &&
            scene_.contact.changing < 0 && scene_.contact.restitution == 1 && scene_.floor == Floor::none)
            at_most("loss of elastic impacts over the energy",
                    lost / std::max(ledger_.largest_energy(), rounding_energy), 1e-10);
        const bool at_rest = ledger_.largest_energy() <= rounding_energy;
        Gates gates;
        judge({ledger_, std::numeric_limits<double>::infinity(), 1e9, true}, {}, gates);
        for (const Gate& gate : gates) {
            if (gate.pass() || at_rest || gate.name == "law_lag") continue;
            // the discrete balances must hold whatever happens; the laws of single contacts are refused where they do not
            const bool is_refusal =
                gate.name != "energy_residual" && gate.name != "cohesion_growth" && gate.name != "largest_speed";
            if (is_refusal) outcome_.refusal = "gate " + std::string(gate.name);
            else at_most(gate.name.data(), gate.value, gate.limit);
        }
    }

private:
    void fail(const std::string& what, double value, double limit) {
        if (!outcome_.broken_law.empty()) return;
        char text[200];
        std::snprintf(text, sizeof text, "%s is %.3g and may be %.3g at step %d", what.c_str(), value, limit,
                      outcome_.n_steps);
        outcome_.broken_law = text;
    }
    void at_most(const char* what, double value, double limit) {
        if (!(value <= limit)) fail(what, value, limit);
    }

    /// Momentum and angular momentum change by gravity alone; a point that carries an impulse over an opening u has the
    /// couple u x P. The positions are those of the start of the step, where all forces and impulses act.
    void keeps_momentum(const State& begin, const State& end, const StepReport& report) {
        if (scene_.floor != Floor::none || scene_.damping > 0) return;
        const double k = 0.5 * (begin.last_step + end.last_step);
        Vec2 change = Vec2::Zero();
        double moment = 0, scale = 0, arm = 0;
        for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
            const Vec2 x = place(model_, begin, c);
            const double m = model_.corner_mass[c];
            const Vec2 before = begin.velocity[begin.node_of_corner[c]], after = end.velocity[end.node_of_corner[c]];
            const Vec2 kick = m * (after - before - k * Vec2(0, -scene_.gravity));
            change += kick, moment += cross(x, kick);
            scale += m * (before.norm() + after.norm()), arm = std::max(arm, x.norm());
        }
        for (std::size_t rank = 0; rank < end.split_fans.size(); ++rank) {
            const auto points = model_.points(model_.fans[end.split_fans[rank]]);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const FanPoint& point = points[i];
                const Vec2 traction = end.points[end.first_point[rank] + i].traction,
                           n = point_frame(model_, begin, point).turned(point.normal),
                           jump = begin.displacement_of(point.after) - begin.displacement_of(point.before);
                moment -= cross(jump, k * point.area * (traction.x() * n + traction.y() * turned_left(n)));
            }
        }
        // a step rounds the elastic forces, whose stresses are up to E times the strain, and impulses of up to the strength
        // that cancel in a body at rest
        double stiffest = 0;
        for (const FlyingBody& body : scene_.bodies) stiffest = std::max(stiffest, body.E);
        scale = std::max({scale, k * stiffest * deformation_.strain().value, k * scene_.law.sigma_c * longest_});
        scale = std::max({scale, mass_ * report.largest_speed, std::sqrt(rounding_energy)});
        outcome_.momentum_error = std::max(outcome_.momentum_error, change.norm() / scale);
        outcome_.moment_error = std::max(outcome_.moment_error, std::abs(moment) / (arm * scale));
        at_most("change of momentum in a step", change.norm() / scale, 1e-12);
        at_most("change of angular momentum in a step", std::abs(moment) / (arm * scale), 1e-12);
    }

    /// Velocities are those of the middle of the last step of their piece, which is of no length where it ended with the
    /// end of the step. Angular momentum is that of the places at the ends of steps; in islands it is exact but for the
    /// way of the corners.
    void keeps_rigid_momentum(const State& begin, const State& end, const StepReport& report) {
        if (scene_.floor != Floor::none || scene_.damping > 0) return;
        const auto last_step = [](const State& state, Index triangle) {
            return state.frozen ? state.rigid_pieces[state.frozen->piece_of_triangle[triangle]].last_step
                                : state.last_step;
        };
        Vec2 change = Vec2::Zero();
        double scale = mass_ * report.largest_speed;
        for (Index c = 0; c < model_.mesh.n_corners(); ++c) {
            const double m = model_.corner_mass[c],
                         k = end.time - begin.time + 0.5 * (last_step(begin, c / 3) - last_step(end, c / 3));
            const Vec2 before = begin.velocity[begin.node_of_corner[c]], after = end.velocity[end.node_of_corner[c]];
            change += m * (after - before - k * Vec2(0, -scene_.gravity));
            scale += m * (before.norm() + after.norm());
        }
        double stiffest = 0;
        for (const FlyingBody& body : scene_.bodies) stiffest = std::max(stiffest, body.E);
        scale += (end.time - begin.time) * (stiffest * deformation_.strain().value + scene_.law.sigma_c * longest_) +
                 std::sqrt(rounding_energy);
        outcome_.momentum_error = std::max(outcome_.momentum_error, change.norm() / scale);
        at_most("change of momentum in a step", change.norm() / scale, rigid_momentum);
        if (!begin.frozen || begin.frozen != end.frozen || report.micro_steps > 0 || scene_.gravity > 0) return;
        double moment = 0, arm = 0;
        for (std::size_t p = 0; p < begin.rigid_pieces.size(); ++p) {
            const FrozenBody::Piece& body = begin.frozen->pieces[p];
            const auto of = [&](const RigidPiece& piece) {
                return body.mass * cross(piece.centre, piece.velocity) + body.inertia * piece.spin;
            };
            moment += of(end.rigid_pieces[p]) - of(begin.rigid_pieces[p]);
            arm = std::max(arm, begin.rigid_pieces[p].centre.norm() + body.radius);
        }
        outcome_.moment_error = std::max(outcome_.moment_error, std::abs(moment) / (arm * scale));
        at_most("change of angular momentum in a step", std::abs(moment) / (arm * scale), rigid_momentum);
    }

    /// A body strained beyond what the model covers is refused, wherever its triangles lie.
    void search(const State& state) {
        if (deformation_.strain().value > max_strain) return;
        const double found = largest_overlap(model_, state).of_longest;
        outcome_.overlap = std::max(outcome_.overlap, found);
        at_most("overlap of two triangles beyond what is reported",
                found - 2 * outcome_.depth - 2 * largest_live_opening(model_, state), max_overlap);
    }

    const Model& model_;
    const FlyingScene& scene_;
    EnergyLedger ledger_;
    DeformationWatch deformation_;
    FlyingOutcome& outcome_;
    double mass_ = 0, longest_ = 0, deepest_ = 0;
};

/// Steps like the program, from `now` on.
struct Flight {
    Flight(const Model& model, const FlyingScene& scene)
        : stepper(model, options_of(scene)),
          h(scene.safety * stepper.stable_step()),
          control(limits_of(model, scene, h)) {
        if (scene.rigid_step > 0) stepper.resolve_islands(limits_of(model, scene, h));
    }

    static StepLimits limits_of(const Model& model, const FlyingScene& scene, double h) {
        StepLimits limits{.largest = h, .cracking = h, .smallest = std::ldexp(h, -16), .end = scene.n_steps * h};
        if (scene.rigid_step == 0) return limits;
        std::vector<double> area(scene.bodies.size(), 0);
        for (Index t = 0; t < model.mesh.n_triangles(); ++t) area[model.mesh.region[t]] += model.mesh.area(t);
        double passage = 0;
        for (std::size_t b = 0; b < area.size(); ++b)
            passage = std::max(passage, std::sqrt(area[b] * scene.bodies[b].density / scene.bodies[b].E));
        limits.rigid = {.step = scene.rigid.step,
                        .smallest = std::min(scene.rigid.step / 64, h),
                        .hold = scene.rigid.hold * passage};
        return limits;
    }

    /// False where the run ends: at its end, or since the step cannot be taken.
    bool advance(State& now, State& next, FlyingOutcome& outcome) {
        while (!StepControl::has_reached(now, end)) {
            if (control.may_freeze(now)) now.motion = Motion::rigid;
            const double step = control.next(now);
            report = stepper.step(now, step, next);
            const auto cut = control.judge(now, step, report);
            if (!cut) return true;
            ++outcome.n_cuts;
            if (control.is_stuck()) {
                outcome.refusal = std::string(describe(cut->reason));
                stuck_at = cut->place;
                return false;
            }
            if (const auto thawed = cut->thaws ? stepper.thaw(now, next) : std::nullopt) {
                report = *thawed;
                return true;
            }
        }
        return false;
    }

    MoreauJean stepper;
    double h;
    StepControl control;
    double end = 0;
    StepReport report;
    std::optional<Vec2> stuck_at;
};

bool same_everything(const State& a, const State& b) {
    if (!same_bits(a, b) || a.retired != b.retired || a.face_contacts.size() != b.face_contacts.size()) return false;
    for (std::size_t i = 0; i < a.points.size(); ++i) {
        const PointState &x = a.points[i], &y = b.points[i];
        if (x.traction != y.traction || x.largest_opening != y.largest_opening || x.slid != y.slid) return false;
    }
    for (std::size_t i = 0; i < a.face_contacts.size(); ++i) {
        const FaceContactState &x = a.face_contacts[i], &y = b.face_contacts[i];
        if (x.vertex != y.vertex || x.edge != y.edge || x.contact != y.contact || x.tangential != y.tangential)
            return false;
    }
    for (std::size_t p = 0; p < a.rigid_pieces.size(); ++p) {
        const RigidPiece &x = a.rigid_pieces[p], &y = b.rigid_pieces[p];
        if (x.state != y.state || x.centre != y.centre || x.angle != y.angle || x.rates() != y.rates()) return false;
    }
    return a.motion == b.motion && a.n_steps == b.n_steps && a.elastic_energy == b.elastic_energy &&
           a.elastic_work == b.elastic_work;
}

bool lies_within(const Model& model, const State& state, const Vec2& where) {
    Vec2 low = Vec2::Constant(1e300), high = -low;
    for (Index c = 0; c < model.mesh.n_corners(); ++c)
        for (const Vec2& x : {place(model, state, c), model.mesh.corner(c)})
            low = low.cwiseMin(x), high = high.cwiseMax(x);
    const double margin = 1e-6 * (high - low).norm();
    return ((where - low).array() > -margin).all() && ((high - where).array() > -margin).all();
}

void fly(const Model& model, const FlyingScene& scene, FlyingOutcome& outcome) {
    Flight flight(model, scene);
    flight.end = scene.n_steps * flight.h;
    State now = start_of(model, scene), next, saved;
    if (scene.rigid_step > 0) flight.stepper.begin(now);
    if (largest_overlap(model, now).of_longest > 1e-9) {
        outcome.rejected = true;
        return;
    }
    FlyingWatch watch(model, scene, now, outcome);
    std::optional<StepControl> control;  // of the saved state
    while (outcome.broken_law.empty() && outcome.refusal.empty() && outcome.n_steps < 8 * scene.n_steps) {
        if (!control &&
            (outcome.n_steps == scene.n_steps / 2 || (scene.rigid_step > 0 && now.time >= 0.5 * flight.end)))
            saved = now, control = flight.control;
        if (!flight.advance(now, next, outcome)) break;
        watch.step(now, next, flight.report);
        std::swap(now, next);
    }
    if (flight.control.is_stuck() && outcome.broken_law.empty() &&
        (!flight.stuck_at || !lies_within(model, now, *flight.stuck_at)))
        outcome.broken_law = "a refusal without its place";
    watch.end(now);
    for (const PointState& point : now.points) outcome.n_broken += point.cohesion == 0;
    outcome.n_retired = static_cast<int>(std::ranges::count(now.retired, Retirement::retired));
    if (!outcome.broken_law.empty() || !control) return;
    // one thread begins anew every few steps, and has nothing of earlier ones but the state
    for (const int threads : {1, 2}) {
        omp_set_num_threads(threads);
        FlyingOutcome ignored;
        State other = saved;
        std::optional<Flight> again;
        StepControl of_again = *control;
        for (int step = 0; other.n_steps < now.n_steps; ++step) {
            if (!again || (threads == 1 && step % resume_every == 0)) {
                again.emplace(model, scene);
                again->control = of_again, again->end = flight.end;
                next = {};
            }
            if (!again->advance(other, next, ignored)) break;
            std::swap(other, next), of_again = again->control;
        }
        omp_set_num_threads(1);
        if (!same_everything(now, other)) {
            outcome.broken_law = threads == 1 ? "a resumed run has other bits" : "two threads have other bits";
            return;
        }
    }
}

/// What two failures have in common if they break the same law.
std::string law_named_in(const std::string& broken) { return broken.substr(0, broken.find(" is ")); }

}  // namespace

FlyingOutcome run_flying(const FlyingScene& given) {
    FlyingOutcome outcome;
    try {
        FlyingScene scene = given;
        const Model model = make_model(input_of(scene));
        if (scene.rigid_step > 0) scene.rigid.step = scene.rigid_step * scene.safety * MoreauJean(model).stable_step();
        fly(model, scene, outcome);
    } catch (const UserError&) {
        outcome.rejected = true;
    } catch (const SimulationError& error) {
        if (outcome.broken_law.empty()) outcome.broken_law = error.what();
    }
    return outcome;
}

FlyingScene shrunk(FlyingScene scene, const std::string& broken_law) {
    const std::string law = law_named_in(broken_law);
    const auto still_fails = [&](const FlyingScene& other) {
        return law_named_in(run_flying(other).broken_law) == law;
    };
    bool smaller = true;
    const auto try_with = [&](auto change) {
        FlyingScene other = scene;
        change(other);
        if (text_of(other) == text_of(scene) || !still_fails(other)) return;
        scene = other, smaller = true;
    };
    while (std::exchange(smaller, false)) {
        for (std::size_t b = scene.bodies.size(); b-- > 0;)
            if (scene.bodies.size() > 1) try_with([&](FlyingScene& s) { s.bodies.erase(s.bodies.begin() + b); });
        try_with([](FlyingScene& s) { s.floor = Floor::none; });
        try_with([](FlyingScene& s) { s.gravity = 0; });
        try_with([](FlyingScene& s) { s.damping = 0; });
        try_with([](FlyingScene& s) { s.scatter = 0; });
        try_with([](FlyingScene& s) { s.implicit_cohesion = false; });
        try_with([](FlyingScene& s) { s.contact.friction = s.law.friction = 0; });
        try_with([](FlyingScene& s) { s.contact.restitution = s.law.restitution = 0; });
        try_with([](FlyingScene& s) { s.law = CohesiveLaw::unbreakable(), s.cracked = 0; });
        try_with([](FlyingScene& s) { s.cracked = 0; });
        try_with([](FlyingScene& s) { s.law.gamma = 1; });
        try_with([](FlyingScene& s) { s.safety = 0.8; });
        if (scene.rigid_step > 0) {
            try_with([](FlyingScene& s) { s.rigid.smallest = 0; });
            try_with([](FlyingScene& s) { s.rigid.sleep = 0; });
            try_with([](FlyingScene& s) { s.rigid.thaw = 0.3; });
        }
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
            try_with(
                [&](FlyingScene& s) { s.bodies[b].n_x = std::max(s.bodies[b].star ? 3 : 1, s.bodies[b].n_x - 1); });
            try_with([&](FlyingScene& s) { s.bodies[b].n_y = std::max(1, s.bodies[b].n_y - 1); });
            try_with([&](FlyingScene& s) { s.bodies[b].roughness = 0; });
            try_with([&](FlyingScene& s) { s.bodies[b].spin = 0; });
            try_with([&](FlyingScene& s) { s.bodies[b].velocity.setZero(); });
            try_with([&](FlyingScene& s) { s.bodies[b].density = s.bodies[b].E = 1; });
        }
    }
    return scene;
}

std::string text_of(const FlyingScene& s) {
    std::ostringstream text;
    text.precision(17);
    text << "law sigma_c " << s.law.sigma_c << " G_c " << s.law.G_c << " gamma " << s.law.gamma << " mu "
         << s.law.friction << " e " << s.law.restitution << "; contact mu " << s.contact.friction << " e "
         << s.contact.restitution << "; implicit " << s.implicit_cohesion << " cracked " << s.cracked << " scatter "
         << s.scatter << " gravity " << s.gravity << " damping " << s.damping << " floor " << int(s.floor) << " safety "
         << s.safety << " steps " << s.n_steps << " fastest " << s.fastest << "\n";
    if (s.rigid_step > 0)
        text << "rigid step " << s.rigid_step << " thaw " << s.rigid.thaw << " hold " << s.rigid.hold << " smallest "
             << s.rigid.smallest << " sleep " << s.rigid.sleep << " e " << s.rigid.restitution << "; contact gives e "
             << s.contact.gives_restitution << "\n";
    for (const FlyingBody& b : s.bodies)
        text << "    " << (b.star ? "star " : "bar ") << b.n_x << " x " << b.n_y << ", " << b.width << " x " << b.height
             << " at " << b.place.transpose() << " angle " << b.angle << " v " << b.velocity.transpose() << " spin "
             << b.spin << " rough " << b.roughness << " seed " << b.seed << " rho " << b.density << " E " << b.E
             << "\n";
    return text.str();
}

}  // namespace knap::tests
