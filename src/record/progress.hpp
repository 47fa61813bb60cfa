#pragma once
// One line that says how a run goes: rewritten in place on a terminal, a plain line every 5 % otherwise.
#include "record/recorder.hpp"

#include "base/stopwatch.hpp"

#include <cstdio>

namespace knap {

class Progress {
public:
    /// `file`: where the lines go (null: nowhere); `start`: where this process begins, from which rate and time left are counted; `end` [s].
    Progress(std::FILE* file, const State& start, double end, Index n_triangles);

    void after_step(const State& now, const Recorder& recorder);
    void finish(const State& now, const Recorder& recorder);

    /// To stderr, above the line that is rewritten; also where no progress is wanted.
    void say(const std::string& text) const;

private:
    std::string line(const State& now, const Recorder& recorder) const;

    std::FILE* file_;
    bool terminal_;
    double start_;  // [s]
    std::int64_t first_step_;
    double end_;  // [s]
    Index n_triangles_;
    Stopwatch watch_;
    double next_wall_ = 0;  // [s] on a terminal
    int next_part_ = 1;     // of 20, otherwise
};

}  // namespace knap
