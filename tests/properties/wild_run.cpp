#include "properties/wild_run.hpp"
#include "model/make_model.hpp"

#include "analysis/deformation_watch.hpp"
#include "analysis/gates.hpp"
#include "base/error.hpp"
#include "stepper/step_control.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

namespace knap::tests {
namespace {

bool is_explicit(const WildBody& wild) { return wild.body.scheme.bulk == BulkScheme::explicit_lumped; }

/// Velocities of the body per vertex; corners that are apart from the start scatter about them, each by its place in the mesh.
State start_of(const Model& model, const WildBody& wild) {
    State state = initial_state(model);
    Random random(1, "scatter");
    double fastest = 0;
    for (const Vec2& v : wild.body.velocity) fastest = std::max(fastest, v.norm());
    for (Index c = 0; c < model.mesh.n_corners(); ++c) {
        Vec2& velocity = state.velocity[state.node_of_corner[c]];
        velocity = wild.body.velocity[model.mesh.triangles[c / 3][c % 3]];
        const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
        if (model.fans[model.fan_of_corner[c]].split_at_start) velocity += wild.scatter * fastest * Vec2(x, y);
    }
    for (const Fan& fan :
         model.fans) {  // corners that bonds join move as one, and stand still where one of them is the support
        if (!fan.split_at_start) continue;
        const auto velocity = [&](Index corner) {
            return corner == rigid_support ? Vec2(Vec2::Zero()) : state.velocity[state.node_of_corner[corner]];
        };
        const auto give = [&](Index from, Index to) {
            if (to != rigid_support) state.velocity[state.node_of_corner[to]] = velocity(from);
        };
        for (int pass = 0; pass < 3; ++pass)
            for (Index i = 0; i < fan.n_points; ++i) {
                const Index forth = fan.first_point + i, back = fan.first_point + fan.n_points - 1 - i;
                for (const bool backwards : {false, true}) {
                    const FanPoint& point = model.fan_points[backwards ? back : forth];
                    if (point.cracked || model.laws[point.law].sigma_c <= 0) continue;
                    if (pass < 2 ? !backwards : backwards)
                        give(backwards ? point.after : point.before, backwards ? point.before : point.after);
                }
            }
    }
    return state;
}

class Watch {
public:
    Watch(const Model& model, const WildBody& wild, const State& start)
        : model_(model),
          wild_(wild),
          ledger_(model, start, wild.body.scheme.mass),
          stored_(ledger_.row().recoverable + ledger_.row().interface_elastic) {
        for (const FanPoint& point : model.fan_points)
            if (model.laws[point.law].breakable()) {
                const double mass = model.corner_mass[point.after == rigid_support ? point.before : point.after],
                             force = point.area * model.laws[point.law].sigma_c;
                strength_ += force;
                rounding_ = std::max(rounding_, 1e-13 * force * force / mass);
            }
    }

    /// The first law that a step broke, or nothing.
    std::string step(const State& begin, const State& end, double h, const StepReport& report) {
        ledger_.add(end, report);
        found_.clear();
        finite(end, report);
        cohesion_falls(begin, end, report);
        longest_ = std::max(longest_, h), fastest_ = std::max(fastest_, report.largest_speed);
        if (rests()) return found_;
        books_close(report);
        nothing_penetrates(end, report);
        return found_;
    }

    /// The gates that the program itself sets every run, but those that know the scene.
    std::string end() {
        found_.clear();
        if (rests()) return found_;
        if (!model_.obstacles.empty())
            at_most("residual of the laws under lasting pressure", ledger_.worst().residual, 1e-11);
        std::vector<AllowedLimit> any;  // of how far and how large a step goes: random bodies go anywhere
        for (const GateRule& rule : gate_rules())
            if (rule.allowed) any.push_back({std::string(rule.name), std::numeric_limits<double>::infinity()});
        Gates gates;
        judge({ledger_, 0, 0}, any, gates);
        for (const Gate& gate : gates)
            if (!gate.pass() && gate.name != "largest_speed") at_most(gate.name.data(), gate.value, gate.limit);
        return found_;
    }

private:
    bool rests() const { return ledger_.largest_energy() <= rounding_ * longest_ * longest_; }

    void at_most(const char* what, double value, double limit) {
        if (value <= limit || !found_.empty()) return;  // also catches what is not a number
        char text[200];
        std::snprintf(text, sizeof text, "%s is %.3g and may be %.3g", what, value, limit);
        found_ = text;
    }

    void finite(const State& end, const StepReport& report) {
        double sum = report.kinetic + report.strain + report.dissipated + report.recoverable;
        sum += report.external_work + report.cohesive_work + report.friction_work + report.impact_work;
        for (const Vec2& u : end.displacement) sum += u.sum();
        for (const Vec2& v : end.velocity) sum += v.sum();
        for (const PointState& point : end.points) sum += point.traction.sum();
        if (!std::isfinite(sum)) found_ = "not a finite number";
    }

    void cohesion_falls(const State& begin, const State& end, const StepReport& report) {
        at_most("growth of the cohesion, reported", report.largest_beta_growth, 0);
        double most = 0, growth = 0, negative = 0;
        for (Index p = 0; p < model_.n_points(); ++p) {
            if (!model_.laws[model_.interfaces[p / 2].law].breakable()) continue;
            const double before = cohesion(model_, begin, p), after = cohesion(model_, end, p);
            most = std::max(most, after), negative = std::max(negative, -after),
            growth = std::max(growth, after - before);
        }
        at_most("cohesion", most, 1);
        at_most("minus cohesion", negative, 0);
        at_most("growth of the cohesion", growth, 0);
    }

    /// Nothing is given by interfaces; the rest of the energy balance is judged at the end.
    void books_close(const StepReport& report) {
        const EnergyRow& row = ledger_.row();
        at_most("minus the damping of the scheme", -report.scheme_dissipation, 1e-12 * ledger_.largest_energy());
        at_most("minus the recoverable energy", -row.recoverable, 0);
        at_most("fall of the dissipated energy", dissipated_ - row.dissipated, 1e-13 * row.dissipated);
        dissipated_ = row.dissipated;
        const CohesiveLaw& law = model_.laws[0];  // slip alone stores up to G_II
        const double mixed = law.has_mode_mix() ? std::max(1.0, law.G_II / law.G_c) : 1;
        at_most("surface energy", row.surface(), mixed * energy_of_all_interfaces(model_) * (1 + 1e-12));
        // what softened on the way to a start in equilibrium gives its recoverable energy when it closes;
        // sides that have gone into each other were drawn in by their cohesion, which they lose again on their way out; and central differences
        // begin with half a kick; what moves by itself stops within twice what it moves in a step, as below
        if (is_explicit(wild_)) deepest_ = std::max(deepest_, longest_ * fastest_);
        deepest_ = std::max(deepest_, report.penetration);
        // and where cohesion pulls closed sides on for the rest of a step, contact takes at once what it gives: where a body vibrates on such points,
        // step after step
        at_most("energy given by interfaces", -row.cohesive_work + row.impact_work,
                stored_ + 1e-10 * ledger_.largest_energy() + 2 * strength_ * deepest_);
    }

    /// What moves by itself stops within what it moves in a step; a given motion may push a body through its support.
    /// Normals turn between two steps: a slip u_T adds u_T times the angle.
    void nothing_penetrates(const State& end, const StepReport& report) {
        if (!model_.prescribed.empty()) return;
        double by_turning = 0;
        if (model_.large_rotation) {
            for (Index p = 0; p < model_.n_points(); ++p)
                by_turning = std::max(by_turning, opening(model_, end, p).norm());
            by_turning *= std::min(1.0, turned_ += fastest_turn(end) * end.last_step);
        }
        at_most("penetration over step times speed",
                (report.penetration - by_turning) / std::max(longest_ * fastest_, 1e-300), 2);
    }

    /// [rad/s] An upper bound for triangles: the largest difference of velocities over the smallest edge.
    double fastest_turn(const State& end) const {
        double fastest = 0;
        for (Index t = 0; t < model_.mesh.n_triangles(); ++t)
            for (Index k = 0; k < 3; ++k) {
                const Vec2 along = model_.mesh.side_vector(t, k),
                           rate = end.velocity[end.node_of_corner[3 * t + (k + 1) % 3]] -
                                  end.velocity[end.node_of_corner[3 * t + k]];
                fastest = std::max(fastest, std::abs(cross(along, rate)) / along.squaredNorm());
            }
        return fastest;
    }

    const Model& model_;
    const WildBody& wild_;
    EnergyLedger ledger_;
    double stored_;        // [J] recoverable energy at the start
    double strength_ = 0;  // [N] of all points
    double rounding_ = 0;  // [J/s2] a motion of less energy in a step of 1 s is rounding of the strengths
    double longest_ = 0, fastest_ = 0, deepest_ = 0, dissipated_ = 0;
    double turned_ = 0;  // [rad] an upper bound, so far
    std::string found_;
};

void run(const WildBody& wild, const Model& model, WildOutcome& outcome) {
    MoreauJean stepper(model, wild.body.scheme);
    State now = start_of(model, wild), next;
    const double h = is_explicit(wild) ? wild.safety * stepper.stable_step() : wild.body.step;
    if (wild.from_equilibrium) {
        for (Vec2& v : now.velocity) v.setZero();
        stepper.start_in_equilibrium(now);
    }
    StepControl control({.largest = h,
                         .cracking = is_explicit(wild) ? h : wild.cracking * h,
                         .smallest = std::ldexp(wild.cracking * h, -16),
                         .end = wild.n_steps * h});
    Watch watch(model, wild, now);
    DeformationWatch deformation(model);
    const int most = 40 * wild.n_steps;
    int n_tried = 0;
    while (outcome.broken_law.empty() && !StepControl::has_reached(now, wild.n_steps * h) && n_tried++ < most) {
        const double step = control.next(now);
        const StepReport report = stepper.step(now, step, next);
        const auto cut = control.judge(now, step, report);
        if (cut && control.is_stuck()) {
            outcome.stop = std::string(describe(cut->reason));
            break;
        }
        outcome.n_cuts += cut.has_value();
        if (cut) continue;
        ++outcome.n_steps;
        outcome.broken_law = watch.step(now, next, step, report);
        std::swap(now, next);
        if (model.large_rotation) deformation.look_at(now);
        if (!(deformation.strain().value <= max_strain)) {  // zero with small rotations
            outcome.stop = "a strain far from small";
            return;
        }
        if (report.residual >= 1 && !model.prescribed.empty()) {  // the program says so, and calls the run failed
            outcome.stop = "a vertex that is driven against its contact has no lawful motion";
            return;
        }
    }
    if (outcome.broken_law.empty()) outcome.broken_law = watch.end();
    if (n_tried > most) outcome.stop = "forty times as many steps as planned, and not at the end";
    for (const PointState& point : now.points)
        outcome.n_damaged += point.cohesion > 0 && point.cohesion < 1, outcome.n_broken += point.cohesion == 0;
    outcome.end = std::move(now);
}

}  // namespace

WildOutcome run_wild(const WildBody& wild) {
    WildOutcome outcome;
    const Model model = make_model(wild.body.input);
    try {
        run(wild, model, outcome);
    } catch (const SimulationError& error) {
        outcome.stop = error.what();
        if (is_explicit(wild)) outcome.broken_law = outcome.stop;  // nothing stops a stable run
    }
    if (!outcome.broken_law.empty()) outcome.broken_law += " at step " + std::to_string(outcome.n_steps);
    return outcome;
}

std::string difference_in_other_units(const WildBody& wild, const WildOutcome& outcome) {
    WildBody other = wild;
    const double length = 0x1p10, mass = 0x1p-30, time = 0x1p-20;
    in_units(other.body, length, mass, time);
    const WildOutcome found = run_wild(other);
    if (found.stop.empty() != outcome.stop.empty() || found.broken_law != outcome.broken_law)
        return "in other units it ends otherwise: " + found.stop + found.broken_law;
    const State &a = outcome.end, &b = found.end;
    if (a.n_steps != b.n_steps || a.split_fans != b.split_fans)
        return "in other units other steps or other fans come apart";
    for (std::size_t i = 0; i < a.points.size(); ++i)
        if (a.points[i].cohesion != b.points[i].cohesion) return "in other units another cohesion";
    for (std::size_t i = 0; i < a.displacement.size(); ++i)
        if (length * a.displacement[i] != b.displacement[i]) return "in other units another displacement";
    return "";
}

}  // namespace knap::tests
