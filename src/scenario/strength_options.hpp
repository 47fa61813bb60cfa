#pragma once
// What a scenario says of the specimen whose strength was measured (specimen_strength.hpp).
#include "analysis/specimen.hpp"

namespace knap {

/// [strength].
struct StrengthOptions {
    bool as_measured = false;
    SpecimenOptions::Test test = SpecimenOptions::Test::compression;  // or brazilian
    double size = 0;  // [m] width of the plate, twice as high, or diameter of the disc; 0: unknown
};
}  // namespace knap
