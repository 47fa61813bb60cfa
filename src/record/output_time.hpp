#pragma once
// When output is written, and the time that it takes.
#include "base/stopwatch.hpp"
#include "base/vec.hpp"

#include <cmath>

namespace knap {

/// Output times: after the start, at the multiples of an interval [s]; never, where that is 0.
class Every {
public:
    explicit Every(double interval) : interval_(interval) {}
    void start(double time) { next_ = interval_ > 0 ? time + interval_ : infinity; }
    bool is_due(double time) const { return reached(time) >= next_; }
    /// Likewise; if it is due, the next multiple is what counts from then on.
    bool advance_if_due(double time) {
        if (!is_due(time)) return false;
        next_ = interval_ * (std::floor(reached(time) / interval_) + 1);
        return true;
    }
    void serialize(auto& archive) { archive(next_); }

private:
    static double reached(double time) { return time * (1 + 1e-12); }
    double interval_, next_ = infinity;
};

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
