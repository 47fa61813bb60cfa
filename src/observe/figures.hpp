#pragma once
// What a scenario says about its figures.
#include "model/loads.hpp"

#include <optional>
#include <string>
#include <vector>

namespace knap {

struct FigureOptions {
    std::string file;                    // "cracks.png"; .png, .svg or .pdf; with several times the time is put into the name
    std::string show = "cracks";         // cracks, a field (displacement, velocity, stress_xx, stress_yy, stress_xy, principal_stress, speed), energy, crack_length, crack_speed
    std::vector<double> at;              // [s] empty = end
    std::string colour = "opening";      // cracks: opening or beta
    double deform = 1;                   // [-] exaggeration of the displacement
    std::optional<Box> box;              // part of the body
    std::vector<double> range;           // colour range, two values; empty = from the data
    int width = 1600;                    // [pixel]
    std::string title;
};

}  // namespace knap
