// bulk = "auto": both schemes on one state, and the changes between them.
#include "stepper/scheme_change.hpp"
#include "model/make_model.hpp"
#include "stepper/step_control.hpp"
#include "support/obstacles.hpp"
#include "support/relative.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace scheme_change_test {

using namespace knap;
using namespace knap::tests;

namespace {

constexpr double length = 1, height = 0.05;
constexpr int n_cells = 40;

/// A bar with E = rho = 1: waves of speed 1. Region 1 is its right half.
ModelInput bar(const CohesiveLaw& in_the_middle) {
    ModelInput input;
    input.plane = PlaneModel::stress;
    input.mesh = symmetric_bar_mesh(n_cells, length, height, [](int i) { return i < n_cells / 2 ? 0 : 1; });
    input.materials.assign(2, {.density = 1, .E = 1, .nu = 0});
    input.laws = {CohesiveLaw::unbreakable(), in_the_middle};
    input.law_of_pair = {{0, 1}, {1, 0}};
    return input;
}

/// As the loop of a run.
struct Changing {
    Changing(ModelInput input, const StepLimits& limits, SchemeOptions scheme)
        : body(std::move(input), scheme), control(limits) {
        begin_theta_scheme(body.now);
    }

    void step() {
        const double h = control.next(body.now);
        const StepReport report = body.stepper.step(body.now, h, next);
        if (const auto cut = control.judge(body.now, h, report)) {
            REQUIRE_FALSE(control.is_stuck());
            if (cut->changes_to_explicit) begin_leapfrog(body.now);
            return;
        }
        take(report);
        if (!control.ends_explicit_stage(body.now)) return;
        const StepReport closing = body.stepper.close_leapfrog(body.now, next);
        REQUIRE(closing.rejection == Rejection::none);
        control.begin_implicit_stage(next, closing);
        take(closing);
    }
    void take(const StepReport& report) {
        std::swap(body.now, next);
        body.ledger.add(body.now, report);
        ++n_steps;
    }
    void run_until(double time) {
        while (!StepControl::has_reached(body.now, time)) step();
    }

    Run body;
    StepControl control;
    State next;
    int n_steps = 0;
};

double momentum(const Run& run) {
    double sum = 0;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        sum += run.model.corner_mass[c] * run.now.velocity[run.now.node_of_corner[c]].x();
    return sum;
}

void change_to_implicit(Run& run) {
    State end;
    const StepReport closing = run.stepper.close_leapfrog(run.now, end);
    REQUIRE(closing.rejection == Rejection::none);
    run.now = end;
    run.ledger.add(run.now, closing);
}

/// The first mode of a free bar, v = cos(pi x) cos(pi t), under a constant force along it, through given stages of one
/// period. Returns the largest error of the velocity.
struct Vibration {
    double error, energy_residual, impulse_error, step_change_work;
};

enum class Stages { explicit_alone, implicit_alone, both, both_from_implicit };

Vibration vibrate(Stages stages) {
    ModelInput input = bar(CohesiveLaw::unbreakable());
    constexpr double force = 1e-3, start = 1, period = 2;
    input.loads = {load(Load::Kind::body_force, "", force, 0)};
    input.loads[0].on = {};
    Run run(std::move(input), {.bulk = BulkScheme::automatic});
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const double x = run.model.mesh.corner(c / 3, c % 3).x();
        run.now.velocity[run.now.node_of_corner[c]] = {start * std::cos(std::numbers::pi * x / length), 0};
    }
    run.ledger = EnergyLedger(run.model, run.now);
    const double h = 0.8 * run.stepper.stable_step(), H = period / 400, before = momentum(run);
    double pushed = 0;  // [s] for which the force has given its impulse
    const auto go = [&](bool implicit, double until) {
        if (implicit && !run.now.has_end_velocities()) {
            if (run.now.last_step > 0) {
                pushed += 0.5 * (1 + closing_part) * run.now.last_step;
                change_to_implicit(run);
            } else {
                begin_theta_scheme(run.now);
            }
        }
        if (!implicit && run.now.has_end_velocities()) begin_leapfrog(run.now);
        while (run.now.time < until - 1e-9) {
            const double step = std::min(implicit ? H : h, until - run.now.time);
            pushed += implicit ? step : 0.5 * (run.now.last_step + step);
            run.step(step);
        }
    };
    switch (stages) {
        case Stages::explicit_alone: go(false, period); break;
        case Stages::implicit_alone: go(true, period); break;
        case Stages::both:
            go(false, 0.3 * period), go(true, 0.55 * period), go(false, 0.8 * period), go(true, period);
            break;
        case Stages::both_from_implicit: go(true, 0.3 * period), go(false, 0.7 * period), go(true, period); break;
    }
    if (!run.now.has_end_velocities()) {
        pushed += 0.5 * (1 + closing_part) * run.now.last_step;
        change_to_implicit(run);
    }
    Vibration found{};
    const double t = run.now.time, mean = force * t / 1;
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c) {
        const double x = run.model.mesh.corner(c / 3, c % 3).x(),
                     exact = mean + start * std::cos(std::numbers::pi * x) * std::cos(std::numbers::pi * t);
        found.error = std::max(found.error, std::abs(run.now.velocity[run.now.node_of_corner[c]].x() - exact));
    }
    const double energy = 0.25 * height * length;
    found.energy_residual = run.ledger.largest_residual() / energy;
    found.impulse_error =
        std::abs(momentum(run) - before - force * height * length * pushed) / (height * length * start);
    found.step_change_work = std::abs(run.ledger.row().step_change_work) / energy;
    return found;
}

/// A bar that is pulled apart, breaks, and is quiet again before its end at 90 s.
struct PulledBar {
    ModelInput input;
    StepLimits limits;
    SchemeOptions scheme{.bulk = BulkScheme::automatic, .damping = 1};

    explicit PulledBar(double restitution = 0)
        : input(bar({.sigma_c = 1e-3, .G_c = 1e-7, .gamma = 1, .restitution = restitution})) {
        input.loads = {load(Load::Kind::velocity, "left", -1e-5, std::nullopt),
                       load(Load::Kind::velocity, "right", 1e-5, std::nullopt)};
        const double stable = MoreauJean(make_model(ModelInput(input))).stable_step();
        limits = {.largest = 5,
                  .cracking = 100 * stable,
                  .smallest = 1e-6 * stable,
                  .end = 90,
                  .change = {.explicit_step = 0.8 * stable, .quiet_below = 1e-2, .quiet_for = 2}};
    }
};

}  // namespace

TEST_CASE("scheme change: an elastic bar keeps its energy and momentum through both schemes") {
    const Vibration alone = vibrate(Stages::explicit_alone), theta = vibrate(Stages::implicit_alone);
    for (const Stages stages : {Stages::both, Stages::both_from_implicit}) {
        const Vibration found = vibrate(stages);
        CHECK(found.energy_residual <= 1e-12);
        CHECK(found.impulse_error <= 1e-13);
        // the error of the wave is that of the schemes alone; a change that took velocities of the middle of a step for
        // those of its end would add pi h/2 = .02
        CHECK(found.error <= 2 * std::max(alone.error, theta.error));
        CHECK(found.step_change_work <= 1e-3);  // of second order in the explicit step: leapfrog against true energy
    }
    CHECK(alone.energy_residual <= 1e-12);
    CHECK(theta.energy_residual <= 1e-12);
    CHECK(std::max(alone.error, theta.error) <= 2e-3);
}

TEST_CASE("scheme change: a bar that is pulled slowly breaks in explicit steps between implicit ones") {
    constexpr double sigma_c = 1e-3, G_c = 1e-7, speed = 1e-7;  // the bar holds five times what the break takes
    ModelInput input = bar({.sigma_c = sigma_c, .G_c = G_c, .gamma = 1});
    input.loads = {load(Load::Kind::velocity, "left", -speed, std::nullopt),
                   load(Load::Kind::velocity, "right", speed, std::nullopt)};
    const double stable = MoreauJean(make_model(ModelInput(input))).stable_step();
    constexpr double end = 8000;
    const StepLimits limits{.largest = 70,
                            .cracking = 200 * stable,
                            .smallest = 1e-6 * stable,
                            .end = end,
                            .change = {.explicit_step = 0.8 * stable, .quiet_below = 1e-4, .quiet_for = 4}};
    Changing run(std::move(input), limits, {.bulk = BulkScheme::automatic, .damping = 1});
    run.run_until(end);
    // the stress is 2 speed t E/length: it reaches sigma_c at t = 5000
    const std::vector<SchemeChangeEvent>& changes = run.control.changes();
    REQUIRE(changes.size() == 2);
    CHECK(changes[0].to_explicit);
    CHECK_FALSE(changes[1].to_explicit);
    CHECK(changes[0].time <= 5000 + 0.5 * 70 / 4);  // with theta = 1/2 the law holds in the middle of a step
    CHECK(changes[0].time > 5000 - 2 * 200 * stable);
    CHECK(changes[1].time - changes[0].time >= 200 * stable + 4);
    CHECK(run.body.now.has_end_velocities());
    const EnergyRow& row = run.body.ledger.row();
    CHECK(row.dissipated == relative(G_c * height, 1e-12));
    CHECK(run.body.ledger.largest_residual() <= 1e-12 * run.body.ledger.largest_energy());
    CHECK(row.kinetic <= 1e-4 * G_c * height);
    CHECK(run.n_steps < 120 + 20 + (changes[1].time - changes[0].time) / (0.8 * stable) + 60);
}

TEST_CASE("scheme change: a bar that is pulled at once bears no more than its strength") {
    constexpr double sigma_c = 1e-3, speed = 1e-4;
    ModelInput input = bar({.sigma_c = sigma_c, .G_c = 1e-6, .gamma = 1});
    input.loads = {load(Load::Kind::velocity, "left", -speed, std::nullopt),
                   load(Load::Kind::velocity, "right", speed, std::nullopt)};
    const double stable = MoreauJean(make_model(ModelInput(input))).stable_step();
    const StepLimits limits{.largest = 200 * stable,  // the load reaches the strength in half of it
                            .cracking = 200 * stable,
                            .smallest = 1e-6 * stable,
                            .end = 400 * stable,
                            .change = {.explicit_step = 0.8 * stable, .quiet_below = 1e-2, .quiet_for = 4}};
    Changing run(std::move(input), limits, {.bulk = BulkScheme::automatic});
    double most = 0;  // [-] of the strain energy over that of the strength
    while (!StepControl::has_reached(run.body.now, limits.end)) {
        run.step();
        most = std::max(most, run.body.ledger.row().strain / (0.5 * sigma_c * sigma_c * length * height));
    }
    CHECK(most > 0.8);
    CHECK(most < 1.3);  // with the waves of the load, a tenth of the stress; an implicit step to twice of it had 4
}

TEST_CASE("scheme change: the same steps from a state in the middle of either stage") {
    const auto [input, limits, scheme] = PulledBar();
    Changing whole(ModelInput(input), limits, scheme), reference(ModelInput(input), limits, scheme);
    reference.run_until(90);
    REQUIRE(reference.control.changes().size() == 2);
    for (const double until : {30.0, 52.0, 70.0}) {  // before the break, just after it, and quiet again
        whole.run_until(until);
        CHECK(whole.body.now.has_end_velocities() == (until != 52.0));
        Changing rest(ModelInput(input), limits, scheme);  // new schemes, with nothing but state and control
        rest.body.now = whole.body.now;
        rest.control = whole.control;
        rest.run_until(90);
        CHECK(same_bits(rest.body.now, reference.body.now));
        CHECK(rest.control.changes().size() == 2);
    }
}

TEST_CASE("scheme change: the first implicit step after explicit ones reverses no rate of a contact") {
    for (const double restitution : {0.0, 1.0}) {
        PulledBar bar(restitution);
        Changing run(std::move(bar.input), bar.limits, bar.scheme);
        while (run.control.changes().size() < 2) run.step();
        REQUIRE(!run.body.now.split_fans.empty());
        CHECK(run.body.ledger.row().scheme_dissipation == 0);
        const double theta = 1 / (1 + restitution);  // the largest one without gain of energy
        const State begin = run.body.now;
        run.step();
        REQUIRE(run.body.now.n_steps == begin.n_steps + 1);
        for (std::size_t node = 0; node < begin.velocity.size(); ++node)
            CHECK((theta * run.body.now.velocity[node] + (1 - theta) * begin.velocity[node] - run.body.now.rate[node])
                      .norm() <= 1e-17);
        const double dissipated = run.body.ledger.row().scheme_dissipation;
        CHECK((dissipated > 0) == (theta > 0.5));
        CHECK(dissipated <= 1e-2 * 1e-7 * height);
        run.step();  // and all others have theta = 1/2
        CHECK(run.body.ledger.row().scheme_dissipation == dissipated);
        CHECK(run.body.ledger.largest_residual() <= 1e-12 * run.body.ledger.largest_energy());
    }
}

TEST_CASE("scheme change: what an implicit step does not resolve") {
    SchemeChange change({.explicit_step = 1, .quiet_below = 1e-4, .quiet_for = 10});
    StepReport report;
    report.strain = 1;
    State begin;
    change.after_step(begin, 1, report);
    CHECK(change.fault(report) == StepFault::none);
    report.kinetic = 0.9e-3;  // ten times quiet_below
    CHECK(change.fault(report) == StepFault::none);
    report.kinetic = 1.1e-3;
    CHECK(change.fault(report) == StepFault::motion);
    report.strain = 3, report.kinetic = 0.02;  // the load begins
    CHECK(change.fault(report) == StepFault::none);
    report.kinetic = 0.04;
    CHECK(change.fault(report) == StepFault::motion);
    report = {};
    report.strain = 1, report.dissipated = 0.01, report.cohesive_work = 0.0104;
    CHECK(change.fault(report) == StepFault::none);
    report.cohesive_work = 0.0106;
    CHECK(change.fault(report) == StepFault::cohesive_work);
    // the first damage: with theta = 1/2 the end of the step lies beyond the strength by half of what rose in it
    report = {};
    report.strain = 1.09, report.dissipated = report.cohesive_work = 0.01;
    CHECK(change.fault(report) == StepFault::none);
    report.strain = 1.11;
    CHECK(change.fault(report) == StepFault::cohesive_work);
    report = {};
    report.strain = 1, report.dissipated = 1, report.consumed_change = -0.5;  // it warms: G_c of what broke falls
    change.after_step(begin, 1, report);
    report.consumed_change = 0;
    CHECK(change.fault(report) == StepFault::none);
}

TEST_CASE("scheme change: what moves less than the weakest point needs to break is quiet") {
    const SchemeChangeOptions options{.explicit_step = 1, .quiet_below = 1e-4, .quiet_for = 10, .weakest_point = 2};
    SchemeChange change(options);
    StepReport report;  // a ramp from rest: more kinetic than strain energy, both near 0
    report.strain = 1e-6, report.kinetic = 1e-5;
    CHECK(SchemeChange({.explicit_step = 1, .quiet_below = 1e-4}).fault(report) == StepFault::motion);
    CHECK(change.fault(report) == StepFault::none);
    change.after_step({}, 1, report);
    report.kinetic = 1.9e-3;
    CHECK(change.fault(report) == StepFault::none);
    report.kinetic = 2.1e-3;
    CHECK(change.fault(report) == StepFault::motion);
    // an explicit stage of the same motion
    for (const double kinetic : {1.9e-4, 2.1e-4}) {
        SchemeChange stage(options);
        stage.to_explicit(0);
        CHECK(stage.earliest_end() == 10);
        double time = 0;
        while (!stage.is_quiet(time) && time < 100) {
            State begin;
            begin.time = time++;
            report.kinetic = kinetic * (1 - 0.5 * (static_cast<int>(time) % 2));
            report.softened = 1;  // slowly, as the load opens it
            stage.after_step(begin, 1, report);
        }
        CHECK(time == (kinetic < 2e-4 ? 10 : 100));
    }
}

TEST_CASE("scheme change: a bar with a soft joint is pulled through all of its softening by implicit steps") {
    // stable at a fixed displacement: the joint unloads by sigma_c/delta_c = 1/2 of E/length
    constexpr double sigma_c = 1e-3, G_c = 1e-6, delta_c = 2 * G_c / sigma_c, speed = 1e-7;
    ModelInput input = bar({.sigma_c = sigma_c, .G_c = G_c, .gamma = 1});
    input.loads = {load(Load::Kind::velocity, "left", -speed, std::nullopt),
                   load(Load::Kind::velocity, "right", speed, std::nullopt)};
    const double stable = MoreauJean(make_model(ModelInput(input))).stable_step();
    constexpr double end = 1.1 * delta_c / (2 * speed);
    const StepLimits limits{
        .largest = end / 400,
        .cracking = 200 * stable,
        .smallest = 1e-6 * stable,
        .end = end,
        .change = {.explicit_step = 0.8 * stable, .quiet_below = 1e-4, .quiet_for = 4, .weakest_point = G_c * height}};
    for (const bool starts_explicit : {false, true}) {
        Changing run(ModelInput(input), limits, {.bulk = BulkScheme::automatic, .damping = 1});
        if (starts_explicit) {  // in the middle of the softening
            run.run_until(0.7 * end);
            begin_leapfrog(run.body.now);
            StepControl control(limits);
            control.start_from(run.control, run.body.now);
            run.control = control;
        }
        const int before = run.n_steps;
        run.run_until(end);
        CHECK(run.body.now.has_end_velocities());
        CHECK(run.control.changes().size() == (starts_explicit ? 1 : 0));
        CHECK(run.n_steps - before < (starts_explicit ? 1000 : 420));
        CHECK(run.body.ledger.row().dissipated == relative(G_c * height, 1e-12));
        CHECK(run.body.ledger.largest_residual() <= 1e-12 * run.body.ledger.largest_energy());
        CHECK(std::abs(run.body.ledger.largest_law_lag()) <= 0.02);
    }
}

TEST_CASE("scheme change: an explicit step that misses the interface laws is repeated with half its size") {
    StepControl control({.largest = 10,
                         .cracking = 1,
                         .smallest = 1e-6,
                         .end = 100,
                         .change = {.explicit_step = 0.01, .quiet_below = 1e-4, .quiet_for = 10}});
    StepReport report;
    report.residual = 2 * max_residual;
    const auto cut = control.judge({}, 0.01, report);
    REQUIRE(cut);
    CHECK(cut->reason == CutbackReason::not_converged);
    CHECK(cut->to == 0.005);
    CHECK_FALSE(cut->changes_to_explicit);
    report.residual = 0.5 * max_residual;
    CHECK_FALSE(control.judge({}, 0.005, report));
}

TEST_CASE("scheme change: damage of the run that it starts from is no work of the first step") {
    StepReport damaged;
    damaged.strain = 1, damaged.dissipated = 0.5, damaged.recoverable = 0.1;
    SchemeChange earlier({}), next({.explicit_step = 1, .quiet_below = 1e-4, .quiet_for = 10});
    earlier.after_step({}, 1, damaged);
    CHECK(next.fault(damaged) == StepFault::cohesive_work);
    next.start_from(earlier);
    CHECK(next.fault(damaged) == StepFault::none);
}

TEST_CASE("scheme change: explicit steps go on while the pieces come to rest") {
    constexpr double quiet_for = 10;
    const auto length = [&](double decay, double strain) {  // [s] of an explicit stage; kinetic energy exp(-decay t)
        SchemeChange change({.explicit_step = 1, .quiet_below = 1e-2, .quiet_for = quiet_for});
        change.to_explicit(0);
        double time = 0;
        while (!change.is_quiet(time) && time < 1000) {
            State begin;
            begin.time = time++;
            StepReport report;
            report.strain = strain, report.dissipated = 1000;  // so that U alone allows any of these energies
            report.kinetic = std::exp(-decay * time);
            change.after_step(begin, 1, report);
        }
        return time;
    };
    CHECK(length(0, 1000) == quiet_for);                     // below a part of the strain energy at once
    CHECK(length(0, 1e-9) == 2 * quiet_for);                 // it does not fall any more: pieces that fly
    CHECK(length(0.06, 1e-9) == 2 * quiet_for);              // by less than a half
    CHECK(length(0.1, 1) == std::ceil(10 * std::log(100)));  // until it is below 1e-2 of the strain energy
}

TEST_CASE("scheme change: a motion of one speed is as good as rest and one that grows is not") {
    constexpr double quiet_for = 10, largest = 1000, strain = 1, limit = 1e-4 * strain;
    for (const double growth : {0., 0.8, 1.3}) {  // of the kinetic energy in the largest step, over the limit
        SchemeChange change({.explicit_step = 1, .largest_step = largest, .quiet_for = quiet_for});
        change.to_explicit(0);
        State begin;
        StepReport report;
        report.strain = strain;
        for (; !change.is_quiet(begin.time) && begin.time < 100; ++begin.time) {
            report.kinetic = 1 + growth * limit * begin.time / largest;
            change.after_step(begin, 1, report);
        }
        CHECK(begin.time == (growth < 1 ? 2 * quiet_for : 100));
        if (growth > 1) continue;
        // a step counts now in which the kinetic energy changes by 10 quiet_below of the strain energy, until it rests
        change.to_implicit(begin.time, report);
        report.kinetic += 9 * limit;
        CHECK(change.fault(report) == StepFault::none);
        report.kinetic += 2 * limit;
        CHECK(change.fault(report) == StepFault::motion);
        report.kinetic = 0;
        begin.rate = {Vec2::Zero()};
        change.after_step(begin, largest, report);
        report.kinetic = 11 * limit;
        CHECK(change.fault(report) == StepFault::motion);
    }
}

TEST_CASE("scheme change: short implicit stages make the explicit ones longer") {
    SchemeChange change({.explicit_step = 1, .quiet_below = 1e-4, .quiet_for = 10, .weakest_point = 1});
    StepReport quiet;
    quiet.strain = 1;
    double time = 0;
    const auto explicit_stage = [&] {  // returns its length
        change.rejected(time, 5);
        change.to_explicit(time);
        const double from = time;
        while (!change.is_quiet(time)) {
            State begin;
            begin.time = time;
            change.after_step(begin, 1, quiet);
            ++time;
        }
        change.to_implicit(time, quiet);
        return time - from;
    };
    CHECK(explicit_stage() == 15);
    double before = 10;
    for (const double waits : {20, 40, 80, 160, 160}) {
        time += before - 1;                    // of implicit steps
        CHECK(explicit_stage() == 5 + waits);  // beyond the rejected step, and quiet
        before = waits;
    }
    time += before + 1;
    CHECK(explicit_stage() == 15);
}

namespace {

/// Rock under a steady acceleration, which has grown over 0.1 s.
ModelInput resting(Bodies& bodies, const ContactLaw& contact, const Vec2& gravity) {
    ModelInput input = bodies.input(contact);
    for (Elastic& material : input.materials)
        material = {.density = 2500, .E = 1e10, .nu = 0.2, .bulk_viscosity = {0, 1.2}, .shear_viscosity = 0.1};
    input.loads = {{.kind = Load::Kind::acceleration,
                    .value = {gravity.x(), gravity.y()},
                    .history = {.time = {0, 0.1}, .value = {0, 1}}}};
    return input;
}

double fastest(const Run& run) {
    double speed = 0;
    for (const Vec2& v : run.now.velocity) speed = std::max(speed, v.norm());
    return speed;
}

StepLimits limits_of(const ModelInput& input, double largest, double end) {
    const double stable = MoreauJean(make_model(ModelInput(input))).stable_step();
    return {.largest = largest,
            .cracking = 200 * stable,
            .smallest = 1e-6 * stable,
            .end = end,
            .passage = 1e-3,
            .change = {.explicit_step = 0.8 * stable, .quiet_below = 1e-4, .quiet_for = 2e-3}};
}

}  // namespace

TEST_CASE("scheme change: T10 a turned stack at rest stays at rest through both schemes") {
    Bodies bodies;
    const double angle = 120 * std::numbers::pi / 180;
    const Vec2 e(std::cos(angle), std::sin(angle));
    for (int i = 0; i < 5; ++i) bodies.add(bar_mesh(2, 1, 0.4, 0.2), 0.2 * i * turned_left(e), angle);
    ModelInput input = resting(bodies, {.friction = 0.5}, e - 9.81 * turned_left(e));
    input.obstacles = {platen({0, 0}, turned_left(e), {.friction = 0.5})};
    Run run(std::move(input), {.bulk = BulkScheme::automatic, .theta = 1});
    begin_theta_scheme(run.now);
    for (int i = 0; i < 20; ++i) run.step(0.02);
    const State before = run.now;
    const double strain = run.ledger.row().strain;
    begin_leapfrog(run.now);
    for (int i = 0; i < 300; ++i) run.step(0.8 * run.stepper.stable_step());
    CHECK(fastest(run) < 1e-10);
    change_to_implicit(run);
    CHECK(fastest(run) < 1e-10);
    for (int i = 0; i < 20; ++i) run.step(0.02);
    CHECK(fastest(run) < 1e-10);
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        CHECK((run.now.displacement_of(c) - before.displacement_of(c)).norm() < 1e-12);
    CHECK(std::abs(run.ledger.row().strain - strain) < 1e-10 * strain);
    MESSAGE("fastest ", fastest(run), ", residual ", run.ledger.largest_residual() / run.ledger.largest_energy());
    CHECK(run.ledger.largest_residual() <= 1e-13 * run.ledger.largest_energy());
}

TEST_CASE("scheme change: a block that stands slides and stops as Coulomb says in one ledger") {
    constexpr double g = 9.81, mu = 0.3;
    Bodies bodies;
    bodies.add(bar_mesh(4, 2, 0.8, 0.4), {-0.8, 0});
    bodies.add(bar_mesh(2, 1, 0.4, 0.2), {-0.45, 0.4});
    ModelInput input = resting(bodies, {.friction = mu}, {0, -g});
    input.loads.push_back({.kind = Load::Kind::acceleration,
                           .value = {0.4 * g, 0},
                           .history = {.time = {0, 0.5, 1, 1.2}, .value = {0, 0, 1, 0}}});
    input.loads.push_back({.kind = Load::Kind::displacement, .on = {.box = Box{{-1, -1}, {1, 1e-6}}}, .value = {0, 0}});
    const StepLimits limits = limits_of(input, 0.02, 3);
    Changing run(std::move(input), limits, {.bulk = BulkScheme::automatic, .theta = 1});
    run.run_until(0.5);
    CHECK(run.control.changes().empty());
    run.run_until(3);
    const std::vector<SchemeChangeEvent>& changes = run.control.changes();
    REQUIRE(changes.size() >= 2);
    CHECK(changes.front().to_explicit);
    CHECK(std::abs(changes.front().time - 0.875) < 0.02);  // where the load exceeds friction
    CHECK(run.body.now.has_end_velocities());
    CHECK(fastest(run.body) < 1e-9);
    CHECK(run.body.ledger.largest_residual() <= 1e-12 * run.body.ledger.largest_energy());
    // a/g = 0.8 (t - 0.875) until t = 1, then 0.1 - 2 (t - 1) until it stops
    const double v = 0.4 * g * 0.125 * 0.125, t = 0.05 + std::sqrt(0.05 * 0.05 + v / g),
                 way = 0.8 * g * std::pow(0.125, 3) / 6 + v * t + g * (0.05 * t * t - t * t * t / 3);
    double mean = 0;
    for (Index triangle = 16; triangle < 20; ++triangle)
        for (Index k = 0; k < 3; ++k) mean += run.body.u(triangle, k).x() / 12;
    CHECK(mean == relative(way, 1e-3));
}

TEST_CASE("scheme change: T6 a bar creeps down with every cycle of its temperature") {
    constexpr double mu = 0.5, incline = 10 * std::numbers::pi / 180, strain = 3e-4, period = 40, E = 1e12;
    Bodies bodies;
    bodies.add(bar_mesh(3, 1, 3, 0.2), {-1, -0.2});
    Mesh bar = bar_mesh(8, 1, 1, 0.1);
    for (int i = 1; i < 8; ++i) bar.vertices[i].y() += 1e-3;  // it stands on its ends
    bodies.add(bar, {0, 0});
    ModelInput input = resting(bodies, {.friction = mu}, 9.81 * Vec2(-std::sin(incline), -std::cos(incline)));
    for (Elastic& material : input.materials) material.E = E, material.nu = 0;
    input.materials[0].E = 1e3 * E, input.materials[0].density *= 1e3;
    input.loads.push_back({.kind = Load::Kind::displacement, .on = {.box = Box{{-2, -1}, {3, -0.1}}}, .value = {0, 0}});
    auto heat = std::make_shared<Heat>();
    heat->field = {Expression("100"), {.time = {0, 20, 40, 60, 80, 100, 120}, .value = {0, 1, 0, 1, 0, 1, 0}}};
    heat->materials = {{}, {.expansion = {.coefficient = strain / 100}}};
    input.heat = heat;
    const StepLimits limits = limits_of(input, 0.4, 3 * period);
    Changing run(std::move(input), limits, {.bulk = BulkScheme::automatic, .theta = 1});
    std::array<double, 4> way{};
    for (int cycle = 1; cycle <= 3; ++cycle) {
        run.run_until(cycle * period);
        for (Index t = 6; t < run.body.model.mesh.n_triangles(); ++t)
            for (Index k = 0; k < 3; ++k) way[cycle] -= run.body.u(t, k).x() / 48;
    }
    CHECK(run.control.changes().empty());
    // what it grows by (Green's strain) moves its lower end, but for the stress that lets the upper one slide
    const double W = 2500 * 0.1 * 9.81, EA = E * 0.1,
                 creep = std::sqrt(1 + 2 * strain) - 1 - (mu * W * std::cos(incline) - W * std::sin(incline)) / EA;
    CHECK(way[3] - way[2] == relative(creep, 1e-4));
    CHECK(way[3] - way[2] == relative(way[2] - way[1], 1e-7));
    CHECK(run.body.ledger.largest_residual() <= 1e-12 * run.body.ledger.largest_energy());
}

}  // namespace scheme_change_test
