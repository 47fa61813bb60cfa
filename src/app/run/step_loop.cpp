#include "app/run/step_loop.hpp"

#include "app/run/interrupt.hpp"
#include "app/run/run_text.hpp"
#include "base/error.hpp"

namespace knap {
namespace {

/// One try of a step: `now` moves on, or stays where the step is cut. Throws SimulationError where the run cannot go on.
void try_step(const Stepping& run, State& now, State& next) {
    const double h = run.control.next(now);
    const StepReport report = run.stepper.step(now, h, next);
    if (const std::optional<Cutback> cut = run.control.judge(now, h, report)) {
        const Vec2 where = report.rejection == Rejection::none ? place_of_damage(run.model, now, next) : report.where;
        run.log.add(cutback_text(*cut, where));
        if (run.control.is_stuck()) throw SimulationError(stuck_text(*cut, where, run.smallest_step));
        return;
    }
    if (run.options.dump_lcp.contains(next.n_steps)) run.log.add(dump_lcp(run.model, now, h, run.scenario.time.scheme, run.directory / "lcp"));
    std::swap(now, next);
    run.recorder.after_step(now, report);
    run.progress.after_step(now, run.recorder);
    say_new_warnings(run, now);
    const GateKeeper& gates = run.recorder.gates();
    if (!gates.pass()) throw SimulationError(violated_text(gates.gates(), now, place_of_largest_speed(run.model, now)));
}

}  // namespace

void say_new_warnings(const Stepping& run, const State& now) {
    GateKeeper& gates = run.recorder.gates();
    for (const Gate* gate : gates.new_warnings()) {
        const std::string text = warning_text(*gate, now);
        run.progress.say(text);
        run.log.add(text);
        gates.warned(*gate, text);
    }
}

namespace {

/// Before the first step that depends on the end: from there the finished run can be taken to a later one. Not worth a run that is good.
void save_for_later_end(const Stepping& run, const std::function<void()>& save) {
    try {
        save();
    } catch (const OutputError& error) {
        run.log.add(std::string("warning[checkpoint]: no checkpoint of the end, this run cannot be extended: ") + error.what() + "\n");
    }
}

}  // namespace

void step_to_end(const Stepping& run, double until, const Checkpoints& checkpoints, const std::function<void()>& save, State& now, RunRecord& record) {
    State next = now;
    bool at_end = false;  // what comes is no part of a longer run, and is not saved
    try {
        while (record.status == "running" && !StepControl::has_reached(now, until)) {
            if (InterruptGuard::interrupted()) {
                record.status = "interrupted";
                break;
            }
            if (!at_end && run.control.depends_on_end(now)) at_end = true, save_for_later_end(run, save);
            const long before = now.n_steps;
            try {
                try_step(run, now, next);
            } catch (const StepGivenUp&) {
                continue;  // interrupted
            }
            if (!at_end && now.n_steps > before && checkpoints.due()) save();
        }
        if (!StepControl::has_reached(now, run.scenario.time.end) && record.status != "failed" && !at_end) save();  // before the lines of an early end are written
    } catch (const OutputError&) {
        throw;
    } catch (const SimulationError& error) {
        record.status = "failed";
        record.reason = error.what();
    }
    if (record.status == "running") record.status = "done";
}

}  // namespace knap
