#pragma once
// Name, unit and meaning of the numbers that a run writes. record/outputs.hpp lists all of them.
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

/// A column of a table, an array of a frame, or an entry of run.json.
struct Output {
    std::string_view name;  // "*_force_x", "_force_x": a name from the scenario comes first
    std::string_view unit;  // SI units, and deg; "" for a pure number, a count or a text
    std::string_view doc;   // meaning
};

/// The unit of a number whose output has `unit`: temperatures are in K, or in C where the scenario counts in degrees
/// Celsius.
inline std::string_view unit_of_temperature(std::string_view unit, bool celsius) {
    return unit == "K" && celsius ? "C" : unit;
}

/// An output and the function that computes it.
template <class Source>
struct Measure : Output {
    double (*of)(const Source&);
};

template <class Source>
std::vector<std::string> names_of(std::span<const Measure<Source>> measures, const std::string& prefix = "") {
    std::vector<std::string> names;
    for (const Output& measure : measures) names.push_back(prefix + std::string(measure.name));
    return names;
}

template <class Source>
void add_values(std::span<const Measure<Source>> measures, const Source& source, std::vector<double>& row) {
    for (const Measure<Source>& measure : measures) row.push_back(measure.of(source));
}

template <class Source>
std::vector<double> values_of(std::span<const Measure<Source>> measures, const Source& source) {
    std::vector<double> row;
    add_values(measures, source, row);
    return row;
}

/// All outputs of one file, or of one part of it, in their order.
struct OutputTable {
    std::string name;  // "energy.csv", "summary"
    std::string doc;   // what one line of the file contains
    std::vector<Output> rows;
};

}  // namespace knap
