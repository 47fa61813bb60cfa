#pragma once
// report.html of a run: its question, warnings, frames, figures, what was computed, its numbers, and how to repeat it.
#include "app/run/run_directory.hpp"
#include "model/model.hpp"
#include "record/recorder.hpp"
#include "scenario/scenario.hpp"

namespace knap {

/// Writes it into the directory of the run, once its other files are there. Its pictures of frames are fewer where they
/// would take more than a few percent of the processor time of the run.
void write_report(const Scenario& scenario, const RunRecord& record, const Recorder& recorder,
                  const std::filesystem::path& directory);

/// A word of a shell command, in quotes where it needs them.
std::string quoted_for_shell(const std::string& word);
/// "knap run 'my plate.toml' -j 2"
std::string command_line(const std::vector<std::string>& words);

}  // namespace knap
