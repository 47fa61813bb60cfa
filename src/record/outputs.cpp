#include "record/outputs.hpp"

#include "output/vtk_series.hpp"
#include "analysis/breaks.hpp"
#include "analysis/fragments.hpp"
#include "analysis/gates.hpp"
#include "analysis/crack_history.hpp"
#include "analysis/energy_ledger.hpp"
#include "analysis/probes.hpp"
#include "analysis/reactions.hpp"
#include "analysis/specimen.hpp"
#include "figures/ticks.hpp"
#include "record/run_outputs.hpp"
#include "record/summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace knap {
namespace {

template <class Source>
std::vector<Output> rows_of(std::span<const Measure<Source>> measures) {
    std::vector<Output> rows;
    for (const Measure<Source>& measure : measures) rows.push_back({measure.name, measure.unit, measure.doc});
    return rows;
}

/// Rows behind names that the scenario gives.
template <class Source>
void add_named(std::span<const Measure<Source>> columns, std::vector<Output>& rows) {
    static std::map<std::string_view, std::string> patterns;  // rows point into it
    for (const Output& column : columns) {
        const std::string& pattern = patterns.emplace(column.name, "*" + std::string(column.name)).first->second;
        rows.push_back({pattern, column.unit, column.doc});
    }
}

std::vector<OutputTable> all_tables() {
    const Output time{"time", "s", "of the line"};
    std::vector<Output> reactions{time}, probes{time};
    add_named(driver_columns(), reactions);
    add_named(obstacle_columns(), reactions);
    add_named(place_columns(), probes);
    add_named(interface_columns(), probes);
    std::vector<OutputTable> tables{
        {"summary", "numbers of a run: `summary` of run.json, log.txt, stdout, `knap info`; what [expect], studies and sweeps may name", summary_outputs()},
        {"energy.csv", "energies and works so far; a line every output.history_every", rows_of(energy_columns())},
        {"cracks.csv", "cracks; a line at the same times", rows_of(crack_columns())},
        {"reactions.csv", "what drives the body, at the same times; the name of a load (load0, load1, ... where it has none) or of an obstacle stands before each", reactions},
        {"probes.csv", "places and interfaces that are watched, at the same times, each after its name", probes},
        {"breaks.csv", "a line for every interface when it breaks; with output.breaks", rows_of(break_columns())},
        {"stress_strain.csv", "the specimen of a rock test, at the same times", rows_of(stress_strain_columns())},
        {"arms.csv", "a line for the start of every arm of a crack and for each of its edges, at the end", rows_of(arm_columns())},
        {"fragments.csv", "a line a piece of the body, at the end, the heaviest first", rows_of(fragment_columns())},
    };
    OutputTable& gates = tables.emplace_back(
        OutputTable{"gates", "what a run is held against: `gates` of run.json, each with value, unit, warning, limit, level, pass, place_m, meaning and cure", {}});
    for (const GateRule& rule : gate_rules()) gates.rows.push_back({rule.name, rule.unit, rule.meaning});
    tables.insert(tables.end(), frame_outputs().begin(), frame_outputs().end());
    for (OutputTable& table : run_outputs()) tables.push_back(std::move(table));
    return tables;
}

bool is_named(const Output& row, std::string_view name) {
    return row.name.starts_with('*') ? name.size() >= row.name.size() && name.ends_with(row.name.substr(1)) : row.name == name;
}

}  // namespace

const std::vector<OutputTable>& output_tables() {
    static const std::vector<OutputTable> tables = all_tables();
    return tables;
}

const OutputTable& output_table(std::string_view name) {
    static const OutputTable none;
    const auto found = std::ranges::find(output_tables(), name, &OutputTable::name);
    return found == output_tables().end() ? none : *found;
}

const Output* find_output(std::string_view table, std::string_view name) {
    const std::vector<Output>& rows = output_table(table).rows;
    const auto exact = std::ranges::find(rows, name, &Output::name);
    const auto found = exact != rows.end() ? exact : std::ranges::find_if(rows, [&](const Output& row) { return is_named(row, name); });
    return found == rows.end() ? nullptr : &*found;
}

std::string_view unit_of(std::string_view table, std::string_view name) {
    const Output* row = find_output(table, name);
    return row ? row->unit : "";
}

std::string_view unit_of_column(std::string_view column) {
    for (const char* table : {"energy.csv", "cracks.csv", "reactions.csv", "probes.csv", "stress_strain.csv"})
        if (const Output* row = find_output(table, column)) return row->unit;
    return "";
}

std::string_view unit_of_slope(std::string_view column) {
    const std::string_view unit = unit_of_column(column);
    return unit == "J" ? "W" : unit == "m" ? "m/s" : unit == "m/s" ? "m/s2" : unit == "N" ? "N/s" : unit == "Pa" ? "Pa/s" : unit == "s" ? "" : "1/s";
}

std::vector<std::string> header_of(const std::string& table, const std::vector<std::string>& columns) {
    std::vector<std::string> header;
    for (const std::string& column : columns) header.push_back(with_unit(column, std::string(unit_of(table, column))));
    return header;
}

std::string value_text(double value, std::string_view unit, int digits) {
    if (std::isnan(value)) return "none";
    char text[64];
    std::snprintf(text, sizeof text, "%.*g", digits, value + 0.0);
    return unit.empty() ? text : text + (" " + std::string(unit));
}

std::string outputs_markdown() {
    const auto escaped = [](std::string_view text) {
        std::string out;
        for (const char c : text) out += c == '|' ? std::string("\\|") : c == '*' ? std::string("\\*") : std::string(1, c);
        return out;
    };
    std::string text =
        "# What a run writes\n\n"
        "All of it, from the list in the program (`knap schema --outputs`). Units are SI; a name without a unit is a pure number, a count or a text. A body is "
        "computed in the plane, with the thickness `domain.thickness` (1 m unless the scenario says otherwise; `thickness_m` of run.json): J, N, N m, kg and kg m/s are "
        "those of the whole thickness.\n\n"
        "A table begins with one line of names with units in brackets, as `time [s]`; what never happened, or is not known, is an empty field (in run.json `null`, in "
        "texts `none`), so that pandas, numpy.genfromtxt and spreadsheets read it as a gap. `*` stands for a name that the scenario gives. "
        "In a scenario (study, expect, sweep) a column is named without its unit.\n";
    for (const OutputTable& table : output_tables()) {
        text += "\n## " + table.name + "\n\n" + table.doc + ".\n\n| name | unit | meaning |\n|---|---|---|\n";
        for (const Output& row : table.rows) text += "| `" + std::string(row.name) + "` | " + std::string(row.unit) + " | " + escaped(row.doc) + " |\n";
    }
    return text;
}

}  // namespace knap
