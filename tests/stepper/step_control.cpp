// The step-size policy against scripted reports: no stepper, no body.
#include "stepper/step_control.hpp"
#include "model/make_model.hpp"
#include "support/bodies.hpp"
#include "support/relative.hpp"

#include <doctest/doctest.h>

#include <tuple>
#include <utility>
#include <vector>

namespace step_control_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// The report of a step of size h that starts at `time`.
using Script = std::function<StepReport(double time, double h)>;

StepReport good(double, double) { return {}; }
StepReport rejected(Rejection why) {
    StepReport report;
    report.rejection = why;
    return report;
}
StepReport softens() {
    StepReport report;
    report.softened = 1;
    return report;
}

struct Trace {
    std::vector<double> steps;  // [s] that counted
    std::vector<Cutback> cuts;
    double end;
    bool stuck;
};

/// Runs until `until`, or until stuck.
Trace run(const StepLimits& limits, const Script& script, double until) {
    StepControl control(limits);
    State now;
    Trace trace{};
    while (!StepControl::has_reached(now, until) && !control.is_stuck()) {
        REQUIRE(trace.steps.size() + trace.cuts.size() < 200000);
        const double h = control.next(now);
        if (const auto cut = control.judge(now, h, script(now.time, h))) {
            trace.cuts.push_back(*cut);
        } else {
            trace.steps.push_back(h);
            now.time += h;
            now.last_step = h;
            ++now.n_steps;
        }
    }
    trace.end = now.time;
    trace.stuck = control.is_stuck();
    if (!trace.steps.empty()) {
        CHECK(control.smallest_taken() == *std::min_element(trace.steps.begin(), trace.steps.end()));
        CHECK(control.largest_taken() == *std::max_element(trace.steps.begin(), trace.steps.end()));
    }
    std::int64_t n = 0;
    for (const std::int64_t of_reason : control.n_cutbacks()) n += of_reason;
    CHECK(n == static_cast<std::int64_t>(trace.cuts.size()));
    return trace;
}

Trace run(const StepLimits& limits, const Script& script) { return run(limits, script, limits.end); }

StepLimits constant(double step, double end) {
    return {.largest = step, .cracking = step, .smallest = 1e-6 * step, .end = end};
}

}  // namespace

TEST_CASE("step control: a constant step keeps its bits and its count") {
    for (const int n : {1, 2, 3, 7, 400, 100003}) {
        const double end = 0.6e-3, step = end / n;
        const Trace trace = run(constant(step, end), [](double, double) { return softens(); });
        CAPTURE(n);
        CHECK(trace.steps.size() == static_cast<std::size_t>(n));
        for (const double h : trace.steps) REQUIRE(h == step);
        CHECK(trace.end == relative(end, 1e-12));
        CHECK(trace.cuts.empty());
    }
}

TEST_CASE("step control: steps land on the end and none is a sliver") {
    for (const double end : {10.0, 10.001, 10.3, 10.5, 10.999, 0.2, 1.0001}) {
        CAPTURE(end);
        const Trace trace = run(constant(1, end), good);
        CHECK(trace.end == relative(end, 1e-14));
        for (const double h : trace.steps) CHECK(h >= std::min(0.5, end) * (1 - 1e-12));
        for (const double h : trace.steps) CHECK(h <= 1);
    }
}

TEST_CASE("step control: the first loss of cohesion brings the cracking step for good") {
    const StepLimits limits{.largest = 1.5, .cracking = 0.25, .smallest = 1e-3, .end = 60};
    const Trace trace =
        run(limits, [](double time, double h) { return time + h > 20 && time < 25 ? softens() : StepReport{}; });
    REQUIRE(trace.cuts.size() == 1);
    CHECK(trace.cuts[0].reason == CutbackReason::softening);
    CHECK(trace.cuts[0].time == 19.5);
    CHECK(trace.cuts[0].from == 1.5);
    CHECK(trace.cuts[0].to == 0.25);
    for (std::size_t i = 0; i < trace.steps.size(); ++i) REQUIRE(trace.steps[i] == (i < 13 ? 1.5 : 0.25));
    CHECK(trace.end == 60);

    const Trace release = run(limits, [](double, double) {
        StepReport report;
        report.released = 1;
        return report;
    });
    REQUIRE(release.cuts.size() == 1);
    CHECK(release.cuts[0].reason == CutbackReason::release);
    CHECK(release.steps[0] == 0.25);
}

TEST_CASE("step control: a rejected step is halved and grows again after ten good ones") {
    // rejected at any size above 0.3 between times 5 and 6
    const Trace trace = run(constant(1, 40), [](double time, double h) {
        return time >= 5 && time < 6 && h > 0.3 ? rejected(Rejection::not_converged) : StepReport{};
    });
    REQUIRE(trace.cuts.size() >= 2);
    CHECK(trace.cuts[0].to == 0.5);
    CHECK(trace.cuts[1].from == 0.5);
    CHECK(trace.cuts[1].to == 0.25);
    for (const Cutback& cut : trace.cuts) CHECK(cut.reason == CutbackReason::not_converged);
    CHECK(trace.cuts.size() == 2);
    for (std::size_t i = 0; i < 5; ++i) CHECK(trace.steps[i] == 1);
    double expected = 0.25;
    for (std::size_t block = 0; block < 4; ++block) {
        for (std::size_t i = 0; i < 10; ++i) CHECK(trace.steps[5 + 10 * block + i] == expected);
        expected = std::min(1.0, 1.5 * expected);
    }
    CHECK(expected == 1);
}

TEST_CASE("step control: Assumption 1 takes the cracking step first and halves from there") {
    const StepLimits limits{.largest = 8, .cracking = 1, .smallest = 1e-3, .end = 100};
    const Trace trace = run(limits, [](double time, double h) {
        return time < 4 && h > 0.6 ? rejected(Rejection::assumption_1) : StepReport{};
    });
    REQUIRE(trace.cuts.size() >= 2);
    CHECK(trace.cuts[0].to == 1);
    CHECK(trace.cuts[1].to == 0.5);
    CHECK(*std::max_element(trace.steps.begin(), trace.steps.end()) == 1);  // cracking has begun: never larger again

    // what does not come from cracking does not end the large steps
    const Trace contact = run(limits, [](double time, double h) {
        return time < 4 && h > 0.6 ? rejected(Rejection::not_converged) : StepReport{};
    });
    CHECK(*std::max_element(contact.steps.begin(), contact.steps.end()) > 3);
}

TEST_CASE("step control: an implicit size that was not solved is tried again after 8 steps and then after 16") {
    const StepLimits limits{
        .largest = 1, .cracking = 1e-3, .smallest = 1e-9, .end = 1e6, .change = {.explicit_step = 1e-4}};
    StepControl control(limits);
    State now;
    now.rate.assign(1, Vec2::Zero());  // velocities of this moment: implicit steps
    std::vector<int> between;          // steps from one trial of the largest size to the next one
    bool solved = false;
    for (int n = 0, trials = 0; trials < 9;) {
        const double h = control.next(now);
        if (h == 1) {
            between.push_back(std::exchange(n, 0));
            solved = ++trials == 5;
        }
        if (control.judge(now, h, h < 1 || solved ? good(now.time, h) : rejected(Rejection::not_converged))) continue;
        now.time += h;
        now.last_step = h;
        ++now.n_steps, ++n;
        CHECK(h >= 0.25);
    }
    // the fifth trial is solved, so the next one follows at once, is not, and patience begins anew
    CHECK(between == std::vector<int>{0, 8, 16, 32, 64, 1, 8, 16, 32});
}

TEST_CASE("step control: below the smallest step it is stuck") {
    const Trace trace = run(constant(1, 10), [](double time, double) {
        return time < 3 ? StepReport{} : rejected(Rejection::assumption_1);
    });
    CHECK(trace.stuck);
    CHECK(trace.end == 3);
    CHECK(trace.cuts.size() == 20);  // 2^-20 < 1e-6 < 2^-19
    CHECK(trace.cuts.back().from >= 1e-6);
    CHECK(trace.cuts.back().to < 1e-6);
    const Trace jammed =
        run(constant(1, 10), [](double time, double) { return time < 3 ? StepReport{} : rejected(Rejection::jammed); });
    CHECK(jammed.stuck);
    CHECK(jammed.cuts.size() == 20);
    CHECK(jammed.cuts.back().reason == CutbackReason::jammed);
}

TEST_CASE("step control: faces that lie too deep or break their laws cut steps and end the run after ten halvings") {
    const auto deep = [](double depth) {
        return [=](double time, double h) {
            StepReport report;
            report.softened = 1;
            if (time >= 3) report.add_depth(depth * h, {1, 2});
            return report;
        };
    };
    const Trace helped = run(constant(1, 10), deep(1));  // h = 1 / 16 is 1 / 16 deep
    CHECK_FALSE(helped.stuck);
    REQUIRE(helped.cuts.size() > 3);
    CHECK(helped.cuts[0].reason == CutbackReason::contact_depth);
    CHECK(helped.cuts[0].time == 3);
    CHECK(helped.cuts[0].place == Vec2(1, 2));
    CHECK(helped.cuts[0].value == 1);
    CHECK(helped.steps[3] == 1. / 16);

    const auto always = [](const auto& set) {
        return [=](double time, double) {
            StepReport report;
            if (time >= 3) set(report);
            return report;
        };
    };
    const Script too_deep = always([](StepReport&report) {
        report.add_depth(2 * max_contact_depth, {1, 2});
    }),
                 unlawful = always([](StepReport&report) {
                     report.add_contact_residual(2 * max_contact_residual, {3, 4});
                 }),
                 unsolved = always([](StepReport&report) {
                     report.reject(Rejection::contact_residual, {3, 4}, 0.5);
                 }),
                 too_fast = always([](StepReport&report) {
                     report.reject(Rejection::contact_speed, {5, 6}, 0.07);
                 });
    using Expected = std::tuple<Script, CutbackReason, Vec2, double>;
    for (const auto& [script, reason, place, value] :
         {Expected{too_deep, CutbackReason::contact_depth, {1, 2}, 2 * max_contact_depth},
          Expected{unlawful, CutbackReason::contact_residual, {3, 4}, 2 * max_contact_residual},
          Expected{unsolved, CutbackReason::contact_residual, {3, 4}, 0.5},
          Expected{too_fast, CutbackReason::contact_speed, {5, 6}, 0.07}}) {
        const Trace trace = run(constant(1, 10), script);
        CAPTURE(name_of(reason));
        CHECK(trace.stuck);
        CHECK(trace.end == 3);
        CHECK(trace.cuts.size() == 11);
        CHECK(trace.cuts.back().from == 1. / 1024);
        CHECK(trace.cuts.back().reason == reason);
        CHECK(trace.cuts.back().place == place);
        CHECK(trace.cuts.back().value == value);
    }
    StepLimits allowed = constant(1, 10);  // [limits] contact_depth = "none"
    allowed.contact_depth = infinity;
    CHECK(run(allowed, too_deep).cuts.empty());
    // what is at its limit counts
    CHECK(run(constant(1, 10), always([](StepReport& report) {
                  report.add_depth(max_contact_depth, {1, 2});
                  report.add_contact_residual(max_contact_residual, {3, 4});
              }))
              .cuts.empty());
}

TEST_CASE("step control: a run that is stopped early is the start of the longer one") {
    const StepLimits limits{.largest = 1.1, .cracking = 0.3, .smallest = 1e-6, .end = 30};
    const Script script = [](double time, double h) {
        if (time > 12 && h > 0.2 && std::fmod(time, 3) < 1) return rejected(Rejection::not_converged);
        return time + h > 8 ? softens() : StepReport{};
    };
    const Trace whole = run(limits, script);
    for (const double until : {0.1, 1.1, 8.0, 12.5, 29.9}) {
        const Trace part = run(limits, script, until);
        CAPTURE(until);
        CHECK(part.end >= until * (1 - 1e-12));
        CHECK(part.end < until + 1.1);
        REQUIRE(part.steps.size() <= whole.steps.size());
        CHECK(std::equal(part.steps.begin(), part.steps.end(), whole.steps.begin()));
    }
}

TEST_CASE("step control: the place of damage is the vertex that lost most cohesion") {
    const Model model = make_model(point_masses({.sigma_c = 1, .G_c = 0.5, .gamma = 0}, true));
    const State begin = initial_state(model);
    State end = begin;
    for (std::size_t rank = 0; rank < end.split_fans.size(); ++rank)
        if (model.fans[end.split_fans[rank]].vertex == 1) end.points[end.first_point[rank]].cohesion = 0.5;
    CHECK(place_of_damage(model, begin, end) == model.mesh.vertices[1]);
}

TEST_CASE("step control: a hard impact is met in a step that covers one critical opening") {
    // at 5 a contact closes with V; until 8 a point opens with 2 V, then with a hundredth of it
    const double V = 12;
    const auto meet = [&](double time, double h) {
        StepReport report;
        if (time <= 5 && time + h > 5) report.approach = V;
        if (time < 5) return report;
        report.softened = 1;
        report.largest_opened = (time < 8 ? 2 : 0.01) * V * h;
        return report;
    };
    StepLimits limits{.largest = 1, .cracking = 1, .smallest = 1e-6, .end = 40, .critical_opening = 1, .passage = 2};
    const Trace trace = run(limits, meet);
    REQUIRE(trace.cuts.size() == 2);
    for (const Cutback& cut : trace.cuts) CHECK(cut.reason == CutbackReason::impact);
    CHECK(trace.cuts[0].time <= 5);  // before anything is stressed
    CHECK(trace.cuts[0].value == relative(V, 1e-12));
    CHECK(trace.cuts[0].to == relative(1 / V, 1e-12));
    CHECK(trace.cuts[1].to == relative(0.4 / (2 * V), 1e-12));
    double time = 0;
    for (const double h : trace.steps) {
        if (time > 5.1 && time < 8) CHECK(h == relative(0.2 / V, 1e-12));
        time += h;
    }
    CHECK(trace.steps[trace.steps.size() - 3] == 1);  // they grow again
    limits.critical_opening = 5;                      // the approach covers less than three of them
    CHECK(run(limits, meet).cuts.empty());
}

}  // namespace step_control_test
