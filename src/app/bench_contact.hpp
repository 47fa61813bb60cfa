#pragma once
// What contact between free faces costs a step: rubble in motion and at rest, dust.
#include "base/stopwatch.hpp"

#include <string>
#include <vector>

namespace knap {

struct Measurement {
    std::string name;
    double value;
};

/// [s] Of work on one thread: processor time, or the wall's where the clock of the processor ticks too coarsely for a
/// kernel (10 ms on some virtual machines, where short work would take no time at all).
double one_thread_time(const Stopwatch& watch);

/// On one thread; takes some ten seconds.
std::vector<Measurement> measure_contact();

}  // namespace knap
