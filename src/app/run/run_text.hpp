#pragma once
// Texts of a run for people: in log.txt, on the screen at its end, and as the reason of a failure.
#include "app/run/dump_lcp.hpp"
#include "record/run_record.hpp"
#include "scenario/scenario.hpp"
#include "stepper/step_control.hpp"

#include <filesystem>
#include <string>

namespace knap {

/// A cutback, as a line of the log; a change to explicit steps with the numbers of them that lie ahead. `end` [s].
std::string cutback_text(const Cutback& cut, const Vec2& where, double end);

/// The change to implicit steps, likewise.
std::string quiet_text(double time);
std::string rigid_text(double time, std::size_t n_pieces);

/// Why a run cannot continue with any step allowed, where, when, and what to change. `smallest` [s].
std::string stuck_text(const Cutback& cut, const Vec2& where, double smallest);

/// What probes watch, a line each, as knap check and the log say it.
std::string probes_text(const std::vector<ProbeSubject>& subjects);
std::string probes_text(const Model& model, const std::vector<ProbeOptions>& probes);

/// Warning about files of this run that no longer exist; empty where all exist.
std::string missing_text(const std::vector<std::string>& files);

/// Warning about steps that --dump-lcp selected but this command, from step `before` to `now`, did not take; or empty.
std::string not_dumped_text(const StepSelection& selected, std::int64_t before, std::int64_t now);

/// Warning of a gate, as a line of the log: value, place, time, and what to change.
std::string warning_text(const Gate& gate, const State& now);

/// Which gates stopped a run, and what to change. `fastest` [m]: where the body moves fastest.
std::string violated_text(const Gates& gates, const State& now, const Vec2& fastest);

/// Warning: the simulated time, to `end` [s], was over before the body came to rest.
std::string not_at_rest_text(double end);

/// Warning: a specimen whose interfaces can break has not failed: its largest stress is no strength; else empty.
std::string not_failed_text(const Scenario& scenario, const Summary& summary, Index n_breaks);
/// For the log, once: damping leaves the motion of pieces and obstacles alone that nothing holds since `time` [s];
/// empty where there are none.
std::string damping_text(const SchemeOptions& scheme, const Model& model, const State& now, double time);

/// The methods of bulk and cohesion.
std::string scheme_text(const TimeOptions& time, bool is_viscous);

/// The results of a run.
std::string end_of_run(const RunRecord& record, const std::filesystem::path& directory);

}  // namespace knap
