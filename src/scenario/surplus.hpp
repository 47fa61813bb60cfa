#pragma once
// Tables that `knap calibrate` writes: what a mesh adds to a property of its interfaces, over the properties of law and
// mesh. Of the fracture energy: toughness.hpp; of the strength: specimen_strength.hpp.
#include "base/error.hpp"

#include <optional>
#include <string>
#include <vector>

namespace knap {

/// What a random mesh adds to a property: the property of the body over that of its interfaces.
struct Surplus {
    double mean = 1, deviation = 0;
};

/// Least part of several runs that has to show what they are made for.
constexpr double least_part_through = 0.8;

/// One kind of table.
struct CalibrationFormat {
    const char* name;     // "toughness"
    const char* columns;  // its header
    std::size_t n_words;  // columns of words come first, then numbers that are not negative
};

struct CalibrationLine {
    std::vector<std::string> words;
    std::vector<double> numbers;
    int number = 0;  // in the file
};

UserError bad_calibration(const CalibrationFormat& format, const CalibrationLine& line, const std::string& what);
/// The lines behind the header. Throws UserError for a text that is no such table.
std::vector<CalibrationLine> calibration_lines(const CalibrationFormat& format, const std::string& csv);

/// A surplus at a point, with a coordinate per axis.
struct SurplusPoint {
    std::vector<double> at;
    Surplus surplus;
};

/// Linear along one axis after the other; up to `beyond` outside of the points of an axis the value of the last one,
/// none farther out.
std::optional<Surplus> interpolated(const std::vector<SurplusPoint>& points, const std::vector<double>& at,
                                    const std::vector<double>& beyond);

}  // namespace knap
