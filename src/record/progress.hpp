#pragma once
// One line on the progress of a run: rewritten in place on a terminal, a new line every 5 % otherwise.
#include "base/stopwatch.hpp"
#include "record/recorder.hpp"

#include <cstdio>

namespace knap {

/// "42 s left", "12 min left", "3.5 h left"
std::string left_text(double seconds);

/// Of the search for an equilibrium before the first step, whose end is not known: on a terminal one line, else a new
/// line whenever as much time has passed as before it.
class SearchProgress {
public:
    explicit SearchProgress(std::FILE* file);

    /// TellSearch (stepper/equilibrium.hpp)
    void operator()(int step, double part);

private:
    std::FILE* file_;  // null: none
    bool terminal_;
    Stopwatch watch_;
    double next_wall_ = 0;  // [s]
};

class Progress {
public:
    /// `file`: destination of the lines (null: none); `start`: first state of this process, from which step rate and
    /// remaining time are counted; `end` [s].
    Progress(std::FILE* file, const State& start, double end);

    void after_step(const State& now, const Recorder& recorder, Index n_triangles);
    void finish(const State& now, const Recorder& recorder);

    /// Prints to stderr, above the line that is rewritten; also without a progress line.
    void print(const std::string& text) const;

    std::string line(const State& now, const Recorder& recorder) const;

private:
    std::FILE* file_;
    bool terminal_;
    double start_;  // [s]
    double end_;    // [s]
    std::int64_t last_step_, triangle_steps_ = 0;
    Stopwatch watch_;
    double next_wall_ = 0;  // [s] on a terminal
    int next_part_ = 1;     // of 20, otherwise
};

}  // namespace knap
