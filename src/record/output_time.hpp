#pragma once
// When output is written, and the time that it takes.
#include "base/every.hpp"
#include "base/stopwatch.hpp"

namespace knap {

/// Time spent on output.
struct OutputTime {
    double cpu = 0;                // [s] processor time of all output
    double frames = 0;             // [s] its part for frames
    double figures = 0;            // [s] its part for figures
    double waited_for_frames = 0;  // [s] wall time for which steps waited for the frame writer

    void serialize(auto& archive) { archive(cpu, frames, figures, waited_for_frames); }
};

/// Adds the processor time of its block to that of the output and to one part of it. Only the time of the calling
/// thread counts: that of the process includes the frame writer and the other threads of the steps.
class Timed {
public:
    explicit Timed(OutputTime& time, double OutputTime::*part = nullptr) : time_(time), part_(part) {}
    ~Timed() {
        const double seconds = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID) - start_;
        time_.cpu += seconds;
        if (part_ != nullptr) time_.*part_ += seconds;
    }
    Timed(const Timed&) = delete;
    Timed& operator=(const Timed&) = delete;

private:
    OutputTime& time_;
    double OutputTime::*part_;
    double start_ = Stopwatch::seconds(CLOCK_THREAD_CPUTIME_ID);
};

}  // namespace knap
