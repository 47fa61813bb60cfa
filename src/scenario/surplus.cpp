#include "scenario/surplus.hpp"

#include "base/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

namespace knap {
namespace {

std::vector<std::string> calibration_fields(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');) fields.emplace_back(trimmed(field));
    return fields;
}

/// Linear between the values; none outside.
std::optional<Surplus> between(const std::map<double, Surplus>& values, double x) {
    const double tolerance = 1e-9 * (1 + std::abs(x));
    const auto above = values.lower_bound(x - tolerance);
    if (above == values.end()) return {};
    if (above->first <= x + tolerance) return above->second;
    if (above == values.begin()) return {};
    const auto below = std::prev(above);
    const double part = (x - below->first) / (above->first - below->first);
    return Surplus{std::lerp(below->second.mean, above->second.mean, part),
                   std::lerp(below->second.deviation, above->second.deviation, part)};
}

std::optional<Surplus> along_axis(const std::vector<SurplusPoint>& points, const std::vector<double>& at,
                                  const std::vector<double>& beyond, std::size_t axis) {
    std::map<double, std::vector<SurplusPoint>> groups;
    for (const SurplusPoint& point : points) groups[point.at[axis]].push_back(point);
    std::map<double, Surplus> values;
    for (const auto& [x, group] : groups) {
        const std::optional<Surplus> value =
            axis + 1 == at.size() ? group.back().surplus : along_axis(group, at, beyond, axis + 1);
        if (value) values[x] = *value;
    }
    if (values.empty()) return {};
    const double least = values.begin()->first, most = values.rbegin()->first, x = at[axis];
    if (beyond[axis] == 0) return between(values, x);
    const double margin = beyond[axis] + 1e-9;
    if (x < least - margin || x > most + margin) return {};
    return between(values, std::clamp(x, least, most));
}

}  // namespace

UserError bad_calibration(const CalibrationFormat& format, const CalibrationLine& line, const std::string& what) {
    return UserError("bad-csv", "line " + std::to_string(line.number) + " of the table of " + format.name + " " + what,
                     std::string("each line: ") + format.columns + "; `knap calibrate` writes such a table");
}

std::vector<CalibrationLine> calibration_lines(const CalibrationFormat& format, const std::string& csv) {
    const std::size_t n_columns = calibration_fields(format.columns).size();
    std::vector<CalibrationLine> lines;
    std::istringstream in(csv);
    int number = 0;
    for (std::string text; std::getline(in, text);) {
        CalibrationLine line{.number = ++number};
        const std::string content(trimmed(std::string_view(text).substr(0, text.find_first_of("#\r"))));
        if (content.empty() || content == format.columns) continue;
        const std::vector<std::string> fields = calibration_fields(content);
        if (fields.size() != n_columns)
            throw bad_calibration(
                format, line,
                "has " + std::to_string(fields.size()) + " fields instead of " + std::to_string(n_columns));
        for (std::size_t i = 0; i < n_columns; ++i) {
            const std::string& field = fields[i];
            if (i < format.n_words) {
                line.words.push_back(field);
                continue;
            }
            double& value = line.numbers.emplace_back(0);
            const auto [end, fault] = std::from_chars(field.data(), field.data() + field.size(), value);
            if (fault != std::errc() || end != field.data() + field.size() || !(value >= 0 && value < 1e9))
                throw bad_calibration(format, line, "has `" + field + "` in place of a number");
        }
        lines.push_back(line);
    }
    if (number == 0)
        throw UserError("bad-csv", std::string("the table of ") + format.name + " is empty",
                        "`knap calibrate` writes one");
    return lines;
}

std::optional<Surplus> interpolated(const std::vector<SurplusPoint>& points, const std::vector<double>& at,
                                    const std::vector<double>& beyond) {
    return along_axis(points, at, beyond, 0);
}

}  // namespace knap
