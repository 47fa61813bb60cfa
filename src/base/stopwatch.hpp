#pragma once
// Wall and processor time since construction.
#include <ctime>

namespace knap {

class Stopwatch {
public:
    double wall() const { return seconds(CLOCK_MONOTONIC) - wall_start_; }         // [s]
    double cpu() const { return seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_start_; }  // [s] of all threads

    static double seconds(clockid_t clock) {  // [s]
        timespec now{};
        clock_gettime(clock, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }

private:
    double wall_start_ = seconds(CLOCK_MONOTONIC), cpu_start_ = seconds(CLOCK_PROCESS_CPUTIME_ID);
};

}  // namespace knap
