// Steps in which free faces move too far, or lie too deep in each other, are cut; the cut ones are lawful.
#include "stepper/step_control.hpp"
#include "support/relative.hpp"
#include "support/several_bodies.hpp"

#include <doctest/doctest.h>

namespace refused_steps_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// Two squares of edges 0.5, one above the other.
ModelInput squares(double gap) {
    Bodies bodies;
    bodies.add(bar_mesh(2, 2, 1, 1), {0, -1});
    bodies.add(bar_mesh(2, 2, 1, 1), {0.2, gap});
    return bodies.input({.friction = 0.5});
}

/// All of the upper one moves.
void drop(Run& run, const Vec2& velocity) {
    for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
        if (run.model.mesh.region[c / 3] == 1) run.now.velocity[run.now.node_of_corner[c]] = velocity;
}

}  // namespace

TEST_CASE("a step in which faces that meet move by more than a twentieth of an edge is cut until they move by less") {
    const double edge = 0.5;
    for (const double path : {0.04, 0.06, 0.3}) {  // [-] of an edge, in a step
        CAPTURE(path);
        Run run(squares(0.01 * edge));
        const double h = 0.8 * run.stepper.stable_step();
        drop(run, {0, -path * edge / h});
        StepControl control({.largest = h, .cracking = h, .smallest = 1e-6 * h, .end = 100 * h});
        State end;
        double taken = 0;
        int n_cuts = 0;
        while (taken == 0) {
            REQUIRE_FALSE(control.is_stuck());
            const double step = control.next(run.now);
            const StepReport report = run.stepper.step(run.now, step, end);
            if (const auto cut = control.judge(run.now, step, report)) {
                ++n_cuts;
                CHECK(cut->reason == CutbackReason::contact_speed);
                CHECK(cut->value == relative(path * step / h, 0.01));
                REQUIRE(cut->place);
                CHECK(std::abs(cut->place->y()) < 0.02 * edge);
            } else {
                taken = step;
            }
        }
        CHECK(path * taken / h <= 0.05);
        CHECK(n_cuts == (path < 0.05 ? 0 : path < 0.1 ? 1 : 3));
    }
}

TEST_CASE("near faces that move apart fast are not refused") {
    const double edge = 0.5;
    for (const double path : {-0.08, 0.08}) {
        Run run(squares(0.01 * edge));
        State end;
        const double h = 0.8 * run.stepper.stable_step();
        drop(run, {0, path * edge / h});
        CHECK((run.stepper.step(run.now, h, end).rejection == Rejection::none) == (path > 0));
    }
}

TEST_CASE("a step that begins or ends with a face too deep in another one is no part of a run") {
    const double edge = 0.5;
    for (const double depth : {0.05, 0.15}) {
        CAPTURE(depth);
        Run run(squares(1e-4));
        const double h = 0.8 * run.stepper.stable_step();
        run.step(h);  // contacts with a history
        REQUIRE(run.last.face_contacts > 0);
        for (Index c = 0; c < run.model.mesh.n_corners(); ++c)
            if (run.model.mesh.region[c / 3] == 1)
                run.now.displacement[run.now.node_of_corner[c]].y() = -depth * edge - 1e-4;
        StepControl control({.largest = h, .cracking = h, .smallest = 1e-6 * h, .end = 100 * h});
        State end;
        const StepReport report = run.stepper.step(run.now, h, end);
        CHECK(report.contact_depth == relative(depth, 0.02));
        const auto cut = control.judge(run.now, h, report);
        REQUIRE(cut.has_value() == (depth > max_contact_depth));
        if (!cut) continue;
        CHECK(cut->reason == CutbackReason::contact_depth);
        CHECK(cut->value == report.contact_depth);
        CHECK(std::abs(cut->place->y()) < 0.2 * edge);
        CHECK(cut->to == 0.5 * h);
    }
}

}  // namespace refused_steps_test
