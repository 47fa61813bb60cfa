#pragma once
// report.html of a run: its question, warnings, frames, figures, what was computed, its numbers, and how to repeat it.
#include "app/run/run_directory.hpp"
#include "base/stopwatch.hpp"
#include "model/model.hpp"
#include "record/recorder.hpp"
#include "scenario/scenario.hpp"

namespace knap {

/// Writes it into the directory of the run, once its other files are there. Its pictures of frames are fewer where they
/// would take more than a few percent of the processor time of the run.
void write_report(const Scenario& scenario, const RunRecord& record, const Recorder& recorder,
                  const std::filesystem::path& directory);

/// report.html until the first step: it takes the place of an earlier one, for who looks at that.
std::string starting_page(const Scenario& scenario, const std::string& toml, const RunRecord& record,
                          const std::string& state);

/// report.html while the run goes on, which loads itself again: progress, the present state and the energies so far.
class LiveReport {
public:
    LiveReport(const Scenario& scenario, std::filesystem::path directory)
        : scenario_(scenario), directory_(std::move(directory)) {}

    bool is_due() const { return clock_.wall() >= next_; }
    /// `state`: a line about the progress; `part` of the simulated time that is over. The picture is an earlier one
    /// where a new one would take more than a small share of the processor time.
    void write(const std::string& state, double part, const Model& model, const State& now, const RunRecord& record,
               const Recorder& recorder);

    static constexpr double shortest_period = 3;  // [s] wall time; a shorter run has none

private:
    void draw(const Model& model, const State& now, const Recorder& recorder);

    static constexpr double share_of_live = 0.02;  // of the time of the run, at most, for pictures
    const Scenario& scenario_;
    std::filesystem::path directory_;
    Stopwatch clock_;
    std::string picture_;
    double next_ = shortest_period, next_picture_ = 0;  // [s] wall time
};

/// A word of a shell command, in quotes where it needs them.
std::string quoted_for_shell(const std::string& word);
/// "knap run 'my plate.toml' -j 2"
std::string command_line(const std::vector<std::string>& words);

}  // namespace knap
