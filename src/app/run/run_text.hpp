#pragma once
// What a run says to people: in log.txt, on the screen at its end, and as the reason of a failure.
#include "app/run/dump_lcp.hpp"
#include "app/run/run_json.hpp"
#include "stepper/step_control.hpp"

#include <filesystem>
#include <string>

namespace knap {

/// A line of the log.
std::string cutback_text(const Cutback& cut, const Vec2& where);

/// Why a run cannot go on after a step that asks for a smaller one than allowed: what, where, when, and what to change.
std::string stuck_text(const Cutback& cut, const Vec2& where, double smallest);

/// That a run goes on from a checkpoint.
std::string resumed_text(const State& now);

/// That files which a run wrote are gone; empty where none is.
std::string missing_text(const std::vector<std::string>& files);

/// That steps whose problems were asked for are not among those that a command took, all after `before`; empty where none is.
std::string not_dumped_text(const StepSelection& asked, std::int64_t before, std::int64_t now);

/// That a gate warns, as a line of the log: what, where, when, and what to change.
std::string warning_text(const Gate& gate, const State& now);

/// Why a run was stopped by gates, all that are violated, and where to look.
std::string violated_text(const Gates& gates, const State& now, const Vec2& fastest);

/// What a run found.
std::string end_of_run(const RunRecord& record, const std::filesystem::path& directory);

}  // namespace knap
