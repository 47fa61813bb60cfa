// A point that loses cohesion within a step counts as softened with either bulk, and that is what a step size reacts
// to.
#include "stepper/common/point_work.hpp"
#include "stepper/step_control.hpp"
#include "support/bodies.hpp"
#include "support/paths.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace softening_counts_test {

using namespace knap;
using namespace knap::tests;

namespace {

const CohesiveLaw glue{.sigma_c = 0.5, .G_c = 0.25};  // delta_c = 1

/// Two points of area 1 on a support: opened half way, closed, opened until they break at t = 4, and further.
ModelInput cycled() {
    ModelInput input = point_masses(glue, true);
    input.loads = {load(Load::Kind::displacement, "base", 0.0, 1.0, {{0, 1, 2, 3, 5}, {0, 0.5, 0, 0.5, 1.5}})};
    return input;
}

/// A square under a sudden pull that it cannot bear: cracks, and behind them pieces that rest.
ModelInput torn() {
    ModelInput input = body_with(bar_mesh(6, 6, 6, 6), {.density = 1, .E = 100, .nu = 0.2},
                                 {.sigma_c = 1, .G_c = 0.05, .friction = 0.3});
    input.scatter = {{.kind = Scatter::Kind::uniform, .deviation = 0.1}};
    input.seed = 1;
    input.loads = {load(Load::Kind::velocity, "top", std::nullopt, 0.1),
                   load(Load::Kind::velocity, "bottom", std::nullopt, -0.1)};
    return input;
}

std::int64_t lost_cohesion(const Model& model, const State& begin, const State& end) {
    std::int64_t n = 0;
    for (Index p = 0; p < model.n_points(); ++p)
        n += cohesion(model, begin, p) - cohesion(model, end, p) > relative_tolerance;
    return n;
}

}  // namespace

TEST_CASE("softening: each bulk counts the same points in the same steps") {
    constexpr double h = 1.0 / 64;
    std::vector<std::int64_t> expected;  // while it opens further than ever before, until it is broken
    for (int i = 0; i < 5 * 64; ++i) expected.push_back(i < 64 || (i >= 3 * 64 && i < 4 * 64) ? 2 : 0);
    for (const SchemeOptions& path : all_paths()) {
        Run run(cycled(), path);
        std::vector<std::int64_t> found;
        for (int i = 0; i < 5 * 64; ++i) found.push_back(run.step(h).softened);
        CHECK_MESSAGE(found == expected, name_of(path));
    }
}

TEST_CASE("softening: the count is that of the points which lost cohesion on every path through the stepper") {
    const double stable = Run(torn()).stepper.stable_step();  // of the explicit bulk
    for (const SchemeOptions& path : both_paths()) {
        Run run(torn(), path);
        double h = 0.5 * stable;
        std::int64_t all = 0;
        while (run.now.time < 1.5) {
            const State begin = run.now;
            if (!run.step_if_taken(h)) {  // torn pieces that rub may need a smaller one
                h *= 0.5;
                REQUIRE(h > 1e-3 * stable);
                continue;
            }
            CHECK(run.last.softened == lost_cohesion(run.model, begin, run.now));
            all += run.last.softened;
        }
        CHECK_MESSAGE(all > 100, name_of(path));
    }
}

TEST_CASE("softening: the step falls to the cracking step at the first of it with either bulk") {
    for (const SchemeOptions& path : both_paths()) {
        Run run(cycled(), path);  // on its support no fan splits: only the softening tells
        StepControl control({.largest = 0.05, .cracking = 0.01, .smallest = 1e-6, .end = 0.5});
        State next;
        std::vector<Cutback> cuts;
        while (!StepControl::has_reached(run.now, 0.5)) {
            const double h = control.next(run.now);
            const StepReport report = run.stepper.step(run.now, h, next);
            CHECK(report.released == 0);
            if (const auto cut = control.judge(run.now, h, report)) {
                cuts.push_back(*cut);
                REQUIRE(cuts.size() < 10);
                continue;
            }
            CHECK((h <= 0.01 * (1 + 1e-9) || report.softened == 0));
            std::swap(run.now, next);
        }
        REQUIRE_MESSAGE(cuts.size() == 1, name_of(path));
        CHECK(cuts[0].reason == CutbackReason::softening);
        CHECK(cuts[0].time == 0);
        CHECK(cohesion(run.model, run.now, 0) == relative(0.5 + 0.25, 1e-9));
    }
}

TEST_CASE("recoverable energy is told from dissipated energy") {
    for (const SchemeOptions& path : all_paths()) {
        Run run(cycled(), path);
        constexpr int n = 256;
        const auto go_on = [&] {
            for (int i = 0; i < n; ++i) run.step(1.0 / n);
            return run.ledger.row();
        };
        // beta = 1/2 from t = 1 to 3: two points of G_c/4, and beta sigma_c u_N of each
        const EnergyRow opened = go_on(), closed = go_on(), reopened = go_on(), broken = go_on();
        CAPTURE(name_of(path));
        for (const EnergyRow& row : {opened, closed, reopened})
            CHECK(row.dissipated == relative(2 * glue.G_c / 4, 1e-12));
        for (const EnergyRow& row : {opened, reopened}) CHECK(row.recoverable == relative(2 * 0.5 * 0.5 * 0.5, 1e-12));
        CHECK(std::abs(closed.recoverable) <= 1e-12);
        CHECK(broken.dissipated == relative(2 * glue.G_c, 1e-12));
        CHECK(broken.recoverable == 0);
    }
}

}  // namespace softening_counts_test
