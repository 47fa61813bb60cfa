#pragma once
// Wall and processor time since construction.
#include <chrono>
#include <ctime>

namespace knap {

class Stopwatch {
public:
    double wall() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start_).count(); }  // [s]
    double cpu() const { return seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu_start_; }                                          // [s] all threads

    /// [s]
    static double seconds(clockid_t clock) {
        timespec now{};
        clock_gettime(clock, &now);
        return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
    }

private:
    std::chrono::steady_clock::time_point wall_start_ = std::chrono::steady_clock::now();
    double cpu_start_ = seconds(CLOCK_PROCESS_CPUTIME_ID);
};

}  // namespace knap
