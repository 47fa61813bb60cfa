#pragma once
// What one number, column or array of the output is called, its unit and its one meaning. The list of all of them is in record/outputs.hpp.
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace knap {

struct Output {
    std::string_view name;  // "*_force_x": after a name that the scenario gives
    std::string_view unit;  // SI, angles in degrees where it says so; "" for a pure number, a count or a text
    std::string_view doc;
};

/// An output with how it is had from what a line is about.
template <class Source>
struct Measure {
    std::string_view name, unit, doc;
    double (*of)(const Source&);
};

template <class Source>
std::vector<std::string> names_of(std::span<const Measure<Source>> measures) {
    std::vector<std::string> names;
    for (const Measure<Source>& measure : measures) names.emplace_back(measure.name);
    return names;
}

template <class Source>
std::vector<double> values_of(std::span<const Measure<Source>> measures, const Source& source) {
    std::vector<double> values;
    for (const Measure<Source>& measure : measures) values.push_back(measure.of(source));
    return values;
}

/// What stands in one file, or in one part of it, in its order.
struct OutputTable {
    std::string name;  // "energy.csv", "summary"
    std::string doc;   // what a line of it is
    std::vector<Output> rows;
};

}  // namespace knap
