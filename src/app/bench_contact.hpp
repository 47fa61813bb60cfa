#pragma once
// What contact between free faces costs a step: rubble in motion and at rest, dust.
#include <string>
#include <vector>

namespace knap {

struct Measurement {
    std::string name;
    double value;
};

/// On one thread; takes some ten seconds.
std::vector<Measurement> measure_contact();

}  // namespace knap
