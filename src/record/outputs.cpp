#include "record/outputs.hpp"

#include "base/formatted.hpp"
#include "figures/ticks.hpp"
#include "output/vtk_series.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace knap {
namespace {

bool is_named(const Output& row, std::string_view name) {
    return row.name.starts_with('*') ? name.size() >= row.name.size() && name.ends_with(row.name.substr(1))
                                     : row.name == name;
}

}  // namespace

const OutputTable& output_table(std::string_view name) {
    static const OutputTable none;
    const auto found = std::ranges::find(output_tables(), name, &OutputTable::name);
    return found == output_tables().end() ? none : *found;
}

const Output* find_output(std::string_view table, std::string_view name) {
    const std::vector<Output>& rows = output_table(table).rows;
    const auto exact = std::ranges::find(rows, name, &Output::name);
    const auto found = exact != rows.end()
                           ? exact
                           : std::ranges::find_if(rows, [&](const Output& row) { return is_named(row, name); });
    return found == rows.end() ? nullptr : &*found;
}

std::string_view unit_of(std::string_view table, std::string_view name) {
    const Output* row = find_output(table, name);
    return row ? row->unit : "";
}

std::string_view unit_of_column(std::string_view column) {
    for (const HistoryFile& file : history_files)
        if (const Output* row = file.regular ? find_output(file.name, column) : nullptr) return row->unit;
    return "";
}

std::string_view unit_of_slope(std::string_view column) {
    const std::string_view unit = unit_of_column(column);
    return unit == "J"        ? "W"
           : unit == "m"      ? "m/s"
           : unit == "m/s"    ? "m/s2"
           : unit == "N"      ? "N/s"
           : unit == "kg m/s" ? "N"
           : unit == "Pa"     ? "Pa/s"
           : unit == "s"      ? ""
                              : "1/s";
}

std::vector<std::string> header_of(const std::string& table, const std::vector<std::string>& columns, bool celsius) {
    std::vector<std::string> header;
    for (const std::string& column : columns)
        header.push_back(with_unit(column, std::string(unit_of_temperature(unit_of(table, column), celsius))));
    return header;
}

std::string value_text(double value, std::string_view unit, int digits) {
    if (std::isnan(value)) return "none";
    return formatted("%.*g", digits, value + 0.0) + (unit.empty() ? "" : " " + std::string(unit));
}

std::string shown_text(double value, std::string_view unit, int digits) {
    const DisplayUnit shown = display_unit(std::abs(value), std::string(unit));
    return value_text(value * shown.factor, shown.unit, digits);
}

std::string outputs_markdown() {
    const auto escaped = [](std::string_view text) {
        std::string out;
        for (const char c : text)
            out += c == '|' ? std::string("\\|") : c == '*' ? std::string("\\*") : std::string(1, c);
        return out;
    };
    std::string text =
        "# What a run writes\n\n"
        "This list is written by the program (`knap schema --outputs`). Units are SI (temperatures in K, or in C where "
        "the scenario gives them so); a name without a unit is a pure number, a count or a text. A body is computed in "
        "the plane with the thickness `domain.thickness` (1 m unless the scenario sets it; `thickness_m` of run.json): "
        "J, N, N m, kg and kg m/s refer to this thickness.\n\n"
        "A table starts with one line of names with units in brackets, as `time [s]`. The value of an event that never "
        "happened, or that is unknown, is an empty field (`null` in run.json, `none` in texts), so that pandas, "
        "numpy.genfromtxt and spreadsheets read it as missing. `*` stands for a name that the scenario gives. A "
        "scenario (study, expect, sweep) refers to a column by its name without the unit.\n";
    for (const OutputTable& table : output_tables()) {
        text += "\n## " + table.name + "\n\n" + table.doc + ".\n\n| name | unit | meaning |\n|---|---|---|\n";
        for (const Output& row : table.rows)
            text += "| `" + std::string(row.name) + "` | " + std::string(row.unit) + " | " + escaped(row.doc) + " |\n";
    }
    return text;
}

}  // namespace knap
